// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/message_json.h"

#include <array>
#include <variant>

#include <nlohmann/json.hpp>

#include "shoal/mapping/piece.h"
#include "shoal/wire/heartbeat_codec.h"
#include "shoal/wire/labels_codec.h"
#include "shoal/wire/map_codec.h"
#include "shoal/wire/matches_codec.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/piece_codec.h"
#include "shoal/wire/repair_codec.h"

namespace shoal::wire {
namespace {

using nlohmann::json;

json arrayOf(const world::CellIndex& c) { return {c.x, c.y, c.z}; }

json fields(const Heartbeat& h) {
  constexpr std::array kPhases = {"flying", "landed", "leaving", "node", "listening"};
  json j{{"phase", kPhases[static_cast<size_t>(h.phase)]},
         {"epoch", h.epoch},
         {"observation", h.observation},
         {"num_observations", h.num_observations},
         {"num_topics", h.num_topics},
         {"num_cells", h.num_cells},
         {"own_digest", h.own_digest},
         {"state_digest", h.state_digest},
         {"map_digest", h.map_digest},
         {"map_of_state", h.map_of_state},
         {"vocabulary", h.vocabulary},
         {"cell_size_m", h.cell_size_m},
         {"host", h.host},
         {"pid", h.pid},
         {"x_m", double{h.x_m}},
         {"y_m", double{h.y_m}},
         {"z_m", double{h.z_m}},
         {"bytes_sent", h.bytes_sent},
         {"budget", h.budget},
         {"queue_bytes", h.queue_bytes},
         {"rejected", h.rejected},
         {"conflicts", h.conflicts},
         {"ms_per_frame", double{h.ms_per_frame}}};
  constexpr std::array kClasses = {"heartbeat", "matches",  "topics", "bricks",
                                   "certainty", "pictures", "local"};
  for (size_t c = 0; c < kClasses.size(); ++c) j["class_bytes"][kClasses[c]] = h.class_bytes[c];
  j["battery_percent"] = h.battery_percent < 0 ? json() : json(h.battery_percent);
  j["depth_cm"] = h.depth_cm < 0 ? json() : json(h.depth_cm);
  j["learnt"] = hasLanded(h.phase) ? json(h.learnt) : json();
  j["roster"] = json::array();
  for (const auto& share : h.roster) j["roster"].push_back(json::array({number(share.robot), share.digest}));
  return j;
}

json fields(const mapping::Edit& edit) {
  json j{{"operation", std::string(mapping::verbOf(edit))},
         {"author", edit.id.author},
         {"counter", edit.id.counter},
         {"made_us", edit.time.us}};
  const auto topic = [](const mapping::TopicRef& t) {
    return json::array({number(t.robot), t.epoch, number(t.topic)});
  };
  if (const auto* name = std::get_if<mapping::NameEdit>(&edit.operation)) {
    j["topics"] = json::array({topic(name->topic)});
    j["name"] = name->text;
  } else if (const auto* link = std::get_if<mapping::LinkEdit>(&edit.operation)) {
    j["topics"] = json::array({topic(link->a), topic(link->b)});
  } else if (const auto* exclude = std::get_if<mapping::ExcludeEdit>(&edit.operation)) {
    j["robot"] = number(exclude->robot);
  } else {
    const mapping::EditId& undone = std::get<mapping::UndoEdit>(edit.operation).edit;
    j["undone"] = json::array({undone.author, undone.counter});
  }
  return j;
}

json topicFields(const mapping::Piece& piece) {
  const auto& topic = std::get<mapping::TopicPart>(piece.content);
  json j{{"part", piece.part},
         {"num_parts", piece.num_parts},
         {"observation", piece.version.observation},
         {"topic", piece.key.index[0]},
         {"num_words", topic.words.size()},
         {"created_us", topic.created.us},
         {"weight", topic.weight},
         {"group_sizes", topic.group_sizes},
         {"words", json::array()}};
  for (const auto& [word, count] : topic.words) j["words"].push_back(json::array({word, count}));
  return j;
}

json fields(const mapping::Piece& piece, const mapping::PicturePart& picture) {
  return {{"part", piece.part},
          {"num_parts", piece.num_parts},
          {"robot", number(piece.key.robot)},
          {"epoch", piece.version.epoch},
          {"observation", piece.version.observation},
          {"topic", piece.key.index[0]},
          {"example", piece.key.index[1]},
          {"cell", arrayOf(picture.cell)},
          {"seen_us", picture.seen.us},
          {"layer", picture.layer}};
}

json fields(const mapping::Piece& piece, const mapping::SettingsPart& settings) {
  return {{"robot", number(piece.key.robot)},
          {"epoch", piece.version.epoch},
          {"words", settings.words},
          {"hyperparameters", settings.hyperparameters},
          {"cell_size_m", settings.cell_size_m}};
}

json brickFields(const mapping::Piece& piece) {
  json j{{"part", piece.part},
         {"num_parts", piece.num_parts},
         {"observation", piece.version.observation},
         {"brick_x", piece.key.index[0]},
         {"brick_y", piece.key.index[1]},
         {"brick_z", piece.key.index[2]}};
  if (const auto* brick = std::get_if<mapping::BrickPart>(&piece.content)) {
    for (const auto& c : brick->cells)
      j["cells"].push_back(json::array({arrayOf(c.cell), number(c.topic), c.seen.us}));
  } else {
    for (const auto& c : std::get<mapping::CertaintyPart>(piece.content).cells)
      j["certainties"].push_back(json::array({arrayOf(c.cell), c.steps, c.surprise}));
  }
  return j;
}

json fields(const std::vector<mapping::Piece>& pieces) {
  const mapping::Piece& first = pieces.front();
  if (const auto* edit = std::get_if<mapping::Edit>(&first.content)) return fields(*edit);
  if (const auto* picture = std::get_if<mapping::PicturePart>(&first.content)) return fields(first, *picture);
  if (const auto* settings = std::get_if<mapping::SettingsPart>(&first.content))
    return fields(first, *settings);
  json j{{"robot", number(first.key.robot)}, {"epoch", first.version.epoch}};
  if (std::holds_alternative<mapping::TopicPart>(first.content)) {
    for (const mapping::Piece& piece : pieces) j["topics"].push_back(topicFields(piece));
    return j;
  }
  json& bricks = j[std::holds_alternative<mapping::BrickPart>(first.content) ? "bricks" : "certain_bricks"];
  for (const mapping::Piece& piece : pieces) bricks.push_back(brickFields(piece));
  return j;
}

json fields(const mapping::Piece& piece) { return fields(std::vector{piece}); }

template <typename Chunk>
json chunkFields(const Chunk& chunk) {
  return {{"map_digest", chunk.map_digest}, {"chunk", chunk.chunk}, {"num_chunks", chunk.num_chunks}};
}

json fields(const MatchesChunk& chunk) {
  json j = chunkFields(chunk);
  j["correspondences"] = json::array();
  for (const auto& c : chunk.correspondences)
    j["correspondences"].push_back(json::array({number(c.robot), number(c.topic), number(c.label)}));
  return j;
}

json fields(const LabelsChunk& chunk) {
  json j = chunkFields(chunk);
  j["labels"] = json::array();
  for (const auto& row : chunk.labels) {
    json robots = json::array();
    for (const world::RobotId robot : row.robots) robots.push_back(number(robot));
    j["labels"].push_back({{"label", number(row.label)},
                           {"name", row.name},
                           {"cells", row.cells},
                           {"robots", robots},
                           {"first_seen_us", row.first_seen.us}});
  }
  return j;
}

json fields(const MapChunk& chunk) {
  json j = chunkFields(chunk);
  j["brick_x"] = chunk.brick[0];
  j["brick_y"] = chunk.brick[1];
  j["brick_z"] = chunk.brick[2];
  j["fused_cells"] = json::array();
  for (const auto& c : chunk.cells)
    j["fused_cells"].push_back(json::array(
        {arrayOf(c.cell), number(c.label), number(c.robot), c.seen.us, certaintySteps(c.certainty)}));
  return j;
}

json fields(const Bytes& talk) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string hex;
  for (const uint8_t byte : talk) hex += {kDigits[byte >> 4], kDigits[byte & 15]};
  return {{"talk", hex}};
}

}  // namespace

