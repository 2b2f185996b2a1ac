// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/export/mcap_export.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>
#include <vector>

#include "fusion_node/picture_files.h"
#include "operator_console/base64.h"
#include "operator_console/export/foxglove_schemas.h"
#include "operator_console/export/little_endian.h"
#include "operator_console/export/mcap_writer.h"
#include "operator_console/render.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kMissionFrame = "mission";
constexpr uint64_t kBillion = 1'000'000'000;

uint64_t nanoseconds(world::Timestamp time) {
  return static_cast<uint64_t>(std::max<int64_t>(0, time.us)) * 1000;
}
uint64_t nanoseconds(double s) {
  return static_cast<uint64_t>(std::llround(std::clamp(s, 0.0, 9e9) * 1e6)) * 1000;
}

Json mcapStamp(uint64_t ns) { return {{"sec", ns / kBillion}, {"nsec", ns % kBillion}}; }
Json mcapPoint(double x, double y, double z) { return {{"x", x}, {"y", y}, {"z", z}}; }
const Json kNoTurn = {{"x", 0}, {"y", 0}, {"z", 0}, {"w", 1}};

// Messages in order of time; topics are declared as they come.
class Topics {
 public:
  void say(const std::string& topic, const char* schema_name, std::string_view schema, uint64_t ns,
           const Json& message) {
    auto known = channels_.find(topic);
    if (known == channels_.end())
      known = channels_.emplace(topic, writer_.channel(topic, schema_name, schema)).first;
    said_.emplace_back(ns, known->second, message.dump(-1, ' ', false, Json::error_handler_t::replace));
  }
  std::string finish() {
    std::ranges::stable_sort(said_, {}, [](const auto& message) { return std::get<0>(message); });
    for (const auto& [ns, channel, json] : said_) writer_.say(channel, ns, json);
    return writer_.finish();
  }

 private:
  McapWriter writer_;
  std::map<std::string, uint16_t> channels_;
  std::vector<std::tuple<uint64_t, uint16_t, std::string>> said_;
};

Json cloudOf(const mapping::MissionView& view, uint64_t ns) {
  constexpr int kUint8 = 1, kUint16 = 3, kInt32 = 6, kFloat32 = 7;  // foxglove.NumericType
  Json fields = Json::array();
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
  const world::Grid grid(view.cell_size_m);
  world::Timestamp newest;
  for (const mapping::GlobalCell& c : view.map.cells) newest = std::max(newest, c.seen);
  std::string data;
  data.reserve(view.map.cells.size() * static_cast<size_t>(stride));
  for (const mapping::GlobalCell& c : view.map.cells) {
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
  return {{"timestamp", mcapStamp(ns)},
          {"frame_id", kMissionFrame},
          {"pose", {{"position", mcapPoint(0, 0, 0)}, {"orientation", kNoTurn}}},
          {"point_stride", stride},
          {"fields", fields},
          {"data", base64(data)}};
}

void sayRobots(Topics& topics, const mapping::MissionView& view, const GeoFrame* frame) {
  for (const mapping::NodeStatus& node : view.nodes) {
    if (node.phase == "node" || node.observation < 0) continue;
    const uint64_t ns = nanoseconds(node.heard_s);
    topics.say("/tf", "foxglove.FrameTransform", kFrameTransformSchema, ns,
               {{"timestamp", mcapStamp(ns)},
                {"parent_frame_id", kMissionFrame},
                {"child_frame_id", node.name},
                {"translation", mcapPoint(node.x_m, node.y_m, node.z_m)},
                {"rotation", kNoTurn}});
    if (frame == nullptr) continue;
    const auto at = frame->degreesOf(node.x_m, node.y_m);
    topics.say("/robots/" + node.name, "foxglove.LocationFix", kLocationFixSchema, ns,
               {{"timestamp", mcapStamp(ns)},
                {"frame_id", node.name},
                {"latitude", at.latitude},
                {"longitude", at.longitude},
                {"altitude", node.z_m},
                {"position_covariance", Json::array({0, 0, 0, 0, 0, 0, 0, 0, 0})},
                {"position_covariance_type", 0}});  // unknown
  }
}

void sayPictures(Topics& topics, const mapping::LabelPictures& pictures) {
  for (const auto& [label, of_label] : pictures) {
    for (const mapping::HeldPicture& picture : of_label) {
      const uint64_t ns = nanoseconds(picture.seen);
      topics.say("/pictures/" + std::to_string(world::number(label)), "foxglove.CompressedImage",
                 kCompressedImageSchema, ns,
                 {{"timestamp", mcapStamp(ns)},
                  {"frame_id", name(picture.robot)},
                  {"data", base64(encodePng(fusion_node::pixelsOf(picture)))},
                  {"format", "png"}});
    }
  }
}

void sayEvents(Topics& topics, const Json& events) {
  constexpr int kInfo = 2, kWarning = 3;
  const auto list = events.find("events");
  if (list == events.end()) return;
  for (const Json& event : *list) {
    const auto kind = event.at("kind").get<std::string>();
    const bool is_bad = kind == "lost" || kind == "twin" || kind == "refused" || kind == "mission";
    const uint64_t ns = nanoseconds(event.at("at_s").get<double>());
    topics.say("/events", "foxglove.Log", kLogSchema, ns,
               {{"timestamp", mcapStamp(ns)},
                {"level", is_bad ? kWarning : kInfo},
                {"message", event.at("says")},
                {"name", event.at("node")},
                {"file", ""},
                {"line", 0}});
  }
}

}  // namespace

std::string missionMcap(const mapping::MissionView& view, const mapping::LabelPictures& pictures,
                        const Json& events, const GeoFrame* frame) {
  uint64_t end_ns = 0;
  for (const mapping::NodeStatus& node : view.nodes) end_ns = std::max(end_ns, nanoseconds(node.heard_s));
  for (const mapping::GlobalCell& c : view.map.cells) end_ns = std::max(end_ns, nanoseconds(c.seen));
  Topics topics;
  sayEvents(topics, events);
  sayPictures(topics, pictures);
  sayRobots(topics, view, frame);
  topics.say("/map", "foxglove.PointCloud", kPointCloudSchema, end_ns, cloudOf(view, end_ns));
  constexpr std::string_view kAnyObject = R"({"type":"object"})";
  topics.say("/labels", "shoal.Labels", kAnyObject, end_ns, mapping::labelsAnswer(view));
  topics.say("/status", "shoal.Status", kAnyObject, end_ns, mapping::statusAnswer(view));
  return topics.finish();
}

}  // namespace shoal::console
