// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/checkpoint.h"

#include <array>
#include <bit>
#include <charconv>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

#include "shoal/mapping/atomic_file.h"
#include "shoal/random.h"
#include "shoal/wire/bytes.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/piece_codec.h"

namespace shoal::robot_agent {
namespace {

constexpr std::string_view kMagic = "SHOALRC6";  // the last letter is the version
constexpr int64_t kMostTrailer = 64;             // of a datagram
constexpr size_t kTrailer = 16;                  // checksum, and how long the explorer's part is

// Of several runs of bytes, each of so many.
uint64_t hashOf(std::span<const uint8_t> bytes, uint64_t hash = 0) {
  hash = hashCombine(hash, bytes.size());
  for (; bytes.size() >= 8; bytes = bytes.subspan(8))
    hash = hashCombine(hash, wire::bigEndian(bytes.first(8)));
  return hashCombine(hash, wire::bigEndian(bytes));
}

std::string_view textOf(std::span<const uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void putNumber(wire::Bytes& out, int64_t value) { wire::putBigEndian(out, static_cast<uint64_t>(value), 8); }

void putBlob(wire::Bytes& out, std::span<const uint8_t> blob) {
  wire::putVarint(out, blob.size());
  out.insert(out.end(), blob.begin(), blob.end());
}

int64_t number64(wire::ByteReader& in) { return static_cast<int64_t>(in.bigEndian(8)); }

void putBrick(wire::Bytes& out, const mapping::Brick& brick) {
  for (const int32_t i : brick) wire::putBigEndian(out, static_cast<uint32_t>(i), 4);
}

mapping::Brick readBrick(wire::ByteReader& in) {
  mapping::Brick brick{};
  for (int32_t& i : brick) i = static_cast<int32_t>(in.bigEndian(4));
  return brick;
}

Checkpoint read(wire::ByteReader& in, const std::string& path) {
  const auto damaged = [&path](const std::string& what) {
    return std::runtime_error(path + " is damaged: " + what);
  };
  Checkpoint c;
  c.mission = static_cast<int32_t>(number64(in));
  c.robot = world::RobotId{static_cast<int32_t>(number64(in))};
  c.epoch = static_cast<int32_t>(number64(in));
  c.mission_us = number64(in);
  c.saved.wall_us = number64(in);
  c.saved.boot_us = number64(in);
  c.saved.boot_id = textOf(in.take(in.varint()));
  c.detail = in.bigEndian(1) == 0 ? mapping::Detail::kFine : mapping::Detail::kCoarse;
  c.cut = {number64(in), number64(in)};
  if (c.cut.budget < 0 || c.cut.trailer < 0 || c.cut.trailer > kMostTrailer)
    throw damaged("pieces cannot be cut so");
  for (uint64_t n = in.varint(); n > 0 && !in.failed(); --n) {
    const bool waits = in.bigEndian(1) != 0;
    const auto message = in.take(in.varint());
    const auto header = wire::peek(message);
    if (!header) throw damaged("what is no message stands for a piece");
    const auto pieces = wire::decodePieces(header->kind, message);
    if (!pieces) throw damaged("a piece is refused: " + std::string(wire::name(pieces.error())));
    for (const mapping::Piece& piece : *pieces) c.said.push_back({piece, waits, {}});
  }
  for (uint64_t n = in.varint(); n > 0 && !in.failed(); --n) {
    mapping::BeliefChanges::Waiting waiting;
    waiting.key.robot = c.robot;
    waiting.key.kind = static_cast<mapping::PieceKind>(in.bigEndian(1));
    if (waiting.key.kind != mapping::PieceKind::kTopic && waiting.key.kind != mapping::PieceKind::kBrick &&
        waiting.key.kind != mapping::PieceKind::kCertainty)
      throw damaged("what waits is neither topic nor brick");
    waiting.key.index = readBrick(in);
    waiting.told_hash = in.bigEndian(8);
    waiting.since = static_cast<int32_t>(in.bigEndian(4));
    c.untold.push_back(waiting);
  }
  if (in.bigEndian(1) != 0) c.looked_until = readBrick(in);
  for (uint64_t n = in.varint(); n > 0 && !in.failed(); --n) c.seen.insert(readBrick(in));
  for (uint64_t n = in.varint(); n > 0 && !in.failed(); --n) {
    mapping::StampedPose pose;
    pose.time.us = number64(in);
    for (Eigen::Index row = 0; row < 3; ++row)
      for (Eigen::Index column = 0; column < 4; ++column)
        pose.world_from_camera.matrix()(row, column) = std::bit_cast<double>(in.bigEndian(8));
    c.path.push_back(pose);
  }
  const auto explorer = in.take(in.varint());
  c.explorer.assign(explorer.begin(), explorer.end());
  if (in.failed() || in.remaining() != 0) throw damaged("its lengths do not fit");
  return c;
}

}  // namespace

std::string epochPath(const std::string& folder, world::RobotId robot) {
  return folder + "/" + world::name(robot) + ".epoch";
}

std::optional<int32_t> readEpoch(const std::string& path) {
  constexpr int32_t kMost = 1'000'000;
  if (!std::filesystem::exists(path)) return std::nullopt;
  std::string text = mapping::readFile(path);
  if (text.ends_with('\n')) text.pop_back();
  int32_t epoch = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), epoch);
  if (error != std::errc{} || end != text.data() + text.size() || epoch < 0 || epoch >= kMost) {
    throw std::runtime_error(path + " should hold the number of an epoch, but holds \"" + text.substr(0, 40) +
                             "\"; write there the last in which the robot has spoken, 0 for the first");
  }
  return epoch;
}

