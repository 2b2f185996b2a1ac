// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/serve/truth_layer.h"

#include <chrono>
#include <exception>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <spdlog/fmt/fmt.h>

namespace shoal::console {

TruthLayer::TruthLayer(Where where, TruthHint hint)
    : where_(std::move(where)), hint_(std::move(hint)), world_(worldOf(where_, hint_)) {}

const MissionTruth* TruthLayer::known() {
  if (world_.empty())
    throw std::runtime_error("nobody says which world this is: serve --world knows the truth");
  if (!problem_.empty()) throw std::runtime_error(problem_);
  if (truth_) return truth_.get();
  if (!finding_.valid()) {
    finding_ = std::async(std::launch::async, [this] { return truthOf(where_, viewOf(where_), hint_); });
  }
  if (finding_.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) return nullptr;
  try {
    truth_ = std::make_unique<const MissionTruth>(finding_.get());
  } catch (const std::exception& error) {
    problem_ = error.what();
    throw std::runtime_error(problem_);
  }
  return truth_.get();
}

nlohmann::ordered_json TruthLayer::classes() {
  const std::lock_guard lock(mutex_);
  const MissionTruth* truth = known();
  if (truth == nullptr) return nullptr;
  nlohmann::ordered_json classes = nlohmann::ordered_json::array();
  for (const world::TruthClass& c : truth->place->classes()) {
    classes.push_back({{"id", c.id},
                       {"name", c.name},
                       {"color", fmt::format("#{:02x}{:02x}{:02x}", c.rgb[0], c.rgb[1], c.rgb[2])}});
  }
  return {{"classes", std::move(classes)}};
}

std::shared_ptr<const TileMap> TruthLayer::tiles(const Moment& moment) {
  const std::lock_guard lock(mutex_);
  const MissionTruth* truth = known();
  if (truth == nullptr) return nullptr;
  if (drawn_ && drawn_sequence_ == moment.sequence) return drawn_;
  TileMap drawn;
  for (const auto& [key, versioned] : moment.tiles) {
    auto tile = std::make_shared<Tile>(*versioned.tile);
    for (size_t i = 0; i < kTileColumns; ++i) {
      if (tile->label[i] < 0) continue;
      const world::CellIndex cell{key.first * kTileSide + static_cast<int32_t>(i) % kTileSide,
                                  key.second * kTileSide + static_cast<int32_t>(i) / kTileSide,
                                  tile->height[i]};
      tile->label[i] = truth->of_cell(cell).value_or(-1);
    }
    drawn.emplace(key, VersionedTile{moment.sequence, std::move(tile)});
  }
  drawn_ = std::make_shared<const TileMap>(std::move(drawn));
  drawn_sequence_ = moment.sequence;
  return drawn_;
}

}  // namespace shoal::console
