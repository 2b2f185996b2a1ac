// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_forms.h"

#include <algorithm>
#include <cmath>

#include "shoal/demand.h"
#include "shoal/world/noise.h"

namespace shoal::world {
namespace {

using Eigen::Vector3f;

class Dice {
 public:
  explicit Dice(Random random) : random_(random) {}
  float between(float low, float high) { return low + (high - low) * static_cast<float>(random_.uniform()); }
  int count(int low, int high) {
    return low + static_cast<int>(random_.below(static_cast<uint64_t>(high - low + 1)));
  }

 private:
  Random random_;
};

Vector3f heading(float turns, float up) {
  const float level = std::sqrt(std::max(0.0f, 1.0f - up * up));
  return {level * cosineOfTurns(turns), level * cosineOfTurns(turns - 0.25f), up};
}

/// An ellipsoid whose third half axis lies along `up`, the others turned about it by `turns`.
Ellipsoid solid(const Vector3f& center, const Vector3f& up, float turns, const Vector3f& lengths) {
  const Vector3f w = up.normalized();
  const Vector3f aside = std::abs(w.z()) < 0.9f ? Vector3f::UnitZ().cross(w) : Vector3f::UnitX().cross(w);
  const Vector3f u0 = aside.normalized(), v0 = w.cross(u0);
  const float cosine = cosineOfTurns(turns), sine = cosineOfTurns(turns - 0.25f);
  Vector3f u = cosine * u0 + sine * v0;
  u.normalize();
  Ellipsoid result;
  result.center = center;
  result.axes << lengths.x() * u, lengths.y() * w.cross(u), lengths.z() * w;
  return result;
}

std::vector<Part> boulder(Dice& dice) {
  std::vector<Part> parts;
  const auto lump = [&](const Vector3f& center, const Vector3f& up, float size) {
    const Vector3f lengths(size, size * dice.between(0.6f, 0.95f), size * dice.between(0.4f, 0.75f));
    parts.push_back({solid(center, up, dice.between(0, 1), lengths), dice.between(0.85f, 1.1f)});
  };
  const float width = dice.between(0.7f, 0.85f), height = dice.between(0.35f, 0.6f);
  lump({0, 0, 0.1f}, heading(dice.between(0, 1), dice.between(0.85f, 1.0f)), width);
  for (int i = dice.count(9, 15); i > 0; --i) {  // corners and edges that stand out of it
    const Vector3f out = heading(dice.between(0, 1), dice.between(0.0f, 0.9f));
    const Vector3f place(0.72f * width * out.x(), 0.72f * width * out.y(), 0.05f + 0.8f * height * out.z());
    const Vector3f up = (out + 0.8f * heading(dice.between(0, 1), dice.between(-0.3f, 0.8f))).normalized();
    lump(place, up, dice.between(0.18f, 0.42f));
  }
  for (int i = dice.count(1, 4); i > 0; --i) {  // what has fallen off
    const Vector3f out = dice.between(0.8f, 1.05f) * heading(dice.between(0, 1), 0);
    lump({out.x(), out.y(), 0.02f}, heading(dice.between(0, 1), 0.8f), dice.between(0.08f, 0.2f));
  }
  return parts;
}

std::vector<Part> stones(Dice& dice) {
  std::vector<Part> parts;
  for (int i = dice.count(7, 13); i > 0; --i) {
    const float size = dice.between(0.07f, 0.14f) + 0.16f * dice.between(0, 1) * dice.between(0, 1);
    const Vector3f place = std::sqrt(dice.between(0, 1)) * heading(dice.between(0, 1), 0);
    const Vector3f lengths(size, size * dice.between(0.4f, 0.9f), size * dice.between(0.3f, 0.6f));
    parts.push_back({solid({place.x(), place.y(), 0.25f * size},
                           heading(dice.between(0, 1), dice.between(0.7f, 1)), dice.between(0, 1), lengths),
                     dice.between(0.9f, 1.4f)});
  }
  return parts;
}

std::vector<Part> dome(Dice& dice) {
  std::vector<Part> parts;
  const float width = dice.between(0.75f, 0.95f), height = dice.between(0.5f, 0.85f);
  const float knobbly = dice.between(0.0f, 1.0f);  // from smooth domes to heaps of knobs
  parts.push_back({solid({0, 0, 0.02f}, heading(dice.between(0, 1), 0.97f), dice.between(0, 1),
                         {width, width * dice.between(0.75f, 1.0f), height}),
                   0.94f});
  for (int i = dice.count(14, 26); i > 0; --i) {
    const Vector3f out = heading(dice.between(0, 1), dice.between(0.05f, 0.98f));
    const float size = dice.between(0.16f, 0.42f - 0.16f * knobbly);
    const float far = 0.8f + 0.14f * knobbly;
    const Vector3f place(out.x() * width * far, out.y() * width * far * 0.9f, out.z() * height * far);
    parts.push_back(
        {solid(place, out, dice.between(0, 1), {size, size * dice.between(0.7f, 1.0f), size * 0.6f}),
         dice.between(0.86f, 1.1f)});
  }
  return parts;
}

/// A flat branch from `from` along `way`, and the two or three into which it forks.
void branch(Dice& dice, std::vector<Part>& parts, const Vector3f& from, const Vector3f& way, float length,
            float width, int forks) {
  const Vector3f to = from + length * way;
  parts.push_back(
      {solid(0.5f * (from + to), way, dice.between(-0.06f, 0.06f), {width, 0.55f * width, 0.58f * length}),
       std::min(1.15f, 0.62f + 0.5f * to.z() + 0.25f * to.head<2>().norm())});
  if (forks == 0) return;
  for (int i = dice.count(2, 3); i > 0; --i) {
    Vector3f onwards =
        way + 0.75f * heading(dice.between(0, 1), 0) + Vector3f(0, 0, dice.between(-0.15f, 0.35f));
    onwards.normalize();
    onwards.z() = std::max(onwards.z(), 0.02f);
    branch(dice, parts, to - 0.05f * way, onwards, length * dice.between(0.65f, 0.9f), 0.82f * width,
           forks - 1);
  }
}

std::vector<Part> antlers(Dice& dice) {
  std::vector<Part> parts;
  const int stems = dice.count(6, 9);
  const float start = dice.between(0, 1);
  for (int i = 0; i < stems; ++i) {
    const float turns =
        start + (static_cast<float>(i) + dice.between(-0.3f, 0.3f)) / static_cast<float>(stems);
    branch(dice, parts, {0, 0, 0.05f}, heading(turns, dice.between(0.25f, 0.75f)), dice.between(0.36f, 0.46f),
           dice.between(0.10f, 0.13f), 2);
  }
  return parts;
}

std::vector<Part> tables(Dice& dice) {
  std::vector<Part> parts;
  const int tiers = dice.count(1, 4);
  for (int i = 0; i < tiers; ++i) {
    const float part = static_cast<float>(i) / static_cast<float>(tiers);
    const float size = dice.between(0.5f, 0.95f) * (1.0f - 0.45f * part);
    const Vector3f aside = (i == 0 ? 0.05f : dice.between(0.2f, 0.55f)) * heading(dice.between(0, 1), 0);
    const Vector3f top(aside.x(), aside.y(), dice.between(0.28f, 0.4f) + 0.22f * static_cast<float>(i));
    const Vector3f up = heading(dice.between(0, 1), dice.between(0.93f, 1.0f));
    parts.push_back(
        {solid(top, up, dice.between(0, 1), {size, size * dice.between(0.75f, 1.0f), 0.045f}), 1.0f});
    // The middle lies a little lower and is darker; a stalk holds it.
    parts.push_back({solid(top + 0.02f * up, up, 0, {0.45f * size, 0.4f * size, 0.045f}), 0.86f});
    parts.push_back({solid(0.5f * top, top, 0, {0.13f, 0.13f, 0.5f * top.norm()}), 0.5f});
  }
  return parts;
}

std::vector<Part> barrels(Dice& dice) {
  std::vector<Part> parts;
  const int barrels = dice.count(1, 4);
  for (int i = 0; i < barrels; ++i) {
    const float width = i == 0 ? dice.between(0.42f, 0.6f) : dice.between(0.22f, 0.38f);
    const float height = width * dice.between(0.9f, 1.5f);
    const Vector3f up = heading(dice.between(0, 1), dice.between(0.9f, 1.0f));
    const Vector3f foot = (i == 0 ? 0.0f : dice.between(0.45f, 0.7f)) * heading(dice.between(0, 1), 0);
    const Vector3f middle = foot + 0.55f * height * up;
    parts.push_back({solid(middle, up, 0, {width, width * dice.between(0.85f, 1.0f), height}), 1.0f});
    // The mouth: a pale rim, and dark within.
    const Vector3f lip = middle + 0.9f * height * up;
    parts.push_back({solid(lip, up, 0, {0.52f * width, 0.52f * width, 0.16f * height}), 1.18f});
    parts.push_back(
        {solid(lip + 0.12f * height * up, up, 0, {0.34f * width, 0.34f * width, 0.08f * height}), 0.22f});
  }
  return parts;
}

std::vector<Part> tuft(Dice& dice) {
  std::vector<Part> parts;
  for (int i = dice.count(14, 24); i > 0; --i) {
    const Vector3f place = 0.85f * std::sqrt(dice.between(0, 1)) * heading(dice.between(0, 1), 0);
    const Vector3f up = (heading(dice.between(0, 1), 0.7f) + 0.5f * place).normalized();
    const float size = dice.between(0.14f, 0.3f);
    const float high = 0.35f * (1.0f - 0.7f * place.squaredNorm());
    parts.push_back({solid({place.x(), place.y(), high}, up, dice.between(0, 1),
                           {size, size * dice.between(0.4f, 0.7f), size * dice.between(0.5f, 0.9f)}),
                     0.7f + 0.9f * high + dice.between(-0.12f, 0.12f)});
  }
  return parts;
}

std::vector<Part> blades(Dice& dice) {
  std::vector<Part> parts;
  for (int i = dice.count(16, 26); i > 0; --i) {
    const Vector3f place = 0.9f * std::sqrt(dice.between(0, 1)) * heading(dice.between(0, 1), 0);
    const Vector3f up = heading(0.08f + dice.between(-0.07f, 0.07f), dice.between(0.25f, 0.7f));
    const float length = dice.between(0.18f, 0.4f);
    parts.push_back({solid(place + length * up, up, dice.between(0, 1), {0.055f, 0.028f, length}),
                     dice.between(0.9f, 1.45f)});
  }
  return parts;
}

}  // namespace

std::vector<Part> grow(Form form, Random random) {
  Dice dice(random);
  switch (form) {
    case Form::kBoulder:
      return boulder(dice);
    case Form::kStones:
      return stones(dice);
    case Form::kDome:
      return dome(dice);
    case Form::kAntlers:
      return antlers(dice);
    case Form::kTables:
      return tables(dice);
    case Form::kBarrels:
      return barrels(dice);
    case Form::kTuft:
      return tuft(dice);
    case Form::kBlades:
      return blades(dice);
  }
  SHOAL_DEMAND(false && "every form grows");
}

}  // namespace shoal::world
