// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/ply.h"

#include <algorithm>
#include <cstdint>

#include "operator_console/export/little_endian.h"
#include "operator_console/render.h"

namespace shoal::console {
std::string globalMapPly(const mapping::GlobalMap& map, const world::Grid& grid) {
  std::string ply =
      "ply\nformat binary_little_endian 1.0\ncomment metres of the mission frame\nelement vertex " +
      std::to_string(map.cells.size()) +
      "\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\nproperty double scalar_label\nproperty float scalar_certainty\n"
      "property float scalar_robot\nproperty float scalar_age\nend_header\n";
  world::Timestamp newest;
  for (const mapping::GlobalCell& c : map.cells) newest = std::max(newest, c.seen);
  for (const mapping::GlobalCell& c : map.cells) {
    const Eigen::Vector3d p = grid.centerOf(c.cell);
    for (const double coordinate : {p.x(), p.y(), p.z()}) addLittleEndian(ply, coordinate);
    for (const uint8_t channel : colorOf(c.label)) ply += static_cast<char>(channel);
    addLittleEndian(ply, static_cast<double>(number(c.label)));
    addLittleEndian(ply, c.certainty);
    addLittleEndian(ply, static_cast<float>(number(c.robot)));
    addLittleEndian(ply, static_cast<float>(newest.seconds() - c.seen.seconds()));
  }
  return ply;
}

}  // namespace shoal::console
