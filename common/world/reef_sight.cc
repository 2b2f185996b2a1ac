// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_sight.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace shoal::world {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

const Vector3f kToSun = Vector3f(-0.42f, -0.38f, 0.82f).normalized();  // refracted: within 48 degrees of up
constexpr float kSky = 0.46f, kSun = 0.70f;  // light from all sides and from the sun, on level ground
constexpr double kSharp = 60.0;              // metres from the eye beyond which water hides what is small

/// The part of the ground on which things that a view may see stand: where its outermost rays pass through
/// the layer that the reef fills.
Extent areaSeen(const View& view) {
  const Eigen::Matrix3d world_from_view = view.view_from_world.transpose();
  Extent area{1e9, 1e9, -1e9, -1e9};
  for (const double u : {-0.5, view.width - 0.5}) {
    for (const double v : {-0.5, view.height - 0.5}) {
      const Vector3d ray = world_from_view * Vector3d((u - view.cx) / view.fx, (v - view.cy) / view.fy, 1.0);
      for (const float z : {ReefScene::kLowest, ReefScene::kHighest}) {
        const double steps = ray.z() < -1e-3 ? std::max(0.0, (z - view.eye.z()) / ray.z()) : 1e3;
        const Vector3d p = view.eye + steps * ray;
        area = {std::min(area.min_x, p.x()), std::min(area.min_y, p.y()), std::max(area.max_x, p.x()),
                std::max(area.max_y, p.y())};
      }
    }
  }
  return area;
}

Extent grown(const Extent& area, double by) {
  return {area.min_x - by, area.min_y - by, area.max_x + by, area.max_y + by};
}

Extent around(const Vector3d& p, double reach) {
  return {p.x() - reach, p.y() - reach, p.x() + reach, p.y() + reach};
}

Extent common(const Extent& a, const Extent& b) {
  return {std::max(a.min_x, b.min_x), std::max(a.min_y, b.min_y), std::min(a.max_x, b.max_x),
          std::min(a.max_y, b.max_y)};
}

bool isEmpty(const Extent& area) { return !(area.min_x < area.max_x && area.min_y < area.max_y); }

/// Parallel rays of the sun over an area of the seabed.
View sunOver(const Extent& area) {
  constexpr double kPixelsPerMetre = 20.0, kMost = 60.0;  // metres a side
  View view;
  view.parallel = true;
  const Vector3d forward = -kToSun.cast<double>();
  const Vector3d right = Vector3d(0, 1, 0).cross(forward).normalized(), down = forward.cross(right);
  view.view_from_world << right.transpose(), down.transpose(), forward.transpose();
  const double width = isEmpty(area) ? 0.0 : std::min(kMost, area.max_x - area.min_x),
               height = isEmpty(area) ? 0.0 : std::min(kMost, area.max_y - area.min_y);
  const double margin = 3.0;  // a shadow is no further from its thing, aslant
  view.eye = {0.5 * (area.min_x + area.max_x), 0.5 * (area.min_y + area.max_y), 0.0};
  view.eye -= 20.0 * forward;
  view.width = 1 + static_cast<int>((width + 2 * margin) * kPixelsPerMetre);
  view.height = 1 + static_cast<int>((height + 2 * margin) * kPixelsPerMetre);
  view.fx = view.fy = kPixelsPerMetre;
  view.cx = 0.5 * (view.width - 1);
  view.cy = 0.5 * (view.height - 1);
  return view;
}

}  // namespace

ReefSight::ReefSight(const ReefScene& scene, const View& view)
    : scene_(scene), raster_(view), shadows_(View{}) {
  const Extent reef{0.0, -ReefScene::kSide, ReefScene::kSide, 0.0};
  const Extent seen = areaSeen(view);
  const Extent sharp = common(seen, around(view.eye, kSharp));
  const Extent with_things = common(grown(sharp, ReefGarden::kReach), reef);
  const Extent ground = common(seen, reef);
  if (!isEmpty(with_things)) gather(with_things);
  if (!isEmpty(ground)) drawGround(ground);
  for (size_t i = 0; i < pieces_.size(); ++i) raster_.draw(pieces_[i].solid, static_cast<int32_t>(i));
  drawShadows(common(sharp, reef));
}

