// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "shoal/mapping/local_belief.h"
#include "shoal/mapping/piece.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/picture_coder.h"

namespace shoal::wire {

/// An example as the pieces that travel, one a layer; one empty layer when it is no more. Its version is the
/// observation at which it became the example: a function of the example alone.
std::vector<mapping::Piece> picturePieces(const mapping::ExamplePicture& example, world::RobotId robot,
                                          int32_t epoch);

/// The same example sharper, under a number of its own: mapping::kSharperBy. Of the same version, and a
/// function of the example alone too; nothing for an example that is no more. Cost: as encodePicture().
std::vector<mapping::Piece> sharperPieces(const mapping::ExamplePicture& example, world::RobotId robot,
                                          int32_t epoch);

/// The most that the layers of a sharper picture take, bytes.
inline constexpr PictureSizes kSharperSizes = {kMaxLayerBytes, kMaxLayerBytes};

/// Turns a robot's successive examples into what is new to say, as mapping::BeliefChanges does for the rest.
class PictureChanges {
 public:
  /// The pieces of the examples that changed since the last call: those that are no more, then all first
  /// layers, the most typical examples first, then what sharpens them. Each example is encoded once.
  std::vector<mapping::Piece> update(const mapping::LocalBelief& belief);

 private:
  std::map<mapping::PieceKey, int32_t> said_;  // observation of the version said last
};

}  // namespace shoal::wire
