// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "shoal/comms/wall_time.h"

namespace shoal::comms {

/// A wall clock that moves only when somebody sleeps.
class FakeWall {
 public:
  WallTime time() {
    return {.now_us = [state = state_] { return state->now_us; },
            .sleep_us =
                [state = state_](int64_t us) {
                  state->now_us += us;
                  state->sleeps.push_back(us);
                }};
  }
  int64_t now() const { return state_->now_us; }
  void pass(int64_t us) { state_->now_us += us; }
  const std::vector<int64_t>& sleeps() const { return state_->sleeps; }

 private:
  struct State {
    int64_t now_us = 123'456;
    std::vector<int64_t> sleeps;
  };
  std::shared_ptr<State> state_ = std::make_shared<State>();  // outlived by the functions handed out
};

}  // namespace shoal::comms