json messageJson(const std::string& channel, std::span<const uint8_t> bytes) {
  const auto refused = [&](DecodeError error) {
    return json{{"channel", channel}, {"refused", std::string(name(error))}};
  };
  const auto header = peek(bytes);
  if (!header) return refused(header.error());
  const auto told = [&](const auto& decoded) {
    if (!decoded) return refused(decoded.error());
    json j = fields(*decoded);
    j["channel"] = channel;
    j["kind"] = std::string(channelKind(header->kind));
    j["utime"] = header->time.us;
    j["mission"] = header->mission;
    return j;
  };
  switch (header->kind) {
    case MessageKind::kHeartbeat:
      return told(decodeHeartbeat(bytes));
    case MessageKind::kTopics:
    case MessageKind::kBrick:
    case MessageKind::kCertainty:
    case MessageKind::kEdit:
      return told(decodePieces(header->kind, bytes));
    case MessageKind::kPicture:
    case MessageKind::kSettings:
      return told(decodePieces(header->kind, bytes));
    case MessageKind::kMatches:
      return told(decodeMatches(bytes));
    case MessageKind::kLabels:
      return told(decodeLabels(bytes));
    case MessageKind::kMap:
      return told(decodeMap(bytes));
    case MessageKind::kRequest:
      return told(decodeRequest(bytes));
    case MessageKind::kRepair:
      return told(decodeRepair(bytes));
  }
  return {};
}

}  // namespace shoal::wire
