// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "shoal/matching/association_graph.h"
#include "shoal/matching/descriptors.h"

namespace shoal::console {

/// What a file for `operator_console match` says.
struct MatchInput {
  std::variant<matching::AssociationGraph, matching::DescriptorSet> labels;
  std::vector<std::string> names;         ///< of the robots
  std::vector<int> num_labels;            ///< of each robot
  std::optional<std::string> matcher;     ///< only beside descriptors, as the next two
  std::optional<std::string> similarity;  ///< any string
  std::optional<double> sigma;            ///< in (0, 1]; none: "auto", or not said
  std::vector<std::string> warnings;
};

/// Largest file that is read, 128 MiB. 500 robots with 20 labels of 1000 words need about 100 MB.
inline constexpr std::size_t kMaxMatchFileBytes = std::size_t{128} << 20;

/// Reads and checks a file as runMatch() describes it. Stops reading at `max_bytes`, so it survives endless
/// input.
/// @throws std::invalid_argument: one line that names the place in the file, and what would be right there.
MatchInput readMatchInput(std::istream& in, std::size_t max_bytes = kMaxMatchFileBytes);

}  // namespace shoal::console
