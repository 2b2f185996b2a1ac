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
#include "operator_console/export/foxglove_messages.h"
#include "operator_console/export/foxglove_schemas.h"
#include "operator_console/export/mcap_writer.h"
#include "operator_console/render.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

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

void sayRobots(Topics& topics, const mapping::MissionView& view, const GeoFrame* frame) {
  for (const mapping::NodeStatus& node : view.nodes) {
    if (node.phase == "node" || node.observation < 0) continue;
    const uint64_t ns = foxgloveTime(node.heard_s);
    topics.say("/tf", "foxglove.FrameTransform", kFrameTransformSchema, ns, foxgloveTransform(node));
    if (frame == nullptr) continue;
    const auto at = frame->degreesOf(node.x_m, node.y_m);
    topics.say("/robots/" + node.name, "foxglove.LocationFix", kLocationFixSchema, ns,
               {{"timestamp", foxgloveStamp(ns)},
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
      const uint64_t ns = foxgloveTime(picture.seen.seconds());
      topics.say("/pictures/" + std::to_string(world::number(label)), "foxglove.CompressedImage",
                 kCompressedImageSchema, ns,
                 {{"timestamp", foxgloveStamp(ns)},
                  {"frame_id", name(picture.robot)},
                  {"data", base64(encodePng(fusion_node::pixelsOf(picture)))},
                  {"format", "png"}});
    }
  }
}

void sayEvents(Topics& topics, const Json& events) {
  const auto list = events.find("events");
  if (list == events.end()) return;
  for (const Json& event : *list) {
    const auto kind = event.at("kind").get<std::string>();
    const bool is_bad = kind == "lost" || kind == "twin" || kind == "refused" || kind == "mission";
    const uint64_t ns = foxgloveTime(event.at("at_s").get<double>());
    topics.say("/events", "foxglove.Log", kLogSchema, ns,
               foxgloveLog(ns, is_bad, event.at("says"), event.at("node")));
  }
}

}  // namespace

std::string missionMcap(const mapping::MissionView& view, const mapping::LabelPictures& pictures,
                        const Json& events, const GeoFrame* frame) {
  uint64_t end_ns = 0;
  for (const mapping::NodeStatus& node : view.nodes) end_ns = std::max(end_ns, foxgloveTime(node.heard_s));
  for (const mapping::GlobalCell& c : view.map.cells)
    end_ns = std::max(end_ns, foxgloveTime(c.seen.seconds()));
  Topics topics;
  sayEvents(topics, events);
  sayPictures(topics, pictures);
  sayRobots(topics, view, frame);
  topics.say("/map", "foxglove.PointCloud", kPointCloudSchema, end_ns,
             foxgloveCloud(view.map.cells, view.cell_size_m, end_ns));
  constexpr std::string_view kAnyObject = R"({"type":"object"})";
  topics.say("/labels", "shoal.Labels", kAnyObject, end_ns, mapping::labelsAnswer(view));
  topics.say("/status", "shoal.Status", kAnyObject, end_ns, mapping::statusAnswer(view));
  return topics.finish();
}

}  // namespace shoal::console
