// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/render.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "fusion_node/picture_files.h"
#include "shoal/mapping/csv.h"
#include "shoal/mapping/map_files.h"
#include "shoal/matching/assignment.h"

namespace shoal::console {
namespace {

constexpr int kMapPixels = 720;    // long side of a map
constexpr int kLegendWidth = 300;  // pixels, at least
constexpr int kMostTextWidth = 380;
constexpr double kTextSize = 0.45;
constexpr int kMargin = 16;
constexpr int kTitleHeight = 34;
constexpr int kRowHeight = 24;
constexpr int kPictureRowHeight = 38;
constexpr int kMostLegendRows = 24, kFewestLegendRows = 8;  // between them, what fits beside the map
const cv::Scalar kPaper(250, 250, 250), kInk(40, 40, 40), kNothing(225, 225, 225);

cv::Scalar bgr(const Rgb& c) { return {double(c[2]), double(c[1]), double(c[0])}; }

void write(cv::Mat& picture, const std::string& text, cv::Point at, double size = 0.5) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, size, kInk, 1, cv::LINE_AA);
}

struct Column {
  int32_t z;
  Rgb color;
};
using Columns = std::map<std::pair<int32_t, int32_t>, Column>;

void put(Columns& columns, const world::CellIndex& cell, const Rgb& color) {
  const auto [at, inserted] = columns.emplace(std::pair(cell.x, cell.y), Column{cell.z, color});
  if (!inserted && at->second.z <= cell.z) at->second = {cell.z, color};
}

// One pixel a column, then enlarged; north is up.
cv::Mat drawColumns(const Columns& columns, const cv::Rect& bounds) {
  cv::Mat small(bounds.height, bounds.width, CV_8UC3, kNothing);
  for (const auto& [xy, column] : columns) {
    const int row = bounds.y + bounds.height - 1 - xy.second, col = xy.first - bounds.x;
    small.at<cv::Vec3b>(row, col) = {column.color[2], column.color[1], column.color[0]};
  }
  const double scale = std::max(1.0, double(kMapPixels) / std::max(bounds.width, bounds.height));
  cv::Mat large;
  cv::resize(small, large, {}, scale, scale, cv::INTER_NEAREST);
  return large;
}

cv::Rect boundsOf(const mapping::GlobalMap& map) {
  int32_t min_x = INT32_MAX, min_y = INT32_MAX, max_x = INT32_MIN, max_y = INT32_MIN;
  for (const auto& c : map.cells) {
    min_x = std::min(min_x, c.cell.x);
    max_x = std::max(max_x, c.cell.x);
    min_y = std::min(min_y, c.cell.y);
    max_y = std::max(max_y, c.cell.y);
  }
  return {min_x, min_y, max_x - min_x + 1, max_y - min_y + 1};
}

struct LegendRow {
  Rgb color;
  std::string text;
  cv::Mat picture = {};
};

int widthOf(const std::string& text) {
  int below = 0;
  return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, kTextSize, 1, &below).width;
}

// OpenCV's letters are those of ASCII: a label with a name in others goes by its number here.
std::string drawableName(const mapping::LabelSummary& label) {
  const bool is_drawable = std::ranges::all_of(label.name, [](char c) { return c >= ' ' && c <= '~'; });
  return label.name.empty() || !is_drawable ? std::to_string(number(label.label)) : label.name;
}

// The name, and what is said of the label, in a width that there is room for.
std::string fitting(std::string name, const std::string& said) {
  if (widthOf(name + said) <= kMostTextWidth) return name + said;
  while (!name.empty() && widthOf(name + ".." + said) > kMostTextWidth) name.pop_back();
  return name + ".." + said;
}

std::string percent(double share) {
  return share > 0 && share < 0.0005 ? "< 0.1 %" : mapping::fixed(share * 100, 1) + " %";
}

std::vector<LegendRow> legendOf(const mapping::GlobalMap& map, const world::Grid& grid,
                                const std::map<world::GlobalLabel, Rgb>& colors,
                                const LegendPictures& pictures, size_t most_rows) {
  const auto areas = mapping::areas(map, grid);
  std::vector<mapping::LabelSummary> labels = map.labels;
  std::ranges::stable_sort(labels, std::ranges::greater{}, &mapping::LabelSummary::cells);
  double total = 0;
  for (const auto& [label, area] : areas) total += area;
  std::vector<LegendRow> rows;
  for (const auto& label : labels) {
    if (rows.size() == most_rows - 1 && labels.size() > most_rows) {
      rows.push_back(
          {{225, 225, 225}, "and " + std::to_string(labels.size() - rows.size()) + " more labels"});
      break;
    }
    const auto area = areas.find(label.label);
    const double share = area == areas.end() || total <= 0 ? 0 : area->second / total;
    rows.push_back(
        {colors.at(label.label),
         fitting(drawableName(label), "  " + percent(share) + "  " + std::to_string(label.robots.size()) +
                                          (label.robots.size() == 1 ? " robot" : " robots"))});
    if (const auto shown = pictures.find(label.label); shown != pictures.end()) {
      rows.back().picture = shown->second;
    }
  }
  return rows;
}

