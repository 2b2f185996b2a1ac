// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_forms.h"

#include <gtest/gtest.h>

namespace shoal::world {
namespace {

constexpr Form kForms[] = {Form::kBoulder, Form::kStones,  Form::kDome, Form::kAntlers,
                           Form::kTables,  Form::kBarrels, Form::kTuft, Form::kBlades};

TEST(ReefFormsTest, AreSolidsWithOrthogonalAxesWithinTheirBounds) {
  for (const Form form : kForms) {
    for (uint64_t i = 0; i < 200; ++i) {
      SCOPED_TRACE(static_cast<int>(form) * 1000 + static_cast<int>(i));
      const std::vector<Part> parts = grow(form, Random(3, i));
      ASSERT_FALSE(parts.empty());
      ASSERT_LE(parts.size(), 130u);
      float top = 0;
      for (const Part& part : parts) {
        const Eigen::Matrix3f& axes = part.solid.axes;
        const Eigen::Vector3f lengths = axes.colwise().norm().transpose();
        ASSERT_GT(lengths.minCoeff(), 0.005f);
        for (int a = 0; a < 3; ++a) {
          for (int b = 0; b < a; ++b)
            ASSERT_NEAR(axes.col(a).dot(axes.col(b)) / (lengths[a] * lengths[b]), 0, 1e-5);
        }
        // An ellipsoid's reach along an axis of the world is the length of that row.
        const Eigen::Vector3f reach = axes.rowwise().norm();
        ASSERT_LT(part.solid.center.head<2>().norm() + reach.head<2>().maxCoeff(), 1.6f);
        top = std::max(top, part.solid.center.z() + reach.z());
        ASSERT_GT(part.brightness, 0.1f);
        ASSERT_LT(part.brightness, 1.5f);
      }
      EXPECT_GT(top, 0.05f);
      EXPECT_LT(top, 1.6f);
    }
  }
}

TEST(ReefFormsTest, AreTheSameFromTheSameRandomnessAndNoOther) {
  for (const Form form : kForms) {
    const auto a = grow(form, Random(3, 1)), again = grow(form, Random(3, 1)),
               other = grow(form, Random(3, 2));
    ASSERT_EQ(a.size(), again.size());
    for (size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].solid.center, again[i].solid.center);
      EXPECT_EQ(a[i].solid.axes, again[i].solid.axes);
    }
    EXPECT_NE(a[0].solid.axes, other[0].solid.axes);
  }
}

}  // namespace
}  // namespace shoal::world
