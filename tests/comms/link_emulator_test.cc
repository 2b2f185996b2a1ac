// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/link_emulator.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fake_wall.h"
#include "second.h"
#include "shoal/comms/memory_bus.h"

namespace shoal::comms {
namespace {

constexpr int64_t kMs = 1000;
// A message for these tests: when it was sent, its number and where its sender is.
struct Words {
  int64_t sent_us;
  int64_t number;
  double x_m;
};

Packet packetFrom(const std::string& node, int64_t sent_us, int64_t number, double x_m = 0) {
  const Words words{sent_us, number, x_m};
  Packet packet{"SHOAL_" + node + "_X", Bytes(sizeof words)};
  std::memcpy(packet.bytes.data(), &words, sizeof words);
  return packet;
}

Words wordsOf(const Packet& packet) {
  Words words{};
  std::memcpy(&words, packet.bytes.data(), sizeof words);
  return words;
}

std::optional<OnAir> look(const Packet& packet) {
  if (packet.bytes.size() != sizeof(Words)) return std::nullopt;
  return OnAir{wordsOf(packet).sent_us, std::array{wordsOf(packet).x_m, 0.0, 0.0}};
}

// A listener called ME over an emulated link, and speakers who are on the air.
struct Listener {
  explicit Listener(const LinkModel& model, uint64_t seed = 1, const std::string& name = "ME",
                    double rate = 0)
      : air(network.connect()),
        speaker(network.connect()),
        link(*air, model, {.receiver = name, .seed = seed, .rate = rate, .wall = wall.time(), .look = look}) {
  }

  void say(int64_t sent_us, int64_t number, const std::string& node = "R00", double x_m = 0) {
    speaker->publish(packetFrom(node, sent_us, number, x_m));
  }

  std::vector<int64_t> hear() {
    std::vector<int64_t> numbers;
    const int delivered =
        link.receive(0, [&](const Packet& heard) { numbers.push_back(wordsOf(heard).number); });
    EXPECT_EQ(delivered, static_cast<int>(numbers.size()));
    return numbers;
  }

