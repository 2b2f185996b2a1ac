// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/piece_audit.h"

#include <variant>

#include "shoal/world/ids.h"

namespace shoal::console {
namespace {

std::string pieceNameOf(const mapping::PieceKey& key) {
  const auto& i = key.index;
  if (key.kind == mapping::PieceKind::kTopic) return "topic " + std::to_string(i[0]);
  if (key.kind == mapping::PieceKind::kPicture) {
    return "picture " + std::to_string(i[1]) + " of topic " + std::to_string(i[0]);
  }
  if (key.kind == mapping::PieceKind::kSettings) return "settings";
  const std::string brick =
      "brick (" + std::to_string(i[0]) + ", " + std::to_string(i[1]) + ", " + std::to_string(i[2]) + ")";
  return (key.kind == mapping::PieceKind::kBrick ? "labels of " : "certainties of ") + brick;
}

// What a part adds to the counts of a heartbeat.
int64_t countOf(const mapping::Piece& piece) {
  if (const auto* topic = std::get_if<mapping::TopicPart>(&piece.content)) {
    return piece.part == 0 && topic->weight > 0 ? 1 : 0;
  }
  if (const auto* brick = std::get_if<mapping::BrickPart>(&piece.content)) {
    return static_cast<int64_t>(brick->cells.size());
  }
  return 0;
}

}  // namespace

void PieceAudit::hear(const mapping::Piece& piece) {
  int32_t& epoch = epochs_.try_emplace(piece.key.robot, piece.version.epoch).first->second;
  if (piece.version.epoch < epoch) return;
  if (piece.version.epoch > epoch) {
    std::erase_if(pieces_, [&](const auto& heard) { return heard.first.robot == piece.key.robot; });
    epoch = piece.version.epoch;
  }
  Heard& heard = pieces_.try_emplace(piece.key, Heard{piece.version, piece.num_parts, {}}).first->second;
  if (piece.version < heard.version) return;
  if (heard.version < piece.version) heard = {piece.version, piece.num_parts, {}};
  heard.cells[piece.part] = countOf(piece);
}

std::vector<std::string> PieceAudit::lacking(world::RobotId robot, const wire::Heartbeat& last) const {
  std::vector<std::string> lines;
  const std::string owner = world::name(robot) + ": ";
  int64_t topics = 0;
  int64_t cells = 0;
  for (const auto& [key, heard] : pieces_) {
    if (key.robot != robot) continue;
    for (const auto& [part, count] : heard.cells) {
      if (key.kind == mapping::PieceKind::kTopic) topics += count;
      if (key.kind == mapping::PieceKind::kBrick) cells += count;
    }
    for (int32_t part = 0; part < heard.num_parts; ++part) {
      if (heard.cells.contains(part)) continue;
      lines.push_back(owner + pieceNameOf(key) + ", part " + std::to_string(part + 1) + " of " +
                      std::to_string(heard.num_parts));
    }
    if (key.kind != mapping::PieceKind::kBrick && key.kind != mapping::PieceKind::kCertainty) continue;
    mapping::PieceKey other = key;
    other.kind =
        key.kind == mapping::PieceKind::kBrick ? mapping::PieceKind::kCertainty : mapping::PieceKind::kBrick;
    if (!pieces_.contains(other)) lines.push_back(owner + pieceNameOf(other));
  }
  if (topics < last.num_topics) {
    lines.push_back(owner + std::to_string(last.num_topics - topics) + " of " +
                    std::to_string(last.num_topics) + " topics");
  }
  if (cells < last.num_cells) {
    lines.push_back(owner + std::to_string(last.num_cells - cells) + " of " + std::to_string(last.num_cells) +
                    " cells");
  }
  if (lines.empty()) lines.push_back(owner + "the newest version of some pieces");
  return lines;
}

}  // namespace shoal::console
