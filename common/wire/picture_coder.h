// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shoal/wire/bytes.h"

namespace shoal::wire {

/// Pictures are 32 x 32 pixels of red, green and blue, row by row.
inline constexpr int kPictureEdge = 32;
inline constexpr size_t kPictureBytes = size_t{3} * kPictureEdge * kPictureEdge;

/// How many bytes the layers of a picture may take.
struct PictureSizes {
  size_t first = 110;   ///< a small picture by itself, half as fine
  size_t second = 220;  ///< what makes it sharp
};

/// A picture as layers of bytes, at most as long as `sizes` says. The first is usable alone, the second needs
/// it. Luma in full, chroma in half resolution, as integer 5/3 wavelets (Le Gall and Tabatabai 1988) whose
/// coefficients are quantised and coded by the range coder of all our payloads; docs/wire.md says how.
/// Deterministic on every machine: integers only. About 1 ms.
///
/// @param rgb  kPictureBytes bytes.
/// @throws std::invalid_argument when there are not so many, or when a size is below 64.
std::vector<Bytes> encodePicture(std::span<const uint8_t> rgb, const PictureSizes& sizes = {});

/// True when these layers are a whole picture, as fine as encodePicture() makes any: more bytes would show
/// nothing more.
bool isFinest(std::span<const Bytes> layers);

/// The picture that these layers, from the first on, show; more than two are not looked at. Any bytes are
/// some picture: what is hostile gives wrong pixels, in the same time and memory.
/// @throws std::invalid_argument when there is no layer.
std::vector<uint8_t> decodePicture(std::span<const Bytes> layers);

}  // namespace shoal::wire
