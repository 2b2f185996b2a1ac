// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/picture_coder.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "shoal/demand.h"
#include "shoal/wire/numbers.h"
#include "shoal/wire/range_coder.h"
#include "shoal/wire/wavelet.h"

namespace shoal::wire {
namespace {

constexpr int kLow = 4;  // edge of the band that is left when nothing more is split
constexpr int kChromaEdge = kPictureEdge / 2;
constexpr int kQualities = 32;      // of the quantiser; 0 is the finest
constexpr int kFinest = 8;          // finer is more than anybody sees
constexpr int kMostBits = 7;        // of every number that the first layer may leave to the second
constexpr int32_t kLargest = 4095;  // no honest quantised coefficient is above; also bounds hostile ones

// Luma and two chroma planes as wavelet coefficients, quantised or not.
struct Planes {
  std::array<Square, 3> plane = {Square(kPictureEdge), Square(kChromaEdge), Square(kChromaEdge)};
};

// Part of a plane: which numbers of it belong to one band.
struct Band {
  int x = 0, y = 0, edge = 0;
  bool is_low = false, is_diagonal = false;
};

// Coarse to fine.
std::vector<Band> bandsOf(int plane_edge) {
  std::vector<Band> bands = {{0, 0, kLow, true, false}};
  for (int n = kLow; n < plane_edge; n *= 2) {
    bands.push_back({n, 0, n, false, false});
    bands.push_back({0, n, n, false, false});
    bands.push_back({n, n, n, false, true});
  }
  return bands;
}

bool isFinest(const Band& band, int plane_edge) { return 2 * band.edge == plane_edge; }

// The quantiser's step in 1/128. An error in a coarse band is seen in many pixels: finer steps there. Chroma
// is coarser.
int32_t stepOf(int quality, const Band& band, bool is_chroma) {
  constexpr std::array<int32_t, 4> kQuarterOctaves = {16, 19, 23, 27};
  const int32_t step = kQuarterOctaves[static_cast<size_t>(quality % 4)] << (quality / 4);
  int32_t weight = 0;
  if (is_chroma) {
    weight = band.is_low ? 4 : band.edge == kLow ? (band.is_diagonal ? 8 : 6) : (band.is_diagonal ? 18 : 12);
  } else {
    weight = band.is_low         ? 2
             : band.edge == kLow ? (band.is_diagonal ? 4 : 3)
             : band.edge == 8    ? (band.is_diagonal ? 8 : 5)
             : band.is_diagonal  ? 12
                                 : 8;
  }
  return step * weight;
}

int32_t quantized(int32_t value, int32_t step, bool is_low) {
  if (is_low) {  // rounds down, as its low bits are cut off later
    const int32_t scaled = value * 128;
    return scaled >= 0 ? scaled / step : -((-scaled + step - 1) / step);
  }
  const int32_t level = std::min(std::abs(value) * 128 / step, kLargest);
  return value < 0 ? -level : level;
}

// The middle of what quantises to `level` when its low `cut` bits are not known. Honest values are small;
// hostile ones are kept so small that no sum overflows.
int32_t restored(int32_t level, int cut, int32_t step, bool is_low) {
  constexpr int64_t kMost = 32767;
  const int64_t wide_step = int64_t{step} << cut;
  if (is_low) {
    return static_cast<int32_t>(std::clamp((2 * int64_t{level >> cut} + 1) * wide_step / 256, -kMost, kMost));
  }
  const int64_t magnitude = std::abs(level) >> cut;
  if (magnitude == 0) return 0;
  // A little below the middle: small coefficients are more frequent.
  const auto value = static_cast<int32_t>(std::min((8 * magnitude + 3) * wide_step / (8 * 128), kMost));
  return level < 0 ? -value : value;
}

// Codes levels, to and from `levels`. Both directions, as all codecs of this room.
template <typename Coder>
class LevelCoder {
 public:
  explicit LevelCoder(Coder& coder) : coder_(coder) {}

