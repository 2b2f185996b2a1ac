// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

namespace shoal::console {

/// Where on Earth a mission was.
struct GeoOrigin {
  double latitude_deg = 0, longitude_deg = 0;  ///< of (0, 0) of the mission frame, WGS 84
  double heading_deg = 0;                      ///< where +Y points, clockwise from true north
};

/// The mission frame's X and Y on Earth, and back in degrees.
///
/// X and Y are turned by the heading and read as east and north of a transverse Mercator projection of WGS 84
/// that is centred on the origin with scale 1. So a point d metres east or west of the origin is put on Earth
/// d^3 / (6 R^2) too near: 4 micrometres at 1 km, 0.5 mm at 5 km, 4 mm at 10 km; along the meridian nothing
/// is lost. Heights are left alone. Source: PROJ's tmerc (Poder and Engsager), accurate to nanometres here.
class GeoFrame {
 public:
  /// @throws std::invalid_argument unless latitude is within 89 degrees of the equator, longitude within 180
  ///         of Greenwich and heading within [-360, 360].
  explicit GeoFrame(const GeoOrigin& origin);
  ~GeoFrame();
  GeoFrame(GeoFrame&&) noexcept;

  struct Plane {
    double east_m, north_m;
  };
  struct Degrees {
    double latitude, longitude;
  };

  const GeoOrigin& origin() const;
  Plane planeOf(double x_m, double y_m) const;
  /// @throws std::runtime_error for points too far for the projection (thousands of kilometres).
  Degrees degreesOf(double x_m, double y_m) const;

 private:
  struct Projection;
  std::unique_ptr<Projection> projection_;
};

}  // namespace shoal::console
