// SPDX-License-Identifier: BSD-3-Clause
// Real codecs, real queue, real budget, real repair, real state over a link that loses, doubles and reorders.
// No processes. The line that a mission prints is what docs/benchmarks.md shows.
#include <algorithm>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fusion_node/link.h"
#include "fusion_node/mission_state.h"
#include "fusion_node/repair.h"
#include "shoal/comms/channels.h"
#include "shoal/comms/link_model.h"
#include "shoal/comms/memory_bus.h"
#include "shoal/comms/sender.h"
#include "shoal/comms/window_meter.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/fusion.h"
#include "shoal/mapping/held_pictures.h"
#include "shoal/random.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/picture_pieces.h"
#include "shoal/wire/piece_codec.h"
#include "shoal/wire/repair_codec.h"

namespace shoal {
namespace {

constexpr int32_t kMission = 7;
constexpr int64_t kSecondUs = 1'000'000;

struct Scene {
  int robots = 3;
  std::vector<std::string> listeners = {"OPERATOR", "RELAY"};  // nodes that fuse
  int fusing_robots = 0;                                       // the first so many
  comms::MemoryNetworkOptions network = {};
  comms::LinkModel link = {};
  int64_t budget = 3000;                                  // of everybody
  int steps = 8;                                          // seconds in which robots learn
  int beats = 1;                                          // a second, in which all hear each other
  int strip = 10;                                         // columns of cells that a robot sees a step
  double apart_m = 0;                                     // robot k is at (k + 1) times this
  mapping::StoreLimits limits = {};                       // of what nodes hold
  std::function<int(const std::string&)> joins_at = {};   // second in which a node starts
  std::function<int(const std::string&)> leaves_at = {};  // and is no more
  std::function<bool(const std::string&, int)> is_down =
      {};  // killed, in that second: it comes again as it was
  std::function<void(int, comms::MemoryNetwork&)> happen = {};
};

// A robot that makes up its beliefs (a few topics of a shared set, a strip of cells, more at every step), or
// a node that only listens; as robot_agent and fusion_node join the parts.
class Party {
 public:
  Party(const std::string& name, int robot, bool fuses, const Scene& scene, comms::MemoryNetwork& network)
      : name_(name),
        robot_{robot},
        fuses_(fuses),
        x_m_(static_cast<float>(scene.apart_m * (robot + 1))),
        strip_(scene.strip),
        budget_(scene.budget),
        bus_(network.connect()),
        link_(fusion_node::emulated(*bus_, scene.link, {name, kMission, 1, 0})),
        state_(kMission, {}, 1.0, scene.limits),
        sender_(link_ ? static_cast<comms::Bus&>(*link_) : *bus_, nullptr, senderOptions(scene.budget)),
        repair_(repairOptions(), state_, sender_) {}

  void learn(int step) {
    if (!isRobot()) return;
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
    for (int x = 0; x < strip_ * (1 + step); ++x)
      for (int y = 0; y < 12; ++y)
        belief.cells.push_back({{x, y + 10 * number(robot_), 0},
                                world::TopicId{x / 7 % 3},
                                {(x % 10) * kSecondUs},
                                static_cast<float>(random.uniform())});
    for (const mapping::Piece& whole : changes_.update(belief)) {
      const std::string channel = comms::channelName(name_, wire::channelKind(wire::kindOf(whole)));
      for (const mapping::Piece& part : wire::cutToFit(whole, 600)) {
        said_.apply(part);
        state_.apply(part);
        sender_.offer(comms::TrafficClass::kTopics, queueKey(part),
                      {channel, wire::encode(part, kMission, {})});
      }
    }
  }

  // The robot shows what its topic 2 looks like, and sharper when it is asked to.
  void show() {
    for (const mapping::Piece& layer : wire::picturePieces(example_, robot_, 0)) say(layer);
  }

  void ask(const mapping::PieceKey& key, const world::Version& version) {
    for (const int32_t part : {0, 1}) repair_.ask(key, part, version);
  }

