// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace shoal::console {

/// A curve with error bars.
struct Series {
  std::string name;
  std::vector<double> x, y, margin;  ///< equally long; margin is half of an error bar, 0 = none
  bool dashed = false;
};

struct LinePlot {
  std::string title, x_name, y_name;
  std::vector<Series> series;
};

/// The plot as an SVG element, with axes from 0, a legend on the right, and colours that stay apart for the
/// colour blind. Pure.
std::string svg(const LinePlot& plot);

}  // namespace shoal::console
