// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/anti_entropy.h"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "shoal/random.h"

namespace shoal::comms {
namespace {

constexpr uint64_t kKeys = uint64_t{1} << kKeyBits;

Leaf leaf(uint64_t key, uint64_t version) { return {key, version, hashCombine(key, version)}; }

std::vector<Leaf> randomLeaves(size_t count, Random& random) {
  std::vector<Leaf> leaves;
  for (size_t i = 0; i < count; ++i) leaves.push_back(leaf(random.below(kKeys), random.below(100)));
  return leaves;
}

TEST(DigestTreeTest, SumsAreThoseOfTheLeavesBelow) {
  Random random(1);
  for (const size_t count : {0u, 1u, 17u, 300u}) {
    const std::vector<Leaf> leaves = randomLeaves(count, random);
    const DigestTree tree(leaves);
    for (int trial = 0; trial < 200; ++trial) {
      const int depth = static_cast<int>(random.below(kMaxTreeDepth + 1));
      const bool is_taken = count > 0 && random.below(2) == 0;
      const uint64_t key = is_taken ? leaves[random.below(count)].key : random.below(kKeys);
      const TreeNode node{depth, key >> (kKeyBits - 4 * depth)};
      uint64_t sum = 0;
      size_t below = 0;
      for (const Leaf& each : leaves) {
        if (each.key >> (kKeyBits - 4 * depth) != node.prefix) continue;
        sum += each.hash;
        ++below;
      }
      EXPECT_EQ(tree.digest(node), sum);
      EXPECT_EQ(tree.size(node), below);
    }
    for (const Leaf& each : leaves) EXPECT_EQ(tree.find(each.key), each);
    EXPECT_FALSE(tree.find(kKeys - 1).has_value());
  }
}

RepairTalk randomTalk(Random& random) {
  RepairTalk talk{static_cast<uint32_t>(random()), {}};
  for (uint64_t n = random.below(5); n > 0; --n) {
    Statement s;
    s.kind = static_cast<Statement::Kind>(random.below(3));
    s.share = static_cast<int32_t>(random.below(kMaxShare + 1));
    if (s.kind != Statement::Kind::kWanted) {
      s.asks = random.below(2) == 0;
      s.node.depth = static_cast<int>(random.below(kMaxTreeDepth));
      s.node.prefix = random.below(uint64_t{1} << (4 * s.node.depth));
    }
    if (s.kind == Statement::Kind::kChildren) {
      for (uint16_t& child : s.children) child = static_cast<uint16_t>(random());
    } else {
      std::set<uint64_t> keys;
      for (uint64_t k = random.below(20); k > 0; --k)
        keys.insert(s.node.firstKey() + random.below(s.node.endKey() - s.node.firstKey()));
      for (const uint64_t key : keys) s.leaves.push_back({key, random() >> random.below(64)});
    }
    talk.statements.push_back(s);
  }
  return talk;
}

TEST(RepairTalkTest, WhatIsEncodedIsDecoded) {
  Random random(2);
  for (int trial = 0; trial < 2000; ++trial) {
    const RepairTalk talk = randomTalk(random);
    const Bytes bytes = encodeTalk(talk);
    size_t size = 4;
    for (const Statement& statement : talk.statements) size += encodedSize(statement);
    EXPECT_EQ(bytes.size(), size);
    const auto decoded = decodeTalk(bytes);
    ASSERT_TRUE(decoded.has_value());
    EXPECT_EQ(*decoded, talk);
  }
}

// Cut short, flipped, or nothing but noise: refused, or a talk within the caps that has these very bytes.
TEST(RepairTalkTest, WhateverTheBytesAreItReturns) {
  Random random(3);
  const auto check = [](const Bytes& bytes) {
    if (const auto talk = decodeTalk(bytes)) {
      EXPECT_EQ(encodeTalk(*talk), bytes);
      for (const Statement& s : talk->statements) EXPECT_LE(s.leaves.size(), kMaxStatementLeaves);
    }
  };
  for (int trial = 0; trial < 30; ++trial) {  // some 100,000 messages
    const Bytes bytes = encodeTalk(randomTalk(random));
    for (size_t length = 0; length < bytes.size(); ++length)
      check(Bytes(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(length)));
    for (size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
      Bytes flipped = bytes;
      flipped[bit / 8] ^= static_cast<uint8_t>(1 << (bit % 8));
      check(flipped);
    }
    Bytes noise(random.below(60));
    for (uint8_t& byte : noise) byte = static_cast<uint8_t>(random());
    check(noise);
  }
  EXPECT_FALSE(decodeTalk(Bytes{0, 0, 0}).has_value());
  EXPECT_FALSE(decodeTalk(Bytes{0, 0, 0, 0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff, 0x0f, 0}).has_value());
}

// A node that holds opaque pieces, and others' digests as if it had heard them.
class Holder final : public Holdings {
 public:
  Holder(int number, std::vector<std::unique_ptr<Holder>>& all)
      : all_(all), talk({.seed = static_cast<uint64_t>(number), .own_share = number}, *this) {}
  const DigestTree& treeOf(int32_t share) override { return tree_ = DigestTree(leavesOf(share)); }
  bool isDoubted(int32_t share) override {
    return std::ranges::any_of(all_, [&](const auto& other) {
      return DigestTree(other->leavesOf(share)).digest() != treeOf(share).digest();
    });
  }
  std::optional<int64_t> missed(int32_t) override { return {}; }