  void speakUntil(int64_t to_us) {
    while (now_us_ < to_us) {
      const int64_t repair_due = repair_.pump(now_us_);
      now_us_ = std::min({sender_.pump(now_us_), repair_due, to_us});
    }
  }

  void listen(bool attentive, int64_t now_us) {
    comms::Bus& ears = link_ ? static_cast<comms::Bus&>(*link_) : *bus_;
    ears.receive(0, [&](const comms::Packet& packet) {
      if (attentive) takeIn(packet);
    });
    if (!attentive) now_us_ = now_us;
  }

  void takeIn(const comms::Packet& packet) {
    ++num_heard_;
    state_.hear(packet, sender_.stats());
    repair_.hear(packet, now_us_);
  }

  void hear(const comms::Packet& packet) { repair_.hear(packet, now_us_); }

  bool isRobot() const { return number(robot_) >= 0; }
  bool fuses() const { return fuses_; }
  const std::string& name() const { return name_; }
  const mapping::BeliefStore& said() const { return said_; }
  fusion_node::MissionState& state() { return state_; }
  const comms::Sender& sender() const { return sender_; }
  const comms::Stats& stats() const { return sender_.stats(); }
  size_t rosterSize() { return repair_.roster(now_us_).size(); }
  uint64_t numHeard() const { return num_heard_; }

 private:
  static std::string queueKey(const mapping::Piece& part) {
    return std::to_string(static_cast<int>(part.key.kind)) + "/" + std::to_string(part.key.index[0]) + "/" +
           std::to_string(part.key.index[1]) + "/" + std::to_string(part.part);
  }

  comms::SenderOptions senderOptions(int64_t budget) {
    comms::SenderOptions options;
    options.bytes_per_s = budget;
    options.stamp = [](comms::Packet& packet, int64_t now_us) { wire::stampTime(packet.bytes, {now_us}); };
    options.wall = {[] { return int64_t{0}; }, [](int64_t) {}};
    options.pacing.gap_us = 0;
    options.make_heartbeat = [this](int64_t now_us) { return heartbeat(now_us); };
    return options;
  }

  fusion_node::RepairOptions repairOptions() {
    fusion_node::RepairOptions options{name_, kMission, budget_, {}, fuses_, {}};
    if (!isRobot()) return options;
    options.own_share = number(robot_);
    options.make_wanted = [this](uint64_t key) {
      const auto layers = wire::sharperPieces(example_, robot_, 0);
      for (const mapping::Piece& layer : layers)
        if (fusion_node::nameOf(layer.key, layer.part).second == key) say(layer);
    };
    options.is_unsaid = [this](const mapping::Piece& piece) {
      return piece.key.robot == robot_ && sender_.queue().isWaiting(queueKey(piece));
    };
    return options;
  }

  comms::Packet heartbeat(int64_t now_us) {
    wire::Heartbeat h;
    h.time = {now_us};
    h.mission = kMission;
    h.phase = isRobot() ? wire::Phase::kFlying : wire::Phase::kNode;
    h.observation = isRobot() ? 1 : -1;
    h.x_m = isRobot() ? x_m_ : 0;
    h.budget = static_cast<int32_t>(budget_);
    h.own_digest = isRobot() ? said_.digestOf(robot_) : 0;
    h.bytes_sent = static_cast<int64_t>(sender_.stats().linkBytes());
    h.queue_bytes = static_cast<int32_t>(sender_.backlog());
    h.map_of_state = fuses_ ? state_.beliefs().digest() : 0;
    h.roster = repair_.roster(now_us);
    return {comms::channelName(name_, "HEARTBEAT"), wire::encode(h)};
  }

  void say(const mapping::Piece& layer) {
    said_.apply(layer);
    state_.apply(layer);
    sender_.offer(comms::TrafficClass::kPictures, queueKey(layer),
                  {comms::channelName(name_, "PICTURE"), wire::encode(layer, kMission, {})});
  }

