// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <limits>
#include <map>
#include <stdexcept>

#include <zstd.h>

#include "operator_console/bag/bag_reader.h"

namespace shoal::console {
namespace {

constexpr std::string_view kMagic = "\x89MCAP0\r\n";
constexpr uint64_t kMaxRecord = uint64_t{1} << 28;  // a chunk is some megabytes
constexpr size_t kMaxBagChannels = 65536;

enum Opcode : uint8_t { kSchema = 3, kChannel = 4, kMessage = 5, kChunk = 6, kDataEnd = 15 };

// Little-endian fields; reading past the end gives zeros and is remembered.
class Fields {
 public:
  explicit Fields(std::span<const uint8_t> bytes) : left_(bytes) {}
  bool good() const { return good_; }
  uint64_t number(size_t size) {
    uint64_t value = 0;
    const auto taken = take(size);
    for (size_t i = taken.size(); i-- > 0;) value = value << 8 | taken[i];
    return value;
  }
  std::string string() {
    const auto taken = take(number(4));
    return {taken.begin(), taken.end()};
  }
  std::span<const uint8_t> take(uint64_t size) {
    if (!good_ || size > left_.size()) {
      good_ = false;
      return {};
    }
    const auto taken = left_.first(static_cast<size_t>(size));
    left_ = left_.subspan(static_cast<size_t>(size));
    return taken;
  }
  std::span<const uint8_t> rest() { return take(left_.size()); }
  bool isEmpty() const { return left_.empty(); }

 private:
  std::span<const uint8_t> left_;
  bool good_ = true;
};

class Mcap {
 public:
  Mcap(const std::string& name, const OnBagMessage& on_message) : name_(name), on_message_(on_message) {}

  void record(uint8_t opcode, std::span<const uint8_t> content, bool in_chunk) {
    Fields f(content);
    if (opcode == kSchema) {
      const uint64_t id = f.number(2);
      const std::string type = f.string();
      if (f.good()) types_[id] = type;
    } else if (opcode == kChannel) {
      const uint64_t id = f.number(2), schema = f.number(2);
      Channel channel{f.string(), types_[schema], {}};
      channel.is_cdr = f.string() == "cdr";
      if (f.good() && channels_.size() < kMaxBagChannels) channels_.insert_or_assign(id, channel);
    } else if (opcode == kMessage) {
      const auto channel = channels_.find(f.number(2));
      f.take(4 + 8 + 8);  // sequence, times: messages have stamps of their own
      const auto data = f.rest();
      if (f.good() && channel != channels_.end() && channel->second.is_cdr)
        on_message_({channel->second.topic, channel->second.type, data});
    } else if (opcode == kChunk && !in_chunk) {
      chunk(f);
    }
  }

 private:
  struct Channel {
    std::string topic, type;
    bool is_cdr = false;
  };

  void chunk(Fields& f) {
    f.take(8 + 8);
    const uint64_t size = f.number(8);
    f.take(4);
    const std::string compression = f.string();
    std::span<const uint8_t> records = f.take(f.number(8));
    if (!f.good()) throw std::runtime_error(name_ + ": a chunk is broken");
    std::vector<uint8_t> unpacked;
    if (compression == "zstd") {
      if (size > kMaxRecord) throw std::runtime_error(name_ + ": a chunk is larger than 256 MB");
      unpacked.resize(static_cast<size_t>(size));
      const size_t got = ZSTD_decompress(unpacked.data(), unpacked.size(), records.data(), records.size());
      if (ZSTD_isError(got) != 0 || got != unpacked.size())
        throw std::runtime_error(name_ + ": a chunk cannot be unpacked");
      records = unpacked;
    } else if (!compression.empty()) {
      throw std::runtime_error(name_ + ": chunks are packed with " + compression +
                               "; none and zstd are read (mcap compress --compression zstd)");
    }
    Fields inside(records);
    while (!inside.isEmpty()) {
      const auto opcode = static_cast<uint8_t>(inside.number(1));
      const auto content = inside.take(inside.number(8));
      if (!inside.good()) throw std::runtime_error(name_ + ": a chunk is broken");
      record(opcode, content, true);
    }
  }

  const std::string& name_;
  const OnBagMessage& on_message_;
  std::map<uint64_t, std::string> types_;
  std::map<uint64_t, Channel> channels_;
};

}  // namespace

void readMcap(std::istream& in, const std::string& name, const OnBagMessage& on_message) {
  std::array<char, kMagic.size()> magic{};
  if (!in.read(magic.data(), magic.size()) || std::string_view(magic.data(), magic.size()) != kMagic) {
    throw std::runtime_error(name + " is no MCAP file");
  }
  Mcap mcap(name, on_message);
  std::vector<uint8_t> content;
  std::array<uint8_t, 9> head{};
  while (in.read(reinterpret_cast<char*>(head.data()), head.size())) {
    const uint64_t size = Fields(std::span(head).subspan(1)).number(8);
    if (size > kMaxRecord) throw std::runtime_error(name + ": a record is larger than 256 MB");
    content.clear();
    constexpr uint64_t kStep = 1 << 20;  // memory grows with what is there, not with what a length says
    while (content.size() < size && in) {
      const size_t step = static_cast<size_t>(std::min<uint64_t>(kStep, size - content.size()));
      content.resize(content.size() + step);
      in.read(reinterpret_cast<char*>(content.data() + content.size() - step),
              static_cast<std::streamsize>(step));
    }
    if (!in) return;  // cut off
    if (head[0] == kDataEnd) return;
    mcap.record(head[0], content, false);
  }
}

}  // namespace shoal::console