// Where the text of a row begins.
int indentOf(int row_height) { return row_height == kRowHeight ? 28 : 66; }

void drawLegend(cv::Mat& picture, cv::Point at, const std::string& heading,
                const std::vector<LegendRow>& rows, int row_height = kRowHeight) {
  write(picture, heading, at + cv::Point(0, 14), 0.55);
  const int lift = (row_height - kRowHeight) / 2;  // of what stands in the middle of a higher row
  for (size_t i = 0; i < rows.size(); ++i) {
    const cv::Point corner = at + cv::Point(0, 26 + static_cast<int>(i) * row_height + lift);
    cv::rectangle(picture, {corner, cv::Size(18, 16)}, bgr(rows[i].color), cv::FILLED);
    cv::rectangle(picture, {corner, cv::Size(18, 16)}, kInk, 1);
    if (!rows[i].picture.empty()) {
      const cv::Rect place(corner + cv::Point(26, 8 - rows[i].picture.rows / 2), rows[i].picture.size());
      rows[i].picture.copyTo(picture(place));
      cv::rectangle(picture, place, kInk, 1);
    }
    write(picture, rows[i].text, corner + cv::Point(indentOf(row_height), 13), kTextSize);
  }
}

}  // namespace

// Each the farthest from all before it to whichever of three eyes sees them most alike: usual ones (which
// count half), protanopes' and deuteranopes' (CIE L*a*b*, G. Machado et al. 2009). A robot's own topics get
// different ones; the step between robots is the one that mixed up the fewest large labels of the maps that
// we had.
Rgb colorOf(world::GlobalLabel label) {
  static constexpr std::array<Rgb, 36> kColors = {
      {{0x00, 0x72, 0xb2}, {0xd5, 0x5e, 0x00}, {0x3c, 0xf0, 0x96}, {0xa5, 0x00, 0x5a}, {0xd2, 0xd2, 0x00},
       {0x78, 0x4b, 0xe1}, {0x2d, 0x4b, 0x0f}, {0xff, 0xc3, 0xe1}, {0x1e, 0xa5, 0x96}, {0xff, 0x0f, 0x4b},
       {0xff, 0x87, 0xf0}, {0xa5, 0x96, 0x69}, {0x87, 0x5a, 0x87}, {0xf0, 0xb4, 0x4b}, {0x0f, 0x4b, 0x4b},
       {0x87, 0x00, 0x87}, {0x96, 0xc3, 0x69}, {0x69, 0x87, 0xff}, {0x00, 0x87, 0x3c}, {0xff, 0x78, 0xa5},
       {0xa5, 0x0f, 0x1e}, {0x5a, 0xc3, 0xff}, {0x87, 0x3c, 0x3c}, {0x3c, 0xc3, 0x2d}, {0xe1, 0x2d, 0xc3},
       {0x00, 0x3c, 0xa5}, {0x96, 0xe1, 0xb4}, {0xa5, 0x78, 0x78}, {0x96, 0x4b, 0x00}, {0x78, 0xb4, 0xc3},
       {0x5a, 0x96, 0x0f}, {0xb4, 0x78, 0xe1}, {0xf0, 0xc3, 0x87}, {0x00, 0xe1, 0xd2}, {0x3c, 0xc3, 0x87},
       {0xc3, 0xd2, 0xff}}};
  constexpr int64_t kStep = 13;
  const int64_t robot = number(label) / 10000, topic = number(label) % 10000;
  return kColors[static_cast<size_t>(std::abs(topic + kStep * robot)) % kColors.size()];
}

// Okabe and Ito's, then Tol's muted ones.
Rgb robotColor(world::RobotId robot) {
  static constexpr std::array<Rgb, 12> kColors = {{{0x00, 0x72, 0xb2},
                                                   {0xe6, 0x9f, 0x00},
                                                   {0x00, 0x9e, 0x73},
                                                   {0xcc, 0x79, 0xa7},
                                                   {0xd5, 0x5e, 0x00},
                                                   {0x56, 0xb4, 0xe9},
                                                   {0x33, 0x22, 0x88},
                                                   {0x99, 0x99, 0x33},
                                                   {0x88, 0x22, 0x55},
                                                   {0x44, 0xaa, 0x99},
                                                   {0x11, 0x77, 0x33},
                                                   {0xaa, 0x44, 0x99}}};
  return kColors[static_cast<size_t>(world::number(robot)) % kColors.size()];
}

LegendPictures legendPictures(const mapping::LabelPictures& pictures) {
  LegendPictures shown;
  for (const auto& [label, held] : pictures) shown[label] = fusion_node::pixelsOf(held.front());
  return shown;
}

