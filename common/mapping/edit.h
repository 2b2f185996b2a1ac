// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "shoal/world/ids.h"

namespace shoal::mapping {

/// A robot's topic, in the life in which it has that meaning: a robot that began anew gives its numbers to
/// other topics, and what was said of the old ones is void.
struct TopicRef {
  world::RobotId robot{};
  int32_t epoch = 0;  ///< >= 0
  world::TopicId topic{};
  auto operator<=>(const TopicRef&) const = default;
};

/// Which edit: "OPERATOR/3" is the third that OPERATOR made.
struct EditId {
  std::string author;   ///< the node that it was made on, [A-Z0-9]{1,16}
  int32_t counter = 1;  ///< from 1
  auto operator<=>(const EditId&) const = default;
};

/// "OPERATOR/3", and back.
std::string toText(const EditId& id);
std::optional<EditId> parseEditId(std::string_view text);

/// The topic, and the label that holds it, are called `text`; empty takes the name away.
struct NameEdit {
  TopicRef topic;
  std::string text;  ///< isLabelName()
  bool operator==(const NameEdit&) const = default;
};

/// Two topics are the same thing, or are not.
struct LinkEdit {
  TopicRef a, b;       ///< a < b
  bool apart = false;  ///< not the same
  bool operator==(const LinkEdit&) const = default;
};

/// Nothing that the robot said, ever, enters the map.
struct ExcludeEdit {
  world::RobotId robot{};
  bool operator==(const ExcludeEdit&) const = default;
};

/// An earlier edit does not count. May be undone itself.
struct UndoEdit {
  EditId edit;
  bool operator==(const UndoEdit&) const = default;
};

/// What an operator decided: an operation of the replicated state, never changed once made.
struct Edit {
  EditId id;
  world::Timestamp time;  ///< mission time; later than that of every edit its author knew of
  std::variant<NameEdit, LinkEdit, ExcludeEdit, UndoEdit> operation;
  bool operator==(const Edit&) const = default;
};

/// The operation in a word: name, link, unlink, exclude, undo.
std::string_view verbOf(const Edit& edit);

/// A hash of all of it, the same on every machine.
uint64_t contentHash(const Edit& edit);

/// The order in which edits count: time, author, counter; then content, for authors that repeat themselves.
bool isEarlier(const Edit& a, const Edit& b);

/// Why an edit may not be kept, e.g. "a topic is linked to itself"; empty when it may. Robots lie in [0,
/// 9999].
std::string fault(const Edit& edit);

}  // namespace shoal::mapping
