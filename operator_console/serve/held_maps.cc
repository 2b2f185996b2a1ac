// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/serve/held_maps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "operator_console/holding.h"
#include "operator_console/label_pictures.h"
#include "shoal/mapping/questions.h"
#include "shoal/mapping/told_surprises.h"

namespace shoal::console {
namespace {

constexpr size_t kMostKept = 4;
constexpr size_t kMostPictures = 64;  // of a label
constexpr auto kCounts = std::chrono::seconds(5);

}  // namespace

HeldMaps::Held HeldMaps::of(const std::string& node, std::optional<double> at_s) {
  const std::lock_guard lock(mutex_);
  const auto latest = feed_.now();
  const uint64_t sequence = latest ? latest->sequence : 0;
  const auto now = std::chrono::steady_clock::now();
  std::erase_if(kept_, [&](const Kept& k) {  // a finished mission changes only when something is decided
    return where_.node.empty() ? k.sequence != sequence : !k.at_s && now - k.made > kCounts;
  });
  const auto known =
      std::ranges::find_if(kept_, [&](const Kept& k) { return k.node == node && k.at_s == at_s; });
  if (known != kept_.end()) return known->held;
  Held held = make(node, at_s);
  kept_.push_front({node, at_s, sequence, std::chrono::steady_clock::now(), held});
  if (kept_.size() > kMostKept) kept_.pop_back();
  return held;
}

HeldMaps::Held HeldMaps::make(const std::string& node, std::optional<double> at_s) const {
  std::optional<world::Timestamp> until;
  if (at_s) {
    if (!(std::abs(*at_s) <= 4e12)) throw std::invalid_argument("\"at\" is no mission time");
    until = world::Timestamp{std::llround(*at_s * 1e6)};
  }
  Holding holding = holdingOf(recordingOf(where_), where_.key, matcherOf(where_), node, until);
  const mapping::MissionView view = holding.state.view();
  mapping::ToldSurprises surprises;
  surprises.update(holding.state.beliefs());
  auto moment = std::make_shared<Moment>();
  const auto latest = feed_.now();
  moment->sequence = moment->chain = latest ? latest->sequence : 1;
  moment->time_s = holding.at_s;
  moment->cell_size_m = view.cell_size_m;
  moment->base_s = latest ? latest->base_s : 0;
  moment->tiles = tilesOf(view.map, surprises.of(view.map.cells), moment->base_s, moment->sequence, {});
  moment->status = mapping::statusAnswer(view);
  moment->labels = colored(mapping::labelsAnswer(view));
  mapping::addLibraryNames(moment->labels["labels"], view.map, holding.state.beliefs());
  moment->pictures = std::make_shared<const mapping::LabelPictures>(
      mapping::picturesOfLabels(view.map, holding.state.beliefs(), kMostPictures));
  moment->pictures_sequence = moment->sequence;
  return {std::move(moment), holding.json()};
}

}  // namespace shoal::console
