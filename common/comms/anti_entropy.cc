// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/anti_entropy.h"

#include <algorithm>
#include <array>

namespace shoal::comms {
namespace {

// What a hostile peer may make us remember.
constexpr size_t kMaxQuestions = 1024;
constexpr size_t kMaxAnswers = 1024;
constexpr size_t kMaxWanted = 4096;
constexpr size_t kMaxRepairs = 2048;

// Where there are no more leaves than this, they are named: less than the digests of another level and
// another round would take.
constexpr size_t kFewLeaves = 16;

constexpr int kMaxWantedAttempts = 4;
constexpr int kSlowestQuestion = 4;  // doublings of the time between two
constexpr int kMostQuestions = 3;    // about what was missed of a share that is still said

constexpr int64_t kMicro = 1'000'000;

// Of a message without statements: headers, channel, fixed fields.
constexpr int64_t kTalkOverheadBytes = 90;

// The longest statement that is not cut to fit: kFewLeaves keys, versions of one epoch.
constexpr int64_t kStatementBytes = 200;

}  // namespace

AntiEntropy::AntiEntropy(const AntiEntropyOptions& options, Holdings& holdings)
    : options_(options), holdings_(holdings), random_(options.seed, 0x7265706169u) {
  tokens_ = (kTalkOverheadBytes + static_cast<int64_t>(options_.max_talk_bytes)) * kMicro;
}

int64_t AntiEntropy::backOff(double least, double most) {
  const double units = least + (most - least) * random_.uniform();
  return static_cast<int64_t>(units * static_cast<double>(options_.unit_us));
}

int64_t AntiEntropy::holderBackOff(int32_t share) { return isOwn(share) ? backOff(0, 0.3) : backOff(1, 4); }

void AntiEntropy::doubt(int32_t share, int64_t now_us) {
  if (share < 0 || share > kMaxShare || isOwn(share) || questions_.contains(share)) return;
  if (questions_.size() >= kMaxQuestions) return;
  questions_[share].due_us = now_us + options_.patience_us + backOff(1, 3);
}

Statement AntiEntropy::about(int32_t share, const TreeNode& node, bool asks, uint32_t salt) {
  const DigestTree& tree = holdings_.treeOf(share);
  Statement statement{Statement::Kind::kLeaves, share, asks, node, {}, {}};
  if (const auto leaves = tree.leaves(node); leaves.size() <= kFewLeaves || node.depth == kMaxTreeDepth) {
    for (const Leaf& leaf : leaves) statement.leaves.push_back({leaf.key, leaf.version});
    return statement;
  }
  statement.kind = Statement::Kind::kChildren;
  for (int i = 0; i < kTreeFanout; ++i) {
    statement.children[static_cast<size_t>(i)] = foldedDigest(tree.digest(node.child(i)), salt);
  }
  return statement;
}

void AntiEntropy::answer(int32_t share, const TreeNode& node, bool asks, int64_t due_us) {
  if (answers_.size() >= kMaxAnswers) return;
  const auto [held, is_new] = answers_.try_emplace({share, node}, Answer{due_us, asks});
  if (is_new) return;
  held->second.asks = held->second.asks || asks;
  held->second.due_us = std::min(held->second.due_us, due_us);
}

void AntiEntropy::hear(const RepairTalk& talk, int64_t now_us) {
  for (const Statement& said : talk.statements) {
    switch (said.kind) {
      case Statement::Kind::kChildren:
        hearChildren(said, talk.salt, now_us);
        break;
      case Statement::Kind::kLeaves:
        hearLeaves(said, now_us);
        break;
      case Statement::Kind::kWanted:
        hearWanted(said, now_us);
        break;
    }
  }
}

void AntiEntropy::hearChildren(const Statement& said, uint32_t salt, int64_t now_us) {
  const bool wanting = questions_.contains(said.share);
  const DigestTree& tree = holdings_.treeOf(said.share);
  bool differs = false;
  for (int i = 0; i < kTreeFanout; ++i) {
    const TreeNode child = said.node.child(i);
    const uint16_t theirs = said.children[static_cast<size_t>(i)];
    if (foldedDigest(tree.digest(child), salt) == theirs) continue;
    differs = true;
    if (said.asks && (wanting || tree.size(child) > 0)) {
      answer(said.share, child, wanting, now_us + holderBackOff(said.share));
    } else if (!said.asks && wanting && theirs != 0) {
      answer(said.share, child, true, now_us + backOff(0, 0.3));
    }
  }
  if (const auto mine = answers_.find({said.share, said.node}); mine != answers_.end()) {
    if (!differs || (!said.asks && !mine->second.asks)) answers_.erase(mine);  // it has been said
  }
  if (wanting && said.asks && !differs && said.node == TreeNode{}) {  // the answer will serve us too
    Question& mine = questions_[said.share];
    mine.due_us = std::max(mine.due_us, now_us + backOff(3, 5));
  }
}

void AntiEntropy::hearLeaves(const Statement& said, int64_t now_us) {
  const bool wanting = questions_.contains(said.share);
  const auto mine = holdings_.treeOf(said.share).leaves(said.node);
  size_t i = 0;
  for (const Statement::Named& theirs : said.leaves) {
    for (; i < mine.size() && mine[i].key < theirs.key; ++i) {
      if (said.asks) scheduleRepair({said.share, mine[i].key}, now_us);
    }
    const bool held = i < mine.size() && mine[i].key == theirs.key;
    if (!held || mine[i].version < theirs.version) {
      if (wanting) want({said.share, theirs.key}, theirs.version, now_us);
    } else if (said.asks && mine[i].version > theirs.version) {
      scheduleRepair({said.share, mine[i].key}, now_us);
    }
    if (held) ++i;
  }
  for (; said.asks && i < mine.size(); ++i) scheduleRepair({said.share, mine[i].key}, now_us);
  const auto answered = answers_.find({said.share, said.node});
  if (answered != answers_.end() && !said.asks && !answered->second.asks) answers_.erase(answered);
}

void AntiEntropy::hearWanted(const Statement& said, int64_t now_us) {
  const DigestTree& tree = holdings_.treeOf(said.share);
  for (const Statement::Named& named : said.leaves) {
    const PieceName piece{said.share, named.key};
    const auto leaf = tree.find(named.key);
    if (leaf && leaf->version >= named.version) scheduleRepair(piece, now_us);
    const auto mine = wanted_.find(piece);
    if (mine != wanted_.end()) mine->second.due_us = std::max(mine->second.due_us, now_us + backOff(4, 6));
  }
}

void AntiEntropy::scheduleRepair(const PieceName& piece, int64_t now_us) {
  if (repairs_.size() >= kMaxRepairs) return;
  const auto lately = said_lately_.find(piece);
  if (lately != said_lately_.end() && now_us - lately->second < 2 * options_.unit_us) return;
  repairs_.try_emplace(piece, now_us + holderBackOff(piece.first));
}

void AntiEntropy::want(const PieceName& piece, uint64_t version, int64_t now_us) {
  if (wanted_.size() >= kMaxWanted) return;
  const auto [held, is_new] = wanted_.try_emplace(piece, Wanted{version, now_us + backOff(0, 0.5), 0});
  if (!is_new) held->second.version = std::max(held->second.version, version);
}

void AntiEntropy::heard(const PieceName& piece, uint64_t version, bool repaired, int64_t now_us) {
  const auto wanted = wanted_.find(piece);
  if (wanted != wanted_.end() && wanted->second.version <= version) wanted_.erase(wanted);
  if (!repaired) return;
  std::erase_if(said_lately_, [&](const auto& said) { return now_us - said.second > 8 * options_.unit_us; });
  if (said_lately_.size() < kMaxRepairs) said_lately_[piece] = now_us;
  if (const auto planned = repairs_.find(piece); planned != repairs_.end()) {  // else no tree need be made
    const auto leaf = holdings_.treeOf(piece.first).find(piece.second);
    if (!leaf || leaf->version <= version) repairs_.erase(planned);
  }
  if (isOwn(piece.first)) return;
  // Somebody is at it: whoever speaks first goes on.
  const int64_t later_us = now_us + holderBackOff(piece.first);
  for (auto other = repairs_.lower_bound({piece.first, 0});
       other != repairs_.end() && other->first.first == piece.first; ++other) {
    other->second = std::max(other->second, later_us);
  }
}

void AntiEntropy::refill(int64_t now_us) {
  const int64_t most = (kTalkOverheadBytes + static_cast<int64_t>(options_.max_talk_bytes)) * kMicro;
  const int64_t passed_us = std::clamp<int64_t>(now_us - refilled_us_, 0, 100 * kMicro);
  refilled_us_ = std::max(refilled_us_, now_us);
  const bool unlimited = options_.talk_bytes_per_s == 0;
  tokens_ = unlimited ? most : std::min(most, tokens_ + passed_us * options_.talk_bytes_per_s);
}

bool AntiEntropy::add(RepairTalk& talk, size_t& room, Statement statement) const {
  const size_t size = encodedSize(statement);
  if (size > room || talk.statements.size() >= kMaxStatements) return false;
  room -= size;
  talk.statements.push_back(std::move(statement));
  return true;
}

void AntiEntropy::addWanted(RepairTalk& talk, size_t& room, int64_t now_us) {
  constexpr size_t kBytesEach = 11;  // a key and, mostly, a short version
  for (auto at = wanted_.begin(); at != wanted_.end();) {
    const int32_t share = at->first.first;
    Statement statement{Statement::Kind::kWanted, share, false, {}, {}, {}};
    const size_t most = std::min(kMaxStatementLeaves, room / kBytesEach);
    std::vector<PieceName> given_up;
    for (; at != wanted_.end() && at->first.first == share; ++at) {
      Wanted& wanted = at->second;
      if (wanted.due_us > now_us || statement.leaves.size() >= most) continue;
      if (wanted.attempts == kMaxWantedAttempts) {
        given_up.push_back(at->first);  // the next question finds it again
        continue;
      }
      statement.leaves.push_back({at->first.second, wanted.version});
      wanted.due_us = now_us + backOff(4, 6) * (int64_t{1} << wanted.attempts++);
    }
    for (const PieceName& piece : given_up) wanted_.erase(piece);
    if (!statement.leaves.empty() && !add(talk, room, std::move(statement))) return;
  }
}

void AntiEntropy::addAnswers(RepairTalk& talk, size_t& room, int64_t now_us) {
  for (auto at = answers_.begin(); at != answers_.end();) {
    const auto& [place, said] = *at;
    if (said.due_us > now_us) {
      ++at;
      continue;
    }
    if (!add(talk, room, about(place.first, place.second, said.asks, talk.salt))) return;
    at = answers_.erase(at);
  }
}

void AntiEntropy::addQuestions(RepairTalk& talk, size_t& room, int64_t now_us) {
  for (auto at = questions_.begin(); at != questions_.end();) {
    const int32_t share = at->first;
    Question& question = at->second;
    if (question.due_us > now_us) {
      ++at;
      continue;
    }
    if (!holdings_.isDoubted(share)) {
      at = questions_.erase(at);
      continue;
    }
    ++at;
    const auto wanted = wanted_.lower_bound({share, 0});
    const bool is_asked_for = wanted != wanted_.end() && wanted->first.first == share;
    const std::optional<int64_t> missed = holdings_.missed(share);
    if (is_asked_for) {
      question.due_us = now_us + backOff(2, 3);
      question.attempts = 1;
      continue;
    }
    const uint64_t state = missed ? static_cast<uint64_t>(*missed) : holdings_.treeOf(share).digest();
    if (missed == 0 || (missed && state == question.state && question.attempts >= kMostQuestions)) {
      question.due_us = now_us + backOff(3, 5);
      continue;
    }
    if (!add(talk, room, about(share, {}, true, talk.salt))) return;
    question.attempts = state == question.state ? std::min(question.attempts + 1, kSlowestQuestion) : 1;
    question.state = state;
    question.due_us = now_us + backOff(3, 5) * (int64_t{1} << (question.attempts - 1));
  }
}

std::optional<RepairTalk> AntiEntropy::nextTalk(int64_t now_us) {
  refill(now_us);
  const int64_t allowed = tokens_ / kMicro - kTalkOverheadBytes;
  if (allowed < kStatementBytes) return std::nullopt;
  RepairTalk talk{static_cast<uint32_t>(random_()), {}};
  const size_t most = std::min(options_.max_talk_bytes, static_cast<size_t>(allowed));
  size_t room = most;
  addWanted(talk, room, now_us);
  addAnswers(talk, room, now_us);
  addQuestions(talk, room, now_us);
  if (talk.statements.empty()) return std::nullopt;
  tokens_ -= (kTalkOverheadBytes + static_cast<int64_t>(most - room)) * kMicro;
  return talk;
}

std::optional<AntiEntropy::PieceName> AntiEntropy::nextRepair(int64_t now_us) {
  const auto first = std::ranges::min_element(repairs_, {}, [](const auto& repair) { return repair.second; });
  if (first == repairs_.end() || first->second > now_us) return std::nullopt;
  const PieceName piece = first->first;
  repairs_.erase(first);
  if (said_lately_.size() < kMaxRepairs) said_lately_[piece] = now_us;
  return piece;
}

int64_t AntiEntropy::nextTalkDue(int64_t now_us) const {
  int64_t due_us = kNever;
  for (const auto& [share, question] : questions_) due_us = std::min(due_us, question.due_us);
  for (const auto& [place, said] : answers_) due_us = std::min(due_us, said.due_us);
  for (const auto& [piece, wanted] : wanted_) due_us = std::min(due_us, wanted.due_us);
  if (due_us != kNever && options_.talk_bytes_per_s > 0) {
    const int64_t lacking = (kTalkOverheadBytes + kStatementBytes) * kMicro - tokens_;
    if (lacking > 0) due_us = std::max(due_us, refilled_us_ + lacking / options_.talk_bytes_per_s + 1);
  }
  return due_us == kNever ? kNever : std::max(due_us, now_us + 1);
}

int64_t AntiEntropy::nextRepairDue(int64_t now_us) const {
  int64_t due_us = kNever;
  for (const auto& [piece, repair_us] : repairs_) due_us = std::min(due_us, repair_us);
  return due_us == kNever ? kNever : std::max(due_us, now_us + 1);
}

}  // namespace shoal::comms