  std::vector<Leaf> leavesOf(int32_t share) const {
    std::vector<Leaf> leaves;
    const auto held = pieces.find(share);
    if (held == pieces.end()) return leaves;
    for (const auto& [key, version] : held->second) leaves.push_back(leaf(key, version));
    return leaves;
  }
  void take(int32_t share, uint64_t key, uint64_t version) {
    uint64_t& held = pieces[share].try_emplace(key, version).first->second;
    held = std::max(held, version);
  }

  std::map<int32_t, std::map<uint64_t, uint64_t>> pieces;  // share -> key -> version
  std::vector<std::unique_ptr<Holder>>& all_;
  DigestTree tree_;
  AntiEntropy talk;
};

struct Exchange {
  int seconds = -1;
  size_t talk_bytes = 0, repairs = 0;
};

// All hear all, a part of it.
Exchange exchange(std::vector<std::unique_ptr<Holder>>& all, double loss, uint64_t seed) {
  Random random(seed);
  Exchange result;
  const auto others = [&](const Holder& speaker, const auto& tell) {
    for (auto& other : all)
      if (other.get() != &speaker && random.uniform() >= loss) tell(*other);
  };
  for (int64_t tenth = 0; tenth < 6000; ++tenth) {
    const int64_t now_us = tenth * 100'000;
    bool agreed = true;
    for (auto& holder : all) {
      for (int32_t share = 0; share < 3; ++share) {
        if (!holder->isDoubted(share)) continue;
        agreed = false;
        if (tenth % 10 == 0) holder->talk.doubt(share, now_us);
      }
    }
    if (agreed) {
      result.seconds = static_cast<int>(tenth / 10);
      return result;
    }
    for (auto& holder : all) {
      if (const auto talk = holder->talk.nextTalk(now_us)) {
        result.talk_bytes += encodeTalk(*talk).size();
        others(*holder, [&](Holder& other) { other.talk.hear(*talk, now_us); });
      }
      if (const auto piece = holder->talk.nextRepair(now_us)) {
        ++result.repairs;
        const uint64_t version = holder->pieces.at(piece->first).at(piece->second);
        others(*holder, [&](Holder& other) {
          other.take(piece->first, piece->second, version);
          other.talk.heard(*piece, version, true, now_us);
        });
      }
    }
  }
  return result;
}

std::vector<std::unique_ptr<Holder>> holders(int count) {
  std::vector<std::unique_ptr<Holder>> all;
  for (int i = 0; i < count; ++i) all.push_back(nullptr);
  return all;
}

// Counts how often it is asked for the tree of a share: who holds it may have to make it anew each time.
class CountingHoldings final : public Holdings {
 public:
  const DigestTree& treeOf(int32_t) override {
    ++num_trees;
    return tree;
  }
  bool isDoubted(int32_t) override { return true; }
  std::optional<int64_t> missed(int32_t) override { return {}; }
  DigestTree tree;
  int num_trees = 0;
};

TEST(AntiEntropyTest, ARepairThatWasNotPlannedHereNeedsNoTree) {
  CountingHoldings holdings;
  holdings.tree = DigestTree({leaf(7, 3), leaf(8, 3)});
  AntiEntropy talk({.seed = 1}, holdings);
  for (uint64_t key = 100; key < 1100; ++key) talk.heard({9, key}, 1, true, 0);
  EXPECT_EQ(holdings.num_trees, 0);
  talk.hear({1, {{Statement::Kind::kWanted, 9, false, {}, {}, {{7, 3}, {8, 3}}}}}, 0);
  EXPECT_EQ(talk.numRepairs(), 2u);
  holdings.num_trees = 0;
  talk.heard({9, 7}, 2, true, 0);  // older than what is held: it will be said all the same
  EXPECT_EQ(talk.numRepairs(), 2u);
  talk.heard({9, 7}, 3, true, 0);
  EXPECT_EQ(talk.numRepairs(), 1u);
  EXPECT_EQ(holdings.num_trees, 2);
}

// Somebody else seems to hold more of share 9, always; says how often this node asks about it in a while.
class Doubtful final : public Holdings {
 public:
  const DigestTree& treeOf(int32_t) override { return tree; }
  bool isDoubted(int32_t) override { return true; }
  std::optional<int64_t> missed(int32_t) override { return missed_bytes; }

  int questionsIn(int seconds) {
    int questions = 0;
    for (const int64_t until_us = now_us + seconds * 1'000'000LL; now_us < until_us; now_us += 1'000'000) {
      talk.doubt(9, now_us);
      while (const auto said = talk.nextTalk(now_us)) questions += static_cast<int>(said->statements.size());
    }
    return questions;
  }

