// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/picture_message.h"

#include <shoal/picture_t.hpp>
#include <utility>

#include "shoal/wire/limits.h"
#include "shoal/wire/message.h"

namespace shoal::wire {

std::string faultOf(const mapping::PicturePart& picture, const mapping::Piece& piece) {
  const mapping::PieceKey& key = piece.key;
  if (key.kind != mapping::PieceKind::kPicture) return "key and content are of different kinds";
  if (key.index[0] < 0 || key.index[0] > world::kMaxTopicId) return "topic ids lie in [0, 9999]";
  if (key.index[1] < 0 || key.index[1] >= mapping::kMaxExamples) return "examples are numbered from 0 to 7";
  if (key.index[2] != 0) return "a picture's index is {topic, example, 0}";
  if (piece.num_parts > kMaxPictureLayers) return "a picture has 1 to 4 layers";
  if (picture.seen.us < 0 || picture.seen.us > kMaxTimeUs) return "the time of the image is out of range";
  if (picture.layer.size() > kMaxLayerBytes) return "a layer has more than 540 bytes";
  if (picture.layer.empty() && piece.num_parts != 1) return "a layer is empty";
  return {};
}

Bytes encodePictureMessage(const mapping::Piece& piece, int32_t mission, world::Timestamp time) {
  const auto& picture = std::get<mapping::PicturePart>(piece.content);
  picture_t message{};
  message.utime = time.us;
  message.mission = mission;
  message.part = static_cast<uint8_t>(piece.part);
  message.num_parts = static_cast<uint8_t>(piece.num_parts);
  message.robot = static_cast<int16_t>(number(piece.key.robot));
  message.epoch = piece.version.epoch;
  message.observation = piece.version.observation;
  message.topic = static_cast<int16_t>(piece.key.index[0]);
  message.example = static_cast<uint8_t>(piece.key.index[1]);
  message.cell_x = picture.cell.x;
  message.cell_y = picture.cell.y;
  message.cell_z = picture.cell.z;
  message.seen = picture.seen.us;
  return pack(std::move(message), picture.layer);
}

Result<mapping::Piece> decodePictureMessage(std::span<const uint8_t> bytes) {
  const auto message = unpack<picture_t>(bytes);
  if (!message) return message.error();
  const picture_t& m = *message;
  return mapping::Piece{
      .key = {world::RobotId{m.robot}, mapping::PieceKind::kPicture, {m.topic, m.example, 0}},
      .version = {m.epoch, m.observation},
      .part = m.part,
      .num_parts = m.num_parts,
      .content = mapping::PicturePart{{m.cell_x, m.cell_y, m.cell_z}, {m.seen}, m.payload}};
}

}  // namespace shoal::wire
