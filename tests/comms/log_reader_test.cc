// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/log_reader.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "shoal/random.h"

namespace shoal::comms {
namespace {

void appendBigEndian(Bytes& out, uint64_t value, int bytes) {
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8)
    out.push_back(static_cast<uint8_t>(value >> shift));
}

void append(Bytes& out, const Bytes& bytes) { out.insert(out.end(), bytes.begin(), bytes.end()); }

Bytes event(uint64_t number, const std::string& channel, const Bytes& payload) {
  Bytes out;
  appendBigEndian(out, 0xEDA1DA01, 4);
  appendBigEndian(out, number, 8);
  appendBigEndian(out, 1'000'000 + number, 8);
  appendBigEndian(out, channel.size(), 4);
  appendBigEndian(out, payload.size(), 4);
  append(out, Bytes(channel.begin(), channel.end()));
  append(out, payload);
  return out;
}

struct Read {
  std::vector<LogEvent> events;
  LogCounts counts;
};

Read read(const Bytes& log) {
  const auto path =
      std::filesystem::temp_directory_path() / ("shoal_log_reader_test_" + std::to_string(getpid()));
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(log.data()), static_cast<std::streamsize>(log.size()));
  Read result;
  LogReader reader(path);
  std::filesystem::remove(path);  // the reader has it open
  while (auto next = reader.next()) result.events.push_back(std::move(*next));
  result.counts = reader.counts();
  EXPECT_EQ(result.counts.good, result.events.size());
  EXPECT_EQ(reader.next().has_value(), false);
  return result;
}

std::string channel(int i) { return "SHOAL_R0" + std::to_string(i % 10) + "_X"; }
Bytes payload(int i) { return Bytes(static_cast<size_t>(10 + i), static_cast<uint8_t>(i)); }

TEST(LogReaderTest, ReadsWhatTheLoggerWrites) {
  Bytes log;
  for (int i = 0; i < 2000; ++i)
    append(log, event(static_cast<uint64_t>(i), channel(i), payload(i)));  // 2 MB
  const Read result = read(log);
  ASSERT_EQ(result.events.size(), 2000u);
  for (int i = 0; i < 2000; ++i) {
    const LogEvent& each = result.events[static_cast<size_t>(i)];
    ASSERT_EQ(each.time_us, 1'000'000 + i);
    ASSERT_EQ(each.packet.channel, channel(i));
    ASSERT_EQ(each.packet.bytes, payload(i));
  }
  EXPECT_EQ(result.counts.damaged, 0u);
}

TEST(LogReaderTest, ReadsNothingFromAnEmptyLog) { EXPECT_TRUE(read({}).events.empty()); }

TEST(LogReaderTest, GoesOnAfterRubbish) {
  Bytes log(100, 0xED);
  append(log, event(0, "A", payload(0)));
  append(log, Bytes(50, 7));
  append(log, event(1, "B", payload(1)));
  append(log, {0xED, 0xA1, 0xDA, 0x01});  // a sync word and no more
  const Read result = read(log);
  ASSERT_EQ(result.events.size(), 2u);
  EXPECT_EQ(result.events[0].packet.bytes, payload(0));
  EXPECT_EQ(result.events[1].packet.bytes, payload(1));
  EXPECT_EQ(result.counts.damaged, 3u);
  EXPECT_EQ(result.counts.damaged_bytes, 154u);
}

// The search goes in steps of 64 KiB: a sync word may lie across two of them.
TEST(LogReaderTest, GoesOnAfterLongRubbishOfAnyLength) {
  for (size_t length = 65536 - 8; length < 65536 + 8; ++length) {
    Bytes log(length, 0xED);
    append(log, event(0, "A", payload(0)));
    EXPECT_EQ(read(log).counts.good, 1u) << length;
  }
}

TEST(LogReaderTest, SurvivesTruncationAtEveryByte) {
  Bytes log;
  std::vector<size_t> ends;
  for (int i = 0; i < 4; ++i) {
    append(log, event(static_cast<uint64_t>(i), channel(i), payload(i)));
    ends.push_back(log.size());
  }
  for (size_t length = 0; length < log.size(); ++length) {
    size_t whole = 0;
    while (ends[whole] <= length) ++whole;
    const Read result = read(Bytes(log.begin(), log.begin() + static_cast<std::ptrdiff_t>(length)));
    ASSERT_EQ(result.events.size(), whole) << length;
    const bool torn = length > (whole == 0 ? 0 : ends[whole - 1]);
    ASSERT_EQ(result.counts.damaged, torn ? 1u : 0u) << length;
  }
}

