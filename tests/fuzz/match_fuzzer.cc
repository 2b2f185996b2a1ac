// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a file for `operator_console match`: what is wrong is said in one line, what is read is whole.
//
//     fuzz_match -max_total_time=60 -max_len=4096
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "operator_console/match_input.h"

namespace {

constexpr size_t kMaxBytes = 3000;  // smaller than the longest input: the cap is reached too

bool isSound(const shoal::console::MatchInput& input) {
  if (input.names.size() != input.num_labels.size()) return false;
  const auto* graph = std::get_if<shoal::matching::AssociationGraph>(&input.labels);
  if (graph == nullptr) return true;
  const int num_labels = std::accumulate(graph->num_topics.begin(), graph->num_topics.end(), 0);
  for (const auto& edge : graph->edges) {
    if (edge.i < 0 || edge.j < 0 || edge.i >= num_labels || edge.j >= num_labels) return false;
  }
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::istringstream in(std::string(reinterpret_cast<const char*>(data), size));
  try {
    if (!isSound(shoal::console::readMatchInput(in, kMaxBytes))) std::abort();
  } catch (const std::invalid_argument& error) {
    if (std::string_view(error.what()).empty()) std::abort();
  }
  return 0;
}