  FakeWall wall;
  MemoryNetwork network;
  std::unique_ptr<MemoryBus> air;
  std::unique_ptr<MemoryBus> speaker;
  LinkEmulator link;
};

// What of `count` messages, 10 ms apart, comes through; the last is there to move the clock on.
std::vector<int64_t> run(const LinkModel& model, uint64_t seed, int count, const std::string& name = "ME") {
  Listener listener(model, seed, name);
  for (int i = 0; i < count; ++i) listener.say(i * 10 * kMs, i);
  std::vector<int64_t> heard = listener.hear();
  EXPECT_LE(listener.link.counts().sent, static_cast<uint64_t>(count));
  return heard;
}

TEST(LinkEmulatorTest, APerfectLinkChangesNothing) {
  const std::vector<int64_t> heard = run({}, 1, 1000);
  ASSERT_EQ(heard.size(), 1000u);
  for (size_t i = 0; i < heard.size(); ++i) EXPECT_EQ(heard[i], static_cast<int64_t>(i));
}

TEST(LinkEmulatorTest, LosesWithinBinomialBounds) {
  constexpr int kCount = 20'000;
  for (const double loss : {0.0, 0.01, 0.1, 0.5, 0.9, 1.0}) {
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      LinkModel model;
      model.loss = loss;
      const auto lost = static_cast<double>(kCount - run(model, seed, kCount).size());
      // Five standard deviations: one run in two million is farther off.
      EXPECT_NEAR(lost, kCount * loss, 5 * std::sqrt(kCount * loss * (1 - loss))) << loss << ' ' << seed;
    }
  }
}

// If loss were not independent from one message to the next, pairs would be lost more or less often.
TEST(LinkEmulatorTest, LosesOneMessageIndependentlyOfTheNext) {
  constexpr int kCount = 40'000;
  LinkModel model;
  model.loss = 0.3;
  const std::vector<int64_t> heard = run(model, 3, kCount);
  const std::set<int64_t> got(heard.begin(), heard.end());
  int pairs = 0;
  for (int i = 0; i + 1 < kCount; ++i) pairs += !got.contains(i) && !got.contains(i + 1) ? 1 : 0;
  EXPECT_NEAR(pairs, 0.09 * kCount, 5 * std::sqrt(kCount * 0.09 * (1 - 0.09) * 1.6));  // neighbours overlap
}

TEST(LinkEmulatorTest, TheSameSeedIsTheSameFateAndOthersDiffer) {
  LinkModel model;
  model.loss = 0.3;
  model.bursts = {.good_s = 1, .bad_s = 0.2, .loss = 1};
  model.delay_s = 0.05;
  model.jitter_s = 0.1;
  model.reordering = 0.2;
  model.duplication = 0.1;
  const std::vector<int64_t> heard = run(model, 1, 3000);
  EXPECT_EQ(heard, run(model, 1, 3000));
  EXPECT_NE(heard, run(model, 2, 3000));
  EXPECT_NE(heard, run(model, 1, 3000, "YOU"));
}

// Senders do not disturb each other, and when the listener listens does not matter.
TEST(LinkEmulatorTest, TheFateOfASendersMessagesIsItsOwn) {
  LinkModel model;
  model.loss = 0.3;
  model.delay_s = 0.5;
  model.reordering = 0.3;
  const std::vector<int64_t> alone = run(model, 1, 500);
  Listener listener(model);
  std::vector<int64_t> of_r00;
  std::vector<int64_t> of_r01;
  for (int i = 0; i < 500; ++i) {
    listener.say(i * 10 * kMs, i);
    listener.say(i * 10 * kMs + 3, 10'000 + i, "R01");
    if (i % 7 != 0) continue;
    for (const int64_t number : listener.hear()) (number < 10'000 ? of_r00 : of_r01).push_back(number);
  }
  for (const int64_t number : listener.hear()) (number < 10'000 ? of_r00 : of_r01).push_back(number);
  EXPECT_EQ(of_r00, alone);
  for (int64_t& number : of_r01) number -= 10'000;
  EXPECT_NE(of_r01, alone);
}

TEST(LinkEmulatorTest, FadesLoseRunsOfMessages) {
  LinkModel model;
  model.bursts = {.good_s = 9, .bad_s = 1, .loss = 1};
  Listener listener(model);
  constexpr int kCount = 300'000;  // 3000 s: about 300 fades of 100 messages
  for (int i = 0; i < kCount; ++i) listener.say(i * 10 * kMs, i);
  const std::vector<int64_t> heard = listener.hear();
  int runs = 0;
  for (size_t i = 1; i < heard.size(); ++i) runs += heard[i] > heard[i - 1] + 1 ? 1 : 0;
  const auto lost = static_cast<double>(kCount - heard.size());
  EXPECT_NEAR(lost / kCount, 0.1, 0.03);  // 300 exponential times: four standard deviations
  EXPECT_NEAR(lost / runs, 100, 30);
  EXPECT_EQ(listener.link.counts().faded, kCount - heard.size());
}

//    sent at     0    100   200   300   400 ms
//    due at    250    350   450   550   650
//    known at             the 300: 0 is due;  the 400: so is 100
TEST(LinkEmulatorTest, DelaysInMissionTimeAsTheSenderTellsIt) {
  LinkModel model;
  model.delay_s = 0.25;
  Listener listener(model);
  for (const int64_t i : {0, 1, 2}) listener.say(i * 100 * kMs, i);
  EXPECT_TRUE(listener.hear().empty());
  EXPECT_EQ(listener.link.numHeld(), 3u);
  listener.wall.pass(10 * kSecond);  // as fast as possible, wall time means nothing
  EXPECT_TRUE(listener.hear().empty());
  listener.say(300 * kMs, 3);
  EXPECT_EQ(listener.hear(), std::vector<int64_t>{0});
  listener.say(1000 * kMs, 4, "R01");  // another clock
  EXPECT_TRUE(listener.hear().empty());
  listener.say(400 * kMs, 5);
  EXPECT_EQ(listener.hear(), std::vector<int64_t>{1});
  listener.say(10'000 * kMs, 6);
  EXPECT_EQ(listener.hear(), (std::vector<int64_t>{2, 3, 5}));
}

TEST(LinkEmulatorTest, ARunningClockDeliversWithoutAnotherMessage) {
  LinkModel model;
  model.delay_s = 2;
  Listener listener(model, 1, "ME", 10);  // ten seconds of mission time a second
  listener.say(5 * kSecond, 1);
  EXPECT_TRUE(listener.hear().empty());
  listener.wall.pass(199 * kMs);
  EXPECT_TRUE(listener.hear().empty());
  listener.wall.pass(1 * kMs);
  EXPECT_EQ(listener.hear(), std::vector<int64_t>{1});
}

TEST(LinkEmulatorTest, JitterKeepsTheOrderAndReorderingDoesNot) {
  LinkModel model;
  model.delay_s = 0.1;
  model.jitter_s = 0.5;
  const std::vector<int64_t> in_order = run(model, 1, 5000);
  EXPECT_GT(in_order.size(), 4900u);  // the last are on their way
  EXPECT_TRUE(std::ranges::is_sorted(in_order));

  model.reordering = 0.1;
  model.late_s = 1;
  std::vector<int64_t> disordered = run(model, 1, 5000);
  EXPECT_FALSE(std::ranges::is_sorted(disordered));
  for (size_t i = 0; i < disordered.size();
       ++i) {  // 1 s is 100 messages, and jitter may let 50 more come at once
    ASSERT_NEAR(static_cast<double>(disordered[i]), static_cast<double>(i), 160);
  }
  std::ranges::sort(disordered);
  EXPECT_EQ(std::ranges::unique(disordered).begin(), disordered.end());
}

TEST(LinkEmulatorTest, DoublesAsOftenAsTold) {
  LinkModel model;
  model.duplication = 0.2;
  model.late_s = 0.3;
  const std::vector<int64_t> heard = run(model, 1, 20'000);
  std::vector<int> copies(20'000);
  for (const int64_t number : heard) ++copies[static_cast<size_t>(number)];
  EXPECT_EQ(std::ranges::count(copies, 0), 0);
  EXPECT_EQ(std::ranges::count_if(copies, [](int n) { return n > 2; }), 0);
  EXPECT_NEAR(static_cast<double>(std::ranges::count(copies, 2)), 4000,
              5 * std::sqrt(20'000 * 0.2 * 0.8) + 10);
}

// 1000 bytes per second, and datagrams of 24 bytes take 72 on the wire, so one every 72 ms.
TEST(LinkEmulatorTest, TheRateSpreadsABurstAndDropsWhatWouldWaitTooLong) {
  ASSERT_EQ(wireSize(packetFrom("R00", 0, 0)), 72u);
  LinkModel model;
  model.rate_bytes_per_s = 1000;
  model.queue_s = 1;
  Listener listener(model);
  for (int i = 0; i < 30; ++i) listener.say(0, i);
  EXPECT_TRUE(listener.hear().empty());
  EXPECT_EQ(listener.link.counts().overflowed, 16u);  // the k-th waits 72 k ms: k = 13 is the last
  for (int64_t k = 1; k < 30; ++k) {
    listener.say((72 * k - 1) * kMs, 99);  // joins the line, where there is room again
    EXPECT_EQ(listener.hear().size(), k == 1 ? 0u : 1u) << k;
  }
  // Over a long time: what comes is what the rate carries.
  Listener flooded(model);
  for (int i = 0; i < 20'000; ++i) flooded.say(i * 10 * kMs, i);  // 7200 B/s for 200 s
  EXPECT_NEAR(static_cast<double>(flooded.hear().size()), 200'000.0 / 72, 20);
}

TEST(LinkEmulatorTest, APartitionSeparatesForItsTime) {
  LinkModel model;
  model.partitions = {{.from_s = 10, .until_s = 20, .groups = {{"ME", "R00"}, {"R01"}}},
                      {.from_s = 30, .until_s = 40, .groups = {{"R01", "R02"}}}};
  const auto heard = [&model](const std::string& node) {
    Listener listener(model);
    for (int i = 0; i < 50; ++i) listener.say(i * kSecond, i, node);
    const std::vector<int64_t> numbers = listener.hear();
    std::set<int64_t> lacking;
    for (int64_t i = 0; i < 50; ++i) {
      if (!std::ranges::binary_search(numbers, i)) lacking.insert(i / 10);
    }
    EXPECT_EQ(numbers.size() % 10, 0u);
    return lacking;
  };
  EXPECT_EQ(heard("R00"), std::set<int64_t>{});        // with ME at first, with nobody named later, as ME
  EXPECT_EQ(heard("R01"), (std::set<int64_t>{1, 3}));  // in other groups both times
  EXPECT_EQ(heard("R02"), (std::set<int64_t>{1, 3}));  // nobody names it at first, but ME
}

TEST(LinkEmulatorTest, NothingIsHeardFromBeyondTheRange) {
  LinkModel model;
  model.range_m = 100;
  model.base_m = {0, 0, 0};
  Listener listener(model);
  listener.say(0, 1, "R00", 100);
  listener.say(1, 2, "R00", 101);
  EXPECT_EQ(listener.hear(), std::vector<int64_t>{1});  // this node is at the base
  listener.link.publish(packetFrom("ME", 2, 3, 50));    // and now it is not
  listener.say(3, 4, "R00", 150);
  listener.say(4, 5, "R00", -51);
  EXPECT_EQ(listener.hear(), (std::vector<int64_t>{3, 4}));
  EXPECT_EQ(listener.link.counts().out_of_range, 2u);
}

TEST(LinkEmulatorTest, WithoutABaseANodeThatDoesNotFlyIsInRange) {
  LinkModel model;
  model.range_m = 100;
  Listener listener(model);
  listener.say(0, 1, "R00", 1e6);
  EXPECT_EQ(listener.hear(), std::vector<int64_t>{1});
}

TEST(LinkEmulatorTest, OneselfAndWhatIsNotOfTheLinkPass) {
  LinkModel model;
  model.loss = 1;
  Listener listener(model);
  listener.link.publish(packetFrom("ME", 0, 1));
  listener.say(0, 2, "ME");  // a twin: told to oneself as well
  listener.say(0, 3, "R00");
  listener.speaker->publish({"SHOAL_R00_X", {1, 2, 3}});  // rubbish, for the process to count
  int rubbish = 0;
  std::vector<int64_t> heard;
  listener.link.receive(0, [&](const Packet& each) {
    if (each.bytes.size() == 3) {
      ++rubbish;
    } else {
      heard.push_back(wordsOf(each).number);
    }
  });
  EXPECT_EQ(heard, (std::vector<int64_t>{1, 2}));
  EXPECT_EQ(rubbish, 1);
  EXPECT_EQ(listener.link.counts().sent, 1u);
}

TEST(LinkEmulatorTest, ASenderThatBeginsAnewIsHeardAgain) {
  LinkModel model;
  model.delay_s = 5;
  Listener listener(model);
  listener.say(1000 * kSecond, 1);
  listener.say(0, 2);  // came back after a crash
  EXPECT_EQ(listener.hear(), std::vector<int64_t>{1});
  listener.say(4 * kSecond, 3);
  EXPECT_TRUE(listener.hear().empty());
  listener.say(5 * kSecond, 4);
  EXPECT_EQ(listener.hear(), std::vector<int64_t>{2});
}

TEST(LinkEmulatorTest, HoldsNoMoreThanItMay) {
  LinkModel model;
  model.delay_s = 1;
  Listener listener(model);
  for (int i = 0; i < 70'000; ++i) listener.say(0, i);
  EXPECT_TRUE(listener.hear().empty());
  EXPECT_EQ(listener.link.numHeld(), 65'536u);
  EXPECT_EQ(listener.link.counts().overflowed, 70'000u - 65'536u);
  listener.say(kSecond, 0);
  EXPECT_EQ(listener.hear().size(), 65'536u);
}

TEST(LinkEmulatorTest, AHandlerMayThrowAndPublish) {
  Listener listener({});
  listener.say(0, 1);
  EXPECT_THROW(listener.link.receive(0, [](const Packet&) { throw std::runtime_error("no"); }),
               std::runtime_error);
  listener.say(1, 2);
  EXPECT_EQ(listener.link.receive(0, [&](const Packet&) { listener.link.publish(packetFrom("ME", 2, 3)); }),
            1);
  EXPECT_EQ(listener.hear(), std::vector<int64_t>{3});
}

TEST(LinkEmulatorTest, RejectsWhatIsNoLink) {
  MemoryNetwork network;
  const auto air = network.connect();
  LinkModel model;
  model.loss = 2;
  EXPECT_THROW(LinkEmulator(*air, model, {.receiver = "ME", .look = look}), std::invalid_argument);
  EXPECT_THROW(LinkEmulator(*air, {}, {.receiver = "ME", .look = {}}), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::comms
