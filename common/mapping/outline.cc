// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/outline.h"

#include <array>
#include <map>
#include <set>

#include "shoal/demand.h"

namespace shoal::mapping {
namespace {

// Directions: east, north, west, south. A left turn adds one.
constexpr std::array<Corner, 4> kStep = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
constexpr size_t kRight = 3, kStraight = 0, kLeft = 1;  // turns, to be added modulo 4

Corner step(const Corner& from, size_t direction) {
  return {from.first + kStep[direction].first, from.second + kStep[direction].second};
}

// Columns joined with `start` by their edges; taken out of `open`.
std::set<Column> takeJoined(std::set<Column>& open, const Column& start) {
  std::vector<Column> joined = {start};
  open.erase(start);
  for (size_t next = 0; next < joined.size(); ++next) {
    for (size_t d = 0; d < kStep.size(); ++d) {
      const Column neighbor = step(joined[next], d);
      if (open.erase(neighbor) > 0) joined.push_back(neighbor);
    }
  }
  return {joined.begin(), joined.end()};
}

// Edges between the set and what is not in it, by the corner they start from: directions that leave there.
// The set lies to the left.
std::map<Corner, std::set<size_t>> boundary(const std::set<Column>& columns) {
  std::map<Corner, std::set<size_t>> leaving;
  for (const Column& c : columns) {
    const auto [x, y] = c;
    const std::array<Corner, 4> from = {{{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}}};
    const std::array<Column, 4> beyond = {{{x, y - 1}, {x + 1, y}, {x, y + 1}, {x - 1, y}}};
    for (size_t d = 0; d < 4; ++d) {
      if (!columns.contains(beyond[d])) leaving[from[d]].insert(d);
    }
  }
  return leaving;
}

// Follows the boundary from its lowest corner, which is where some ring turns, until it closes.
Ring takeRing(std::map<Corner, std::set<size_t>>& leaving) {
  const Corner start = leaving.begin()->first;
  size_t direction = *leaving.begin()->second.begin();
  Ring ring;
  Corner at = start;
  bool turns = true;
  do {
    if (turns) ring.push_back(at);
    const auto edges = leaving.find(at);
    SHOAL_DEMAND(edges != leaving.end() && edges->second.erase(direction) == 1);
    if (edges->second.empty()) leaving.erase(edges);
    at = step(at, direction);
    if (at == start) break;
    // Where two columns of the set meet at a corner only, turning right goes on along the other one. They
    // are joined elsewhere, so the way round through this corner encloses ground: it becomes a hole's ring.
    const std::set<size_t>& out = leaving.at(at);
    turns = false;
    for (const size_t turn : {kRight, kStraight, kLeft}) {
      const size_t next = (direction + turn) % 4;
      if (!out.contains(next)) continue;
      turns = next != direction;
      direction = next;
      break;
    }
  } while (true);
  return ring;
}

}  // namespace

std::vector<Polygon> outlineOf(std::span<const Column> columns) {
  std::set<Column> open(columns.begin(), columns.end());
  std::vector<Polygon> polygons;
  while (!open.empty()) {
    auto leaving = boundary(takeJoined(open, *open.begin()));
    // The lowest corner of all is on the outer ring: nothing lies beyond it.
    Polygon polygon{.outer = takeRing(leaving), .holes = {}};
    while (!leaving.empty()) polygon.holes.push_back(takeRing(leaving));
    polygons.push_back(std::move(polygon));
  }
  return polygons;
}

}  // namespace shoal::mapping
