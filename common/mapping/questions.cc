// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/questions.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "shoal/mapping/area_answer.h"
#include "shoal/mapping/edits_answer.h"
#include "shoal/mapping/held_pictures.h"
#include "shoal/mapping/library.h"
#include "shoal/mapping/map_files.h"
#include "shoal/mapping/node_answer.h"
#include "shoal/mapping/surprises.h"
#include "shoal/mapping/why_answer.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;

// As far as mission times go, whatever a stranger asks.
constexpr double kFarthestS = 4e12;
constexpr int64_t kMostPictures = 1000;  // of a label

PatchFilter filterOf(const Json& question) {
  PatchFilter filter;
  filter.min_m2 = question.value("min_m2", 0.0);
  filter.certainty = question.value("certainty", 0.0);
  if (question.contains("since_s")) {
    const double since_s = question.at("since_s");
    if (!(std::abs(since_s) <= kFarthestS)) throw std::invalid_argument("since_s is no mission time");
    filter.since = world::Timestamp{std::llround(since_s * 1e6)};
  }
  return filter;
}

Json picturesOf(const Witness& witness, const Json& question) {
  const int64_t most = question.value("most", int64_t{4});
  if (most < 1 || most > kMostPictures)
    throw std::invalid_argument("most lies in [1, " + std::to_string(kMostPictures) + "]");
  const BeliefStore& beliefs = witness.beliefs();  // first: of a finished run, it completes the map
  return picturesAnswer(picturesOfLabels(witness.view.map, beliefs, static_cast<size_t>(most)));
}

Json labelsOf(const Witness& witness) {
  const GlobalMap& map = witness.view.map;
  Json answer = labelsAnswer(witness.view);
  if (std::ranges::find(map.correspondences, kLibrary, &Correspondence::robot) != map.correspondences.end())
    addLibraryNames(answer["labels"], map, witness.beliefs());
  return answer;
}

Json mapAnswer(const MissionView& view) {
  const world::Grid grid(view.cell_size_m);
  return {{"cell_size_m", view.cell_size_m},
          {"global_map_csv", globalMapCsv(view.map, grid)},
          {"labels_csv", labelsCsv(view.map, grid)}};
}

}  // namespace

void addLibraryNames(Json& rows, const GlobalMap& map, const BeliefStore& beliefs) {
  if (beliefs.epochOf(kLibrary) < 0) return;
  const auto names = libraryNames(map, beliefs);
  for (Json& row : rows) {
    const auto known = names.find(world::GlobalLabel{row["label"].get<int32_t>()});
    row["library"] = known == names.end() ? std::vector<std::string>{} : known->second;
  }
}

Json answer(const Witness& witness, const Json& question) {
  const MissionView& view = witness.view;
  try {
    const std::string query = question.value("query", "");
    if (query == "status") return statusAnswer(view);
    if (query == "labels") return labelsOf(witness);
    if (query == "library") {
      const BeliefStore& beliefs = witness.beliefs();  // first: of a finished run, it completes the map
      return {{"library", libraryJson(libraryOf(view.map, beliefs))}};
    }
    if (query == "map") return mapAnswer(view);
    if (query == "pictures") return picturesOf(witness, question);
    if (query == "at") return atAnswer(view, witness.beliefs(), question.at("x"), question.at("y"));
    if (query == "area") return areaAnswer(view, question.at("label"), filterOf(question));
    if (query == "why") return whyAnswer(view, witness.beliefs(), witness.matcher, question.at("label"));
    if (query == "node") return nodeAnswer(view, witness.beliefs(), question.at("node"));
    if (query == "surprises") {
      const BeliefStore& beliefs = witness.beliefs();  // first: of a finished run, it completes the map
      Json told = surprisesAnswer(view, beliefs, question.value("least", 0.0));
      if (question.value("csv", false))
        told["surprise_csv"] = surprisesCsv(surprisesOf(view.map, beliefs), world::Grid(view.cell_size_m));
      return told;
    }
    if (query == "edits") return editsAnswer(witness.beliefs());
    if (query == "events") {
      const auto seen = witness.events ? witness.events() : std::vector<MissionEvent>{};
      return eventsAnswer(view, witness.beliefs(), seen);
    }
    return {{"error",
             "unknown question; questions are status, labels, map, pictures, library, at, area, why, node, "
             "surprises, edits and events"}};
  } catch (const Json::exception& error) {
    return {{"error", error.what()}};
  } catch (const std::invalid_argument& error) {
    return {{"error", error.what()}};
  }
}

}  // namespace shoal::mapping
