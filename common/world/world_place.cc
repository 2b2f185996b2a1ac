// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "shoal/demand.h"
#include "shoal/world/place.h"

namespace shoal::world {
namespace {

class WorldPlace final : public Place {
 public:
  WorldPlace(std::unique_ptr<World> world, uint64_t seed) : world_(std::move(world)), seed_(seed) {
    SHOAL_DEMAND(world_);
  }

  const std::string& name() const override { return world_->name(); }
  const std::vector<TruthClass>& classes() const override { return world_->classes(); }
  int maxRobots() const override { return kMaxTeam; }
  bool isRecorded() const override { return false; }

  SurveyOptions completed(SurveyOptions options) const override {
    checkSensors(options.sensors);
    if (options.cell_size_m == 0.0) options.cell_size_m = world_->defaultCellSize();
    if (options.altitude_m == 0.0) options.altitude_m = options.intrinsics.fx * world_->metresPerPixel();
    return options;
  }

  std::unique_ptr<ObservationSource> source(const SurveyOptions& options, int robot,
                                            bool single) const override {
    auto perfect = makeSurveySource(*world_, surveyPath(*world_, options, robot, single), options.intrinsics,
                                    options.frame_period_s);
    return withSensors(std::move(perfect), options.sensors, robot, seed_);
  }

  std::optional<Extent> extent() const override { return world_->extent(); }
  std::optional<uint8_t> truthOfSquare(const Grid& grid, const CellIndex& cell) const override {
    return world_->truthOfSquare(grid, cell);
  }
  bool hasFlatTruth() const override { return world_->hasFlatTruth(); }

 private:
  const std::unique_ptr<const World> world_;
  const uint64_t seed_;
};

}  // namespace

std::unique_ptr<Place> makePlace(std::unique_ptr<World> world, uint64_t seed) {
  return std::make_unique<WorldPlace>(std::move(world), seed);
}

}  // namespace shoal::world
