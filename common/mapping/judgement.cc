// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/judgement.h"

#include <algorithm>

#include "shoal/mapping/topic_groups.h"

namespace shoal::mapping {
std::string_view toText(Standing standing) {
  switch (standing) {
    case Standing::kInForce:
      return "in force";
    case Standing::kUndone:
      return "undone";
    case Standing::kReplaced:
      return "replaced";
    case Standing::kOverruled:
      return "overruled";
    case Standing::kVoid:
      break;
  }
  return "void";
}

std::string Judgement::nameOf(std::span<const Topic> topics) const {
  const NameGiven* newest = nullptr;
  for (const Topic& topic : topics) {
    const auto given = names.find(topic);
    if (given == names.end()) continue;
    if (newest == nullptr || newest->order < given->second.order) newest = &given->second;
  }
  return newest == nullptr ? "" : newest->text;
}

std::vector<Edit> editsOf(const BeliefStore& beliefs) {
  std::vector<Edit> edits;
  beliefs.visitOf(kOperators, [&](const Piece& piece) {
    if (const auto* edit = std::get_if<Edit>(&piece.content)) edits.push_back(*edit);
  });
  std::ranges::sort(edits, isEarlier);
  return edits;
}

Judgement judge(std::span<const Edit> edits, const BeliefStore& beliefs, std::vector<Standing>* standings) {
  std::vector<Standing> became(edits.size(), Standing::kInForce);
  std::set<EditId> known, undone;
  for (const Edit& edit : edits) known.insert(edit.id);
  const auto isNow = [&beliefs](const TopicRef& t) { return beliefs.epochOf(t.robot) == t.epoch; };
  const auto topicOf = [](const TopicRef& t) { return Topic{t.robot, t.topic}; };
  Judgement judgement;
  std::set<TopicPair> decided;
  TopicGroups groups;
  for (size_t i = edits.size(); i-- > 0;) {  // the newest first: it decides
    const Edit& edit = edits[i];
    if (undone.contains(edit.id)) {
      became[i] = Standing::kUndone;
    } else if (const auto* undo = std::get_if<UndoEdit>(&edit.operation)) {
      if (!known.contains(undo->edit)) became[i] = Standing::kVoid;
      undone.insert(undo->edit);
    } else if (const auto* name = std::get_if<NameEdit>(&edit.operation)) {
      if (!isNow(name->topic)) {
        became[i] = Standing::kVoid;
      } else if (!judgement.names.try_emplace(topicOf(name->topic), NameGiven{i, name->text}).second) {
        became[i] = Standing::kReplaced;
      }
    } else if (const auto* link = std::get_if<LinkEdit>(&edit.operation)) {
      const TopicPair pair{topicOf(link->a), topicOf(link->b)};
      if (!isNow(link->a) || !isNow(link->b)) {
        became[i] = Standing::kVoid;
      } else if (!decided.insert(pair).second) {
        became[i] = Standing::kReplaced;
      } else if (!groups.add(pair.first, pair.second, link->apart)) {
        became[i] = Standing::kOverruled;
      } else {
        (link->apart ? judgement.apart : judgement.links).push_back(pair);
      }
    } else if (!judgement.excluded.insert(std::get<ExcludeEdit>(edit.operation).robot).second) {
      became[i] = Standing::kReplaced;
    }
  }
  std::ranges::sort(judgement.links);
  std::ranges::sort(judgement.apart);
  if (standings != nullptr) *standings = std::move(became);
  return judgement;
}

Judgement judge(const BeliefStore& beliefs) { return judge(editsOf(beliefs), beliefs); }

}  // namespace shoal::mapping
