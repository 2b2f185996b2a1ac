// SPDX-License-Identifier: BSD-3-Clause
// read_octree FILE.ot: what liboctomap reads, a line a leaf: x y z edge red green blue occupied.
#include <octomap/ColorOcTree.h>

#include <cstdio>
#include <memory>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::unique_ptr<octomap::AbstractOcTree> read(octomap::AbstractOcTree::read(argv[1]));
  const auto* tree = dynamic_cast<octomap::ColorOcTree*>(read.get());
  if (tree == nullptr) return 1;
  for (auto leaf = tree->begin_leafs(); leaf != tree->end_leafs(); ++leaf) {
    const octomap::ColorOcTreeNode::Color color = leaf->getColor();
    std::printf("%.6f %.6f %.6f %.6f %d %d %d %d\n", leaf.getX(), leaf.getY(), leaf.getZ(), leaf.getSize(),
                color.r, color.g, color.b, tree->isNodeOccupied(*leaf) ? 1 : 0);
  }
}
