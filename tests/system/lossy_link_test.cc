// SPDX-License-Identifier: BSD-3-Clause
// Real codecs, real queue, real budget, real state over a link that loses, doubles and reorders. No
// processes.
#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fusion_node/mission_state.h"
#include "shoal/comms/channels.h"
#include "shoal/comms/memory_bus.h"
#include "shoal/comms/sender.h"
#include "shoal/comms/window_meter.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/random.h"
#include "shoal/wire/piece_codec.h"

namespace shoal {
namespace {

constexpr int32_t kMission = 7;
constexpr int64_t kSecondUs = 1'000'000;
constexpr int64_t kBudget = 3000;

// A robot that makes up its beliefs: a few topics of a shared set, a strip of cells, more at every step.
class Speaker {
 public:
  Speaker(int number, comms::MemoryNetwork& network)
      : robot_{number}, bus_(network.connect()), sender_(*bus_, nullptr, options()) {}

  void learn(int step) {
    Random random(99, static_cast<uint64_t>(number(robot_)), static_cast<uint64_t>(step));
    mapping::LocalBelief belief{robot_, {0, step}, {{"a", 0, 400}, {"b", 400, 100}}, {}, {}};
    for (int t = 0; t < 3 + step % 2; ++t) {
      mapping::BelievedTopic topic{world::TopicId{t}, {t * kSecondUs}, 0, {}};
      const int what = (t + number(robot_)) % 5;  // robots number the same things differently
      for (int word = what * 80; word < what * 80 + 80; ++word) {
        topic.words.push_back({word, 1 + static_cast<int32_t>(random.below(30))});
        topic.weight += topic.words.back().count;
      }
      belief.topics.push_back(topic);
    }
    for (int x = 0; x < 10 + 10 * step; ++x)
      for (int y = 0; y < 12; ++y)
        belief.cells.push_back({{x, y + 10 * number(robot_), 0},
                                world::TopicId{x / 7 % 3},
                                {(x % 10) * kSecondUs},
                                static_cast<float>(random.uniform())});
    for (const mapping::Piece& whole : changes_.update(belief)) {
      const std::string channel = comms::channelName(name(robot_), wire::channelKind(wire::kindOf(whole)));
      for (const mapping::Piece& part : wire::cutToFit(whole, wire::maxPayload(channel.size()))) {
        said_.apply(part);
        sender_.offer(comms::TrafficClass::kTopics,
                      std::to_string(static_cast<int>(part.key.kind)) + "/" +
                          std::to_string(part.key.index[0]) + "/" + std::to_string(part.key.index[1]) + "/" +
                          std::to_string(part.part),
                      {channel, wire::encode(part, kMission, {step * kSecondUs})});
      }
    }
  }

  void speakUntil(int64_t to_us) {
    for (int64_t now = now_us_; now < to_us; now = std::min(sender_.pump(now), to_us)) now_us_ = now;
    now_us_ = to_us;
  }

  const mapping::BeliefStore& said() const { return said_; }
  world::RobotId robot() const { return robot_; }
  const comms::Sender& sender() const { return sender_; }

 private:
  static comms::SenderOptions options() {
    comms::SenderOptions options;
    options.bytes_per_s = kBudget;
    options.wall = {[] { return int64_t{0}; }, [](int64_t) {}};
    options.pacing.gap_us = 0;
    return options;
  }

  world::RobotId robot_;
  std::unique_ptr<comms::MemoryBus> bus_;
  comms::Sender sender_;
  mapping::BeliefChanges changes_;
  mapping::BeliefStore said_;
  int64_t now_us_ = 0;
};

struct Listener {
  explicit Listener(comms::MemoryNetwork& network) : bus(network.connect()), state(kMission, {}) {}
  void listen() {
    bus->receive(0, [this](const comms::Packet& packet) { state.hear(packet, stats); });
  }
  bool holdsAll(const std::vector<std::unique_ptr<Speaker>>& speakers) const {
    return std::ranges::all_of(speakers, [this](const auto& s) {
      return state.beliefs().digestOf(s->robot()) == s->said().digestOf(s->robot());
    });
  }
  std::unique_ptr<comms::MemoryBus> bus;
  fusion_node::MissionState state;
  comms::Stats stats;
};

// Seconds of mission time until both listeners hold everything, or -1.
int settle(comms::MemoryNetwork& network, std::vector<std::unique_ptr<Speaker>>& speakers,
           std::vector<std::unique_ptr<Listener>>& listeners,
           const std::function<void(int, comms::MemoryNetwork&)>& happen) {
  for (int second = 0; second < 600; ++second) {
    happen(second, network);
    for (auto& speaker : speakers) {
      if (second < 8) speaker->learn(second);
      speaker->speakUntil((second + 1) * kSecondUs);
    }
    for (auto& listener : listeners) listener->listen();
    if (second >= 8 && std::ranges::all_of(listeners, [&](const auto& l) { return l->holdsAll(speakers); })) {
      return second;
    }
  }
  return -1;
}

void expectOneMap(const std::vector<std::unique_ptr<Speaker>>& speakers,
                  std::vector<std::unique_ptr<Listener>>& listeners) {
  mapping::BeliefStore everything;
  for (const auto& speaker : speakers)
    speaker->said().visit([&](const mapping::Piece& p) { everything.apply(p); });
  const mapping::GlobalMap expected = mapping::fuse(everything, {});
  ASSERT_GT(expected.cells.size(), 1000u);
  for (auto& listener : listeners) {
    EXPECT_EQ(listener->state.beliefs().digest(), everything.digest());
    EXPECT_EQ(listener->state.refreshMap().cells, expected.cells);
    EXPECT_EQ(listener->state.mapDigest(), expected.digest());
    EXPECT_TRUE(listener->stats.rejected.empty());
  }
}

void run(const comms::MemoryNetworkOptions& options,
         const std::function<void(int, comms::MemoryNetwork&)>& happen, int latest) {
  comms::MemoryNetwork network(options);
  std::vector<std::unique_ptr<Speaker>> speakers;
  for (int r = 0; r < 3; ++r) speakers.push_back(std::make_unique<Speaker>(r, network));
  std::vector<std::unique_ptr<Listener>> listeners;
  for (int i = 0; i < 2; ++i) listeners.push_back(std::make_unique<Listener>(network));
  const int settled = settle(network, speakers, listeners, happen);
  EXPECT_GE(settled, 0) << "not everything was heard within 600 s";
  EXPECT_LE(settled, latest);
  expectOneMap(speakers, listeners);
  for (const auto& speaker : speakers) {
    EXPECT_LE(speaker->sender().worstWindow().bytes, std::max<int64_t>(kBudget, comms::kMaxWireBytes));
  }
}

TEST(LossyLinkTest, ACleanLinkCarriesEverything) {
  run(
      {.seed = 1}, [](int, comms::MemoryNetwork&) {}, 60);
}

TEST(LossyLinkTest, RotationHealsLossAndDisorder) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    run(
        {.seed = seed, .loss = 0.4, .duplication = 0.2, .reordering = 0.3}, [](int, comms::MemoryNetwork&) {},
        300);
  }
}

TEST(LossyLinkTest, APartitionHeals) {
  run(
      {.seed = 3, .loss = 0.05},
      [](int second, comms::MemoryNetwork& network) {
        if (second == 2) network.partition({0, 0, 1, 0, 1});
        if (second == 40) network.heal();
      },
      200);
}

}  // namespace
}  // namespace shoal
