// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "fusion_node/mission_state.h"
#include "shoal/comms/channels.h"
#include "shoal/comms/seal.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/belief_files.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/map_files.h"
#include "shoal/wire/piece_codec.h"

namespace shoal {

/// A mission of three robots that landed at 10, 20 and 30 s, small enough to work out by hand, as a finished
/// run with its recording. Cells of 2 m, two word groups of 10 words.
///
/// "reef" (words 3 and 12) is topic 4 of R00 and topic 5 of R01, and so is global label 4; R02's topic 6 has
/// word 3 too: cosine 1/2. R00's topic 7 is alone. Column (-1, 0) was seen by all three, R01 last.
class SmallMission {
 public:
  static constexpr int32_t kMission = 5;
  static constexpr int64_t kSecond = 1'000'000;

  static std::vector<mapping::LocalBelief> beliefs() {
    using world::TopicId;
    const auto robot = [](int number, std::vector<mapping::BelievedTopic> topics,
                          std::vector<mapping::BelievedCell> cells) {
      return mapping::LocalBelief{
          world::RobotId{number}, {0, 9}, {{"g", 0, 10}, {"h", 10, 10}}, std::move(topics), std::move(cells)};
    };
    return {
        robot(0, {{TopicId{4}, {2 * kSecond}, 16, {{3, 8}, {12, 8}}}, {TopicId{7}, {0}, 5, {{9, 5}}}},
              {{{-2, 0, 0}, TopicId{4}, {8 * kSecond}, 1.f},
               {{-1, 0, 0}, TopicId{4}, {9 * kSecond}, 0.f},
               {{5, 0, 0}, TopicId{7}, {7 * kSecond}, 1.f}}),
        robot(1, {{TopicId{5}, {3 * kSecond}, 16, {{3, 8}, {12, 8}}}},
              {{{-1, 0, 0}, TopicId{5}, {18 * kSecond}, 1.f}}),
        robot(2, {{TopicId{6}, {1 * kSecond}, 16, {{3, 8}, {15, 8}}}},
              {{{-1, 0, 0}, TopicId{6}, {15 * kSecond}, 1.f}, {{9, 0, 0}, TopicId{6}, {15 * kSecond}, 1.f}})};
  }

  /// All that was sent, with a heartbeat after each robot's pieces.
  static std::vector<comms::Packet> packets() {
    std::vector<comms::Packet> packets;
    for (const mapping::LocalBelief& belief : beliefs()) {
      const std::string node = world::name(belief.robot);
      const world::Timestamp time{(number(belief.robot) + 1) * 10 * kSecond};
      mapping::BeliefStore own;
      for (const mapping::Piece& piece : mapping::wholePieces(belief)) {
        own.apply(piece);
        packets.push_back({comms::channelName(node, wire::channelKind(wire::kindOf(piece))),
                           wire::encode(piece, kMission, time)});
      }
      wire::Heartbeat h;
      h.time = time;
      h.mission = kMission;
      h.observation = 9;
      h.num_observations = 10;
      h.phase = wire::Phase::kLanded;
      h.num_topics = static_cast<int32_t>(belief.topics.size());
      h.num_cells = static_cast<int32_t>(belief.cells.size());
      h.own_digest = own.digestOf(belief.robot);
      h.cell_size_m = 2;
      h.bytes_sent = 1000;
      h.budget = 200;
      packets.push_back({comms::channelName(node, "HEARTBEAT"), wire::encode(h)});
    }
    return packets;
  }

  /// What a node knows that heard everything.
  static fusion_node::MissionState state() {
    fusion_node::MissionState state(kMission, matching::usualMatcher());
    comms::Stats stats;
    for (const comms::Packet& packet : packets()) state.hear(packet, stats);
    state.refreshMap();
    return state;
  }

  /// Writes the run with its mission.lcmlog.
  static void write(const std::string& folder) {
    const world::Grid grid(2);
    for (const mapping::LocalBelief& belief : beliefs()) {
      mapping::writeBelief(folder + "/robots/" + world::name(belief.robot), belief, grid);
    }
    const mapping::MissionView view = state().view();
    mapping::writeFileAtomically(folder + "/global_map.csv", mapping::globalMapCsv(view.map, grid));
    mapping::writeFileAtomically(folder + "/labels.csv", mapping::labelsCsv(view.map, grid));
    nlohmann::ordered_json nodes = nlohmann::ordered_json::array();
    for (const mapping::NodeStatus& node : view.nodes) nodes.push_back(mapping::toJson(node));
    const matching::MatcherOptions matcher = matching::usualMatcher();
    const nlohmann::ordered_json summary = {
        {"mission_id", kMission},
        {"cell_size_m", 2},
        {"matching",
         {{"matcher", matcher.matcher},
          {"similarity", matcher.similarity},
          {"sigma", matcher.leastSimilarity()}}},
        {"digest",
         {{"state", mapping::digestText(view.state_digest)}, {"map", mapping::digestText(view.map_digest)}}},
        {"nodes", nodes}};
    mapping::writeFileAtomically(folder + "/summary.json", summary.dump());
    mapping::writeFileAtomically(folder + "/mission.lcmlog", log());
  }

  /// The recording alone, of a team with a key.
  static void writeSealedLog(const std::string& path) {
    const comms::SealKey key(std::array<uint8_t, comms::SealKey::kBytes>{});
    mapping::writeFileAtomically(path, log(&key));
  }

 private:
  // As lcm-logger writes it: magic, number, wall time, lengths, channel, payload; big-endian.
  static std::string log(const comms::SealKey* key = nullptr) {
    std::string log;
    const auto add = [&log](uint64_t value, int bytes) {
      for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8)
        log += static_cast<char>(value >> shift & 0xff);
    };
    uint64_t event = 0;
    for (comms::Packet& packet : packets()) {
      if (key != nullptr) comms::addSeal(*key, {1, static_cast<uint32_t>(event)}, packet);
      add(0xEDA1DA01, 4);
      add(event, 8);
      add(1'000'000 + event++, 8);
      add(packet.channel.size(), 4);
      add(packet.bytes.size(), 4);
      log += packet.channel;
      log.append(packet.bytes.begin(), packet.bytes.end());
    }
    return log;
  }
};

}  // namespace shoal