  mapping::ExamplePicture example_{.topic = world::TopicId{2},
                                   .number = 1,
                                   .observation = 5,
                                   .cell = {3, 4, 0},
                                   .seen = {2 * kSecondUs},
                                   .rgb = std::vector<uint8_t>(wire::kPictureBytes, 90)};
  std::string name_;
  world::RobotId robot_;
  bool fuses_;
  float x_m_;
  int strip_;
  int64_t budget_;
  std::unique_ptr<comms::MemoryBus> bus_;
  std::unique_ptr<comms::LinkEmulator> link_;
  fusion_node::MissionState state_;
  mapping::BeliefChanges changes_;
  mapping::BeliefStore said_;
  comms::Sender sender_;
  fusion_node::Repair repair_;
  int64_t now_us_ = 0;
  uint64_t num_heard_ = 0;
};

struct Outcome {
  int settled_s = -1;
  uint64_t first = 0, requests = 0, repairs = 0, heartbeats = 0;  // bytes of all
  uint64_t idle = 0;  // bytes in the two minutes after all agreed, heartbeats left out
};

class Meeting {
 public:
  explicit Meeting(const Scene& scene) : scene_(scene), network_(scene.network) {
    for (int r = 0; r < scene.robots; ++r) {
      parties_.push_back(std::make_unique<Party>(world::name(world::RobotId{r}), r, r < scene.fusing_robots,
                                                 scene_, network_));
    }
    for (const std::string& name : scene.listeners)
      parties_.push_back(std::make_unique<Party>(name, -1, true, scene_, network_));
  }

  // Until all that fuse hold everything; checks that they do, that it makes one map, and the budget.
  Outcome run(int latest) {
    Outcome outcome;
    int second = 0;
    for (; second <= latest && outcome.settled_s < 0; ++second) {
      turn(second);
      if (second >= lastJoin() + scene_.steps && allHoldAll(second)) outcome.settled_s = second;
    }
    EXPECT_GE(outcome.settled_s, 0) << "not everything was heard within " << latest << " s";
    outcome.first = bytes(comms::TrafficClass::kTopics);
    outcome.requests = bytes(comms::TrafficClass::kRequests);
    outcome.repairs = bytes(comms::TrafficClass::kRepairs);
    outcome.heartbeats = bytes(comms::TrafficClass::kHeartbeat);
    check();
    return outcome;
  }

  // Bytes other than heartbeats that all send from second `from` to `until`.
  uint64_t bytesBetween(int from, int until) {
    const uint64_t before = spoken();
    for (int second = from; second < until; ++second) turn(second);
    return spoken() - before;
  }

  std::vector<std::unique_ptr<Party>>& parties() { return parties_; }
  Party& find(const std::string& name) {
    return **std::ranges::find_if(parties_, [&](const auto& p) { return p->name() == name; });
  }
  void turn(int second) {
    if (scene_.happen) scene_.happen(second, network_);
    for (auto& party : parties_) {
      if (!isThere(*party, second)) continue;
      if (const int step = second - joinsAt(*party); step < scene_.steps) party->learn(step);
    }
    for (int beat = 1; beat <= scene_.beats; ++beat) {
      const int64_t until_us = second * kSecondUs + beat * kSecondUs / scene_.beats;
      for (auto& party : parties_)
        if (isThere(*party, second)) party->speakUntil(until_us);
      for (auto& party : parties_) party->listen(isThere(*party, second), until_us);
    }
  }

