// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "shoal/world/world.h"

namespace shoal::world {

// For this room's .cc files: reading world.json and camera.json. All throw std::invalid_argument that names
// the file and what would be right.

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& why);

/// The object in a JSON file.
/// @param hint  what is said when the file is missing, as in "a world folder holds world.json".
nlohmann::json parseObject(const std::filesystem::path& file, const std::string& hint);

/// The text at `key`, which must be there; `meaning` says what it should be.
std::string text(const std::filesystem::path& file, const nlohmann::json& object, const char* key,
                 const std::string& meaning);

/// An integer in [low, high].
int integer(const std::filesystem::path& file, const nlohmann::json& value, int low, int high,
            const std::string& what);

/// A finite number.
double number(const std::filesystem::path& file, const nlohmann::json& value, const std::string& what);

/// "classes": [{id, name, rgb}, ..], not empty, ids distinct and in [0, 254].
std::vector<TruthClass> truthClasses(const std::filesystem::path& file, const nlohmann::json& object);

}  // namespace shoal::world
