// SPDX-License-Identifier: BSD-3-Clause
// Any numbers as the checkpoint of a model of labelled cells: refused with a reason, or a model whose own
// checkpoint is the very same. What is given replaces a sound checkpoint's numbers from the first that the
// first byte says; kind, version, identity and checksum are right, so that the fuzzer gets past them.
//
//     fuzz_checkpoint -max_total_time=60 -max_len=2048
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "shoal/topics/cell_label_model.h"
#include "shoal/topics/state_bytes.h"

namespace {

using namespace shoal;  // NOLINT: a main file
using topics::CellLabelModel;

const std::vector<world::WordGroup> kGroups{{"a", 0, 6}, {"b", 6, 4}};

std::optional<CellLabelModel> resumed(std::span<const uint8_t> checkpoint) {
  try {
    return CellLabelModel::resumed({}, kGroups, 7, world::RobotId{3}, checkpoint);
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

// A model that has seen a few cells.
std::vector<uint8_t> soundCheckpoint() {
  CellLabelModel model({}, kGroups, 7, world::RobotId{3});
  world::WordsInCells words;
  for (int x = 0; x < 6; ++x) words.cells.push_back({{x, 0, 0}, {{x % 3, 2}, {6 + x % 2, 1}}});
  model.observe(words);
  return model.checkpoint();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::vector<uint8_t> kSound = soundCheckpoint();
  constexpr size_t kFront = 8 + 4 + 8, kChecksum = 8;  // kind, version, identity; behind all
  if (size == 0) return 0;
  std::vector<uint8_t> bytes(kSound.begin(), kSound.end() - std::ptrdiff_t{kChecksum});
  const size_t from = kFront + 4 * static_cast<size_t>(data[0]);
  if (from < bytes.size()) {
    bytes.resize(from);
    bytes.insert(bytes.end(), data + 1, data + size);
  }
  topics::StateWriter whole("shoalCLM", 1);
  for (size_t at = 12; at + 4 <= bytes.size(); at += 4) {
    whole.u32(bytes[at] | uint32_t{bytes[at + 1]} << 8 | uint32_t{bytes[at + 2]} << 16 |
              uint32_t{bytes[at + 3]} << 24);
  }
  const std::vector<uint8_t> checkpoint = std::move(whole).finish();
  if (const auto model = resumed(checkpoint); model && model->checkpoint() != checkpoint) std::abort();
  resumed({data, size});
  return 0;
}
