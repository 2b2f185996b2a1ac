// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/cell_truth.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "shoal/demand.h"

namespace shoal::eval {
namespace {

constexpr uint8_t kUnlabelled = 255;

}  // namespace

void ProjectedTruth::Votes::add(uint8_t id, int32_t pixels) {
  const auto known = std::ranges::find(of_class, id, &Count::id);
  if (known == of_class.end()) {
    of_class.push_back({id, pixels});
  } else {
    known->pixels += pixels;
  }
}

void ProjectedTruth::add(const world::Observation& frame) {
  if (frame.labels.empty()) return;
  SHOAL_DEMAND(frame.labels.size() == frame.depth_m.size());
  constexpr double kMaxIndex = 2147483000.0;  // a little inside what a cell index holds
  world::CellIndex last;
  Votes* votes = nullptr;  // of `last`: neighbours mostly fall into one cell
  for (int v = 0; v < frame.labels.rows; ++v) {
    const auto* labels = frame.labels.ptr<uint8_t>(v);
    const auto* depths = frame.depth_m.ptr<float>(v);
    for (int u = 0; u < frame.labels.cols; ++u) {
      const double depth = depths[u];
      if (!(depth > 0.0) || !std::isfinite(depth)) continue;
      const Eigen::Vector3d p_in_world = frame.world_from_camera * frame.intrinsics.unproject(u, v, depth);
      if (!((p_in_world / grid_.cellSize()).cwiseAbs().maxCoeff() < kMaxIndex)) continue;
      const world::CellIndex cell = grid_.cellOf(p_in_world);
      if (votes == nullptr || cell != last) {
        votes = &votes_[cell];
        last = cell;
      }
      if (labels[u] == kUnlabelled) {
        ++votes->unlabelled;
      } else {
        votes->add(labels[u], 1);
      }
    }
  }
}

void ProjectedTruth::add(const ProjectedTruth& other) {
  for (const auto& [cell, theirs] : other.votes_) {
    Votes& mine = votes_[cell];
    for (const Count& count : theirs.of_class) mine.add(count.id, count.pixels);
    mine.unlabelled += theirs.unlabelled;
  }
}

std::optional<int> ProjectedTruth::at(const world::CellIndex& cell) const {
  const auto found = votes_.find(cell);
  if (found == votes_.end()) return std::nullopt;
  int64_t labelled = 0;
  Count most;
  for (const Count& count : found->second.of_class) {
    labelled += count.pixels;
    if (count.pixels > most.pixels || (count.pixels == most.pixels && count.id < most.id)) most = count;
  }
  if (labelled == 0 || labelled < found->second.unlabelled) return std::nullopt;
  return most.id;
}

std::optional<int> flatTruth(const world::Place& place, const world::Grid& grid,
                             const world::CellIndex& cell) {
  const auto truth = place.truthOfSquare(grid, cell);
  return truth && *truth != kUnlabelled ? std::optional<int>(*truth) : std::nullopt;
}

}  // namespace shoal::eval
