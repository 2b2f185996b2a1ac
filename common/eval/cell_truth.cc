// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/cell_truth.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "shoal/demand.h"

namespace shoal::eval {

void ProjectedTruth::add(const world::Observation& frame) {
  if (frame.labels.empty()) return;
  SHOAL_DEMAND(frame.labels.size() == frame.depth_m.size());
  for (int v = 0; v < frame.labels.rows; ++v) {
    const auto* labels = frame.labels.ptr<uint8_t>(v);
    const auto* depths = frame.depth_m.ptr<float>(v);
    for (int u = 0; u < frame.labels.cols; ++u) {
      const double depth = depths[u];
      if (!(depth > 0.0) || !std::isfinite(depth)) continue;
      const Eigen::Vector3d p_in_world = frame.world_from_camera * frame.intrinsics.unproject(u, v, depth);
      Votes& votes = votes_[grid_.cellOf(p_in_world)];
      if (labels[u] < votes.of_class.size()) {
        ++votes.of_class[labels[u]];
      } else {
        ++votes.unlabelled;
      }
    }
  }
}

void ProjectedTruth::add(const ProjectedTruth& other) {
  for (const auto& [cell, theirs] : other.votes_) {
    Votes& mine = votes_[cell];
    for (size_t i = 0; i < mine.of_class.size(); ++i) mine.of_class[i] += theirs.of_class[i];
    mine.unlabelled += theirs.unlabelled;
  }
}

std::optional<int> ProjectedTruth::at(const world::CellIndex& cell) const {
  const auto found = votes_.find(cell);
  if (found == votes_.end()) return std::nullopt;
  const auto& counts = found->second.of_class;
  const int labelled = std::reduce(counts.begin(), counts.end());
  if (labelled == 0 || labelled < found->second.unlabelled) return std::nullopt;
  return static_cast<int>(std::ranges::max_element(counts) - counts.begin());
}

std::optional<int> flatTruth(const world::World& world, const world::Grid& grid,
                             const world::CellIndex& cell) {
  const auto truth = world.truthOfSquare(grid, cell);
  return truth && *truth != 255 ? std::optional<int>(*truth) : std::nullopt;
}

}  // namespace shoal::eval
