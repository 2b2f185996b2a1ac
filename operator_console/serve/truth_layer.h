// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <future>
#include <memory>
#include <mutex>

#include <nlohmann/json_fwd.hpp>

#include "operator_console/mission_truth.h"
#include "operator_console/serve/mission_feed.h"

namespace shoal::console {

/// What is really there, for those missions whose world is known. Found out once, in a thread of its own,
/// when first asked for: it may take as long as flying the mission's cameras again. Thread-safe.
class TruthLayer {
 public:
  TruthLayer(Where where, TruthHint hint);

  /// Whether there is a world to look into.
  bool isNamed() const { return !world_.empty(); }

  /// {"classes": [{"id", "name", "color"}]}; null while it is being found out.
  /// @throws std::runtime_error when the truth is not to be had, saying why.
  nlohmann::ordered_json classes();

  /// A map's tiles with the true classes as labels, -1 where they are not known; what else they hold stays.
  /// nullptr while it is being found out. @throws as classes().
  std::shared_ptr<const TileMap> tiles(const Moment& moment);

 private:
  const MissionTruth* known();  // guarded by mutex_

  const Where where_;
  const TruthHint hint_;
  const std::string world_;
  std::mutex mutex_;
  std::future<MissionTruth> finding_;  // guarded by mutex_, as all below
  std::unique_ptr<const MissionTruth> truth_;
  std::string problem_;
  uint64_t drawn_sequence_ = 0;
  std::shared_ptr<const TileMap> drawn_;
};

}  // namespace shoal::console
