// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace shoal::console {

struct Finding {
  enum class State { kGood, kWarning, kBad };
  std::string check;  ///< what was looked at, in a few words
  State state = State::kGood;
  std::string says;  ///< what was found
  std::string type;  ///< what to type; empty when nothing needs to be done
};

/// Looks at this machine: would a mission on this URL work, and leave its files in this folder? Takes about
/// two seconds, for it listens. Changes nothing; what it says to try the network stays on this host.
/// @param url     a multicast group. @throws std::invalid_argument as comms::parseUrl().
/// @param folder  where missions are to go; need not be there yet.
std::vector<Finding> examine(const std::string& url, const std::string& folder);

/// {"url", "works", "checks": [{"check", "state", "says", "type"}]}: it works when nothing is bad.
nlohmann::ordered_json toJson(const std::vector<Finding>& findings, const std::string& url);
std::string toText(const std::vector<Finding>& findings);
bool works(const std::vector<Finding>& findings);

}  // namespace shoal::console