std::string checkpointPath(const std::string& folder, world::RobotId robot) {
  return folder + "/" + world::name(robot) + ".checkpoint";
}

void writeCheckpoint(const std::string& path, const Checkpoint& c) {
  wire::Bytes out(kMagic.begin(), kMagic.end());
  for (const int64_t value : {int64_t{c.mission}, int64_t{number(c.robot)}, int64_t{c.epoch}, c.mission_us,
                              c.saved.wall_us, c.saved.boot_us})
    putNumber(out, value);
  putBlob(out, std::span(reinterpret_cast<const uint8_t*>(c.saved.boot_id.data()), c.saved.boot_id.size()));
  out.push_back(c.detail == mapping::Detail::kFine ? 0 : 1);
  putNumber(out, c.cut.budget);
  putNumber(out, c.cut.trailer);
  wire::putVarint(out, c.said.size());
  for (const Checkpoint::Said& said : c.said) {
    out.push_back(said.waits ? 1 : 0);
    putBlob(out, said.message.empty() ? wire::encode(said.piece, c.mission, {}) : said.message);
  }
  wire::putVarint(out, c.untold.size());
  for (const mapping::BeliefChanges::Waiting& waiting : c.untold) {
    out.push_back(static_cast<uint8_t>(waiting.key.kind));
    putBrick(out, waiting.key.index);
    wire::putBigEndian(out, waiting.told_hash, 8);
    wire::putBigEndian(out, static_cast<uint32_t>(waiting.since), 4);
  }
  out.push_back(c.looked_until ? 1 : 0);
  if (c.looked_until) putBrick(out, *c.looked_until);
  wire::putVarint(out, c.seen.size());
  for (const mapping::Brick& brick : c.seen) putBrick(out, brick);
  wire::putVarint(out, c.path.size());
  for (const mapping::StampedPose& pose : c.path) {
    putNumber(out, pose.time.us);
    for (Eigen::Index row = 0; row < 3; ++row)
      for (Eigen::Index column = 0; column < 4; ++column)
        wire::putBigEndian(out, std::bit_cast<uint64_t>(pose.world_from_camera.matrix()(row, column)), 8);
  }
  wire::putVarint(out, c.explorer.size());
  // Its mind is most of it, and is not copied.
  wire::Bytes checksum;
  wire::putBigEndian(checksum, hashOf(c.explorer, hashOf(out)), 8);
  wire::putBigEndian(checksum, c.explorer.size(), 8);
  const std::array contents = {textOf(out), textOf(c.explorer), textOf(checksum)};
  mapping::writeFileAtomically(path, contents);
}

void removeUnfinished(const std::string& path) {
  const std::filesystem::path file(path);
  std::error_code error;
  std::vector<std::filesystem::path> unfinished;
  for (const auto& entry : std::filesystem::directory_iterator(file.parent_path(), error)) {
    if (entry.path().filename().string().starts_with(file.filename().string() + ".tmp"))
      unfinished.push_back(entry.path());
  }
  for (const auto& each : unfinished) std::filesystem::remove(each, error);
}

std::optional<Checkpoint> readCheckpoint(const std::string& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  const std::string text = mapping::readFile(path);
  const auto bytes = std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size());
  if (bytes.size() < kMagic.size() + kTrailer || !text.starts_with(kMagic))
    throw std::runtime_error(path + " is no checkpoint of this version");
  const auto body = bytes.first(bytes.size() - kTrailer);
  const uint64_t mind = wire::bigEndian(bytes.last(8));
  if (mind > body.size() || hashOf(body.last(mind), hashOf(body.first(body.size() - mind))) !=
                                wire::bigEndian(bytes.last(kTrailer).first(8)))
    throw std::runtime_error(path + " is damaged");
  wire::ByteReader in(body.subspan(kMagic.size()));
  return read(in, path);
}

}  // namespace shoal::robot_agent
