// SPDX-License-Identifier: BSD-3-Clause
// Flies missions in this process and writes what a matcher needs and what scores it, a JSON object a line, so
// that matchers can be compared in seconds: build/bin/shoal_harvest_topics --world W --robots 12 --seeds 3
// --out FILE
#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "shoal/eval/team_learning.h"
#include "shoal/eval/team_words.h"
#include "shoal/eval/topic_tally.h"
#include "shoal/world/place.h"

namespace shoal::eval {
namespace {

using nlohmann::json;
using Vertices = std::map<std::pair<int32_t, int32_t>, int>;  // robot, topic
using Pairs = std::map<std::pair<int, int>, int64_t>;

Vertices verticesOf(const Stacked& team) {
  Vertices vertex;
  for (size_t r = 0; r < team.descriptors.robots.size(); ++r) {
    for (const matching::Descriptor& d : team.descriptors.robots[r])
      vertex.emplace(std::pair(static_cast<int32_t>(r), d.slot), static_cast<int>(vertex.size()));
  }
  return vertex;
}

void count(Pairs& pairs, int i, int j) { ++pairs[std::minmax(i, j)]; }

json listOf(const Pairs& pairs) {
  json list = json::array();
  for (const auto& [pair, n] : pairs) list.push_back({pair.first, pair.second, n});
  return list;
}

// How often topics of one robot are neighbours in the plane, topics of two robots see one cell, and topics of
// two robots are neighbours where only one of them saw each cell.
void addPlaces(json& line, const Stacked& team, const Vertices& vertex) {
  std::map<world::CellIndex, std::vector<int>> seen;
  std::vector<int> robot_of;
  for (const auto& [key, v] : vertex) robot_of.push_back(key.first);
  for (const mapping::LocalBelief& b : team.beliefs) {
    for (const mapping::BelievedCell& c : b.cells) {
      const auto known = vertex.find({number(b.robot), number(c.topic)});
      if (known != vertex.end()) seen[c.cell].push_back(known->second);
    }
  }
  Pairs inside, shared, border;
  for (const auto& [cell, here] : seen) {
    for (size_t a = 0; a < here.size(); ++a)
      for (size_t b = 0; b < a; ++b) count(shared, here[a], here[b]);
    for (const auto& next : {world::CellIndex{cell.x + 1, cell.y, cell.z}, {cell.x, cell.y + 1, cell.z}}) {
      const auto there = seen.find(next);
      if (there == seen.end()) continue;
      for (const int i : here) {
        for (const int j : there->second) {
          const bool own = robot_of[static_cast<size_t>(i)] == robot_of[static_cast<size_t>(j)];
          count(own ? inside : border, i, j);
        }
      }
    }
  }
  line["inside"] = listOf(inside);
  line["shared"] = listOf(shared);
  line["border"] = listOf(border);
}

json mission(std::vector<mapping::LocalBelief> beliefs, const TruthOfCell& truth) {
  const Stacked team = stackTeam(std::move(beliefs));
  const Vertices vertex = verticesOf(team);
  const TeamTally tally = eval::tally(team.beliefs, truth, FusionRule::kNewestWins);
  std::map<std::pair<int32_t, int32_t>, const TopicTally*> tallied;
  for (const TopicTally& t : tally.topics) tallied[{number(t.robot), number(t.topic)}] = &t;
  json line{{"vocabulary", team.descriptors.vocabulary_size},
            {"group_first", team.descriptors.group_first},
            {"topics", json::array()},
            {"left_out", json::array()}};
  const auto classes = [&](const std::pair<int32_t, int32_t>& key) {
    return tallied.contains(key) ? tallied[key]->cells_of_class : std::vector<int64_t>{};
  };
  std::map<std::pair<int32_t, int32_t>, int64_t> cells;
  for (const mapping::LocalBelief& b : team.beliefs)
    for (const mapping::BelievedCell& c : b.cells) ++cells[{number(b.robot), number(c.topic)}];
  for (const auto& [key, v] : vertex) {
    const auto& own = team.descriptors.robots[static_cast<size_t>(key.first)];
    const auto d = std::ranges::find(own, key.second, &matching::Descriptor::slot);
    json words = json::array();
    for (const auto& [word, weight] : d->entries) words.push_back({word, weight});
    line["topics"].push_back({{"robot", key.first},
                              {"topic", key.second},
                              {"cells", cells[key]},
                              {"classes", classes(key)},
                              {"words", words}});
  }
  for (const auto& [key, t] : tallied)
    if (!vertex.contains(key)) line["left_out"].push_back(t->cells_of_class);
  addPlaces(line, team, vertex);
  return line;
}

}  // namespace
}  // namespace shoal::eval

int main(int argc, char** argv) {
  using namespace shoal;
  std::vector<std::string> worlds;
  std::vector<int> teams{12}, parts{100};
  std::string out, cache, made_by = "harvest ", profile = "best";
  int observations = 60, seeds = 1, first_seed = 1;
  double exposure = 0, color_cast = 0;
  CLI::App app("Harvests topics of missions");
  app.add_option("--world", worlds)->required();
  app.add_option("--robots", teams);
  app.add_option("--observations", observations, "of a team of 12; other teams share the same number");
  app.add_option("--parts", parts, "stages of the mission, per cent");
  app.add_option("--seeds", seeds);
  app.add_option("--first-seed", first_seed);
  app.add_option("--profile", profile);
  app.add_option("--exposure", exposure);
  app.add_option("--color-cast", color_cast);
  app.add_option("--cache", cache);
  app.add_option("--made-by", made_by);
  app.add_option("--out", out)->required();
  CLI11_PARSE(app, argc, argv);
  std::ofstream file(out, std::ios::app);
  for (const std::string& world : worlds) {
    const auto place = world::openPlace(world, 1);
    for (const int robots : teams) {
      world::SurveyOptions survey;
      survey.num_robots = robots;
      survey.observations = std::max(1, observations * 12 / robots);
      if (world.find("uav_") != std::string::npos) survey.observations = observations;
      survey.sensors.exposure = exposure;
      survey.sensors.color_cast = color_cast;
      const eval::TeamWords words = eval::lookAround(
          *place, 1, survey, profile, {.folder = cache, .made_by = made_by + world, .images = nullptr});
      size_t images = 0;
      for (const auto& robot : words.robots) images = std::max(images, robot.size());
      std::vector<int32_t> checkpoints;
      for (const int part : parts) checkpoints.push_back(static_cast<int32_t>(images) * part / 100);
      for (int seed = first_seed; seed < first_seed + seeds; ++seed) {
        std::vector<std::vector<mapping::LocalBelief>> stages(parts.size());
        for (size_t r = 0; r < words.robots.size(); ++r) {
          auto beliefs = eval::learn(
              words.robots[r], world::RobotId{static_cast<int32_t>(r)}, words.cell_size_m,
              {.profile = profile, .seed = static_cast<uint64_t>(seed), .hyperparameters = {}}, checkpoints);
          for (size_t s = 0; s < parts.size(); ++s) stages[s].push_back(std::move(beliefs[s]));
        }
        for (size_t s = 0; s < parts.size(); ++s) {
          nlohmann::json line = eval::mission(std::move(stages[s]), words.truthOfCell());
          line["world"] = place->name();
          line["robots"] = robots;
          line["seed"] = seed;
          line["part"] = parts[s];
          line["varied"] = exposure > 0 || color_cast > 0;
          file << line.dump() << std::endl;
        }
        std::cerr << world << ' ' << robots << ' ' << seed << '\n';
      }
    }
  }
  return file ? 0 : 1;
}
