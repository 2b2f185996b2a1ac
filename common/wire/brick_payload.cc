// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "shoal/demand.h"
#include "shoal/wire/cells_coder.h"
#include "shoal/wire/cut.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/part_coder.h"
#include "shoal/wire/payloads.h"

namespace shoal::wire {
namespace {

using mapping::BrickPart;
using mapping::CertaintyPart;
using mapping::Piece;

// What says which brick comes next, of what version: close to the one before.
class HeaderCoder {
 public:
  template <typename Coder>
  bool code(Coder& coder, Piece& piece) {
    auto& [x, y, z] = piece.key.index;
    const std::array<int32_t, 3> before = before_;
    int32_t& observation = piece.version.observation;
    if (first_) {
      for (int32_t* number : {&x, &y, &z})
        *number = unzigzag(static_cast<uint32_t>(codeWide(coder, zigzag(*number))));
      observation = static_cast<int32_t>(codeWide(coder, static_cast<uint64_t>(observation)));
      row_y_ = y;
      first_ = false;
    } else {
      x = forward(coder, x_, before[0], x);
      y = x == before[0] ? forward(coder, y_, before[1], y) : around(coder, row_, row_y_, y);
      if (x != before[0]) row_y_ = y;
      z = x == before[0] && y == before[1] ? forward(coder, above_, before[2] + 1, z)
                                           : around(coder, z_, before[2], z);
      observation = around(coder, version_, observation_, observation);
    }
    if (!parts_.code(coder, piece)) return false;
    before_ = piece.key.index;
    observation_ = observation;
    return isBrick(piece.key.index) && observation >= 0;
  }

 private:
  // Modulo 2^32 whatever is read; what cannot be is found by its range afterwards.
  template <typename Coder>
  static int32_t forward(Coder& coder, SmallNumber& model, int32_t from, int32_t to) {
    const uint32_t step = static_cast<uint32_t>(to) - static_cast<uint32_t>(from);
    return static_cast<int32_t>(static_cast<uint32_t>(from) + model.code(coder, step));
  }
  template <typename Coder>
  static int32_t around(Coder& coder, SmallNumber& model, int32_t from, int32_t to) {
    const auto step = static_cast<int32_t>(static_cast<uint32_t>(to) - static_cast<uint32_t>(from));
    const auto coded = static_cast<uint32_t>(unzigzag(model.code(coder, zigzag(step))));
    return static_cast<int32_t>(static_cast<uint32_t>(from) + coded);
  }

