// SPDX-License-Identifier: BSD-3-Clause
// The file of a link: docs/link.md.
#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "shoal/comms/link_model.h"

namespace shoal::comms {
namespace {

using nlohmann::json;
using Reader = std::function<void(const json& value, const std::string& field)>;
using Fields = std::map<std::string, Reader>;

[[noreturn]] void refuse(const std::string& field, const std::string& should, const json& got) {
  throw std::invalid_argument('"' + field + "\" must be " + should + ", got " + got.dump());
}

double number(const json& value, const std::string& field) {
  if (!value.is_number()) refuse(field, "a number", value);
  return value.get<double>();
}

Reader into(double& target) {
  return [&target](const json& value, const std::string& field) { target = number(value, field); };
}

// Every key of `object` is read by the reader of its name; a key that has none is a mistake.
void readObject(const json& object, const std::string& field, const Fields& fields) {
  if (!object.is_object()) refuse(field, "an object", object);
  for (const auto& [key, value] : object.items()) {
    const auto reader = fields.find(key);
    if (reader == fields.end()) {
      std::string known;
      for (const auto& [name, unused] : fields) known += (known.empty() ? "" : ", ") + name;
      throw std::invalid_argument('"' + field + key + "\" is not known; there are " + known);
    }
    reader->second(value, field + key);
  }
}

void readGroups(const json& value, const std::string& field, Partition& partition) {
  const auto isGroup = [](const json& group) {
    return group.is_array() &&
           std::all_of(group.begin(), group.end(), [](const json& node) { return node.is_string(); });
  };
  if (!value.is_array() || !std::all_of(value.begin(), value.end(), isGroup)) {
    refuse(field, "a list of lists of nodes, as in [[\"R00\"], [\"R01\", \"OPERATOR\"]]", value);
  }
  partition.groups = value.get<std::vector<std::vector<std::string>>>();
}

Partition readPartition(const json& value, const std::string& field) {
  Partition partition;
  readObject(value, field + ".",
             {{"from_s", into(partition.from_s)},
              {"until_s", into(partition.until_s)},
              {"groups", [&partition](const json& groups, const std::string& at) {
                 readGroups(groups, at, partition);
               }}});
  return partition;
}

LinkModel linkFrom(const json& object) {
  LinkModel link;
  if (!object.is_object()) throw std::invalid_argument("a link is a JSON object");
  if (const auto like = object.find("like"); like != object.end()) {
    const auto preset = like->is_string() ? linkPreset(like->get<std::string>()) : std::nullopt;
    if (!preset) refuse("like", "clean, mesh, acoustic or satellite", *like);
    link = *preset;
  }
  const Fields bursts = {{"good_s", into(link.bursts.good_s)},
                         {"bad_s", into(link.bursts.bad_s)},
                         {"loss", into(link.bursts.loss)}};
  readObject(object, "",
             {{"like", [](const json&, const std::string&) {}},
              {"rate_bytes_per_s", into(link.rate_bytes_per_s)},
              {"queue_s", into(link.queue_s)},
              {"delay_s", into(link.delay_s)},
              {"jitter_s", into(link.jitter_s)},
              {"loss", into(link.loss)},
              {"bursts",
               [&](const json& value, const std::string& field) { readObject(value, field + ".", bursts); }},
              {"reordering", into(link.reordering)},
              {"duplication", into(link.duplication)},
              {"late_s", into(link.late_s)},
              {"range_m", into(link.range_m)},
              {"base_m",
               [&](const json& value, const std::string& field) {
                 if (!value.is_array() || value.size() != 3)
                   refuse(field, "three numbers, x y z in metres", value);
                 link.base_m = {number(value[0], field), number(value[1], field), number(value[2], field)};
               }},
              {"partitions", [&](const json& value, const std::string& field) {
                 if (!value.is_array()) refuse(field, "a list", value);
                 for (size_t i = 0; i < value.size(); ++i) {
                   link.partitions.push_back(readPartition(value[i], field + '[' + std::to_string(i) + ']'));
                 }
               }}});
  check(link);
  return link;
}

}  // namespace

LinkModel parseLink(const std::string& text, const std::string& origin) {
  try {
    return linkFrom(json::parse(text, nullptr, true, /*ignore_comments=*/true));
  } catch (const json::exception& error) {
    throw std::invalid_argument("the link " + origin + ": broken JSON: " + error.what());
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("the link " + origin + ": " + error.what());
  }
}

LinkModel readLink(const std::string& name_or_file) {
  if (const auto preset = linkPreset(name_or_file)) return *preset;
  std::ifstream file(name_or_file);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) {
    throw std::invalid_argument("the link " + name_or_file +
                                " is neither clean, mesh, acoustic or satellite nor a file that can be read");
  }
  return parseLink(text.str(), name_or_file);
}

}  // namespace shoal::comms
