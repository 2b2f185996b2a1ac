// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include "operator_console/reproduce.h"

namespace shoal::console {

/// Writes report.html, table.csv, by_robots.csv, by_images.csv, by_shares.csv and summary.json.
void writeReport(const Reproduction& reproduction);

/// What summary.json holds: docs/schemas/reproduce.schema.json.
nlohmann::ordered_json summaryOf(const Reproduction& reproduction);

}  // namespace shoal::console
