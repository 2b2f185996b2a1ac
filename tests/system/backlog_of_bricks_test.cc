// SPDX-License-Identifier: BSD-3-Clause
// The backlog that a robot publishes, with the real codec, against what it then sends.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "shoal/comms/memory_bus.h"
#include "shoal/comms/sender.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/random.h"
#include "shoal/wire/piece_codec.h"

namespace shoal {
namespace {

// A flat map of topics in strips, wider with every seed.
mapping::LocalBelief mapOf(uint64_t seed, int cells_wide) {
  Random random(seed);
  mapping::LocalBelief belief{world::RobotId{3}, {0, 250}, {{"a", 0, 400}}, {}, {}};
  for (int t = 0; t < 4; ++t) belief.topics.push_back({world::TopicId{t}, {t}, 10, {{t, 10}}});
  for (int x = 0; x < cells_wide; ++x)
    for (int y = 0; y < 70; ++y) {
      const auto topic =
          static_cast<int>((static_cast<uint64_t>(x / 9 + y / 13) + random.below(20) / 19) % 4);
      belief.cells.push_back({{x, y, 0},
                              world::TopicId{topic},
                              {(x + y) / 4 * 1'000'000},
                              static_cast<float>(random.uniform())});
    }
  return belief;
}

TEST(BacklogOfBricksTest, IsWithinATenthOfWhatIsThenSent) {
  for (const int cells_wide : {5, 40, 200, 800}) {
    SCOPED_TRACE(cells_wide);
    comms::MemoryNetwork network;
    const auto bus = network.connect();
    const auto listener = network.connect();
    std::map<std::string, mapping::Piece, std::less<>> said;
    comms::SenderOptions options;
    options.wall = {[] { return int64_t{0}; }, [](int64_t) {}};
    options.pacing.gap_us = 0;
    options.most_joined_bytes = 1000;
    options.join = [&](std::span<const comms::SendQueue::Next> together) -> std::optional<comms::Packet> {
      std::vector<const mapping::Piece*> pieces;
      for (const auto& each : together) pieces.push_back(&said.find(each.key)->second);
      auto bytes = wire::encodeTogether(pieces, 1);
      if (!bytes) return std::nullopt;
      return comms::Packet{together.front().packet->channel, std::move(*bytes)};
    };
    comms::Sender sender(*bus, nullptr, options);
    mapping::BeliefChanges changes;
    for (const mapping::Piece& whole : changes.update(mapOf(static_cast<uint64_t>(cells_wide), cells_wide))) {
      for (const mapping::Piece& part : wire::cutToFit(whole, 1000)) {
        const std::string key = std::to_string(said.size() + 100'000);
        said.emplace(key, part);
        const bool is_topic = part.key.kind == mapping::PieceKind::kTopic;
        const bool is_brick = part.key.kind == mapping::PieceKind::kBrick;
        sender.offer(is_topic   ? comms::TrafficClass::kTopics
                     : is_brick ? comms::TrafficClass::kBricks
                                : comms::TrafficClass::kCertainty,
                     key,
                     {is_topic   ? "SHOAL_R03_TOPICS"
                      : is_brick ? "SHOAL_R03_BRICK"
                                 : "SHOAL_R03_CERTAINTY",
                      wire::encode(part, 1, {})});
      }
    }
    const int64_t alone = sender.queue().waitingBytes();
    const int64_t published = sender.backlog();
    sender.pump(0);
    int64_t heard = 0;
    listener->receive(0,
                      [&](const comms::Packet& packet) { heard += static_cast<int64_t>(wireSize(packet)); });
    EXPECT_EQ(sender.queue().waitingBytes(), 0);
    EXPECT_EQ(heard, static_cast<int64_t>(sender.stats().linkBytes()));
    EXPECT_LE(published, heard * 11 / 10);
    EXPECT_GE(published, heard * 10 / 11);
    std::printf("%4zu pieces: said to wait %6ld B, sent %6ld B; each alone %6ld B\n", said.size(), published,
                heard, alone);
  }
}

}  // namespace
}  // namespace shoal
