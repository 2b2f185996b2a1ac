// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shoal/world/words_in_cells.h"

namespace shoal::eval {

using CellTruth = std::vector<std::pair<world::CellIndex, uint8_t>>;

/// Writes the words of a robot's images, compressed (zstd), under a key that says what they are of.
/// @throws std::runtime_error when the file cannot be written.
void writeWordFile(const std::string& path, uint64_t key, const std::vector<world::WordsInCells>& images);
void writeTruthFile(const std::string& path, uint64_t key, const CellTruth& truth);

/// What was written under this key; nothing when the file is not there, broken, or of another key.
std::optional<std::vector<world::WordsInCells>> readWordFile(const std::string& path, uint64_t key);
std::optional<CellTruth> readTruthFile(const std::string& path, uint64_t key);

}  // namespace shoal::eval