void ReefSight::gather(const Extent& area) {
  const ReefGarden& garden = scene_.garden();
  const int first_x = ReefGarden::binOf(static_cast<float>(area.min_x)),
            last_x = ReefGarden::binOf(static_cast<float>(area.max_x)),
            first_y = ReefGarden::binOf(static_cast<float>(-area.max_y)),
            last_y = ReefGarden::binOf(static_cast<float>(-area.min_y));
  for (int y = first_y; y <= last_y; ++y) {
    for (const ReefGarden::Thing& thing : garden.strip(first_x, last_x, y)) {
      for (const Part& part : garden.parts(thing)) {
        Piece piece{ReefGarden::placed(part.solid, thing), {}, &thing, part.brightness};
        const Eigen::Matrix3f& axes = piece.solid.axes;
        const Vector3f inverse_squares = axes.colwise().squaredNorm().cwiseInverse().transpose();
        piece.normal_from_offset = axes * inverse_squares.cwiseAbs2().asDiagonal() * axes.transpose();
        pieces_.push_back(piece);
      }
    }
  }
}

void ReefSight::drawGround(const Extent& area) {
  const ReefFields& fields = scene_.fields();
  const int squares = fields.meshNodes() - 1;
  const auto square = [&](double p) {
    return std::clamp(static_cast<int>(p / ReefFields::kHeightSpacing), 0, squares - 1);
  };
  const int first_x = square(area.min_x), last_x = square(area.max_x), first_y = square(-area.max_y),
            last_y = square(-area.min_y);
  const View& view = raster_.view();
  std::vector<Vector3d> row, next;  // nodes in the frame of the view
  const auto nodes = [&](int y, std::vector<Vector3d>& into) {
    into.clear();
    for (int x = first_x; x <= last_x + 1; ++x) {
      constexpr double kSpacing = ReefFields::kHeightSpacing;
      into.push_back(view.fromWorld({x * kSpacing, -y * kSpacing, fields.meshHeight(x, y)}));
    }
  };
  nodes(first_y, row);
  for (int y = first_y; y <= last_y; ++y) {
    nodes(y + 1, next);
    for (size_t x = 0; x + 1 < row.size(); ++x) {
      raster_.drawTriangle(row[x], next[x], row[x + 1], -1);
      raster_.drawTriangle(next[x + 1], row[x + 1], next[x], -1);
    }
    std::swap(row, next);
  }
}

void ReefSight::drawShadows(const Extent& area) {
  shadows_ = Raster(sunOver(area));
  const View& view = shadows_.view();
  for (size_t i = 0; i < pieces_.size(); ++i) shadows_.draw(pieces_[i].solid, static_cast<int32_t>(i));
  Eigen::Matrix3d scaled = view.view_from_world;
  scaled.topRows<2>() *= view.fx;
  shadow_pixel_from_world_.leftCols<3>() = scaled.cast<float>();
  shadow_pixel_from_world_.col(3) = (Vector3d(view.cx, view.cy, 0.0) - scaled * view.eye).cast<float>();
}

float ReefSight::sunlit(const Vector3f& p) const {
  constexpr float kBias = 0.08f;  // metres: a surface does not shade itself
  const auto& m = shadow_pixel_from_world_;
  const auto along = [&](int i) { return m(i, 0) * p.x() + m(i, 1) * p.y() + m(i, 2) * p.z() + m(i, 3); };
  const float x = along(0), y = along(1), depth = along(2) - kBias;
  const View& view = shadows_.view();
  if (!(x >= 0.0f && y >= 0.0f && x < static_cast<float>(view.width - 1) &&
        y < static_cast<float>(view.height - 1)))
    return 1.0f;
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
  const float* top = shadows_.depths(row) + column;
  const float* bottom = shadows_.depths(row + 1) + column;
  const auto open = [&](float occluder) { return occluder < depth ? 0.0f : 1.0f; };
  return (1.0f - fy) * ((1.0f - fx) * open(top[0]) + fx * open(top[1])) +
         fy * ((1.0f - fx) * open(bottom[0]) + fx * open(bottom[1]));
}

Color ReefSight::lit(const Surface& surface, const ReefFields::Ground& ground, const Vector3f& p,
                     const std::array<float, 2>& waves) const {
  const float scale = 1.0f / std::sqrt(surface.normal.squaredNorm());
  const float facing = scale * surface.normal.dot(kToSun);
  float sun = 0.0f;
  if (facing > 0.0f) {
    sun = sunlit(p) * ground.sun;
    if (sun > 0.0f) {
      // The net of light falls along the sun's rays; on tops it is further up them.
      const float along = p.z() / kToSun.z();
      const float net = scene_.caustics()
                            .at(p.x() - along * kToSun.x() + waves[0], -p.y() + along * kToSun.y() + waves[1])
                            .brightness;
      sun *= facing * (kSun / kToSun.z()) * (1.0f + 0.5f * net);
    }
  }
  const float sky = kSky * (0.65f + 0.35f * scale * surface.normal.z());
  // What the sun does not reach is lit by the water above: bluer.
  return {surface.color[0] * ground.tint[0] * (0.94f * sky + sun),
          surface.color[1] * ground.tint[1] * (sky + sun),
          surface.color[2] * ground.tint[2] * (1.08f * sky + 0.96f * sun)};
}

