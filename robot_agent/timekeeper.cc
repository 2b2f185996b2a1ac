// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/timekeeper.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "fusion_node/process.h"

namespace shoal::robot_agent {
namespace {

using fusion_node::stopRequested;

constexpr int64_t kSecondUs = 1'000'000;
constexpr int kAwaitMs = 20;  // between two looks at a live source
// As fast as possible still leaves the others time to listen: wall time for a mission second after landing.
constexpr auto kBusySecond = std::chrono::milliseconds(40);    // new content waits
constexpr auto kIdleSecond = std::chrono::milliseconds(120);   // somebody may still lack something
constexpr auto kHeardSecond = std::chrono::milliseconds(300);  // nobody does

}  // namespace

Timekeeper::Timekeeper(double rate, comms::MissionClock& clock, CheckpointSaver& saver, Voice& voice,
                       Listener& listener, std::function<void()> heard)
    : rate_(rate),
      clock_(clock),
      saver_(saver),
      voice_(voice),
      listener_(listener),
      heard_(std::move(heard)) {}

void Timekeeper::passTimeUntil(int64_t to_us) {
  while (!stopRequested()) {
    const int64_t now = clock_.now();
    saver_.look();
    const int64_t next = std::min(send(now), to_us);
    listen(static_cast<int>(std::min<int64_t>(clock_.wallUntil(next) / 1000, 50)));
    if (now >= to_us) return;
    if (rate_ == 0) clock_.advanceTo(next);
  }
}

void Timekeeper::passSecond() {
  const auto start = std::chrono::steady_clock::now();
  passTimeUntil(clock_.now() + kSecondUs);
  if (rate_ != 0) return;
  const auto heard_or_idle = [&] { return listener_.isHeard() ? kHeardSecond : kIdleSecond; };
  std::this_thread::sleep_until(start + (isBusy() ? kBusySecond : heard_or_idle()));
}

void Timekeeper::awaitObservation(world::ObservationSource& source) {
  while (!stopRequested() && !source.ready()) {
    const int64_t now = clock_.now();
    saver_.look();
    send(now);
    listen(kAwaitMs);
  }
}

void Timekeeper::awaitSaved() {
  while (saver_.isSaving()) {
    breathe();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    saver_.look();
  }
}

void Timekeeper::breathe() {
  const auto now = std::chrono::steady_clock::now();
  if (rate_ == 0 && now - breathed_ >= kIdleSecond) {
    clock_.advanceTo(clock_.now() + kSecondUs);
    breathed_ = now;
  }
  send(clock_.now());
  listen(0);
}

// What is due. @returns the mission time at which there may be more.
int64_t Timekeeper::send(int64_t now_us) {
  const int64_t repair_due = listener_.repair(now_us);
  return std::min(voice_.sender().pump(now_us), repair_due);
}

void Timekeeper::listen(int timeout_ms) {
  listener_.hear(timeout_ms);
  heard_();
  listener_.warn();
}

}  // namespace shoal::robot_agent
