// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/mapper.h"

#include "shoal/cpu_time.h"

namespace shoal::robot_agent {
namespace {

// Bricks of labels or certainties told with an image in flight, so that it takes no longer on large maps: in
// all turns all of what a robot of a team usually holds. What has changed without being seen waits, at last
// for the end.
constexpr size_t kMostBricks = 128 / Mapper::kTurns;

// Cells looked at for what has changed, beside those of the bricks seen: the same, and all of a usual map.
constexpr size_t kMostCells = 16384 / Mapper::kTurns;

}  // namespace

robot::StageTimes Mapper::learn(const world::Observation& observation) {
  explorer_.observe(observation);
  const double learnt_ms = threadCpuMs();
  belief_ = explorer_.outline();
  path_.push_back({observation.time, observation.world_from_camera});
  robot::StageTimes times = explorer_.lastTimes();
  times.belief_ms += threadCpuMs() - learnt_ms;
  return times;
}

void Mapper::lookAgain(const topics::TeamTopics& team, const std::function<void()>& breathe) {
  explorer_.lookAgain(team, breathe);
}

std::vector<mapping::Piece> Mapper::changesInTurn() {
  const mapping::BeliefChanges::Turn turn{static_cast<int32_t>(path_.size() % kTurns), int32_t{kTurns}};
  return changes_.update(belief_, explorer_, explorer_.takeSeenBricks(), kMostBricks, kMostCells, turn);
}

std::vector<mapping::Piece> Mapper::allChanges() {
  if (path_.empty()) return {};
  belief_ = explorer_.belief();
  explorer_.takeSeenBricks();
  return changes_.update(belief_);
}

void Mapper::saveTo(Checkpoint& checkpoint) const {
  checkpoint.explorer = explorer_.checkpoint();
  checkpoint.untold = changes_.waiting(belief_, explorer_);
  checkpoint.looked_until = changes_.lookedUntil();
  checkpoint.seen = changes_.seen();
  checkpoint.path = path_;
}

void Mapper::restore(const Checkpoint& checkpoint) {
  explorer_.restore(checkpoint.explorer);
  path_ = checkpoint.path;
  if (path_.empty()) return;
  belief_ = explorer_.belief();
  changes_.restore(belief_, checkpoint.untold, checkpoint.looked_until, checkpoint.seen);
}

void Mapper::report(wire::Heartbeat& h) const {
  h.observation = path_.empty() ? -1 : belief_.version.observation - (explorer_.hasLookedAgain() ? 1 : 0);
  h.num_topics = static_cast<int32_t>(belief_.topics.size());
  h.num_cells = explorer_.numCells();
  h.vocabulary = explorer_.fingerprint();
  if (path_.empty()) return;
  const Eigen::Vector3f position = path_.back().world_from_camera.translation().cast<float>();
  h.x_m = position.x();
  h.y_m = position.y();
  h.z_m = position.z();
}

}  // namespace shoal::robot_agent
