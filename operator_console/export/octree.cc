// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/export/octree.h"

#include <octomap/ColorOcTree.h>

#include <sstream>
#include <stdexcept>

#include <spdlog/fmt/fmt.h>

#include "operator_console/render.h"

namespace shoal::console {

std::string colorOcTree(const mapping::MissionView& view) {
  constexpr int32_t kMiddle = 32768, kFurthest = 16383;  // keys have 16 bits
  octomap::ColorOcTree tree(view.cell_size_m / 2);
  for (const mapping::GlobalCell& c : view.map.cells) {
    for (const int32_t index : {c.cell.x, c.cell.y, c.cell.z})
      if (index < -kFurthest || index > kFurthest)
        throw std::runtime_error(fmt::format("cell ({}, {}, {}) lies outside what an OctoMap can hold",
                                             c.cell.x, c.cell.y, c.cell.z));
    const Rgb color = colorOf(c.label);
    // Cell i spans from (2 i - 1) to (2 i + 1) half cells.
    for (int corner = 0; corner < 8; ++corner) {
      const auto key = [&](int32_t index, int axis) {
        return static_cast<octomap::key_type>(kMiddle + 2 * index - 1 + (corner >> axis & 1));
      };
      octomap::ColorOcTreeNode* node =
          tree.setNodeValue(octomap::OcTreeKey(key(c.cell.x, 0), key(c.cell.y, 1), key(c.cell.z, 2)),
                            tree.getClampingThresMaxLog(), true);
      node->setColor(color[0], color[1], color[2]);
    }
  }
  if (tree.size() > 0) tree.updateInnerOccupancy();
  std::ostringstream bytes;
  if (!tree.write(bytes)) throw std::runtime_error("liboctomap cannot write the tree");
  return std::move(bytes).str();
}

}  // namespace shoal::console
