// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/line_plot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "operator_console/xml_text.h"

namespace shoal::console {
namespace {

// Okabe and Ito's colours, 2008.
constexpr std::array kColors = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                "#E69F00", "#56B4E9", "#000000", "#8A6D00"};

constexpr double kWidth = 620, kHeight = 340, kLeft = 56, kRight = 190, kTop = 34, kBottom = 46;

// A round number of about `range / 6`.
double step(double range) {
  const double rough = range / 6;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) return factor * power;
  }
  return 10 * power;
}

struct Axis {
  double low = 0, high = 1;
  double from = 0, to = 1;  // on paper
  double at(double value) const { return from + (value - low) / (high - low) * (to - from); }
};

std::string number(double value) { return fmt::format("{:g}", std::round(value * 1e6) / 1e6); }

}  // namespace

std::string svg(const LinePlot& plot) {
  double most_x = 0, most_y = 0, least_y = 0;
  for (const Series& s : plot.series) {
    for (size_t i = 0; i < s.x.size(); ++i) {
      most_x = std::max(most_x, s.x[i]);
      most_y = std::max(most_y, s.y[i] + s.margin[i]);
      least_y = std::min(least_y, s.y[i] - s.margin[i]);
    }
  }
  if (most_x <= 0) most_x = 1;
  if (most_y <= least_y) most_y = least_y + 1;
  const double step_x = step(most_x), step_y = step(most_y - least_y);
  const Axis x{0, most_x, kLeft, kWidth - kRight};
  const Axis y{std::floor(least_y / step_y) * step_y, std::ceil(most_y / step_y) * step_y, kHeight - kBottom,
               kTop};

  std::string out = fmt::format(
      "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\"><text x=\"{}\" y=\"18\" "
      "class=\"title\">{}</text>\n",
      kWidth, kHeight, xmlText(plot.title), kLeft, xmlText(plot.title));
  for (double value = y.low; value <= y.high + step_y / 2; value += step_y) {
    out += fmt::format(
        "<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\" class=\"grid\"/><text x=\"{:.1f}\" "
        "y=\"{:.1f}\" "
        "text-anchor=\"end\">{}</text>\n",
        x.from, x.to, y.at(value), y.at(value), x.from - 6, y.at(value) + 4, number(value));
  }
  for (double value = 0; value <= most_x + step_x / 100; value += step_x) {
    out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", x.at(value),
                       y.from + 16, number(value));
  }
  out += fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text><text transform=\"translate(14 "
      "{:.1f}) "
      "rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      (x.from + x.to) / 2, kHeight - 10, xmlText(plot.x_name), (y.from + y.to) / 2, xmlText(plot.y_name));
  for (size_t k = 0; k < plot.series.size(); ++k) {
    const Series& s = plot.series[k];
    const char* color = kColors[k % kColors.size()];
    std::string points;
    for (size_t i = 0; i < s.x.size(); ++i) {
      points += fmt::format("{:.1f},{:.1f} ", x.at(s.x[i]), y.at(s.y[i]));
      if (s.margin[i] > 0) {
        out += fmt::format(
            "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\" stroke=\"{3}\" "
            "stroke-opacity=\".5\"/>\n",
            x.at(s.x[i]), y.at(s.y[i] - s.margin[i]), y.at(s.y[i] + s.margin[i]), color);
      }
    }
    const char* dash = s.dashed ? " stroke-dasharray=\"6 4\"" : "";
    const double row = kTop + 8 + 18 * static_cast<double>(k);
    out += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"{}/>\n", points,
                       color, dash);
    out += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{1:.1f}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"{3}\" "
        "stroke-width=\"2\"{4}/>"
        "<text x=\"{5:.1f}\" y=\"{6:.1f}\">{7}</text>\n",
        x.to + 12, x.to + 34, row, color, dash, x.to + 40, row + 4, xmlText(s.name));
  }
  return out + "</svg>\n";
}

}  // namespace shoal::console
