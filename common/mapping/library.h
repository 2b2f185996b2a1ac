// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/global_map.h"
#include "shoal/mapping/piece.h"

namespace shoal::mapping {

/// What is known from missions before enters a mission as if a robot of this number had told of it: topics
/// with names, and no cells. No real robot may have it.
inline constexpr world::RobotId kLibrary{9999};

/// What something looked like, in words, that a person has named.
struct LibraryTopic {
  std::string name;                     ///< isLabelName(), not empty
  int64_t weight = 0;                   ///< words seen of it, > 0
  std::vector<world::WordCount> words;  ///< ascending by word, counts quantised, > 0; not empty
  bool operator==(const LibraryTopic&) const = default;
};

struct Library {
  std::vector<int32_t> group_sizes;  ///< of the word groups it was made with: their sum is the vocabulary
  std::vector<LibraryTopic> topics;  ///< ascending by name, each once; at most kMaxLibraryTopics
  bool operator==(const Library&) const = default;
};
inline constexpr size_t kMaxLibraryTopics = 1000;

/// A hash of all of it, the same on every machine.
uint64_t digestOf(const Library& library);

/// The library as pieces of the replicated state: a topic each of kLibrary, in an epoch that is 31 bits of
/// the digest, and an edit each that names it, by author LIBRARY at time 0: whoever names a label later
/// decides. Of two libraries that meet in a mission, the one of the greater epoch counts, on every node
/// alike, and the other's names are void.
std::vector<Piece> piecesOf(const Library& library);
int32_t epochOf(const Library& library);

/// The library in force; nothing when there is none. The inverse of piecesOf() once all pieces are held.
Library libraryIn(const BeliefStore& beliefs);

/// What the named labels of a map look like: of each name the words of all topics in its labels, summed.
/// What a library in force told stays in it, also when nothing of the kind was seen this time. Topics of
/// another vocabulary than most robots', and of excluded robots, are left out.
/// @param map  With its correspondences and names.
Library libraryOf(const GlobalMap& map, const BeliefStore& beliefs);

/// The names that the library in force has for each label of the map, ascending; none for a label that is
/// new.
std::map<world::GlobalLabel, std::vector<std::string>> libraryNames(const GlobalMap& map,
                                                                    const BeliefStore& beliefs);

/// The text of a library file: {"shoal_library": 1, "groups": [..], "topics": [{"name", "weight", "words":
/// {"17": 3}}]}.
std::string libraryJson(const Library& library);

/// The inverse. Reads anything. @throws std::runtime_error naming `path` and what is wrong.
Library parseLibrary(const std::string& text, const std::string& path);

}  // namespace shoal::mapping
