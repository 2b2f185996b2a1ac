// SPDX-License-Identifier: BSD-3-Clause
// Any numbers as the checkpoint of a model of labelled cells, and of labelled words: refused with a reason,
// or a model whose own checkpoint is the very same. What is given replaces a sound checkpoint's numbers from
// the first that the first byte says; kind, version, identity and checksum are right, so that the fuzzer gets
// past them.
//
//     fuzz_checkpoint -max_total_time=60 -max_len=2048
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "shoal/topics/cell_label_model.h"
#include "shoal/topics/state_bytes.h"
#include "shoal/topics/topic_model.h"

namespace {

using namespace shoal;  // NOLINT: a main file
using topics::CellLabelModel;
using topics::TopicModel;

const std::vector<world::WordGroup> kGroups{{"a", 0, 6}, {"b", 6, 4}};

// A few cells.
world::WordsInCells image() {
  world::WordsInCells words;
  for (int x = 0; x < 6; ++x) words.cells.push_back({{x, 0, 0}, {{x % 3, 2}, {6 + x % 2, 1}}});
  return words;
}

struct OfCells {
  static constexpr const char* kKind = "shoalCLM";
  static constexpr uint32_t kVersion = 4;
  static CellLabelModel made() { return {{}, kGroups, 7, world::RobotId{3}}; }
  static CellLabelModel resumed(std::span<const uint8_t> bytes) {
    return CellLabelModel::resumed({}, kGroups, 7, world::RobotId{3}, bytes);
  }
};

struct OfWords {
  static constexpr const char* kKind = "shoalTPM";
  static constexpr uint32_t kVersion = 3;
  static TopicModel made() { return {{}, 10, 7, world::RobotId{3}}; }
  static TopicModel resumed(std::span<const uint8_t> bytes) {
    return TopicModel::resumed({}, 10, 7, world::RobotId{3}, bytes);
  }
};

template <typename Model>
std::optional<std::vector<uint8_t>> checkpointOfResumed(std::span<const uint8_t> checkpoint) {
  try {
    return Model::resumed(checkpoint).checkpoint();
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

template <typename Model>
void tryAll(const uint8_t* data, size_t size) {
  static const std::vector<uint8_t> kSound = [] {
    auto model = Model::made();
    model.observe(image());
    return model.checkpoint();
  }();
  constexpr size_t kFront = 8 + 4 + 8, kChecksum = 8;  // kind, version, identity; behind all
  std::vector<uint8_t> bytes(kSound.begin(), kSound.end() - std::ptrdiff_t{kChecksum});
  const size_t from = kFront + 4 * static_cast<size_t>(data[0]);
  if (from < bytes.size()) {
    bytes.resize(from);
    bytes.insert(bytes.end(), data + 1, data + size);
  }
  topics::StateWriter whole(Model::kKind, Model::kVersion);
  for (size_t at = 12; at + 4 <= bytes.size(); at += 4) {
    whole.u32(bytes[at] | uint32_t{bytes[at + 1]} << 8 | uint32_t{bytes[at + 2]} << 16 |
              uint32_t{bytes[at + 3]} << 24);
  }
  const std::vector<uint8_t> checkpoint = std::move(whole).finish();
  if (const auto again = checkpointOfResumed<Model>(checkpoint); again && *again != checkpoint) std::abort();
  checkpointOfResumed<Model>({data, size});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  tryAll<OfCells>(data, size);
  tryAll<OfWords>(data, size);
  return 0;
}