std::map<world::GlobalLabel, Rgb> alignedColors(const mapping::GlobalMap& map, const TruthPicture& truth) {
  std::map<world::GlobalLabel, Rgb> colors;
  std::map<world::GlobalLabel, std::map<int, int64_t>> overlap;
  for (const auto& c : map.cells) {
    colors.emplace(c.label, colorOf(c.label));
    if (const auto true_class = truth.of_cell(c.cell)) ++overlap[c.label][*true_class];
  }
  std::vector<world::GlobalLabel> labels;
  for (const auto& [label, counts] : overlap) labels.push_back(label);
  if (labels.empty() || truth.classes.empty()) return colors;
  // Rows are classes; columns labels, padded so that every class finds one.
  const auto num_rows = static_cast<Eigen::Index>(truth.classes.size());
  Eigen::MatrixXd cost =
      Eigen::MatrixXd::Zero(num_rows, std::max(num_rows, static_cast<Eigen::Index>(labels.size())));
  for (Eigen::Index r = 0; r < num_rows; ++r)
    for (size_t l = 0; l < labels.size(); ++l) {
      const auto& counts = overlap.at(labels[l]);
      const auto cells = counts.find(truth.classes[static_cast<size_t>(r)].id);
      if (cells != counts.end()) cost(r, static_cast<Eigen::Index>(l)) = -static_cast<double>(cells->second);
    }
  const std::vector<int> column = matching::assign(cost);
  for (size_t r = 0; r < truth.classes.size(); ++r) {
    const auto l = static_cast<size_t>(column[r]);
    if (l < labels.size() && overlap.at(labels[l]).contains(truth.classes[r].id)) {
      colors[labels[l]] = truth.classes[r].rgb;
    }
  }
  return colors;
}

cv::Mat render(const mapping::GlobalMap& map, const world::Grid& grid, const std::string& title,
               const std::optional<TruthPicture>& truth, const LegendPictures& pictures) {
  if (map.cells.empty()) {
    cv::Mat picture(200, 480, CV_8UC3, kPaper);
    write(picture, title, {kMargin, 30}, 0.6);
    write(picture, "nothing has been mapped yet", {kMargin, 110});
    return picture;
  }
  std::map<world::GlobalLabel, Rgb> colors;
  if (truth) {
    colors = alignedColors(map, *truth);
  } else {
    for (const auto& c : map.cells) colors.emplace(c.label, colorOf(c.label));
  }
  Columns fused, true_columns;
  for (const auto& c : map.cells) {
    put(fused, c.cell, colors.at(c.label));
    if (!truth) continue;
    const auto id = truth->of_cell(c.cell);
    const auto known = std::ranges::find_if(truth->classes, [&](const auto& k) { return id && k.id == *id; });
    if (known != truth->classes.end()) put(true_columns, c.cell, known->rgb);
  }
  const cv::Rect bounds = boundsOf(map);
  const cv::Mat fused_picture = drawColumns(fused, bounds);
  const int map_width = fused_picture.cols, map_height = fused_picture.rows;
  const int row_height = pictures.empty() ? kRowHeight : kPictureRowHeight;
  std::vector<LegendRow> class_rows;
  if (truth)
    for (const auto& k : truth->classes) class_rows.push_back({k.rgb, k.name});
  const int beside = 26 + static_cast<int>(truth ? class_rows.size() + 2 : 0) * kRowHeight;
  const int most_rows = std::clamp((map_height - beside) / row_height, kFewestLegendRows, kMostLegendRows);
  const auto rows = legendOf(map, grid, colors, pictures, static_cast<size_t>(most_rows));

  const int legend_height = beside + static_cast<int>(rows.size()) * row_height;
  int legend_width = kLegendWidth;
  for (const LegendRow& row : rows)
    legend_width = std::max(legend_width, indentOf(row_height) + widthOf(row.text) + kMargin);
  for (const LegendRow& row : class_rows)
    legend_width = std::max(legend_width, indentOf(kRowHeight) + widthOf(row.text) + kMargin);
  const int maps = truth ? 2 : 1;
  cv::Mat picture(kTitleHeight + std::max(map_height, legend_height) + 2 * kMargin,
                  maps * (map_width + kMargin) + legend_width + kMargin, CV_8UC3, kPaper);
  write(picture, title, {kMargin, kTitleHeight - 8}, 0.6);
  const int top = kTitleHeight + kMargin;
  fused_picture.copyTo(picture({kMargin, top, map_width, map_height}));
  int left = kMargin + map_width + kMargin;
  if (truth) {
    drawColumns(true_columns, bounds).copyTo(picture({left, top, map_width, map_height}));
    write(picture, "truth", {left, top - 6});
    left += map_width + kMargin;
  }
  drawLegend(picture, {left, top}, "labels", rows, row_height);
  if (truth) {
    drawLegend(picture, {left, top + static_cast<int>(rows.size()) * row_height + 2 * kRowHeight}, "truth",
               class_rows);
  }
  return picture;
}

std::string encodePng(const cv::Mat& picture) {
  std::vector<uint8_t> bytes;
  cv::imencode(".png", picture, bytes);
  return {bytes.begin(), bytes.end()};
}

}  // namespace shoal::console
