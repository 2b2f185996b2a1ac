// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_raster.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace shoal::world {
namespace {

/// c[0] + c[1] x + c[2] y + c[3] x^2 + c[4] x y + c[5] y^2.
struct Quadratic {
  std::array<double, 6> c{};
};

/// First and last pixel, of those within [0, size), whose centres lie in [low, high].
struct Span {
  int first, last;
  Span(double low, double high, int size)
      : first(static_cast<int>(std::ceil(std::clamp(low, 0.0, static_cast<double>(size))))),
        last(static_cast<int>(std::floor(std::clamp(high, -1.0, static_cast<double>(size - 1))))) {}
};

/// Where c0 + c1 x + c2 x^2 >= 0, c2 < 0: an interval about its top; empty (low > high) when nowhere.
struct Interval {
  double low, high;
};
Interval whereNotNegative(double c0, double c1, double c2) {
  const double discriminant = c1 * c1 - 4.0 * c0 * c2;
  if (!(discriminant >= 0.0)) return {1.0, -1.0};
  const double root = std::sqrt(discriminant);
  return {(-c1 + root) / (2.0 * c2), (-c1 - root) / (2.0 * c2)};
}

}  // namespace

Raster::Raster(const View& view)
    : view_(view),
      depth_(static_cast<size_t>(view.width) * static_cast<size_t>(view.height), kNothing),
      id_(depth_.size(), -1) {}

void Raster::draw(const Ellipsoid& solid, int32_t id) {
  const Eigen::Vector3d center = view_.fromWorld(solid.center.cast<double>());
  const Eigen::Matrix3d axes = view_.view_from_world * solid.axes.cast<double>();
  if (!view_.parallel && !(center.z() - axes.row(2).norm() > kNear)) return;

  // In the space where the solid is the unit ball about 0, a pixel's ray is o + depth d. About the pixel
  // (u0, v0) that sees the middle, d = d0 + x dx + y dy and o = -depth0 d0 through a pinhole; of parallel
  // rays d = d0, o = -depth0 d0 + x dx + y dy. The ray meets the ball where a depth^2 + 2 b depth + c = 0.
  const Eigen::Vector3d inverse_squares = axes.colwise().squaredNorm().cwiseInverse().transpose();
  const Eigen::Matrix3d ball_from_view = inverse_squares.asDiagonal() * axes.transpose();
  const double depth0 = center.z();
  const Eigen::Vector3d d0 = view_.parallel ? Eigen::Vector3d(ball_from_view.col(2))
                                            : Eigen::Vector3d(ball_from_view * center / depth0);
  const Eigen::Vector3d dx = ball_from_view.col(0) / view_.fx, dy = ball_from_view.col(1) / view_.fy;
  const double perspective = view_.parallel ? 1.0 : 1.0 / depth0;
  const double u0 = view_.cx + view_.fx * center.x() * perspective;
  const double v0 = view_.cy + view_.fy * center.y() * perspective;
  const double dd = d0.dot(d0), dx1 = d0.dot(dx), dy1 = d0.dot(dy), xx = dx.dot(dx), xy = dx.dot(dy),
               yy = dy.dot(dy);
  std::array<double, 6> a{dd, 0, 0, 0, 0, 0}, b{-depth0 * dd, 0, 0, 0, 0, 0}, under_root{};  // b^2 - a c
  if (view_.parallel) {
    b[1] = dx1;
    b[2] = dy1;
    under_root = {dd, 0, 0, dx1 * dx1 - dd * xx, 2 * (dx1 * dy1 - dd * xy), dy1 * dy1 - dd * yy};
  } else {
    a = {dd, 2 * dx1, 2 * dy1, xx, 2 * xy, yy};
    b[1] = -depth0 * dx1;
    b[2] = -depth0 * dy1;
    const double far = depth0 * depth0;
    under_root = {dd,
                  2 * dx1,
                  2 * dy1,
                  far * (dx1 * dx1 - xx * dd) + xx,
                  2 * (far * (dx1 * dy1 - xy * dd) + xy),
                  far * (dy1 * dy1 - yy * dd) + yy};
  }
  const auto& [r0, r1, r2, r3, r4, r5] = under_root;

  // Rows in which the ray can meet it: where the quadratic in x has roots.
  const Interval rows =
      whereNotNegative(r1 * r1 - 4 * r0 * r3, 2 * r1 * r4 - 4 * r2 * r3, r4 * r4 - 4 * r3 * r5);
  const Span v(v0 + rows.low, v0 + rows.high, view_.height);
  for (int row = v.first; row <= v.last; ++row) {
    const double y = row - v0;
    const double row_r0 = r0 + y * (r2 + y * r5), row_r1 = r1 + y * r4;
    const Interval columns = whereNotNegative(row_r0, row_r1, r3);
    const Span u(u0 + columns.low, u0 + columns.high, view_.width);
    const float fr0 = static_cast<float>(row_r0), fr1 = static_cast<float>(row_r1),
                fr2 = static_cast<float>(r3);
    const float a0 = static_cast<float>(a[0] + y * (a[2] + y * a[5])),
                a1 = static_cast<float>(a[1] + y * a[4]), a2 = static_cast<float>(a[3]);
    const float b0 = static_cast<float>(b[0] + y * b[2]), b1 = static_cast<float>(b[1]);
    float* depth = depth_.data() + offset(row);
    int32_t* ids = id_.data() + offset(row);
    for (int column = u.first; column <= u.last; ++column) {
      const float x = static_cast<float>(column - u0);
      const float root = std::sqrt(std::max(0.0f, fr0 + x * (fr1 + x * fr2)));
      const float met = (-(b0 + x * b1) - root) / (a0 + x * (a1 + x * a2));
      if (met < depth[column]) {
        depth[column] = met;
        ids[column] = id;
      }
    }
  }
}