  DigestTree tree = DigestTree({leaf(7, 3)});
  std::optional<int64_t> missed_bytes;
  AntiEntropy talk{{.seed = 1}, *this};
  int64_t now_us = 0;
};

TEST(AntiEntropyTest, WhileTheOwnerSpeaksOnlyWhatWasMissedIsAskedFor) {
  Doubtful node;
  node.missed_bytes = 0;
  EXPECT_EQ(node.questionsIn(600), 0);
  node.missed_bytes = 250;
  EXPECT_EQ(node.questionsIn(600), 3);
  EXPECT_EQ(node.questionsIn(600), 0);
  node.missed_bytes = 400;  // something was lost again
  EXPECT_EQ(node.questionsIn(600), 3);
  node.missed_bytes = std::nullopt;  // it has said all
  EXPECT_GE(node.questionsIn(20), 2);
  const int seldom = node.questionsIn(600);  // eight times 3 to 5 s apart
  EXPECT_GE(seldom, 600 / 40 - 1);
  EXPECT_LE(seldom, 600 / 24 + 3);
}

// Share 9 has no owner here. Two nodes, a thousand pieces, and one of them is older here than there.
TEST(AntiEntropyTest, TwoNodesFindOnePieceInAFewHundredBytes) {
  std::vector<std::unique_ptr<Holder>> all = holders(2);
  for (int i = 0; i < 2; ++i) all[static_cast<size_t>(i)] = std::make_unique<Holder>(i + 1, all);
  Random random(5);
  for (int k = 0; k < 1000; ++k) {
    const uint64_t key = random.below(kKeys);
    for (auto& holder : all) holder->take(0, key, 7);
    if (k == 500) all[0]->take(0, key, 8);
  }
  const Exchange e = exchange(all, 0, 1);
  EXPECT_GE(e.seconds, 0);
  EXPECT_LT(e.talk_bytes, 600u);
  EXPECT_EQ(e.repairs, 1u);
}

// Five nodes each hold some pieces of three shares, in some versions; in the end all hold the newest of each.
TEST(AntiEntropyTest, AllComeToHoldTheNewestOfAll) {
  for (const double loss : {0.0, 0.3}) {
    for (uint64_t seed = 1; seed <= 4; ++seed) {
      std::vector<std::unique_ptr<Holder>> all = holders(5);
      for (int i = 0; i < 5; ++i) all[static_cast<size_t>(i)] = std::make_unique<Holder>(i, all);
      Random random(seed);
      std::map<std::pair<int32_t, uint64_t>, uint64_t> newest;
      for (int k = 0; k < 120; ++k) {
        const auto share = static_cast<int32_t>(random.below(3));
        const uint64_t key = random.below(kKeys);
        for (size_t i = 0; i < all.size(); ++i) {
          const bool owns = static_cast<int32_t>(i) == share;  // and so holds the newest
          if (!owns && random.uniform() < 0.4) continue;
          const uint64_t version = owns ? 9 : random.below(10);
          all[i]->take(share, key, version);
          uint64_t& most = newest[{share, key}];
          most = std::max(most, version);
        }
      }
      const Exchange e = exchange(all, loss, seed);
      ASSERT_GE(e.seconds, 0) << "loss " << loss << " seed " << seed;
      for (const auto& [piece, version] : newest)
        for (const auto& holder : all) EXPECT_EQ(holder->pieces.at(piece.first).at(piece.second), version);
    }
  }
}

// What is heard is said by nobody else, and is not asked for.
TEST(AntiEntropyTest, OneRepairServesAll) {
  std::vector<std::unique_ptr<Holder>> all = holders(8);
  for (int i = 0; i < 8; ++i) all[static_cast<size_t>(i)] = std::make_unique<Holder>(i, all);
  Random random(6);
  for (int k = 0; k < 40; ++k) {
    const uint64_t key = random.below(kKeys);
    for (size_t i = 0; i < 4; ++i) all[i]->take(0, key, 1);  // four hold everything, four nothing
  }
  const Exchange e = exchange(all, 0, 7);
  EXPECT_GE(e.seconds, 0);
  EXPECT_GE(e.repairs, 40u);
  EXPECT_LE(e.repairs, 44u);
}

TEST(AntiEntropyTest, MemoryIsBoundedWhateverIsHeard) {
  std::vector<std::unique_ptr<Holder>> all = holders(1);
  all[0] = std::make_unique<Holder>(0, all);
  Random random(8);
  for (int k = 0; k < 3000; ++k) all[0]->take(1, random.below(kKeys), 5);
  for (int trial = 0; trial < 3000; ++trial) {
    RepairTalk talk = randomTalk(random);
    for (Statement& s : talk.statements) {
      s.share = static_cast<int32_t>(random.below(3000));
      all[0]->talk.doubt(s.share, trial);
    }
    talk.statements.push_back({Statement::Kind::kLeaves, 1, true, {}, {}, {}});
    all[0]->talk.hear(talk, trial);
  }
  EXPECT_LE(all[0]->talk.numWanted(), 4096u);
  EXPECT_LE(all[0]->talk.numRepairs(), 2048u);
}

}  // namespace
}  // namespace shoal::comms
