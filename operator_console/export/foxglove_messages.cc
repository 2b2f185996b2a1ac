// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/export/foxglove_messages.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "operator_console/base64.h"
#include "operator_console/export/little_endian.h"
#include "operator_console/render.h"

namespace shoal::console {
namespace {

constexpr const char* kFoxgloveFrame = "mission";

nlohmann::ordered_json xyz(double x, double y, double z) { return {{"x", x}, {"y", y}, {"z", z}}; }

const nlohmann::ordered_json& noTurn() {
  static const nlohmann::ordered_json kNone = {{"x", 0}, {"y", 0}, {"z", 0}, {"w", 1}};
  return kNone;
}

}  // namespace

uint64_t foxgloveTime(double seconds) {
  return static_cast<uint64_t>(std::llround(std::clamp(seconds, 0.0, 9e9) * 1e6)) * 1000;
}

nlohmann::ordered_json foxgloveStamp(uint64_t ns) {
  constexpr uint64_t kBillion = 1'000'000'000;
  return {{"sec", ns / kBillion}, {"nsec", ns % kBillion}};
}

nlohmann::ordered_json foxgloveCloud(std::span<const mapping::GlobalCell> cells, double cell_size_m,
                                     uint64_t ns) {
  constexpr int kUint8 = 1, kUint16 = 3, kInt32 = 6, kFloat32 = 7;  // foxglove.NumericType
  nlohmann::ordered_json fields = nlohmann::ordered_json::array();
  int stride = 0;
  const auto field = [&](const char* name, int type, int size) {
    fields.push_back({{"name", name}, {"offset", stride}, {"type", type}});
    stride += size;
  };
  for (const char* axis : {"x", "y", "z"}) field(axis, kFloat32, 4);
  for (const char* channel : {"red", "green", "blue", "alpha"}) field(channel, kUint8, 1);
  field("label", kInt32, 4);
  field("certainty", kFloat32, 4);
  field("robot", kUint16, 2);
  field("age", kFloat32, 4);
  const world::Grid grid(cell_size_m);
  world::Timestamp newest;
  for (const mapping::GlobalCell& c : cells) newest = std::max(newest, c.seen);
  std::string data;
  data.reserve(cells.size() * static_cast<size_t>(stride));
  for (const mapping::GlobalCell& c : cells) {
    const Eigen::Vector3d p = grid.centerOf(c.cell);
    for (const double coordinate : {p.x(), p.y(), p.z()})
      addLittleEndian(data, static_cast<float>(coordinate));
    for (const uint8_t channel : colorOf(c.label)) data += static_cast<char>(channel);
    data += '\xff';
    addLittleEndian(data, world::number(c.label));
    addLittleEndian(data, c.certainty);
    addLittleEndian(data, static_cast<uint16_t>(world::number(c.robot)));
    addLittleEndian(data, static_cast<float>(newest.seconds() - c.seen.seconds()));
  }
  return {{"timestamp", foxgloveStamp(ns)},
          {"frame_id", kFoxgloveFrame},
          {"pose", {{"position", xyz(0, 0, 0)}, {"orientation", noTurn()}}},
          {"point_stride", stride},
          {"fields", fields},
          {"data", base64(data)}};
}

nlohmann::ordered_json foxgloveTransform(const mapping::NodeStatus& node) {
  return {{"timestamp", foxgloveStamp(foxgloveTime(node.heard_s))},
          {"parent_frame_id", kFoxgloveFrame},
          {"child_frame_id", node.name},
          {"translation", xyz(node.x_m, node.y_m, node.z_m)},
          {"rotation", noTurn()}};
}

nlohmann::ordered_json foxgloveLog(uint64_t ns, bool is_bad, const std::string& text,
                                   const std::string& node) {
  constexpr int kInfo = 2, kWarning = 3;
  return {{"timestamp", foxgloveStamp(ns)},
          {"level", is_bad ? kWarning : kInfo},
          {"message", text},
          {"name", node},
          {"file", ""},
          {"line", 0}};
}

}  // namespace shoal::console
