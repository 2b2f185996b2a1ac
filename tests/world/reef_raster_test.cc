// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "shoal/random.h"

namespace shoal::world {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double between(Random& random, double low, double high) { return low + (high - low) * random.uniform(); }

Matrix3d anyRotation(Random& random) {
  const Vector3d axis(between(random, -1, 1), between(random, -1, 1), between(random, -1, 1));
  return Eigen::AngleAxisd(between(random, 0, 6), axis.normalized()).toRotationMatrix();
}

Ellipsoid anySolid(Random& random, double depth) {
  Ellipsoid solid;
  solid.center = Vector3d(between(random, -2, 2), between(random, -2, 2), depth).cast<float>();
  const Vector3d lengths(between(random, .05, 1), between(random, .05, 1), between(random, .05, 1));
  solid.axes = (anyRotation(random) * lengths.asDiagonal()).cast<float>();
  return solid;
}

/// Where a ray enters a solid, by its own equation |A^-1 (p - c)| = 1 and general inversion.
std::optional<double> enter(const Ellipsoid& solid, const Vector3d& from, const Vector3d& ray) {
  const Matrix3d inverse = solid.axes.cast<double>().inverse();
  const Vector3d o = inverse * (from - solid.center.cast<double>()), d = inverse * ray;
  const double a = d.dot(d), b = o.dot(d), c = o.dot(o) - 1.0;
  if (b * b < a * c) return std::nullopt;
  return (-b - std::sqrt(b * b - a * c)) / a;
}

View pinhole() {
  View view;
  view.width = 64;
  view.height = 48;
  view.fx = 40;
  view.fy = 44;
  view.cx = 31;
  view.cy = 24.5;
  return view;
}

struct Ray {
  Vector3d from, along;
};
Ray rayOf(const View& view, int row, int column) {
  const Vector3d aside((column - view.cx) / view.fx, (row - view.cy) / view.fy, 0.0);
  const Matrix3d world_from_view = view.view_from_world.transpose();
  if (view.parallel) return {view.eye + world_from_view * aside, world_from_view.col(2)};
  return {view.eye, world_from_view * (aside + Vector3d::UnitZ())};
}

// Every pixel by brute force: the nearest of all solids that its ray enters. A pixel whose ray all but grazes
// may go either way.
TEST(RasterTest, ShowsTheNearestOfManySolidsToAPinholeAndToParallelRays) {
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    View view = pinhole();
    view.parallel = trial % 2 == 1;
    if (view.parallel) view.fx = view.fy = 14;
    view.view_from_world = Eigen::AngleAxisd(between(random, -.3, .3), Vector3d::UnitX()).toRotationMatrix();
    view.eye = Vector3d(between(random, -.5, .5), between(random, -.5, .5), between(random, -1, 1));
    std::vector<Ellipsoid> solids;
    Raster raster(view);
    for (int i = 0; i < 12; ++i) {
      solids.push_back(anySolid(random, between(random, 3.5, 7)));
      raster.draw(solids.back(), i);
    }
    int covered = 0;
    for (int row = 0; row < view.height; ++row) {
      for (int column = 0; column < view.width; ++column) {
        const Ray ray = rayOf(view, row, column);
        double nearest = Raster::kNothing;
        int which = -1;
        bool grazes = false;
        for (int i = 0; i < 12; ++i) {
          Ellipsoid larger = solids[static_cast<size_t>(i)], smaller = larger;
          larger.axes *= 1.002f;
          smaller.axes *= 0.998f;
          grazes |= enter(larger, ray.from, ray.along).has_value() !=
                    enter(smaller, ray.from, ray.along).has_value();
          const auto depth = enter(solids[static_cast<size_t>(i)], ray.from, ray.along);
          if (depth && *depth < nearest) {
            nearest = *depth;
            which = i;
          }
        }
        if (grazes) continue;
        const float depth = raster.depths(row)[column];
        if (which < 0) {
          ASSERT_EQ(depth, Raster::kNothing);
        } else {
          ++covered;
          ASSERT_NEAR(depth, nearest, 2e-4);
          const auto other = enter(solids[static_cast<size_t>(raster.ids(row)[column])], ray.from, ray.along);
          ASSERT_TRUE(other);
          ASSERT_NEAR(*other, nearest, 2e-4);  // the same one, or one that touches it there
        }
      }
    }
    EXPECT_GT(covered, 100);
  }
}

