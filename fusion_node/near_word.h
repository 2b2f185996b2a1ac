// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace shoal::fusion_node {

/// The word that was most likely meant by `word`: the first of those with fewest letters to put in, take out
/// or change. Empty when none has fewer of these than letters of `word`, or when more than `most` are needed.
std::string nearest(const std::string& word, std::span<const std::string> known, size_t most);

}  // namespace shoal::fusion_node