  // A whole band, its low `cut` bits left out.
  void code(Square& levels, const Band& band, bool is_chroma, int cut) {
    for (int y = 0; y < band.edge; ++y) {
      for (int x = 0; x < band.edge; ++x) {
        int32_t& level = levels.at(band.x + x, band.y + y);
        level = band.is_low ? lowLevel(x, y, is_chroma, level >> cut) * (1 << cut)
                            : detail(levels, band, x, y, is_chroma, cut, level);
      }
    }
  }

  // The low `cut` bits of a band whose others are known.
  void refine(const Square& coarse, Square& levels, const Band& band, bool is_chroma, int cut) {
    if (cut == 0) return;
    for (int y = 0; y < band.edge; ++y) {
      for (int x = 0; x < band.edge; ++x) {
        const int32_t known = coarse.at(band.x + x, band.y + y);
        int32_t& level = levels.at(band.x + x, band.y + y);
        const int32_t mask = (1 << cut) - 1;
        if (band.is_low) {
          level = known + static_cast<int32_t>(coder_.direct(static_cast<uint64_t>(level - known), cut));
        } else if (known == 0) {
          level = detail(levels, band, x, y, is_chroma, 0, level);
          level = std::clamp(level, -mask, mask);
        } else {
          const int32_t magnitude =
              std::abs(known) + static_cast<int32_t>(coder_.direct(
                                    static_cast<uint64_t>(std::abs(level) - std::abs(known)), cut));
          level = known < 0 ? -magnitude : magnitude;
        }
      }
    }
  }

 private:
  // The lowest band differs little from place to place.
  int32_t lowLevel(int x, int y, bool is_chroma, int32_t level) {
    int32_t expected = 0;
    if (x > 0 && y > 0) {
      const int32_t w = last_[at(x - 1, y)], n = last_[at(x, y - 1)], nw = last_[at(x - 1, y - 1)];
      expected = std::clamp(w + n - nw, std::min(w, n), std::max(w, n));
    } else if (x > 0 || y > 0) {
      expected = x > 0 ? last_[at(x - 1, y)] : last_[at(x, y - 1)];
    }
    const uint32_t coded = low_[is_chroma ? 1 : 0].code(coder_, zigzag(level - expected));
    const int32_t found = std::clamp(expected + unzigzag(coded & 0xffffu), -kLargest, kLargest);
    last_[at(x, y)] = found;
    return found;
  }
  static size_t at(int x, int y) { return static_cast<size_t>(y * kLow + x); }

  int32_t detail(const Square& levels, const Band& band, int x, int y, bool is_chroma, int cut,
                 int32_t level) {
    const auto near = [&](int dx, int dy) {
      const int nx = x + dx, ny = y + dy;
      if (nx < 0 || ny < 0 || nx >= band.edge) return 0;
      return std::abs(levels.at(band.x + nx, band.y + ny)) >> cut;
    };
    const int32_t around = 2 * near(-1, 0) + 2 * near(0, -1) + near(-1, -1) + near(1, -1);
    const size_t busy = around == 0 ? 0 : around <= 2 ? 1 : around <= 5 ? 2 : around <= 11 ? 3 : 4;
    // The same place one band up; below the coarsest there is none.
    const int32_t above =
        band.edge == kLow ? 0 : std::abs(levels.at((band.x + x) / 2, (band.y + y) / 2)) >> cut;
    const size_t parent = above == 0 ? 0 : above <= 2 ? 1 : 2;
    SmallNumber& model = detail_[is_chroma ? 1 : 0][busy][parent];
    const auto coded =
        std::min<uint32_t>(model.code(coder_, static_cast<uint32_t>(std::abs(level) >> cut)), kLargest);
    if (coded == 0) return 0;
    const bool is_negative = coder_.direct(level < 0 ? 1 : 0, 1) != 0;
    const int32_t magnitude = std::min(static_cast<int32_t>(coded) * (1 << cut), kLargest);
    return is_negative ? -magnitude : magnitude;
  }

