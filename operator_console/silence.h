// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "operator_console/asking.h"

namespace shoal::console {

/// Who is lost by an answer to `events` and was not heard since. The limit is that of the events' teller.
/// @param nodes  as `status` lists them.
std::set<std::string> lostNodes(const nlohmann::ordered_json& nodes, const nlohmann::ordered_json& events);

/// Adds to every node, as `status` lists them, "ago_s": mission time from its last heartbeat to `now_s`; and
/// "silent": it is lost. A running node's events say of everybody; a finished mission and a recording end
/// at their last message, so there only robots that had not landed can be.
/// @throws as answerTo().
void addSilence(const Asking& asking, nlohmann::ordered_json& nodes, double now_s);

/// Mission time of the latest heartbeat of any of these nodes, s.
double latestHeard(const nlohmann::ordered_json& nodes);

}  // namespace shoal::console
