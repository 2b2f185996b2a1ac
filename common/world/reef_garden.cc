// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_garden.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shoal/random.h"
#include "shoal/world/noise.h"

namespace shoal::world {
namespace {

constexpr int kSpecimens = 12;  // of one growth, from one habit to the other

size_t greatest(const std::array<float, 4>& kinds) {
  return static_cast<size_t>(std::max_element(kinds.begin(), kinds.end()) - kinds.begin());
}

}  // namespace

ReefGarden::ReefGarden(const ReefStyle& style, const ReefFields& fields) {
  plant(style, fields);
  sortIntoBins();
}

int ReefGarden::binOf(float p) {
  return static_cast<int>(std::clamp(p, 0.0f, ReefFields::kSide - 1.0f) / kBinSide);
}

void ReefGarden::plant(const ReefStyle& style, const ReefFields& fields) {
  for (size_t t = 0; t < style.terrains.size(); ++t) {
    for (size_t g = 0; g < style.terrains[t].growths.size(); ++g) {
      const Growth& growth = style.terrains[t].growths[g];
      const size_t first_specimen = specimens_.size();
      for (uint64_t i = 0; i < kSpecimens; ++i) {
        specimens_.push_back(grow(growth.form, Random(fields.key(), 1000 + t, g, i)));
      }
      Random random(fields.key(), t, g);
      const auto between = [&](float low, float high) {
        return low + (high - low) * static_cast<float>(random.uniform());
      };
      // Radii are the smaller of two draws: many small, few large; E[r^2] of that law.
      const float low = growth.min_radius_m, spread = growth.max_radius_m - growth.min_radius_m;
      const float mean_square = low * low + 2.0f / 3.0f * low * spread + spread * spread / 6.0f;
      // Colonies fall anywhere; what is of another terrain or on other ground is left out.
      const float covered = growth.share * ReefFields::kSide * ReefFields::kSide;
      const int colonies = static_cast<int>(
          covered / (std::numbers::pi_v<float> * mean_square * static_cast<float>(growth.colony)));
      const float width = 0.9f * std::sqrt(mean_square * static_cast<float>(growth.colony));
      for (int i = 0; i < colonies; ++i) {
        const float colony_x = between(0.0f, ReefFields::kSide), colony_y = between(0.0f, ReefFields::kSide);
        const bool belongs = fields.terrain(colony_x, colony_y)[t] > 0.5f;
        const float habit = fields.habit(growth.label, colony_x, colony_y);
        for (int member = 0; member < growth.colony; ++member) {
          const float radius = std::min(between(growth.min_radius_m, growth.max_radius_m),
                                        between(growth.min_radius_m, growth.max_radius_m));
          const float x = colony_x + width * (between(-1, 1) + between(-1, 1));
          const float y = colony_y + width * (between(-1, 1) + between(-1, 1));
          const float turns = between(0, 1), own_mix = between(-0.5f, 0.5f),
                      own_shape = between(-0.25f, 0.25f);
          const float inside = 1.3f * radius;  // nothing hangs over the border
          if (!belongs || std::min(x, y) < inside || std::max(x, y) > ReefFields::kSide - inside) continue;
          if (growth.ground != Growth::kAnyGround &&
              greatest(fields.ground(x, y).kinds) != static_cast<size_t>(growth.ground))
            continue;
          // Seagrass leans with the current, everywhere the same way.
          const float turned = growth.form == Form::kBlades ? 0.1f * habit : turns;
          const float shape = std::clamp(0.5f + 0.5f * habit + own_shape, 0.0f, 0.999f);
          things_.push_back({x, -y, fields.relief(x, y).height, cosineOfTurns(turned),
                             cosineOfTurns(turned - 0.25f), radius, 0.7f * habit + own_mix,
                             static_cast<uint16_t>(first_specimen + static_cast<size_t>(shape * kSpecimens)),
                             growth.label});
        }
      }
    }
  }
}

void ReefGarden::sortIntoBins() {
  const auto bin = [](const Thing& thing) { return binOf(-thing.y) * kBins + binOf(thing.x); };
  std::stable_sort(things_.begin(), things_.end(),
                   [&](const Thing& a, const Thing& b) { return bin(a) < bin(b); });
  first_in_bin_.reserve(kBins * kBins + 1);
  size_t next = 0;
  for (int b = 0; b <= kBins * kBins; ++b) {
    while (next < things_.size() && bin(things_[next]) < b) ++next;
    first_in_bin_.push_back(static_cast<int32_t>(next));
  }
}

Ellipsoid ReefGarden::placed(const Ellipsoid& solid, const Thing& thing) {
  Eigen::Matrix3f turn;
  turn << thing.cosine, -thing.sine, 0, thing.sine, thing.cosine, 0, 0, 0, 1;
  turn *= thing.radius;
  return {turn * solid.center + Eigen::Vector3f(thing.x, thing.y, thing.z), turn * solid.axes};
}

}  // namespace shoal::world