void Raster::drawTriangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                          int32_t id) {
  // A pinhole's ray (x, y, 1) passes within a corner's opposite edge where its product with the edge's plane
  // through the eye has the sign of the triangle's volume; the sum of the three over the volume is 1 / depth.
  // Source: M. Olano, T. Greer, "Triangle Scan Conversion using 2D Homogeneous Coordinates", 1997.
  const Eigen::Vector3d planes[3] = {b.cross(c), c.cross(a), a.cross(b)};
  const double volume = a.dot(planes[0]);
  if (!(volume < 0.0)) return;  // from behind, or edge on
  Interval rows{0, view_.height - 1.0};
  if (std::min({a.z(), b.z(), c.z()}) > kNear) {
    const double va = a.y() / a.z(), vb = b.y() / b.z(), vc = c.y() / c.z();
    rows = {view_.cy + view_.fy * std::min({va, vb, vc}) - 1e-6,
            view_.cy + view_.fy * std::max({va, vb, vc}) + 1e-6};
    const double ua = a.x() / a.z(), ub = b.x() / b.z(), uc = c.x() / c.z();
    if (view_.cx + view_.fx * std::max({ua, ub, uc}) < 0.0 ||
        view_.cx + view_.fx * std::min({ua, ub, uc}) > view_.width - 1.0)
      return;
  } else if (std::max({a.z(), b.z(), c.z()}) <= kNear) {
    return;
  }
  std::array<std::array<double, 3>, 3> edges;  // e[0] + u e[1] + v e[2] >= 0 inside
  std::array<double, 3> nearness{};            // 1 / depth, likewise
  for (size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d e = planes[i] / volume;
    edges[i][1] = e.x() / view_.fx;
    edges[i][2] = e.y() / view_.fy;
    edges[i][0] = e.z() - view_.cx * edges[i][1] - view_.cy * edges[i][2];
    for (size_t k = 0; k < 3; ++k) nearness[k] += edges[i][k];
  }
  const Span v(rows.low, rows.high, view_.height);
  for (int row = v.first; row <= v.last; ++row) {
    double low = 0.0, high = view_.width - 1.0;
    for (const auto& e : edges) {
      const double at_0 = e[0] + row * e[2];
      // A shared border belongs to both sides, and rounding leaves no slits.
      if (e[1] > 0.0) {
        low = std::max(low, -at_0 / e[1] - 1e-6);
      } else if (e[1] < 0.0) {
        high = std::min(high, -at_0 / e[1] + 1e-6);
      } else if (at_0 < -1e-9) {
        low = view_.width;
      }
    }
    const Span u(low, high, view_.width);
    const double near_0 = nearness[0] + row * nearness[2];
    float* depth = depth_.data() + offset(row);
    int32_t* ids = id_.data() + offset(row);
    for (int column = u.first; column <= u.last; ++column) {
      const double near = near_0 + column * nearness[1];
      const float met = static_cast<float>(1.0 / near);
      if (near > 0.0 && near < 1.0 / kNear && met < depth[column]) {
        depth[column] = met;
        ids[column] = id;
      }
    }
  }
}

}  // namespace shoal::world
