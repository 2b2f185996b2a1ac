// SPDX-License-Identifier: BSD-3-Clause
#include "other_coders.h"

#include <octomap/ColorOcTree.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace shoal::wire {
namespace {

namespace fs = std::filesystem;

// A folder of its own for a program that reads and writes files.
class Scratch {
 public:
  Scratch() { fs::create_directories(folder_); }
  ~Scratch() { fs::remove_all(folder_); }
  fs::path path(const std::string& name) const { return folder_ / name; }

  // Bytes of the file "coded" that the command writes in the folder; 0 when it fails.
  size_t sizeAfter(const std::string& command) const {
    const std::string there = "cd " + folder_.string() + " && " + command + " >/dev/null 2>&1";
    return std::system(there.c_str()) == 0 ? fs::file_size(path("coded")) : 0;
  }

 private:
  const fs::path folder_ = fs::temp_directory_path() / ("shoal_wire_bytes_" + std::to_string(getpid()));
};

}  // namespace

Raster rasterOf(Cells cells) {
  const auto [x0, x1] = std::ranges::minmax(cells, {}, [](const auto& c) { return c.cell.x; });
  const auto [y0, y1] = std::ranges::minmax(cells, {}, [](const auto& c) { return c.cell.y; });
  Raster raster{x1.cell.x - x0.cell.x + 1, y1.cell.y - y0.cell.y + 1, {}};
  raster.pixels.assign(static_cast<size_t>(raster.width) * static_cast<size_t>(raster.height), 255);
  for (const auto& c : cells)  // ascending: the highest of a column last
    raster.pixels[static_cast<size_t>((c.cell.y - y0.cell.y) * raster.width + c.cell.x - x0.cell.x)] =
        static_cast<uint8_t>(number(c.topic));
  return raster;
}

size_t zstd19(const std::vector<uint8_t>& bytes) {
  std::vector<uint8_t> out(ZSTD_compressBound(bytes.size()));
  const size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 19);
  if (ZSTD_isError(size) != 0) throw std::runtime_error(ZSTD_getErrorName(size));
  return size;
}

size_t jpegXl(const Raster& raster) {
  const Scratch scratch;
  std::ofstream file(scratch.path("map.pgm"), std::ios::binary);
  file << "P5\n" << raster.width << ' ' << raster.height << "\n255\n";
  file.write(reinterpret_cast<const char*>(raster.pixels.data()),
             static_cast<std::streamsize>(raster.pixels.size()));
  file.close();
  return scratch.sizeAfter("cjxl map.pgm coded -d 0 -e 9");
}

size_t draco(Cells cells) {
  const Scratch scratch;
  std::ofstream file(scratch.path("map.ply"));
  file << "ply\nformat ascii 1.0\nelement vertex " << cells.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
          "property uchar blue\nend_header\n";
  for (const auto& c : cells)
    file << c.cell.x << ' ' << c.cell.y << ' ' << c.cell.z << ' ' << number(c.topic) << " 0 0\n";
  file.close();
  return scratch.sizeAfter("draco_encoder -point_cloud -i map.ply -o coded -qp 10 -cl 10");
}

size_t octoMap(Cells cells) {
  octomap::ColorOcTree tree(1.0);
  for (const auto& c : cells) {
    const octomap::point3d centre(static_cast<float>(c.cell.x) + 0.5f, static_cast<float>(c.cell.y) + 0.5f,
                                  static_cast<float>(c.cell.z) + 0.5f);
    tree.updateNode(centre, true, true)->setColor(static_cast<uint8_t>(number(c.topic)), 0, 0);
  }
  tree.updateInnerOccupancy();
  std::ostringstream bytes;
  tree.write(bytes);
  return bytes.str().size();
}

}  // namespace shoal::wire
