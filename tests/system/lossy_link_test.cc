// SPDX-License-Identifier: BSD-3-Clause
// Real codecs, real queue, real budget, real state over a link that loses, doubles and reorders. No
// processes.
#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fusion_node/link.h"
#include "fusion_node/mission_state.h"
#include "shoal/comms/channels.h"
#include "shoal/comms/link_model.h"
#include "shoal/comms/memory_bus.h"
#include "shoal/comms/sender.h"
#include "shoal/comms/window_meter.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/fusion.h"
#include "shoal/random.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/piece_codec.h"

namespace shoal {
namespace {

constexpr int32_t kMission = 7;
constexpr int64_t kSecondUs = 1'000'000;

// A network and, between it and each listener, a link.
struct Trouble {
  comms::MemoryNetworkOptions network = {};
  comms::LinkModel link = {};
  int64_t budget = 3000;  // of each robot
  std::function<void(int second, comms::MemoryNetwork&)> happen = [](int, comms::MemoryNetwork&) {};
};

// A robot that makes up its beliefs: a few topics of a shared set, a strip of cells, more at every step.
class Speaker {
 public:
  Speaker(int number, comms::MemoryNetwork& network, int64_t budget)
      : robot_{number}, bus_(network.connect()), sender_(*bus_, nullptr, options(budget)) {}

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
                      {channel, wire::encode(part, kMission, {})});
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
  static comms::SenderOptions options(int64_t budget) {
    comms::SenderOptions options;
    options.bytes_per_s = budget;
    options.stamp = [](comms::Packet& packet, int64_t now_us) { wire::stampTime(packet.bytes, {now_us}); };
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
  Listener(const std::string& name, comms::MemoryNetwork& network, const comms::LinkModel& model)
      : bus(network.connect()),
        link(fusion_node::emulated(*bus, model, {name, kMission, 1, 0})),
        state(kMission, {}) {}
  void listen() {
    comms::Bus& heard_through = link ? static_cast<comms::Bus&>(*link) : *bus;
    heard_through.receive(0, [this](const comms::Packet& packet) { state.hear(packet, stats); });
  }
  bool holdsAll(const std::vector<std::unique_ptr<Speaker>>& speakers) const {
    return std::ranges::all_of(speakers, [this](const auto& s) {
      return state.beliefs().digestOf(s->robot()) == s->said().digestOf(s->robot());
    });
  }
  std::unique_ptr<comms::MemoryBus> bus;
  std::unique_ptr<comms::LinkEmulator> link;
  fusion_node::MissionState state;
  comms::Stats stats;
};

// Seconds of mission time until both listeners hold everything, or -1.
int settle(comms::MemoryNetwork& network, std::vector<std::unique_ptr<Speaker>>& speakers,
           std::vector<std::unique_ptr<Listener>>& listeners,
           const std::function<void(int, comms::MemoryNetwork&)>& happen) {
  for (int second = 0; second < 3000; ++second) {
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

// Returns the second in which both listeners held everything.
int run(const Trouble& trouble, int latest) {
  comms::MemoryNetwork network(trouble.network);
  std::vector<std::unique_ptr<Speaker>> speakers;
  for (int r = 0; r < 3; ++r) speakers.push_back(std::make_unique<Speaker>(r, network, trouble.budget));
  std::vector<std::unique_ptr<Listener>> listeners;
  for (const std::string name : {"OPERATOR", "R07"})
    listeners.push_back(std::make_unique<Listener>(name, network, trouble.link));
  const int settled = settle(network, speakers, listeners, trouble.happen);
  EXPECT_GE(settled, 0) << "not everything was heard within 3000 s";
  EXPECT_LE(settled, latest);
  expectOneMap(speakers, listeners);
  for (const auto& speaker : speakers) {
    EXPECT_LE(speaker->sender().worstWindow().bytes, std::max<int64_t>(trouble.budget, comms::kMaxWireBytes));
  }
  return settled;
}

TEST(LossyLinkTest, ACleanLinkCarriesEverything) { run({.network = {.seed = 1}}, 60); }

TEST(LossyLinkTest, RotationHealsLossAndDisorder) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    run({.network = {.seed = seed, .loss = 0.4, .duplication = 0.2, .reordering = 0.3}}, 300);
  }
}

TEST(LossyLinkTest, APartitionHeals) {
  run({.network = {.seed = 3, .loss = 0.05},
       .happen =
           [](int second, comms::MemoryNetwork& network) {
             if (second == 2) network.partition({0, 0, 1, 0, 1});
             if (second == 40) network.heal();
           }},
      200);
}

// On every emulated link the nodes end with the very state and map of a perfect one. On thin links robots
// have a budget that fits.
TEST(EmulatedLinkTest, EveryPresetEndsWithTheMapOfAPerfectLink) {
  run({.link = *comms::linkPreset("mesh")}, 120);
  run({.link = *comms::linkPreset("acoustic"), .budget = 600}, 1200);
  run({.link = *comms::linkPreset("satellite"), .budget = 300}, 1200);
}

// More than half is lost, the rest late, double and in disorder; a minute apart besides.
TEST(EmulatedLinkTest, WhateverTheLinkDoesEndsWithTheMapOfAPerfectLink) {
  comms::LinkModel link;
  link.delay_s = 3;
  link.jitter_s = 4;
  link.loss = 0.5;
  link.bursts = {.good_s = 20, .bad_s = 5, .loss = 1};
  link.reordering = 0.3;
  link.duplication = 0.2;
  link.late_s = 15;
  link.partitions = {{.from_s = 3, .until_s = 63, .groups = {{"R00", "OPERATOR"}, {"R01", "R02", "R07"}}}};
  EXPECT_GT(run({.link = link}, 600), 63);
}

// A link that carries less than robots send loses the rest, and rotation says that again.
TEST(EmulatedLinkTest, ALinkThatCarriesLessThanTheBudgetStillCarriesEverything) {
  run({.link = *comms::linkPreset("acoustic"), .budget = 3000}, 3000);
}

}  // namespace
}  // namespace shoal
