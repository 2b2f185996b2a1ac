// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/export/geo_frame.h"

#include <proj.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include <spdlog/fmt/fmt.h>

namespace shoal::console {

struct GeoFrame::Projection {
  GeoOrigin origin;
  double cos_heading = 1, sin_heading = 0;
  PJ_CONTEXT* context = nullptr;
  PJ* pj = nullptr;
  ~Projection() {
    proj_destroy(pj);
    proj_context_destroy(context);
  }
};

GeoFrame::GeoFrame(const GeoOrigin& origin) : projection_(std::make_unique<Projection>()) {
  const auto demand = [](const char* what, double value, double limit) {
    if (!(std::abs(value) <= limit))  // NaN too
      throw std::invalid_argument(
          fmt::format("{} must lie in [-{}, {}] degrees, got {}", what, limit, limit, value));
  };
  demand("the origin's latitude", origin.latitude_deg, 89);
  demand("the origin's longitude", origin.longitude_deg, 180);
  demand("the heading", origin.heading_deg, 360);
  Projection& p = *projection_;
  p.origin = origin;
  // Quarter turns are exact: cos(pi / 2) is not 0 in floating point.
  const double quarters = origin.heading_deg / 90;
  const double rad = origin.heading_deg * std::numbers::pi / 180;
  const bool is_quarter = quarters == std::round(quarters);
  p.cos_heading = is_quarter ? std::round(std::cos(rad)) : std::cos(rad);
  p.sin_heading = is_quarter ? std::round(std::sin(rad)) : std::sin(rad);
  p.context = proj_context_create();
  p.pj = proj_create(p.context,
                     fmt::format("+proj=tmerc +lat_0={:.17g} +lon_0={:.17g} +k=1 +ellps=WGS84 +units=m",
                                 origin.latitude_deg, origin.longitude_deg)
                         .c_str());
  if (p.pj == nullptr) throw std::runtime_error("PROJ knows no transverse Mercator projection");
}

GeoFrame::~GeoFrame() = default;
GeoFrame::GeoFrame(GeoFrame&&) noexcept = default;

const GeoOrigin& GeoFrame::origin() const { return projection_->origin; }

GeoFrame::Plane GeoFrame::planeOf(double x_m, double y_m) const {
  const Projection& p = *projection_;
  return {p.cos_heading * x_m + p.sin_heading * y_m, p.cos_heading * y_m - p.sin_heading * x_m};
}

GeoFrame::Degrees GeoFrame::degreesOf(double x_m, double y_m) const {
  const Plane plane = planeOf(x_m, y_m);
  const PJ_COORD at = proj_trans(projection_->pj, PJ_INV, proj_coord(plane.east_m, plane.north_m, 0, 0));
  const double longitude = at.lp.lam * 180 / std::numbers::pi, latitude = at.lp.phi * 180 / std::numbers::pi;
  if (!std::isfinite(longitude) || !std::isfinite(latitude))
    throw std::runtime_error(fmt::format("({}, {}) m is too far from the origin to have degrees", x_m, y_m));
  return {latitude, longitude};
}

}  // namespace shoal::console
