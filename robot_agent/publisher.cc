// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/publisher.h"

#include <utility>

#include "shoal/wire/limits.h"
#include "shoal/wire/piece_codec.h"

namespace shoal::robot_agent {

void Publisher::publish(const std::vector<mapping::Piece>& whole_pieces, bool repeatable) {
  for (const mapping::Piece& whole : whole_pieces) {
    auto parts = wire::encodeToFit(whole, voice_.mostBytes(whole), mission_);
    for (wire::EncodedPart& each : parts) saver_.say(each.part, std::move(each.message), repeatable);
    int32_t& published = num_parts_[whole.key];
    for (auto stale = static_cast<int32_t>(parts.size()); stale < published; ++stale)
      saver_.forget(whole.key, stale);
    published = static_cast<int32_t>(parts.size());
  }
}

void Publisher::publishPictures(const std::vector<mapping::Piece>& layers, bool repeatable) {
  for (const mapping::Piece& layer : layers) {
    const mapping::Piece* said = voice_.said().find(layer.key, layer.part);
    if (said != nullptr && said->version == layer.version) continue;  // in an earlier life
    saver_.say(layer, wire::encode(layer, mission_, {}), repeatable);
    for (int32_t stale = layer.num_parts; stale < wire::kMaxPictureLayers; ++stale)
      saver_.forget(layer.key, stale);
  }
}

void Publisher::restore(const Checkpoint& checkpoint) {
  for (const Checkpoint::Said& said : checkpoint.said) num_parts_[said.piece.key] = said.piece.num_parts;
}

}  // namespace shoal::robot_agent