TEST(RasterTest, DrawsNothingThatReachesTheEyeOrLiesBehindIt) {
  Raster raster(pinhole());
  for (const float z : {-3.0f, 0.0f, 0.9f}) {
    raster.draw({Eigen::Vector3f(0, 0, z), Eigen::Matrix3f::Identity()}, 1);
  }
  for (int row = 0; row < 48; ++row) {
    for (int column = 0; column < 64; ++column) ASSERT_EQ(raster.depths(row)[column], Raster::kNothing);
  }
}

TEST(RasterTest, ShowsTrianglesFromOneSideAtTheDepthOfTheirPlane) {
  const View view = pinhole();
  // The plane z = 4 + x / 2, so that depth = 4 / (1 - ray.x / 2).
  const auto on = [](double x, double y) { return Vector3d(x, y, 4.0 + 0.5 * x); };
  // Seen by the eye, whose y runs down, clockwise in the picture is counter-clockwise in the world.
  Raster front(view), back(view);
  front.drawTriangle(on(-1, -1), on(-1, 1), on(1, -1), 7);
  back.drawTriangle(on(-1, -1), on(1, -1), on(-1, 1), 7);
  int covered = 0;
  for (int row = 0; row < view.height; ++row) {
    for (int column = 0; column < view.width; ++column) {
      const double rx = (column - view.cx) / view.fx, ry = (row - view.cy) / view.fy;
      const double depth = 4.0 / (1.0 - 0.5 * rx), x = rx * depth, y = ry * depth;
      const double inside = std::min({x + 1.0, y + 1.0, -x - y});
      ASSERT_EQ(back.depths(row)[column], Raster::kNothing);
      if (std::abs(inside) < 1e-6) continue;
      if (inside > 0) {
        ++covered;
        ASSERT_NEAR(front.depths(row)[column], depth, 1e-5);
        ASSERT_EQ(front.ids(row)[column], 7);
      } else {
        ASSERT_EQ(front.depths(row)[column], Raster::kNothing);
      }
    }
  }
  EXPECT_GT(covered, 150);
}

// Two triangles that share a border, wherever it runs: no pixel falls through, in front of the eye nor under
// it.
TEST(RasterTest, LeavesNoSlitsBetweenTrianglesThatShareABorder) {
  Random random(6);
  for (int trial = 0; trial < 300; ++trial) {
    View view = pinhole();
    view.view_from_world = Eigen::AngleAxisd(between(random, -.6, .6), Vector3d::UnitX()).toRotationMatrix();
    const double angle = between(random, 0, 6.3), far = 200.0;
    const Vector3d along(std::cos(angle), std::sin(angle), 0), across(-along.y(), along.x(), 0);
    const Vector3d middle(between(random, -2, 2), between(random, -1, 1), 5);
    const auto corner = [&](double a, double b) {
      return view.fromWorld(middle + far * (a * along + b * across));
    };
    Raster raster(view);
    raster.drawTriangle(corner(-1, 0), corner(0, 1), corner(1, 0), 1);
    raster.drawTriangle(corner(-1, 0), corner(1, 0), corner(0, -1), 2);
    raster.drawTriangle(corner(-1, 0), corner(1, 0), corner(0, 1), 1);
    raster.drawTriangle(corner(-1, 0), corner(0, -1), corner(1, 0), 2);
    for (int row = 0; row < view.height; ++row) {
      for (int column = 0; column < view.width; ++column) {
        const Ray ray = rayOf(view, row, column);
        const double depth = 5.0 / ray.along.z();
        if (!(depth > 0) || (depth * ray.along - middle).norm() > 0.7 * far) continue;
        ASSERT_NEAR(raster.depths(row)[column], depth, 1e-4 * depth) << trial << ' ' << row << ' ' << column;
      }
    }
  }
}

}  // namespace
}  // namespace shoal::world
