// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace shoal::console {

/// Writes an MCAP file (mcap.dev/spec, version 0): uncompressed chunks with indexes and checksums, messages
/// in JSON. Same calls, same bytes.
class McapWriter {
 public:
  McapWriter();

  /// A topic whose messages follow a JSON schema. @returns what say() calls it.
  uint16_t channel(const std::string& topic, const std::string& schema_name, std::string_view json_schema);
  /// @param time_ns  never less than that of the message before.
  void say(uint16_t channel, uint64_t time_ns, std::string_view json);
  /// The whole file; nothing may be said afterwards.
  std::string finish();

 private:
  struct Chunk {
    uint64_t first_ns, last_ns, at, size, index_size, records_size;
    std::map<uint16_t, uint64_t> index_at;  // by channel, offset in the file
  };

  void endChunk();

  std::string file_;
  std::string schemas_, channels_;
  std::map<std::string, uint16_t> schema_ids_;
  uint16_t next_channel_ = 1;
  std::string records_;  // of the chunk that is being filled
  std::map<uint16_t, std::vector<std::pair<uint64_t, uint64_t>>>
      index_;                            // by channel: time, offset in records_
  uint64_t first_ns_ = 0, last_ns_ = 0;  // of that chunk
  std::vector<Chunk> chunks_;
  std::map<uint16_t, uint64_t> counts_;
};

}  // namespace shoal::console
