// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <nlohmann/json_fwd.hpp>

#include "fusion_node/mission_state.h"
#include "shoal/mapping/held_pictures.h"

namespace shoal::fusion_node {

/// A picture that somebody would like to see sharper.
struct SharperPicture {
  mapping::HeldPicture picture;  ///< as it is held
  mapping::PieceKey key;         ///< of what is to be asked for
  world::Version version;        ///< that it must have
};

/// The picture that {"query": "ask", ...} means:
///   robot, topic, and optionally example     "R03", 7, 0
///   label                                    the best picture of a label, by number as text or name
/// @throws std::invalid_argument naming what is wrong and what would be right; nlohmann::json::exception for
/// a
///         missing key.
SharperPicture sharperPicture(const MissionState& state, const nlohmann::ordered_json& question);

/// What it will cost to have it sharper, at most: bytes on the wire of the request and of the answer, headers
/// counted, and seconds of mission time until it is here when nothing is lost: the request under our budget,
/// what the robot still has to say, and the answer, under its budget. Until it has landed, and looked again
/// if it will, there is no such bound. Nothing when the picture is sharp already: it was asked for before, or
/// it is simple enough to have come as fine as any.
/// @param node    Who asks. @param budget  Its bytes per second, 0 = unlimited.
/// @returns {"robot","topic","example","label","state","bytes":{"request","answer"},"seconds","heard_ago_s",
///          "picture"}; state is "sharp" or "not sharp"; seconds is null when there is no bound, or when the
///          robot was never heard: heard_ago_s is null then too.
nlohmann::ordered_json priceOf(const MissionState& state, const SharperPicture& wanted,
                               const std::string& node, int64_t budget);

}  // namespace shoal::fusion_node
