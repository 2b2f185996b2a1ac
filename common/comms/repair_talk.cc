// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/repair_talk.h"

#include <algorithm>

#include "shoal/demand.h"
#include "shoal/random.h"

namespace shoal::comms {
namespace {

constexpr int kKeyBytes = kKeyBits / 8;
constexpr uint8_t kAsks = 4;  // beside the kind in a statement's first byte

void putNumber(Bytes& out, uint64_t value, int num_bytes) {
  for (int i = num_bytes - 1; i >= 0; --i) out.push_back(static_cast<uint8_t>(value >> (8 * i)));
}

void putVarint(Bytes& out, uint64_t value) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<uint8_t>(value | 0x80));
  out.push_back(static_cast<uint8_t>(value));
}

// Reads what the above wrote; past the end it fails for good and returns zeros.
class StatementReader {
 public:
  explicit StatementReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  bool failed() const { return failed_; }
  size_t remaining() const { return bytes_.size(); }
  uint8_t byte() {
    if (bytes_.empty()) {
      failed_ = true;
      return 0;
    }
    const uint8_t next = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return next;
  }
  uint64_t number(int num_bytes) {
    uint64_t value = 0;
    for (int i = 0; i < num_bytes; ++i) value = value << 8 | byte();
    return value;
  }
  uint64_t varint() {
    uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const uint8_t next = byte();
      value |= static_cast<uint64_t>(next & 0x7f) << shift;
      if ((next & 0x80) == 0) return value;
    }
    failed_ = true;
    return 0;
  }

 private:
  std::span<const uint8_t> bytes_;
  bool failed_ = false;
};

void put(Bytes& out, const Statement& s) {
  out.push_back(static_cast<uint8_t>(static_cast<uint8_t>(s.kind) | (s.asks ? kAsks : 0)));
  putVarint(out, static_cast<uint64_t>(s.share));
  if (s.kind != Statement::Kind::kWanted) {
    out.push_back(static_cast<uint8_t>(s.node.depth));
    putNumber(out, s.node.prefix, (s.node.depth + 1) / 2);
  }
  if (s.kind == Statement::Kind::kChildren) {
    for (const uint16_t digest : s.children) putNumber(out, digest, 2);
    return;
  }
  putVarint(out, s.leaves.size());
  if (s.leaves.empty()) return;
  const uint64_t oldest = std::ranges::min_element(s.leaves, {}, &Statement::Named::version)->version;
  putVarint(out, oldest);
  for (const Statement::Named& leaf : s.leaves) {
    putNumber(out, leaf.key, kKeyBytes);
    putVarint(out, leaf.version - oldest);
  }
}

bool read(StatementReader& in, Statement& s) {
  const uint8_t first = in.byte();
  if ((first & 3) > 2 || first > (kAsks | 2)) return false;
  s.kind = static_cast<Statement::Kind>(first & 3);
  s.asks = (first & kAsks) != 0;
  if (s.kind == Statement::Kind::kWanted && s.asks) return false;
  const uint64_t share = in.varint();
  if (share > static_cast<uint64_t>(kMaxShare)) return false;
  s.share = static_cast<int32_t>(share);
  if (s.kind != Statement::Kind::kWanted) {
    s.node.depth = in.byte();
    const int deepest = s.kind == Statement::Kind::kChildren ? kMaxTreeDepth - 1 : kMaxTreeDepth;
    if (s.node.depth > deepest) return false;
    s.node.prefix = in.number((s.node.depth + 1) / 2);
    if (s.node.prefix >> (4 * s.node.depth) != 0) return false;
  }
  if (s.kind == Statement::Kind::kChildren) {
    for (uint16_t& digest : s.children) digest = static_cast<uint16_t>(in.number(2));
    return !in.failed();
  }
  const uint64_t count = in.varint();
  if (in.failed() || count > kMaxStatementLeaves || count * (kKeyBytes + 1) > in.remaining()) return false;
  if (count == 0) return true;
  const uint64_t oldest = in.varint();
  for (uint64_t i = 0; i < count; ++i) {
    const uint64_t key = in.number(kKeyBytes);
    const uint64_t version = oldest + in.varint();
    if (version < oldest || (i > 0 && s.leaves.back().key >= key)) return false;
    if (s.kind == Statement::Kind::kLeaves && (key < s.node.firstKey() || key >= s.node.endKey()))
      return false;
    s.leaves.push_back({key, version});
  }
  return !in.failed();
}

}  // namespace

uint16_t foldedDigest(uint64_t digest, uint32_t salt) {
  if (digest == 0) return 0;
  const auto folded = static_cast<uint16_t>(hashCombine(salt, digest) >> 48);
  return folded == 0 ? 1 : folded;
}

Bytes encodeTalk(const RepairTalk& talk) {
  SHOAL_DEMAND(talk.statements.size() <= kMaxStatements);
  Bytes out;
  putNumber(out, talk.salt, 4);
  for (const Statement& statement : talk.statements) put(out, statement);
  return out;
}

std::optional<RepairTalk> decodeTalk(std::span<const uint8_t> bytes) {
  StatementReader in(bytes);
  RepairTalk talk;
  talk.salt = static_cast<uint32_t>(in.number(4));
  while (in.remaining() > 0) {
    if (talk.statements.size() == kMaxStatements || !read(in, talk.statements.emplace_back()))
      return std::nullopt;
  }
  if (in.failed()) return std::nullopt;
  const Bytes again = encodeTalk(talk);
  if (!std::ranges::equal(again, bytes)) return std::nullopt;  // one encoding for each talk
  return talk;
}

size_t encodedSize(const Statement& statement) {
  Bytes out;
  put(out, statement);
  return out.size();
}

}  // namespace shoal::comms
