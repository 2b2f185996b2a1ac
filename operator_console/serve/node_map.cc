// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/serve/node_map.h"

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "fusion_node/query_server.h"
#include "shoal/mapping/map_changes.h"

namespace shoal::console {

const mapping::MissionView& NodeMap::refresh(const std::string& state_dir,
                                             const nlohmann::ordered_json& status) {
  const std::string has = std::exchange(has_, "");
  try {
    const auto begun = std::chrono::steady_clock::now();
    const auto answer = fusion_node::askNode(state_dir, {{"query", "map"}, {"has", has}});
    const bool is_first = answer.contains("digest") && !answer.contains("blocks");
    asking_ = is_first ? std::chrono::steady_clock::duration{} : std::chrono::steady_clock::now() - begun;
    if (answer.contains("error")) throw std::runtime_error(answer.at("error").get<std::string>());
    view_.mission = status.at("mission_id");
    view_.cell_size_m = answer.at("cell_size_m");
    view_.state_digest = std::stoull(status.at("digest").at("state").get<std::string>(), nullptr, 16);
    view_.map_digest = std::stoull(status.at("digest").at("map").get<std::string>(), nullptr, 16);
    view_.nodes.clear();
    for (const auto& node : status.at("nodes")) view_.nodes.push_back(mapping::nodeFromJson(node));
    has_ = mapping::takeChanges(view_.map, answer, state_dir);
    if (!has_.empty()) view_.map_digest = std::stoull(has_, nullptr, 16);  // it may have grown since status
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error("the node in " + state_dir + " answered nonsense: " + error.what());
  }
  return view_;
}

}  // namespace shoal::console
