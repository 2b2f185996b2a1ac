// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/picture_pieces.h"

#include <algorithm>
#include <tuple>

#include "shoal/mapping/held_pictures.h"

namespace shoal::wire {

namespace {

std::vector<mapping::Piece> piecesOf(const mapping::ExamplePicture& example, int32_t number,
                                     std::vector<Bytes> layers, world::RobotId robot, int32_t epoch) {
  std::vector<mapping::Piece> pieces;
  for (Bytes& layer : layers) {
    pieces.push_back({.key = {robot, mapping::PieceKind::kPicture, {world::number(example.topic), number, 0}},
                      .version = {epoch, example.observation},
                      .part = static_cast<int32_t>(pieces.size()),
                      .num_parts = static_cast<int32_t>(layers.size()),
                      .content = mapping::PicturePart{example.cell, example.seen, std::move(layer)}});
  }
  return pieces;
}

}  // namespace

std::vector<mapping::Piece> picturePieces(const mapping::ExamplePicture& example, world::RobotId robot,
                                          int32_t epoch) {
  std::vector<Bytes> layers = {{}};
  if (!example.rgb.empty()) layers = encodePicture(example.rgb);
  return piecesOf(example, example.number, std::move(layers), robot, epoch);
}

std::vector<mapping::Piece> sharperPieces(const mapping::ExamplePicture& example, world::RobotId robot,
                                          int32_t epoch) {
  if (example.rgb.empty()) return {};
  return piecesOf(example, example.number + mapping::kSharperBy, encodePicture(example.rgb, kSharperSizes),
                  robot, epoch);
}

std::vector<mapping::Piece> PictureChanges::update(const mapping::LocalBelief& belief) {
  std::vector<mapping::Piece> changed;
  for (const mapping::ExamplePicture& example : belief.examples) {
    const mapping::PieceKey key = {
        belief.robot, mapping::PieceKind::kPicture, {number(example.topic), example.number, 0}};
    const auto said = said_.find(key);
    if (said != said_.end() && said->second == example.observation) continue;
    said_[key] = example.observation;
    for (mapping::Piece& piece : picturePieces(example, belief.robot, belief.version.epoch)) {
      changed.push_back(std::move(piece));
    }
  }
  std::ranges::stable_sort(changed, {}, [](const mapping::Piece& piece) {
    const bool is_picture = !std::get<mapping::PicturePart>(piece.content).layer.empty();
    return std::tuple(is_picture, piece.part, piece.key.index[1], piece.key.index[0]);
  });
  return changed;
}

}  // namespace shoal::wire
