// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/edit.h"

#include <algorithm>
#include <charconv>
#include <tuple>

#include "shoal/mapping/label_name.h"
#include "shoal/random.h"
#include "shoal/world/mission_time.h"

namespace shoal::mapping {
namespace {

constexpr int32_t kMaxRobotNumber = 9999;

bool isAuthor(std::string_view name) {
  return !name.empty() && name.size() <= 16 &&
         std::ranges::all_of(name, [](char c) { return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); });
}

bool isRobot(world::RobotId robot) { return number(robot) >= 0 && number(robot) <= kMaxRobotNumber; }

bool isTopic(const TopicRef& t) {
  return isRobot(t.robot) && t.epoch >= 0 && number(t.topic) >= 0 && number(t.topic) <= world::kMaxTopicId;
}

struct EditHasher {
  uint64_t hash = 0;
  void add(int64_t value) { hash = hashCombine(hash, static_cast<uint64_t>(value)); }
  void add(const std::string& text) {
    add(std::ssize(text));
    for (const char c : text) add(static_cast<uint8_t>(c));
  }
  void add(const TopicRef& t) {
    add(number(t.robot));
    add(t.epoch);
    add(number(t.topic));
  }
  void operator()(const NameEdit& e) {
    add(e.topic);
    add(e.text);
  }
  void operator()(const LinkEdit& e) {
    add(e.a);
    add(e.b);
    add(e.apart ? 1 : 0);
  }
  void operator()(const ExcludeEdit& e) { add(number(e.robot)); }
  void operator()(const UndoEdit& e) {
    add(e.edit.author);
    add(e.edit.counter);
  }
};

}  // namespace

std::string toText(const EditId& id) { return id.author + "/" + std::to_string(id.counter); }

std::optional<EditId> parseEditId(std::string_view text) {
  const size_t slash = text.find('/');
  if (slash == std::string_view::npos || !isAuthor(text.substr(0, slash))) return std::nullopt;
  EditId id{std::string(text.substr(0, slash)), 0};
  const std::string_view digits = text.substr(slash + 1);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), id.counter);
  if (error != std::errc{} || end != digits.data() + digits.size() || id.counter < 1) return std::nullopt;
  return id;
}

std::string_view verbOf(const Edit& edit) {
  if (std::holds_alternative<NameEdit>(edit.operation)) return "name";
  if (const auto* link = std::get_if<LinkEdit>(&edit.operation)) return link->apart ? "unlink" : "link";
  return std::holds_alternative<ExcludeEdit>(edit.operation) ? "exclude" : "undo";
}

uint64_t contentHash(const Edit& edit) {
  EditHasher hasher;
  hasher.add(edit.id.author);
  hasher.add(edit.id.counter);
  hasher.add(edit.time.us);
  hasher.add(static_cast<int64_t>(edit.operation.index()));
  std::visit(hasher, edit.operation);
  return hasher.hash;
}

bool isEarlier(const Edit& a, const Edit& b) {
  return std::tuple(a.time, a.id.author, a.id.counter, contentHash(a)) <
         std::tuple(b.time, b.id.author, b.id.counter, contentHash(b));
}

std::string fault(const Edit& edit) {
  if (!isAuthor(edit.id.author)) return "an author is 1 to 16 capitals and digits";
  if (edit.id.counter < 1) return "edits are counted from 1";
  if (edit.time.us < 0 || edit.time.us > world::kMaxTimeUs) return "the time is out of range";
  if (const auto* name = std::get_if<NameEdit>(&edit.operation)) {
    if (!isTopic(name->topic)) return "the topic is out of range";
    if (!isLabelName(name->text)) {
      return "a name is UTF-8 of at most 64 bytes without control characters";
    }
  } else if (const auto* link = std::get_if<LinkEdit>(&edit.operation)) {
    if (!isTopic(link->a) || !isTopic(link->b)) return "a topic is out of range";
    if (link->a == link->b) return "a topic is linked to itself";
    if (link->b < link->a) return "linked topics are not ascending";
  } else if (const auto* exclude = std::get_if<ExcludeEdit>(&edit.operation)) {
    if (!isRobot(exclude->robot)) return "robots are R00 to R9999";
  } else {
    const EditId& undone = std::get<UndoEdit>(edit.operation).edit;
    if (!isAuthor(undone.author) || undone.counter < 1) return "what is undone is no edit";
  }
  return {};
}

}  // namespace shoal::mapping
