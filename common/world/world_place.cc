// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "shoal/demand.h"
#include "shoal/world/place.h"

namespace shoal::world {
namespace {

class WorldPlace final : public Place {
 public:
  explicit WorldPlace(std::unique_ptr<World> world) : world_(std::move(world)) { SHOAL_DEMAND(world_); }

  const std::string& name() const override { return world_->name(); }
  const std::vector<TruthClass>& classes() const override { return world_->classes(); }
  int maxRobots() const override { return kMaxTeam; }
  bool isRecorded() const override { return false; }

  SurveyOptions completed(SurveyOptions options) const override {
    if (options.cell_size_m == 0.0) options.cell_size_m = world_->defaultCellSize();
    if (options.altitude_m == 0.0) options.altitude_m = options.intrinsics.fx * world_->metresPerPixel();
    return options;
  }

  std::unique_ptr<ObservationSource> source(const SurveyOptions& options, int robot,
                                            bool single) const override {
    return makeSurveySource(*world_, surveyPath(*world_, options, robot, single), options.intrinsics,
                            options.frame_period_s);
  }

  std::optional<Extent> extent() const override { return world_->extent(); }
  std::optional<uint8_t> truthOfSquare(const Grid& grid, const CellIndex& cell) const override {
    return world_->truthOfSquare(grid, cell);
  }
  bool hasFlatTruth() const override { return world_->hasFlatTruth(); }

 private:
  const std::unique_ptr<const World> world_;
};

}  // namespace

std::unique_ptr<Place> makePlace(std::unique_ptr<World> world) {
  return std::make_unique<WorldPlace>(std::move(world));
}

std::unique_ptr<Place> openPlace(const std::string& spec, uint64_t seed) {
  return makePlace(openWorld(spec, seed));
}

}  // namespace shoal::world
