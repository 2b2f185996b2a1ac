// SPDX-License-Identifier: BSD-3-Clause
// write_recording FOLDER: a small mission as an LCM log, mission.lcmlog, and what our own code makes of it:
// state.json and global_map.csv. The log has what a real one may have: parts out of order and twice, old
// versions, an earlier life of a robot, a newer version without its part 0, damaged and foreign messages.
// everything.lcmlog holds the same, then the most unlike messages there can be; messages.jsonl is what our
// decoders make of each. sealed.lcmlog is mission.lcmlog with the seals of team.key, and after every fifth
// message another that a stranger altered.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "examples.h"
#include "fusion_node/mission_state.h"
#include "shoal/comms/packet.h"
#include "shoal/comms/seal.h"
#include "shoal/mapping/map_files.h"
#include "shoal/wire/checksum.h"
#include "shoal/wire/labels_codec.h"
#include "shoal/wire/map_codec.h"
#include "shoal/wire/matches_codec.h"
#include "shoal/wire/message_json.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/picture_coder.h"
#include "shoal/wire/picture_pieces.h"
#include "shoal/wire/piece_codec.h"

namespace shoal::wire {
namespace {

using mapping::Piece;
using world::RobotId;
using world::TopicId;

constexpr int32_t kMission = 77;
constexpr double kCellSize = 0.8;
constexpr size_t kMaxBytes = 500;

void append(Bytes& log, const comms::Packet& packet, uint64_t event) {
  putBigEndian(log, 0xEDA1DA01, 4);
  putBigEndian(log, event, 8);
  putBigEndian(log, 1'700'000'000'000'000 + 1000 * event, 8);
  putBigEndian(log, packet.channel.size(), 4);
  putBigEndian(log, packet.bytes.size(), 4);
  log.insert(log.end(), packet.channel.begin(), packet.channel.end());
  log.insert(log.end(), packet.bytes.begin(), packet.bytes.end());
}

comms::Packet packetOf(const Piece& part, int64_t now_us) {
  return {"SHOAL_" + name(part.key.robot) + "_" + std::string(channelKind(kindOf(part))),
          encode(part, kMission, {now_us})};
}

// The same piece of another robot, elsewhere.
Piece moved(Piece piece, RobotId robot, const std::array<int32_t, 3>& brick) {
  piece.key.robot = robot;
  if (auto* labels = std::get_if<mapping::BrickPart>(&piece.content)) {
    for (auto& c : labels->cells) {
      c.cell.x = 16 * brick[0] + (c.cell.x & 15);
      c.cell.y = 16 * brick[1] + (c.cell.y & 15);
      c.cell.z = 16 * brick[2] + (c.cell.z & 15);
      c.seen.us = c.seen.us / 2 + 7 * (number(robot) / 2);  // R00 and R01 see cells at the same time
    }
  }
  piece.key.index = brick;
  return piece;
}

std::vector<Piece> wholePieces(RobotId robot, int32_t observation, Random& random) {
  std::vector<Piece> pieces;
  const auto seed = static_cast<uint64_t>(100 * number(robot) + observation);
  for (int b = 0; b < 2; ++b) {
    pieces.push_back(moved(planarBrick(5, 10, 0.1 * b, seed + 1000 * static_cast<uint64_t>(b)), robot,
                           {b - 1 + number(robot), -1, b / 2}));
    mapping::CertaintyPart certainty;
    for (const auto& c : std::get<mapping::BrickPart>(pieces.back().content).cells)
      certainty.cells.push_back({c.cell, static_cast<uint8_t>(random.below(64)),
                                 static_cast<uint8_t>(random.below(9) == 0 ? 12 + random.below(52) : 0)});
    pieces.push_back({{robot, mapping::PieceKind::kCertainty, pieces.back().key.index}, {}, 0, 1, certainty});
  }
  pieces.push_back(moved(noiseBrick({0, 0, -3}, 0.1, random), robot, {0, 0, -3}));
  pieces.push_back(moved(noiseCertainty({0, 0, -3}, 0.2, random), robot, {0, 0, -3}));
  for (int t = 0; t < 5; ++t) {
    Random words(3, static_cast<uint64_t>(t));  // the same for all robots: they match
    Piece topic = topicPiece(90, 400, 2, 300, words);
    topic.key.robot = robot;
    topic.key.index = {3 * t + 1, 0, 0};
    auto& content = std::get<mapping::TopicPart>(topic.content);
    content.created.us += observation;
    if (t == 4 && observation > 20) {  // retired
      content.weight = 0;
      content.words.clear();
    }
    pieces.push_back(std::move(topic));
  }
  for (int t = 0; t < 3; ++t) {  // the last is no more
    mapping::ExamplePicture example{.topic = world::TopicId{3 * t + 1},
                                    .number = t,
                                    .observation = observation,
                                    .cell = {t, -5, number(robot)},
                                    .seen = {1'000'000 * (observation - t)},
                                    .rgb = {}};
    while (t < 2 && example.rgb.size() < kPictureBytes) {
      const auto i = static_cast<uint32_t>(example.rgb.size());
      example.rgb.push_back(static_cast<uint8_t>(i * i / 700 % 200 + random.below(30)));
    }
    for (Piece& layer : picturePieces(example, robot, 0)) pieces.push_back(std::move(layer));
  }
  for (Piece& piece : pieces) piece.version = {number(robot) == 2 ? 1 : 0, observation};
  return pieces;
}

std::vector<comms::Packet> packetsOfRobots(Random& random) {
  std::vector<comms::Packet> packets, together;
  for (int r = 0; r < 3; ++r) {
    for (const int observation : {20, 40}) {
      std::vector<Piece> shared;  // first parts of topics, said together too
      for (const Piece& whole : wholePieces(RobotId{r}, observation, random)) {
        if (whole.key.kind == mapping::PieceKind::kTopic && whole.key.index[0] > 6)
          shared.push_back(cutToFit(whole, kMaxBytes).front());
        for (const Piece& part : cutToFit(whole, kMaxBytes)) {
          packets.push_back(packetOf(part, 1'000'000 * observation));
          const bool is_layer = part.key.kind == mapping::PieceKind::kPicture;
          if (part.part == 0 && part.num_parts > 1 &&
              !is_layer) {  // a newer version of which this part is never heard
            Piece newer = part;
            newer.version.observation = 60;
            newer.part = 1;
            packets.push_back(packetOf(newer, 60'000'000));
          }
        }
      }
      together.push_back({"SHOAL_" + name(RobotId{r}) + "_TOPICS",
                          encode(shared, kMission, {1'000'000 * (observation + 5)})});
    }
  }
  // An earlier life of R02, with topics of its own.
  for (Piece& whole : wholePieces(RobotId{2}, 80, random)) {
    whole.version.epoch = 0;
    if (whole.key.kind == mapping::PieceKind::kTopic) whole.key.index[0] += 1;
    for (const Piece& part : cutToFit(whole, kMaxBytes)) packets.push_back(packetOf(part, 80'000'000));
  }
  for (const mapping::Edit& edit :
       {mapping::Edit{{"SHORE", 1}, {50'000'000}, mapping::NameEdit{{RobotId{0}, 0, world::TopicId{1}}, "x"}},
        mapping::Edit{{"SHORE", 2}, {51'000'000}, mapping::ExcludeEdit{RobotId{2}}},
        mapping::Edit{{"OPERATOR", 1}, {52'000'000}, mapping::UndoEdit{{"SHORE", 2}}}}) {
    packets.push_back({"SHOAL_OPERATOR_EDIT", encode(mapping::pieceOf(edit), kMission, {53'000'000})});
  }
  for (size_t i = 0, n = packets.size(); i < n; i += 5) {  // said twice, later
    packets.push_back(packets[i]);
    stampTime(packets.back().bytes, {70'000'000});
  }
  for (size_t i = packets.size(); i > 1; --i) std::swap(packets[i - 1], packets[random.below(i)]);
  Random places(9);
  for (const comms::Packet& packet : together)
    packets.insert(packets.begin() + static_cast<ptrdiff_t>(places.below(packets.size() / 2)), packet);
  return packets;
}

// What is refused, each for one reason.
std::vector<comms::Packet> rubbish(const comms::Packet& good) {
  std::vector<comms::Packet> packets(7, good);
  packets[0].channel = "CAMERA";
  packets[1].channel = "SHOAL_R00_HEARTBEAT";
  packets[2].bytes[25] ^= 1;
  packets[3].bytes.pop_back();
  packets[4].bytes[20] = 2;  // another format
  packets[5].bytes.assign(5, 0);
  packets[6].channel = "SHOAL_R77" + good.channel.substr(good.channel.rfind('_'));
  return packets;
}

std::vector<comms::Packet> packetsOfNodes(const fusion_node::MissionState& state) {
  std::vector<comms::Packet> packets;
  const auto say = [&](const std::string& channel, const std::vector<Bytes>& chunks) {
    for (const Bytes& chunk : chunks) packets.push_back({channel, chunk});
  };
  auto labels = state.map().labels;
  labels.front().name = "Seegr\xc3\xa4ser, \"tall\"";
  const uint64_t digest = state.mapDigest();
  for (const std::string node : {"SHOAL_OPERATOR_", "SHOAL_SHORE_"}) {
    say(node + "MATCHES",
        encodeMatches(state.map().correspondences, digest, kMission, {80'000'000}, kMaxBytes));
    say(node + "LABELS", encodeLabels(labels, digest, kMission, {80'000'000}, kMaxBytes));
  }
  say("SHOAL_OPERATOR_MAP", encodeMap(state.map(), digest, kMission, {80'000'000}, kMaxBytes));
  for (int r = 0; r < 3; ++r) {
    Heartbeat h;
    h.mission = kMission;
    h.time.us = 90'000'000;
    h.phase = Phase::kLanded;
    h.cell_size_m = kCellSize;
    h.own_digest = state.beliefs().digestOf(RobotId{r}) + (r == 1 ? 1u : 0u);  // R01 has more to say
    packets.push_back({"SHOAL_" + name(RobotId{r}) + "_HEARTBEAT", encode(h)});
  }
  return packets;
}

// Messages with the most unlike content, as a stream of their own: none is part of the mission.
std::vector<comms::Packet> strangeMessages(Random& random) {
  std::vector<comms::Packet> packets;
  for (const Example& example : goldenExamples()) packets.push_back({example.name, example.bytes});
  const auto say = [&](const Piece& whole) {
    for (const Piece& part : cutToFit(whole, kMaxMessageBytes))
      packets.push_back({"strange", encode(part, -1, {kMaxTimeUs})});
  };
  for (int i = 0; i < 12; ++i) {
    packets.push_back({"strange", encode(noiseHeartbeat(20 * i, 1 + 3 * i, random))});
    const double density = i % 4 == 0 ? 0.0002 : 0.03 * i;
    say(noiseBrick({-(1 << 27), (1 << 27) - 1, i}, density, random));
    say(noiseCertainty({i, -i, 0}, density, random));
    say(planarBrick(1 + 3 * i, 1 + i, 0.04 * i, static_cast<uint64_t>(i)));
    say(topicPiece(1 + 60 * i, 1000 * (i + 1), 1 + 5 * i, 1 + i * i * i * 1000, random));
  }
  packets.push_back({"strange", encodeMap({}, 5, 1, {}).at(0)});
  packets.push_back({"strange", encodeMatches({}, 5, 1, {}).at(0)});
  packets.push_back({"strange", encodeLabels({}, 5, 1, {}).at(0)});
  return packets;
}

Bytes sealedLog(const std::vector<comms::Packet>& packets, const comms::SealKey& key) {
  Bytes log;
  for (size_t i = 0; i < packets.size(); ++i) {
    comms::Packet packet = packets[i];
    if (packet.channel.starts_with("SHOAL_")) comms::addSeal(key, {9, static_cast<uint32_t>(i)}, packet);
    append(log, packet, log.size());
    if (i % 5 != 0 || !packet.channel.starts_with("SHOAL_")) continue;
    packet.bytes[packet.bytes.size() / 2] ^= 1;
    append(log, packet, log.size());
  }
  return log;
}

void write(const std::string& path, std::span<const char> text) {
  std::ofstream file(path, std::ios::binary);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file) throw std::runtime_error("cannot write " + path);
}

nlohmann::json stateJson(const fusion_node::MissionState& state, const comms::Stats& stats) {
  nlohmann::json json{{"state_digest", state.beliefs().digest()},
                      {"map_digest", state.mapDigest()},
                      {"refused", stats.rejected},
                      {"robots", nlohmann::json::object()}};
  for (const RobotId robot : state.beliefs().robots()) {
    if (robot == mapping::kOperators) continue;
    json["robots"][name(robot)] = {
        {"digest", state.beliefs().digestOf(robot)}, {"cells", 0}, {"words", nlohmann::json::object()}};
  }
  state.beliefs().visit([&](const Piece& piece) {
    if (piece.key.robot == mapping::kOperators) return;
    auto& robot = json["robots"][name(piece.key.robot)];
    if (const auto* brick = std::get_if<mapping::BrickPart>(&piece.content))
      robot["cells"] = robot["cells"].get<size_t>() + brick->cells.size();
    const auto* topic = std::get_if<mapping::TopicPart>(&piece.content);
    if (topic == nullptr || topic->weight == 0) return;
    auto& words = robot["words"][std::to_string(piece.key.index[0])];
    for (const auto& [word, count] : topic->words) words[std::to_string(word)] = count;
  });
  return json;
}

void run(const std::string& folder) {
  Random random(20210529);
  std::vector<comms::Packet> packets = packetsOfRobots(random);
  const auto bad = rubbish(packets.front());
  packets.insert(packets.begin() + 9, bad.begin(), bad.end());

  fusion_node::MissionState state(kMission, {}, kCellSize);
  comms::Stats stats;
  for (const auto& packet : packets) state.hear(packet, stats);
  state.refreshMap();
  const auto published = packetsOfNodes(state);
  packets.insert(packets.end(), published.begin(), published.end());
  const auto strange = strangeMessages(random);

  Bytes log;
  std::string lines;
  const auto record = [&](const comms::Packet& packet) {
    append(log, packet, log.size());
    lines += messageJson(packet.channel, packet.bytes).dump() + "\n";
  };
  const auto save = [&](const std::string& name) {
    write(folder + "/" + name, {reinterpret_cast<const char*>(log.data()), log.size()});
  };
  std::ranges::for_each(packets, record);
  save("mission.lcmlog");
  const comms::SealKey key = comms::SealKey::make(folder + "/team.key");
  comms::SealKey::make(folder + "/other.key");
  const Bytes sealed = sealedLog(packets, key);
  write(folder + "/sealed.lcmlog", {reinterpret_cast<const char*>(sealed.data()), sealed.size()});
  std::ranges::for_each(strangeMessages(random), record);
  save("everything.lcmlog");
  write(folder + "/messages.jsonl", lines);
  write(folder + "/state.json", stateJson(state, stats).dump());
  write(folder + "/global_map.csv", mapping::globalMapCsv(state.map(), world::Grid(kCellSize)));
}

}  // namespace
}  // namespace shoal::wire

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: write_recording FOLDER\n");
    return 2;
  }
  try {
    shoal::wire::run(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "write_recording: %s\n", error.what());
    return 1;
  }
  return 0;
}