  Coder& coder_;
  std::array<SmallNumber, 2> low_;
  std::array<std::array<std::array<SmallNumber, 3>, 5>, 2> detail_;
  std::array<int32_t, size_t{kLow} * kLow> last_{};
};

// Calls for each band in coding order: coarse before fine, luma before chroma.
template <typename Visitor>
void visitBands(bool finest, Visitor&& visitor) {
  for (size_t p = 0; p < 3; ++p) {
    const int edge = p == 0 ? kPictureEdge : kChromaEdge;
    for (const Band& band : bandsOf(edge)) {
      if (isFinest(band, edge) == finest) visitor(p, band);
    }
  }
}

template <typename Coder>
void codeFirst(Coder& coder, Planes& levels, int cut) {
  LevelCoder<Coder> code(coder);
  visitBands(false, [&](size_t p, const Band& band) { code.code(levels.plane[p], band, p > 0, cut); });
}

template <typename Coder>
void codeSecond(Coder& coder, const Planes& coarse, Planes& levels, int cut) {
  LevelCoder<Coder> code(coder);
  visitBands(false, [&](size_t p, const Band& band) {
    code.refine(coarse.plane[p], levels.plane[p], band, p > 0, cut);
  });
  visitBands(true, [&](size_t p, const Band& band) { code.code(levels.plane[p], band, p > 0, 0); });
}

Planes planesOf(std::span<const uint8_t> rgb) {
  Planes planes;
  std::array<Square, 2> full = {Square(kPictureEdge), Square(kPictureEdge)};
  for (int y = 0; y < kPictureEdge; ++y) {
    for (int x = 0; x < kPictureEdge; ++x) {
      const size_t i = 3 * static_cast<size_t>(y * kPictureEdge + x);
      const int32_t r = rgb[i], g = rgb[i + 1], b = rgb[i + 2];
      const int32_t orange = r - b, middle = b + (orange >> 1), green = g - middle;
      planes.plane[0].at(x, y) = middle + (green >> 1) - 128;
      full[0].at(x, y) = orange;
      full[1].at(x, y) = green;
    }
  }
  for (size_t p = 0; p < 2; ++p) {
    for (int y = 0; y < kChromaEdge; ++y) {
      for (int x = 0; x < kChromaEdge; ++x) {
        const Square& from = full[p];
        planes.plane[p + 1].at(x, y) = (from.at(2 * x, 2 * y) + from.at(2 * x + 1, 2 * y) +
                                        from.at(2 * x, 2 * y + 1) + from.at(2 * x + 1, 2 * y + 1) + 2) >>
                                       2;
      }
    }
  }
  for (Square& plane : planes.plane) analyze(plane, kLow);
  return planes;
}

// Between the centres of four numbers, three parts of the nearer to one of the farther.
int32_t enlarged(const Square& small, int x, int y) {
  const auto clamped = [&](int i) { return std::clamp(i, 0, small.edge - 1); };
  const int x0 = x / 2, y0 = y / 2;
  const int x1 = clamped(x0 + (x % 2 == 0 ? -1 : 1)), y1 = clamped(y0 + (y % 2 == 0 ? -1 : 1));
  return (9 * small.at(x0, y0) + 3 * small.at(x1, y0) + 3 * small.at(x0, y1) + small.at(x1, y1) + 8) >> 4;
}

std::vector<uint8_t> rgbOf(Planes planes) {
  for (Square& plane : planes.plane) synthesize(plane, kLow);
  std::vector<uint8_t> rgb(kPictureBytes);
  const auto byte = [](int32_t value) { return static_cast<uint8_t>(std::clamp(value, 0, 255)); };
  for (int y = 0; y < kPictureEdge; ++y) {
    for (int x = 0; x < kPictureEdge; ++x) {
      const int32_t orange = enlarged(planes.plane[1], x, y), green = enlarged(planes.plane[2], x, y);
      const int32_t middle = planes.plane[0].at(x, y) + 128 - (green >> 1);
      const int32_t blue = middle - (orange >> 1);
      const size_t i = 3 * static_cast<size_t>(y * kPictureEdge + x);
      rgb[i] = byte(blue + orange);
      rgb[i + 1] = byte(green + middle);
      rgb[i + 2] = byte(blue);
    }
  }
  return rgb;
}

Planes quantize(const Planes& planes, int quality) {
  Planes levels;
  for (const bool finest : {false, true}) {
    visitBands(finest, [&](size_t p, const Band& band) {
      const int32_t step = stepOf(quality, band, p > 0);
      for (int y = band.y; y < band.y + band.edge; ++y)
        for (int x = band.x; x < band.x + band.edge; ++x)
          levels.plane[p].at(x, y) = quantized(planes.plane[p].at(x, y), step, band.is_low);
    });
  }
  return levels;
}

Planes dequantize(const Planes& levels, int quality, int cut, bool is_sharp) {
  Planes planes;
  for (const bool finest : {false, true}) {
    visitBands(finest, [&](size_t p, const Band& band) {
      const int32_t step = stepOf(quality, band, p > 0);
      for (int y = band.y; y < band.y + band.edge; ++y)
        for (int x = band.x; x < band.x + band.edge; ++x)
          planes.plane[p].at(x, y) =
              restored(levels.plane[p].at(x, y), is_sharp ? 0 : cut, step, band.is_low);
    });
  }
  return planes;
}

struct PictureHeader {
  int quality = 0, cut = 0;
};

template <typename Coder>
PictureHeader codeHeader(Coder& coder, const PictureHeader& header) {
  return {static_cast<int>(coder.direct(static_cast<uint64_t>(header.quality), 5)),
          static_cast<int>(coder.direct(static_cast<uint64_t>(header.cut), 3))};
}

Bytes encodeFirst(const Planes& levels, const PictureHeader& header, Planes& coarse) {
  coarse = levels;
  Encoder encoder;
  codeHeader(encoder, header);
  codeFirst(encoder, coarse, header.cut);
  return encoder.finish();
}

Bytes encodeSecond(const Planes& coarse, const Planes& levels, int cut) {
  Planes fine = levels;
  Encoder encoder;
  codeSecond(encoder, coarse, fine, cut);
  return encoder.finish();
}

}  // namespace

std::vector<Bytes> encodePicture(std::span<const uint8_t> rgb, const PictureSizes& sizes) {
  if (rgb.size() != kPictureBytes) {
    throw std::invalid_argument("a picture has " + std::to_string(kPictureBytes) + " bytes of pixels, got " +
                                std::to_string(rgb.size()));
  }
  if (sizes.first < 64 || sizes.second < 64) {
    throw std::invalid_argument("a layer of a picture needs 64 bytes, allowed are " +
                                std::to_string(std::min(sizes.first, sizes.second)));
  }
  const Planes planes = planesOf(rgb);
  for (int quality = kFinest; quality < kQualities; ++quality) {
    const Planes levels = quantize(planes, quality);
    for (int cut = 0; cut <= kMostBits; ++cut) {
      Planes coarse;
      Bytes first = encodeFirst(levels, {quality, cut}, coarse);
      if (first.size() > sizes.first) continue;
      Bytes second = encodeSecond(coarse, levels, cut);
      if (second.size() > sizes.second) break;
      return {std::move(first), std::move(second)};
    }
  }
  SHOAL_DEMAND(false);  // the coarsest takes fewer than 64 bytes: a property test tries noise
  return {};
}

bool isFinest(std::span<const Bytes> layers) {
  if (layers.size() < 2) return false;
  Decoder first(layers[0]);
  return codeHeader(first, {}).quality <= kFinest;
}

std::vector<uint8_t> decodePicture(std::span<const Bytes> layers) {
  if (layers.empty()) throw std::invalid_argument("a picture has at least one layer");
  Decoder first(layers[0]);
  const PictureHeader header = codeHeader(first, {});
  Planes coarse;
  codeFirst(first, coarse, header.cut);
  const bool is_sharp = layers.size() > 1;
  if (!is_sharp) return rgbOf(dequantize(coarse, header.quality, header.cut, false));
  Planes levels = coarse;
  Decoder second(layers[1]);
  codeSecond(second, coarse, levels, header.cut);
  return rgbOf(dequantize(levels, header.quality, header.cut, true));
}

}  // namespace shoal::wire