// One damaged byte in a header costs at most the event it is in, and is seen; elsewhere it costs nothing.
TEST(LogReaderTest, OneDamagedByteCostsAtMostOneEvent) {
  Bytes log;
  std::vector<size_t> starts;
  for (int i = 0; i < 5; ++i) {
    starts.push_back(log.size());
    append(log, event(static_cast<uint64_t>(i), channel(i), payload(i)));
  }
  for (size_t at = 0; at < log.size(); ++at) {
    for (const int flip : {0x01, 0x10, 0x80, 0xff}) {
      Bytes damaged = log;
      damaged[at] = static_cast<uint8_t>(damaged[at] ^ flip);
      size_t hit = 0;
      while (hit + 1 < starts.size() && starts[hit + 1] <= at) ++hit;
      const Read result = read(damaged);
      const size_t in_event = at - starts[hit];
      const bool structural = in_event < 4 || (in_event >= 20 && in_event < 28);
      size_t intact = 0;
      for (const LogEvent& each : result.events) {
        for (int i = 0; i < 5; ++i) {
          intact += each.time_us == 1'000'000 + i && each.packet.channel == channel(i) &&
                    each.packet.bytes == payload(i);
        }
      }
      ASSERT_GE(intact, 4u) << at;
      if (structural) {
        ASSERT_GE(result.counts.damaged, 1u) << at;
      } else {
        ASSERT_EQ(result.events.size(), 5u) << at;
        ASSERT_EQ(result.counts.damaged, 0u) << at;
      }
    }
  }
}

TEST(LogReaderTest, PassesOverLargeEventsAndLongChannels) {
  Bytes log;
  append(log, event(0, "CAMERA", Bytes(kMaxLogPayload + 1, 1)));
  append(log, event(1, "A", Bytes(kMaxLogPayload, 2)));
  append(log, event(2, std::string(64, 'C'), payload(1)));
  append(log, event(3, "", payload(1)));
  append(log, event(4, "CAMERA", Bytes(3'000'000, 1)));
  append(log, event(5, "B", {}));
  const Read result = read(log);
  ASSERT_EQ(result.events.size(), 2u);
  EXPECT_EQ(result.events[0].packet.bytes.size(), kMaxLogPayload);
  EXPECT_EQ(result.events[1].packet.channel, "B");
  EXPECT_EQ(result.counts.large, 2u);
  EXPECT_EQ(result.counts.damaged, 1u);  // two events side by side, one stretch
}

TEST(LogReaderTest, SyncWordsInsideAPayloadMeanNothing) {
  Bytes nested;
  for (int i = 0; i < 3; ++i) append(nested, event(9, "INNER", payload(3)));
  Bytes log;
  append(log, event(0, "A", nested));
  append(log, event(1, "B", nested));
  const Read result = read(log);
  ASSERT_EQ(result.events.size(), 2u);
  EXPECT_EQ(result.events[1].packet.bytes, nested);
}

// Headers that all promise more than there is must not make reading quadratic.
TEST(LogReaderTest, ReadsAMaliciousLogInOnePass) {
  Bytes log;
  for (int i = 0; i < 100'000; ++i) {
    Bytes header = event(static_cast<uint64_t>(i), "A", {});
    header[26] = 0xff;  // claims 65280 bytes
    append(log, header);
  }
  EXPECT_GE(read(log).counts.damaged, 90'000u);
}

TEST(LogReaderTest, ReadsRandomBytesToTheEnd) {
  for (uint64_t trial = 0; trial < 200; ++trial) {
    Random random(8, trial);
    Bytes log;
    while (log.size() < 3000) {
      if (random.below(3) == 0) {
        Bytes head = event(random(), "AB", payload(static_cast<int>(random.below(50))));
        head.resize(random.below(head.size() + 1));
        append(log, head);
      } else {
        log.push_back(static_cast<uint8_t>(random()));
      }
    }
    const Read result = read(log);
    uint64_t bytes = result.counts.damaged_bytes;
    for (const LogEvent& each : result.events)
      bytes += 28 + each.packet.channel.size() + each.packet.bytes.size();
    EXPECT_EQ(bytes, log.size());
  }
}

TEST(LogReaderTest, NamesTheFileThatCannotBeRead) {
  for (const char* path : {"/nonexistent/mission.lcmlog", "/tmp"}) {
    try {
      LogReader reader{std::string(path)};
      ADD_FAILURE() << path;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace shoal::comms