 private:
  int joinsAt(const Party& party) const { return scene_.joins_at ? scene_.joins_at(party.name()) : 0; }
  int lastJoin() const {
    int last = 0;
    for (const auto& party : parties_) last = std::max(last, joinsAt(*party));
    return last;
  }
  bool isThere(const Party& party, int second) const {
    if (second < joinsAt(party) || (scene_.is_down && scene_.is_down(party.name(), second))) return false;
    return !scene_.leaves_at || second < scene_.leaves_at(party.name());
  }
  bool allHoldAll(int second) {
    return std::ranges::all_of(parties_, [&](auto& party) {
      if (!party->fuses() || !isThere(*party, second)) return !party->fuses() || !scene_.joins_at;
      return std::ranges::all_of(parties_, [&](const auto& robot) {
        if (!robot->isRobot()) return true;
        const world::RobotId id = *world::parseRobotId(robot->name());
        return party->state().beliefs().digestOf(id) == robot->said().digestOf(id);
      });
    });
  }
  uint64_t bytes(comms::TrafficClass traffic) const {
    uint64_t sum = 0;
    for (const auto& party : parties_) sum += party->stats().of(traffic).bytes;
    return sum;
  }
  uint64_t spoken() const {
    uint64_t sum = 0;
    for (const auto& party : parties_)
      sum += party->stats().linkBytes() - party->stats().of(comms::TrafficClass::kHeartbeat).bytes;
    return sum;
  }
  void check() {
    mapping::BeliefStore everything;
    for (const auto& party : parties_)
      party->said().visit([&](const mapping::Piece& p) { everything.apply(p); });
    const mapping::GlobalMap expected = mapping::fuse(everything, {});
    ASSERT_GT(expected.cells.size(), 1000u);
    for (auto& party : parties_) {
      if (scene_.budget > 0) {
        EXPECT_LE(party->sender().worstWindow().bytes,
                  std::max<int64_t>(scene_.budget, comms::kMaxWireBytes));
      }
      EXPECT_TRUE(party->stats().rejected.empty()) << party->stats().rejected.begin()->first;
      if (!party->fuses()) continue;
      EXPECT_EQ(party->state().beliefs().digest(), everything.digest()) << party->name();
    }
    fusion_node::MissionState& last = parties_.back()->state();
    EXPECT_TRUE(last.refreshMap().cells == expected.cells);
    EXPECT_EQ(last.mapDigest(), expected.digest());
  }

