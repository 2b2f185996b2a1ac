// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "shoal/random.h"
#include "shoal/world/reef_raster.h"

namespace shoal::world {

/// How a thing on the seabed is built.
enum class Form {
  kBoulder,  ///< a lump and others that lean on it
  kStones,   ///< broken pieces strewn about
  kDome,     ///< massive coral: a dome of lobes
  kAntlers,  ///< branching coral: flat branches that fork outwards
  kTables,   ///< plate coral: thin tilted tables on stalks, one over the other
  kBarrels,  ///< sponge: barrels with dark mouths
  kTuft,     ///< algae: a low bush
  kBlades    ///< seagrass: blades that all lean with the current
};

/// A solid of a form, and how light it is.
struct Part {
  Ellipsoid solid;
  float brightness = 1.0f;  ///< of its colour: 1 plain, below 1 deep inside or dark by nature
};

/// One specimen about the origin, Z up, on ground at 0 (some reaches below), within radius 1.2 and height
/// 1.6; no two alike. Cost: up to 100 parts.
std::vector<Part> grow(Form form, Random random);

}  // namespace shoal::world
