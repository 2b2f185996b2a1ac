// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/sharper_pictures.h"

#include <utility>

#include <spdlog/spdlog.h>

#include "fusion_node/repair.h"
#include "shoal/mapping/held_pictures.h"
#include "shoal/wire/picture_pieces.h"

namespace shoal::robot_agent {

std::vector<mapping::Piece> SharperPictures::made(const mapping::LocalBelief& belief,
                                                  const mapping::BeliefStore& said, int32_t epoch) {
  std::vector<mapping::Piece> layers;
  if (wanted_.empty()) return layers;
  for (const mapping::ExamplePicture& example : belief.examples) {
    const mapping::PieceKey shown = {
        belief.robot, mapping::PieceKind::kPicture, {number(example.topic), example.number, 0}};
    mapping::PieceKey sharper = shown;
    sharper.index[1] += mapping::kSharperBy;
    if (!wanted_.contains(fusion_node::nameOf(sharper, 0).second) &&
        !wanted_.contains(fusion_node::nameOf(sharper, 1).second)) {
      continue;
    }
    const world::Version version{epoch, example.observation};
    const auto isSaid = [&](const mapping::PieceKey& key) {
      const mapping::Piece* piece = said.find(key, 0);
      return piece != nullptr && piece->version == version;
    };
    if (!isSaid(shown) || isSaid(sharper)) continue;
    for (mapping::Piece& layer : wire::sharperPieces(example, sharper.robot, version.epoch))
      layers.push_back(std::move(layer));
    spdlog::info("was asked for a sharper picture of topic {}", number(example.topic));
  }
  wanted_.clear();
  return layers;
}

}  // namespace shoal::robot_agent