  Scene scene_;
  comms::MemoryNetwork network_;
  std::vector<std::unique_ptr<Party>> parties_;
};

Outcome run(const char* what, const Scene& scene, int latest) {
  const Outcome o = Meeting(scene).run(latest);
  std::printf("%-44s %5d s  said %7lu  requests %6lu  repairs %7lu  heartbeats %7lu B\n", what, o.settled_s,
              o.first, o.requests, o.repairs, o.heartbeats);
  return o;
}

TEST(LossyLinkTest, ACleanLinkCarriesEverythingOnceAndThenFallsSilent) {
  Scene scene;
  scene.robots = 13;
  Meeting meeting(scene);
  const Outcome clean = meeting.run(60);
  EXPECT_EQ(clean.repairs, 0u);
  EXPECT_LT(clean.requests, clean.first / 20);
  EXPECT_EQ(meeting.bytesBetween(clean.settled_s + 15, clean.settled_s + 135), 0u);
}

// Sixteen nodes; of thirteen robots, three fuse too.
TEST(LossyLinkTest, SixteenNodesHealWhateverIsLost) {
  Scene scene;
  scene.robots = 13;
  scene.listeners = {"OPERATOR", "SHORE", "BOAT"};
  scene.fusing_robots = 3;
  run("16 nodes, no loss", scene, 60);
  scene.network = {.seed = 2, .loss = 0.1, .duplication = 0.1, .reordering = 0.2};
  run("16 nodes, loss 10 %, double, disorder", scene, 200);
  scene.network.loss = 0.3;
  run("16 nodes, loss 30 %, double, disorder", scene, 300);
  scene.network.loss = 0.5;
  run("16 nodes, loss 50 %, double, disorder", scene, 600);
}

// Nobody holds what is asked for until the robot makes it; then it is state like any other, on every node.
TEST(LossyLinkTest, WhoAsksForASharperPictureGetsItAndSoDoAllOthers) {
  Scene scene;
  scene.listeners = {"OPERATOR", "SHORE"};
  scene.network = {.seed = 5, .loss = 0.3, .duplication = 0.1, .reordering = 0.2};
  Meeting meeting(scene);
  Party& robot = meeting.find("R01");
  const auto sharpened = [&](const std::string& node) {
    const auto held = mapping::heldPictures(meeting.find(node).state().beliefs());
    return held.size() == 1 && held[0].sharpened;
  };
  robot.show();
  int second = meeting.run(300).settled_s + 1;
  ASSERT_FALSE(sharpened("OPERATOR"));
  EXPECT_FALSE(mapping::heldPictures(meeting.find("SHORE").state().beliefs())[0].sharpened);
  const mapping::PieceKey sharper{
      world::RobotId{1}, mapping::PieceKind::kPicture, {2, 1 + mapping::kSharperBy, 0}};
  const uint64_t before = robot.said().digest();
  meeting.find("OPERATOR").ask(sharper, {0, 5});
  const int until = second + 200;
  while (second < until && !(sharpened("OPERATOR") && sharpened("SHORE"))) meeting.turn(second++);
  EXPECT_TRUE(sharpened("OPERATOR"));
  EXPECT_TRUE(sharpened("SHORE"));
  EXPECT_NE(robot.said().digest(), before);
  EXPECT_EQ(meeting.find("OPERATOR").state().beliefs().digest(),
            meeting.find("SHORE").state().beliefs().digest());
}

TEST(LossyLinkTest, APartitionHeals) {
  Scene scene;
  scene.robots = 13;
  scene.listeners = {"OPERATOR", "SHORE", "BOAT"};
  scene.network = {.seed = 3, .loss = 0.05};
  scene.happen = [](int second, comms::MemoryNetwork& network) {
    if (second == 2) network.partition({0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 0, 1, 1});
    if (second == 62) network.heal();
  };
  EXPECT_GT(run("16 nodes, apart for 60 s, loss 5 %", scene, 300).settled_s, 62);
}

TEST(LossyLinkTest, WhoJoinsLateIsToldEverything) {
  Scene scene;
  scene.robots = 13;
  scene.listeners = {"OPERATOR", "SHORE", "LATE"};
  scene.network = {.seed = 4, .loss = 0.05};
  scene.joins_at = [](const std::string& name) { return name == "LATE" ? 60 : 0; };
  EXPECT_GT(run("16 nodes, one joins at 60 s, loss 5 %", scene, 300).settled_s, 60);
}

// Robots end, one after the other has said its share: what they said lives on in those that heard it.
TEST(LossyLinkTest, WhatARobotSaidOutlivesIt) {
  Scene scene;
  scene.robots = 6;
  scene.listeners = {"OPERATOR", "LATE"};
  scene.joins_at = [](const std::string& name) { return name == "LATE" ? 150 : 0; };
  scene.leaves_at = [](const std::string& name) { return name == "R00" || name == "R01" ? 60 : 10000; };
  EXPECT_GT(run("8 nodes, two robots gone before one joins", scene, 400).settled_s, 150);
}

// In a row, each in range of its neighbours alone: two robots between the last one and the operator.
TEST(LossyLinkTest, RobotsRelayForOneThatIsOutOfRange) {
  Scene scene;
  scene.listeners = {"OPERATOR"};
  scene.apart_m = 100;
  scene.link.range_m = 150;
  scene.link.base_m = std::array<double, 3>{0, 0, 0};
  run("3 robots in a row, the operator at one end", scene, 600);
  scene.network = {.seed = 5, .loss = 0.2};
  run("the same, loss 20 %", scene, 900);
}

// On every emulated link the nodes end with the very state and map of a perfect one. On thin links robots
// have a budget that fits.
TEST(EmulatedLinkTest, EveryPresetEndsWithTheMapOfAPerfectLink) {
  Scene scene;
  scene.link = *comms::linkPreset("mesh");
  run("3 robots, mesh", scene, 120);
  scene.link = *comms::linkPreset("acoustic");
  scene.budget = 600;
  run("3 robots, acoustic, 600 B/s", scene, 1200);
  scene.link = *comms::linkPreset("satellite");
  scene.budget = 300;
  run("3 robots, satellite, 300 B/s", scene, 1200);
}

// More than half is lost, the rest late, double and in disorder; a minute apart besides.
TEST(EmulatedLinkTest, WhateverTheLinkDoesEndsWithTheMapOfAPerfectLink) {
  Scene scene;
  scene.link.delay_s = 3;
  scene.link.jitter_s = 4;
  scene.link.loss = 0.5;
  scene.link.bursts = {.good_s = 20, .bad_s = 5, .loss = 1};
  scene.link.reordering = 0.3;
  scene.link.duplication = 0.2;
  scene.link.late_s = 15;
  scene.link.partitions = {
      {.from_s = 3, .until_s = 63, .groups = {{"R00", "OPERATOR"}, {"R01", "R02", "RELAY"}}}};
  EXPECT_GT(run("3 robots, late, lost, double, 60 s apart", scene, 1200).settled_s, 63);
}

// A link that carries less than robots send loses the rest.
TEST(EmulatedLinkTest, ALinkThatCarriesLessThanTheBudgetStillCarriesEverything) {
  Scene scene;
  scene.link = *comms::linkPreset("acoustic");
  run("3 robots, acoustic, 3000 B/s", scene, 3000);
}

// A team of 64 robots, four of which fuse. A tenth is lost; eight robots join late and so does a node, two
// robots and the operator are killed for twenty seconds. All that fuse end with one state; what a node holds,
// is told and has to look at stays within bounds that do not grow with time.
TEST(SoakTest, SixtyFourRobots) {
  Scene scene;
  scene.robots = 64;
  scene.listeners = {"OPERATOR", "SHORE", "LATE"};
  scene.fusing_robots = 4;
  scene.steps = 2;
  scene.beats = 5;
  scene.strip = 5;
  scene.budget = 2000;
  scene.network = {.seed = 6, .loss = 0.1, .duplication = 0.05, .reordering = 0.1};
  scene.joins_at = [](const std::string& name) {
    return name == "LATE" ? 30 : name >= "R56" && name[0] == 'R' ? 15 : 0;
  };
  scene.is_down = [](const std::string& name, int second) {
    return (name == "R03" || name == "R17" || name == "OPERATOR") && second >= 5 && second < 25;
  };
  Meeting meeting(scene);
  const Outcome o = meeting.run(150);
  constexpr int kIdleS = 10;
  const uint64_t idle = meeting.bytesBetween(o.settled_s + 1, o.settled_s + 1 + kIdleS);
  mapping::BeliefStore everything;
  for (const auto& party : meeting.parties())
    party->said().visit([&](const mapping::Piece& p) { everything.apply(p); });
  uint64_t most_heard = 0, most_heartbeats = 0;
  size_t roster = 0;
  for (const auto& party : meeting.parties()) {
    EXPECT_LE(party->state().beliefs().numBytes(), everything.numBytes() * 3 / 2) << party->name();
    most_heard = std::max(most_heard, party->numHeard());
    if (party->fuses()) continue;
    roster = std::max(roster, party->rosterSize());
    most_heartbeats = std::max(most_heartbeats, party->stats().of(comms::TrafficClass::kHeartbeat).bytes);
  }
  const auto seconds = static_cast<uint64_t>(o.settled_s + 1 + kIdleS);
  std::printf("%-44s %5d s  said %7lu  requests %6lu  repairs %7lu  heartbeats %7lu B\n",
              "67 nodes, loss 10 %", o.settled_s, o.first, o.requests, o.repairs, o.heartbeats);
  std::printf(
      "heard by one %lu messages, %ld B held, idle %lu B in %d s, roster %zu, heartbeats of one %lu B/s\n",
      most_heard, static_cast<long>(everything.numBytes()), idle, kIdleS, roster, most_heartbeats / seconds);
  EXPECT_LT(o.repairs, 4 * o.first);
  EXPECT_LT(o.requests, o.first);
  EXPECT_LT(idle, o.first / 2);
  EXPECT_LT(most_heard, 67 * 3 * seconds);
  EXPECT_LE(roster, 16u);  // of 64 shares: a robot's heartbeat does not grow with the team
  EXPECT_LT(most_heartbeats, 300 * seconds);
}

// Somebody says, a hundred times a second, that it holds nothing and would like everything.
TEST(RepairTest, AFloodOfRequestsCostsNoBudgetAndNoNewContent) {
  Scene quiet;
  quiet.robots = 4;
  const Outcome undisturbed = Meeting(quiet).run(100);
  Meeting meeting(quiet);
  int settled = -1;
  for (int second = 0; second < 200 && settled < 0; ++second) {
    comms::RepairTalk forged;
    for (int32_t share = 0; share < 4; ++share)
      forged.statements.push_back({comms::Statement::Kind::kLeaves, share, true, {}, {}, {}});
    for (int i = 0; i < 100; ++i) {
      const comms::Packet packet{"SHOAL_EVIL_REQUEST", wire::encodeRequest(comms::encodeTalk(forged),
                                                                           kMission, {second * kSecondUs})};
      for (auto& party : meeting.parties()) party->hear(packet);
    }
    meeting.turn(second);
    const auto all_said = [](const auto& p) {
      return p->sender().queue().numWaiting(comms::TrafficClass::kTopics) == 0;
    };
    if (second >= quiet.steps && std::ranges::all_of(meeting.parties(), all_said)) settled = second;
  }
  ASSERT_GE(settled, 0);
  EXPECT_LE(settled, undisturbed.settled_s + 4);
  for (const auto& party : meeting.parties()) {
    EXPECT_LE(party->sender().worstWindow().bytes, 3000);
    EXPECT_GT(party->stats().rejected.at("too many requests"), 0u);
  }
}

// Somebody tells ever more of a world that there is not, and that there is more still. It takes no memory
// beyond its own, nobody asks for what there is no room for, and what the others say arrives as ever.
TEST(RepairTest, AFloodOfMapTakesNobodysRoom) {
  Scene scene;
  scene.robots = 4;
  scene.budget = 0;
  const Outcome undisturbed = Meeting(scene).run(100);
  scene.limits = {.max_robots = 8, .max_bytes = 4'000'000, .max_bytes_per_robot = 500'000};
  Meeting meeting(scene);
  const world::RobotId evil{9};
  const std::string node = world::name(evil);
  int brick = 0;
  const auto flood = [&](int second) {
    std::vector<comms::Packet> packets;
    for (int i = 0; i < 100; ++i, ++brick) {
      mapping::BrickPart cells;
      for (int x = 0; x < 16; ++x) cells.cells.push_back({{16 * brick + x, 0, 0}, world::TopicId{x}, {x}});
      packets.push_back(
          {comms::channelName(node, "BRICK"),
           wire::encode({{evil, mapping::PieceKind::kBrick, {brick, 0, 0}}, {0, 1}, 0, 1, cells}, kMission,
                        {second * kSecondUs})});
    }
    wire::Heartbeat more;
    more.time = {second * kSecondUs};
    more.mission = kMission;
    more.own_digest = 1;  // which nobody will ever hold
    packets.push_back({comms::channelName(node, "HEARTBEAT"), wire::encode(more)});
    for (auto& party : meeting.parties())
      for (const comms::Packet& packet : packets) party->takeIn(packet);
  };
  int second = 0;
  for (; second <= undisturbed.settled_s + 5; ++second) {
    flood(second);
    meeting.turn(second);
  }
  const auto requests = [&] {
    uint64_t bytes = 0;
    for (const auto& party : meeting.parties())
      bytes += party->stats().of(comms::TrafficClass::kRequests).bytes;
    return bytes;
  };
  const uint64_t before = requests();
  for (; second < 60; ++second) {
    flood(second);
    meeting.turn(second);
  }
  EXPECT_EQ(requests(), before);
  for (const auto& party : meeting.parties()) {
    const mapping::BeliefStore& held = party->state().beliefs();
    EXPECT_LE(held.numBytesOf(evil), scene.limits.max_bytes_per_robot);
    EXPECT_GT(held.numBytesOf(evil), scene.limits.max_bytes_per_robot - 2000);
    EXPECT_TRUE(held.isFull(evil));
    EXPECT_GT(party->stats().rejected.at("over limit"), 1000u);
    for (const auto& robot : meeting.parties()) {
      if (!robot->isRobot() || !party->fuses()) continue;
      const world::RobotId id = *world::parseRobotId(robot->name());
      EXPECT_EQ(held.digestOf(id), robot->said().digestOf(id)) << party->name() << " of " << robot->name();
    }
  }
}

}  // namespace
}  // namespace shoal