  bool first_ = true;
  std::array<int32_t, 3> before_{};
  int32_t row_y_ = 0, observation_ = 0;
  SmallNumber x_, y_, row_, above_, z_, version_;
  PartCoder parts_;
};

// Which bricks of what versions, then which of their cells. `ends` gets how many cells there are up to each
// brick's end.
template <typename Coder, typename OccupancyOf>
bool codeBricks(Coder& coder, std::span<Piece> pieces, OccupancyOf occupancy_of, CellField& field,
                std::vector<size_t>& ends) {
  HeaderCoder headers;
  for (size_t i = 0; i < pieces.size(); ++i) {
    if (!headers.code(coder, pieces[i]) || coder.overrun()) return false;
    if (i > 0 && !(pieces[i - 1].key.index < pieces[i].key.index)) return false;
  }
  GeometryCoder geometry;
  for (size_t i = 0; i < pieces.size(); ++i) {
    const size_t before = field.cells().size();
    if (!geometry.code(coder, pieces[i].key.index, occupancy_of(i), field)) return false;
    const size_t cells = field.cells().size();
    if (cells > kMaxCellsPerMessage || cells == before || coder.overrun()) return false;
    ends.push_back(cells);
  }
  return true;
}

// The pieces without their content, for codeBricks() to go through.
std::vector<Piece> headersOf(std::span<const Piece* const> pieces) {
  std::vector<Piece> headers;
  for (const Piece* piece : pieces)
    headers.push_back({piece->key, piece->version, piece->part, piece->num_parts, {}});
  return headers;
}

// Encodes where the cells of `pieces` are.
template <typename Part>
void encodeWhere(Encoder& encoder, std::span<const Piece* const> pieces, CellField& field) {
  std::vector<Piece> headers = headersOf(pieces);
  std::vector<size_t> ends;
  const auto occupancy = [&](size_t i) { return Occupancy::of(std::get<Part>(pieces[i]->content).cells); };
  SHOAL_DEMAND(codeBricks(encoder, headers, occupancy, field, ends));
}

template <typename Coder>
bool codeCertainties(Coder& coder, const CellField& field, Palette& steps, Palette& surprises) {
  return codePalette(coder, mapping::kCertaintySteps, mapping::kCertaintySteps + 1, steps.values) &&
         codeIndices(coder, field, steps.size(), Scale::kNames, steps.indices) &&
         codePalette(coder, mapping::kMostSurpriseSteps, mapping::kMostSurpriseSteps + 1, surprises.values) &&
         codeIndices(coder, field, surprises.size(), Scale::kNames, surprises.indices) && !coder.overrun();
}

template <typename Coder>
bool codeColumns(Coder& coder, const CellField& field, Palette& topics, Palette& times) {
  return codePalette(coder, world::kMaxTopicId, kMaxCellsPerMessage, topics.values) &&
         codeIndices(coder, field, topics.size(), Scale::kNames, topics.indices) &&
         codeTimes(coder, kMaxTimeUs, kMaxCellsPerMessage, times.values) &&
         codeIndices(coder, field, times.size(), Scale::kOrder, times.indices) && !coder.overrun();
}

bool decodeWhere(Decoder& decoder, std::span<Piece> pieces, CellField& field, std::vector<size_t>& ends) {
  return codeBricks(
      decoder, pieces, [](size_t) { return Occupancy{}; }, field, ends);
}

}  // namespace

Bytes encodeBricks(std::span<const Piece* const> pieces) {
  Encoder encoder;
  CellField field;
  encodeWhere<BrickPart>(encoder, pieces, field);
  std::vector<int64_t> topics, times;
  for (const Piece* piece : pieces) {
    for (const auto& c : std::get<BrickPart>(piece->content).cells) {
      topics.push_back(number(c.topic));
      times.push_back(c.seen.us);
    }
  }
  Palette topic_palette = Palette::of(std::move(topics)), time_palette = Palette::of(std::move(times));
  SHOAL_DEMAND(codeColumns(encoder, field, topic_palette, time_palette));
  return encoder.finish();
}

bool decodeBricks(std::span<const uint8_t> payload, std::span<Piece> pieces) {
  Decoder decoder(payload);
  CellField field;
  std::vector<size_t> ends;
  Palette topics, times;
  if (!decodeWhere(decoder, pieces, field, ends) || !codeColumns(decoder, field, topics, times)) return false;
  for (size_t i = 0, cell = 0; i < pieces.size(); ++i) {
    BrickPart brick;
    for (; cell < ends[i]; ++cell) {
      const world::TopicId topic{static_cast<int32_t>(topics.at(cell))};
      brick.cells.push_back({field.cells()[cell], topic, {times.at(cell)}});
    }
    pieces[i].content = std::move(brick);
  }
  return true;
}

Bytes encodeCertainties(std::span<const Piece* const> pieces) {
  Encoder encoder;
  CellField field;
  encodeWhere<CertaintyPart>(encoder, pieces, field);
  std::vector<int64_t> steps, surprises;
  for (const Piece* piece : pieces) {
    for (const auto& c : std::get<CertaintyPart>(piece->content).cells) {
      steps.push_back(c.steps);
      surprises.push_back(c.surprise);
    }
  }
  Palette step_palette = Palette::of(std::move(steps)), surprise_palette = Palette::of(std::move(surprises));
  SHOAL_DEMAND(codeCertainties(encoder, field, step_palette, surprise_palette));
  return encoder.finish();
}

bool decodeCertainties(std::span<const uint8_t> payload, std::span<Piece> pieces) {
  Decoder decoder(payload);
  CellField field;
  std::vector<size_t> ends;
  Palette steps, surprises;
  if (!decodeWhere(decoder, pieces, field, ends) || !codeCertainties(decoder, field, steps, surprises))
    return false;
  for (size_t i = 0, cell = 0; i < pieces.size(); ++i) {
    CertaintyPart part;
    for (; cell < ends[i]; ++cell) {
      part.cells.push_back({field.cells()[cell], static_cast<uint8_t>(steps.at(cell)),
                            static_cast<uint8_t>(surprises.at(cell))});
    }
    pieces[i].content = std::move(part);
  }
  return true;
}

}  // namespace shoal::wire
