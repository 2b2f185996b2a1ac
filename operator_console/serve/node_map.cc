// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/serve/node_map.h"

#include <stdexcept>
#include <utility>

#include "fusion_node/query_server.h"

namespace shoal::console {

NodeMap::News NodeMap::ask(const std::string& state_dir) {
  const std::string has = std::exchange(has_, "");
  try {
    const auto begun = std::chrono::steady_clock::now();
    const auto answer = fusion_node::askNode(state_dir, {{"query", "map"}, {"has", has}});
    if (answer.contains("error")) throw std::runtime_error(answer.at("error").get<std::string>());
    News news{
        mapping::readChange(answer, state_dir), answer.at("cell_size_m"), {{"labels", answer.at("labels")}}};
    asking_ = news.change.is_whole ? std::chrono::steady_clock::duration{}
                                   : std::chrono::steady_clock::now() - begun;
    has_ = news.change.digest;
    return news;
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error("the node in " + state_dir + " answered nonsense: " + error.what());
  }
}

}  // namespace shoal::console
