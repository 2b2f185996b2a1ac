// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/global_map.h"

namespace shoal::mapping {

/// Examples from this number on are no others: they are example `number - kSharperBy` once more, sharper,
/// made and said only when somebody has asked for it. Their version is that of the example they show.
inline constexpr int32_t kSharperBy = 4;

/// What is held of one example picture of a robot's topic.
struct HeldPicture {
  world::RobotId robot{};
  world::TopicId topic{};
  int32_t number = 0;                        ///< 0: the most typical
  world::CellIndex cell;                     ///< in the middle
  world::Timestamp seen;                     ///< mission time of the image
  int32_t num_layers = 1;                    ///< that it has
  std::vector<std::vector<uint8_t>> layers;  ///< from the first on, without a gap; at least one
  bool sharpened = false;                    ///< the layers are those that somebody asked for
  bool operator==(const HeldPicture&) const = default;
};

/// All that a state holds, ascending by robot, topic and number; examples that are no more are left out.
/// Where all layers of a sharper one are held, they stand in place of the example's own.
std::vector<HeldPicture> heldPictures(const BeliefStore& beliefs);

/// The pictures of each label of the map, at most `most` each: those of the topic that the label is named
/// after, its oldest, first; then of its other topics by weight, heaviest first, the most typical example of
/// each before the next. Labels without any are left out.
std::map<world::GlobalLabel, std::vector<HeldPicture>> picturesOfLabels(const GlobalMap& map,
                                                                        const BeliefStore& beliefs,
                                                                        size_t most = 4);

/// One picture as the answers show it, its layers in hexadecimal digits.
nlohmann::ordered_json toJson(const HeldPicture& picture);

using LabelPictures = std::map<world::GlobalLabel, std::vector<HeldPicture>>;

/// The answer to "pictures": per label its pictures, each with its layers in hexadecimal digits, as they
/// travelled. Nothing is decoded here.
nlohmann::ordered_json picturesAnswer(const LabelPictures& pictures);

/// The inverse, for who asked. @throws std::runtime_error naming what is wrong with the answer.
LabelPictures picturesFrom(const nlohmann::ordered_json& answer);

}  // namespace shoal::mapping
