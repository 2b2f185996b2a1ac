// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <system_error>

#include "shoal/world/place.h"
#include "shoal/world/recorded_place.h"

namespace shoal::world {

std::unique_ptr<Place> openPlace(const std::string& spec, uint64_t seed,
                                 const std::optional<Camera>& camera) {
  std::error_code error;
  const std::filesystem::path folder(spec);
  if (!std::filesystem::exists(folder / "world.json", error) && isRecording(folder)) {
    return openRecording(folder, seed, camera);
  }
  return makePlace(openWorld(spec, seed), seed);
}

}  // namespace shoal::world
