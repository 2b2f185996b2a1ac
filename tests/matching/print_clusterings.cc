// SPDX-License-Identifier: BSD-3-Clause
// Prints how rectify() clusters noisy graphs of many sizes, and the worked cases when their folder is named:
// a line each. Two builds that print the same decide the same; see compare_builds.sh.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "noisy_graph.h"
#include "shoal/matching/clear.h"

namespace {

using namespace shoal::matching;

void print(const std::string& name, const AssociationGraph& graph) {
  const Clustering clustering = rectify(graph);
  std::cout << name << ": " << clustering.universe << " /";
  for (const int label : clustering.label) std::cout << ' ' << label;
  std::cout << '\n';
}

AssociationGraph read(const std::filesystem::path& path) {
  std::ifstream file(path);
  const nlohmann::json example = nlohmann::json::parse(file);
  AssociationGraph graph{example["counts"].get<std::vector<int>>(), {}};
  for (const auto& e : example["edges"]) {
    if (e[0] < e[1]) graph.edges.push_back({e[0], e[1], e.size() > 2 ? e[2].get<double>() : 1.0});
  }
  return graph;
}

}  // namespace

int main(int argc, char** argv) {
  for (const auto& [robots, topics] : {std::pair{4, 6}, {12, 10}, {12, 25}, {20, 8}, {25, 16}, {60, 12}}) {
    for (const double noise : {.02, .15, .3, .5}) {
      for (const uint64_t seed : {1, 2, 3}) {
        print(std::to_string(robots) + " robots, noise " + std::to_string(noise) + ", seed " +
                  std::to_string(seed),
              makeNoisyGraph(robots, topics, noise, noise, seed).graph);
      }
    }
  }
  if (argc < 2) return 0;
  std::ifstream index_file(std::filesystem::path(argv[1]) / "index.json");
  for (const auto& entry : nlohmann::json::parse(index_file)) {
    const auto name = entry["name"].get<std::string>();
    print(name, read(std::filesystem::path(argv[1]) / (name + ".json")));
  }
}
