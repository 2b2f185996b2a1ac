// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "operator_console/export/geo_frame.h"
#include "operator_console/export/zip.h"
#include "operator_console/mission_sources.h"

namespace shoal::console {

/// A format that a map is written in.
struct ExportFormat {
  std::string name;                      ///< as --format takes it
  std::string file;                      ///< what its file is called: "map.ply"
  std::string what;                      ///< for people
  std::vector<std::string> beside = {};  ///< what more comes with it
  enum class Origin { kNone, kTaken, kNeeded } origin = Origin::kNone;
};

const std::vector<ExportFormat>& exportFormats();

/// The format of that name. @throws std::invalid_argument naming those that there are.
const ExportFormat& exportFormat(const std::string& name);

/// What an export wrote.
struct Export {
  std::vector<ExportedFile> files;
  size_t cells = 0;   ///< of the map
  size_t labels = 0;  ///< of its legend
};

/// The map of a mission as files, the one that was asked for first, called `file`; those beside it are called
/// after it. Coordinates are metres of the mission frame, and with an origin, in the formats that take one,
/// places on Earth (WGS 84).
/// @throws std::invalid_argument for an unknown format, a wrong origin, one that the format does not take, or
/// none
///         where it needs one; std::runtime_error as viewOf(), and for a map too large for the format.
Export exported(const Where& where, const std::string& format, const std::string& file,
                const std::optional<GeoOrigin>& origin = {});

}  // namespace shoal::console
