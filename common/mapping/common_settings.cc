// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/common_settings.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace shoal::mapping {
namespace {

const SettingsPart* settingsOf(const BeliefStore& beliefs, world::RobotId robot) {
  const Piece* piece = beliefs.find({robot, PieceKind::kSettings, {}}, 0);
  return piece == nullptr ? nullptr : std::get_if<SettingsPart>(&piece->content);
}

}  // namespace

std::string_view toText(Comparable comparable) {
  switch (comparable) {
    case Comparable::kSame:
      return "same";
    case Comparable::kOtherWords:
      return "other words";
    case Comparable::kOtherHyperparameters:
      return "other hyper-parameters";
    case Comparable::kOtherCells:
      return "other cells";
    case Comparable::kUnknown:
      break;
  }
  return "unknown";
}

std::optional<SettingsPart> commonSettings(const BeliefStore& beliefs,
                                           const std::set<world::RobotId>& excluded) {
  std::vector<std::pair<SettingsPart, int>> said;  // and by how many
  for (const world::RobotId robot : beliefs.robots()) {
    const SettingsPart* settings = settingsOf(beliefs, robot);
    if (settings == nullptr || excluded.contains(robot)) continue;
    const auto known = std::ranges::find(said, *settings, [](const auto& s) { return s.first; });
    if (known == said.end()) {
      said.emplace_back(*settings, 1);
    } else {
      ++known->second;
    }
  }
  const auto most = std::ranges::max_element(said, {}, [](const auto& s) { return s.second; });
  if (most == said.end()) return std::nullopt;
  return most->first;
}

Comparable compare(const BeliefStore& beliefs, world::RobotId robot,
                   const std::optional<SettingsPart>& common) {
  if (!common) return Comparable::kSame;
  const SettingsPart* settings = settingsOf(beliefs, robot);
  if (settings == nullptr) return Comparable::kUnknown;
  if (settings->cell_size_m != common->cell_size_m) return Comparable::kOtherCells;
  if (settings->words != common->words) return Comparable::kOtherWords;
  return settings->hyperparameters == common->hyperparameters ? Comparable::kSame
                                                              : Comparable::kOtherHyperparameters;
}

std::set<world::RobotId> robotsOfOtherCells(const BeliefStore& beliefs,
                                            const std::set<world::RobotId>& excluded) {
  std::set<world::RobotId> robots;
  const auto common = commonSettings(beliefs, excluded);
  for (const world::RobotId robot : beliefs.robots()) {
    if (compare(beliefs, robot, common) == Comparable::kOtherCells) robots.insert(robot);
  }
  return robots;
}

}  // namespace shoal::mapping