namespace {

Color colorOf(const ReefClass& c, float mix, const TextureTile::Sample& surface) {
  const float second = std::clamp(0.5f + 0.5f * mix + 0.35f * surface.mix, 0.0f, 1.0f);
  const float brightness = 1.0f + c.contrast * surface.brightness;
  Color color;
  for (size_t i = 0; i < 3; ++i) color[i] = brightness * (c.first[i] + (c.second[i] - c.first[i]) * second);
  return color;
}

}  // namespace

ReefPoint ReefSight::onGround(const Vector3f& p, const std::array<float, 2>& waves) const {
  const float x = p.x(), south = -p.y();
  const ReefStyle& style = scene_.style();
  const ReefFields::Ground ground = scene_.fields().ground(x, south);
  const ReefFields::Relief relief = scene_.fields().relief(x, south);
  std::array<float, 4> kinds = ground.kinds;
  const TextureTile::Sample edge = scene_.edges().at(x, south);
  kinds[1] += 0.30f * edge.brightness;
  kinds[2] += 0.36f * edge.mix;
  const float steep = std::sqrt(relief.rise_x * relief.rise_x + relief.rise_y * relief.rise_y);
  kinds[3] += 1.2f * std::max(0.0f, steep - 0.3f) - 0.26f * edge.brightness;

  size_t best = 0, second = 1;
  if (kinds[1] > kinds[0]) std::swap(best, second);
  for (size_t k = 2; k < 4; ++k) {
    if (kinds[k] > kinds[best]) {
      second = std::exchange(best, k);
    } else if (kinds[k] > kinds[second]) {
      second = k;
    }
  }
  const uint8_t label = style.ground[best];
  const ReefClass& c = style.classes[label];
  const TextureTile::Sample texture = scene_.texture(label).at(x, south);
  Surface surface{colorOf(c, ground.mix, texture), {}};
  float bump_x = c.bump * texture.rise_x, bump_y = c.bump * texture.rise_y;
  // Near a border the other ground shows through.
  constexpr float kBlend = 0.06f;
  if (const float ahead = kinds[best] - kinds[second]; ahead < kBlend) {
    const uint8_t other = style.ground[second];
    const TextureTile::Sample below = scene_.texture(other).at(x, south);
    const Color color = colorOf(style.classes[other], ground.mix, below);
    const float part = 0.5f * (1.0f - ahead / kBlend);
    for (size_t i = 0; i < 3; ++i) surface.color[i] += part * (color[i] - surface.color[i]);
    bump_x += part * (style.classes[other].bump * below.rise_x - bump_x);
    bump_y += part * (style.classes[other].bump * below.rise_y - bump_y);
  }
  // Slopes are towards the south in y; the normal is of the world.
  surface.normal = Vector3f(-(relief.rise_x + bump_x), relief.rise_y + bump_y, 1.0f);
  return {label, lit(surface, ground, p, waves)};
}

ReefPoint ReefSight::onPiece(const Piece& piece, const Vector3f& p, const std::array<float, 2>& waves) const {
  const ReefGarden::Thing& thing = *piece.thing;
  const ReefClass& c = scene_.style().classes[thing.label];
  // The texture runs down the sides as well.
  const TextureTile::Sample texture =
      scene_.texture(thing.label).at(p.x() + 0.8f * p.z() + 8.0f, -p.y() + 0.6f * p.z() + 8.0f);
  Surface surface{colorOf(c, thing.mix, texture), piece.normal_from_offset * (p - piece.solid.center)};
  const float length = std::sqrt(surface.normal.squaredNorm());
  surface.normal += length * c.bump * Vector3f(-texture.rise_x, texture.rise_y, 0.0f);
  // Less light gets down to where things stand.
  const float deep = std::clamp(0.66f + 1.1f * (p.z() - thing.z), 0.6f, 1.0f);
  for (float& channel : surface.color) channel *= piece.brightness * deep;
  return {thing.label, lit(surface, scene_.fields().ground(p.x(), -p.y()), p, waves)};
}

ReefPoint ReefSight::at(int row, int column, const Vector3f& p, const std::array<float, 2>& waves) const {
  const int32_t id = raster_.ids(row)[column];
  return id < 0 ? onGround(p, waves) : onPiece(pieces_[static_cast<size_t>(id)], p, waves);
}

}  // namespace shoal::world
