// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/json_fields.h"

#include <cmath>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include <nlohmann/json.hpp>

namespace shoal::world {

using nlohmann::json;
namespace fs = std::filesystem;

void refuse(const fs::path& file, const std::string& why) {
  throw std::invalid_argument(file.string() + ": " + why);
}

json parseObject(const fs::path& file, const std::string& hint) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) refuse(file, "not found; " + hint);
  std::ifstream in(file);
  if (!in) refuse(file, "cannot be read");
  try {
    json parsed = json::parse(in);  // its message has line and column
    if (!parsed.is_object()) refuse(file, "must be a JSON object, got " + std::string(parsed.type_name()));
    return parsed;
  } catch (const json::exception& e) {
    refuse(file, std::string("broken JSON: ") + e.what());
  }
}

std::string text(const fs::path& file, const json& object, const char* key, const std::string& meaning) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_string() || found->get<std::string>().empty()) {
    refuse(file, std::string("\"") + key + "\" must be " + meaning);
  }
  return found->get<std::string>();
}

int integer(const fs::path& file, const json& value, int low, int high, const std::string& what) {
  const bool good = value.is_number_integer() && value.get<double>() >= low && value.get<double>() <= high;
  if (!good) {
    refuse(file, what + " must be an integer in [" + std::to_string(low) + ", " + std::to_string(high) +
                     "], got " + value.dump());
  }
  return value.get<int>();
}

double number(const fs::path& file, const json& value, const std::string& what) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) {
    refuse(file, what + " must be a number, got " + value.dump());
  }
  return value.get<double>();
}

std::vector<TruthClass> truthClasses(const fs::path& file, const json& object) {
  const auto listed = object.find("classes");
  if (listed == object.end() || !listed->is_array() || listed->empty()) {
    refuse(file, "\"classes\" must list {id, name, rgb} for the ids in \"labels\"");
  }
  std::vector<TruthClass> classes;
  for (const json& entry : *listed) {
    const std::string where = "classes[" + std::to_string(classes.size()) + "]";
    if (!entry.is_object()) refuse(file, where + " must be an object with id, name and rgb");
    TruthClass c;
    c.id = integer(file, entry.value("id", json()), 0, 254, where + ".id");
    for (const TruthClass& other : classes) {
      if (other.id == c.id)
        refuse(file, where + ".id must be distinct, got " + std::to_string(c.id) + " again");
    }
    c.name = text(file, entry, "name", "the name of " + where);
    const json rgb = entry.value("rgb", json());
    if (!rgb.is_array() || rgb.size() != 3) refuse(file, where + ".rgb must be three integers in [0, 255]");
    for (size_t i = 0; i < 3; ++i) {
      c.rgb[i] =
          static_cast<uint8_t>(integer(file, rgb[i], 0, 255, where + ".rgb[" + std::to_string(i) + "]"));
    }
    classes.push_back(std::move(c));
  }
  return classes;
}

}  // namespace shoal::world
