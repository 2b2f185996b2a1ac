// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/export/mcap_writer.h"

#include <zlib.h>

#include <algorithm>
#include <utility>

#include "operator_console/export/little_endian.h"
#include "shoal/demand.h"

namespace shoal::console {
namespace {

constexpr size_t kChunkBytes = size_t{4} << 20;  // a chunk ends with the message that fills it
constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";

enum class McapOp : uint8_t {
  kHeader = 1,
  kFooter,
  kSchema,
  kChannel,
  kMessage,
  kChunk,
  kMessageIndex,
  kChunkIndex,
  kStatistics = 0x0b,
  kSummaryOffset = 0x0e,
  kDataEnd = 0x0f
};

void addMcapText(std::string& bytes, std::string_view text) {
  addLittleEndian(bytes, static_cast<uint32_t>(text.size()));
  bytes += text;
}

void addMcapRecord(std::string& bytes, McapOp op, std::string_view content) {
  bytes += static_cast<char>(op);
  addLittleEndian(bytes, static_cast<uint64_t>(content.size()));
  bytes += content;
}

uint32_t mcapCrc(std::string_view bytes) {
  return static_cast<uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace

McapWriter::McapWriter() : file_(kMcapMagic) {
  std::string header;
  addMcapText(header, "");  // no profile
  addMcapText(header, "shoal");
  addMcapRecord(file_, McapOp::kHeader, header);
}

uint16_t McapWriter::channel(const std::string& topic, const std::string& schema_name,
                             std::string_view json_schema) {
  const auto [schema, is_new] =
      schema_ids_.emplace(schema_name, static_cast<uint16_t>(schema_ids_.size() + 1));
  if (is_new) {
    std::string content, record;
    addLittleEndian(content, schema->second);
    addMcapText(content, schema_name);
    addMcapText(content, "jsonschema");
    addMcapText(content, json_schema);
    addMcapRecord(record, McapOp::kSchema, content);
    schemas_ += record;
    records_ += record;
  }
  const uint16_t id = next_channel_++;
  std::string content, record;
  addLittleEndian(content, id);
  addLittleEndian(content, schema->second);
  addMcapText(content, topic);
  addMcapText(content, "json");
  addLittleEndian(content, uint32_t{0});  // no metadata
  addMcapRecord(record, McapOp::kChannel, content);
  channels_ += record;
  records_ += record;
  counts_[id] = 0;
  return id;
}

void McapWriter::say(uint16_t channel, uint64_t time_ns, std::string_view json) {
  SHOAL_DEMAND(counts_.contains(channel) && time_ns >= last_ns_);
  if (index_.empty()) first_ns_ = time_ns;
  last_ns_ = time_ns;
  index_[channel].emplace_back(time_ns, records_.size());
  std::string content;
  content.reserve(json.size() + 22);
  addLittleEndian(content, channel);
  addLittleEndian(content, static_cast<uint32_t>(counts_[channel]++));
  addLittleEndian(content, time_ns);
  addLittleEndian(content, time_ns);
  content += json;
  addMcapRecord(records_, McapOp::kMessage, content);
  if (records_.size() >= kChunkBytes) endChunk();
}

void McapWriter::endChunk() {
  if (records_.empty()) return;
  Chunk chunk{first_ns_, last_ns_, file_.size(), 0, 0, records_.size(), {}};
  if (index_.empty()) chunk.first_ns = chunk.last_ns = 0;  // no message at all
  std::string content;
  addLittleEndian(content, chunk.first_ns);
  addLittleEndian(content, chunk.last_ns);
  addLittleEndian(content, static_cast<uint64_t>(records_.size()));
  addLittleEndian(content, mcapCrc(records_));
  addMcapText(content, "");  // not compressed
  addLittleEndian(content, static_cast<uint64_t>(records_.size()));
  content += records_;
  addMcapRecord(file_, McapOp::kChunk, content);
  chunk.size = file_.size() - chunk.at;
  for (const auto& [channel, entries] : index_) {
    std::string index;
    addLittleEndian(index, channel);
    addLittleEndian(index, static_cast<uint32_t>(entries.size() * 16));
    for (const auto& [time_ns, offset] : entries) {
      addLittleEndian(index, time_ns);
      addLittleEndian(index, offset);
    }
    chunk.index_at[channel] = file_.size();
    addMcapRecord(file_, McapOp::kMessageIndex, index);
  }
  chunk.index_size = file_.size() - chunk.at - chunk.size;
  chunks_.push_back(std::move(chunk));
  records_.clear();
  index_.clear();
}

std::string McapWriter::finish() {
  endChunk();
  std::string end;
  addLittleEndian(end, uint32_t{0});  // no checksum over all: chunks have theirs
  addMcapRecord(file_, McapOp::kDataEnd, end);

  const uint64_t summary_at = file_.size();
  std::vector<std::pair<McapOp, std::string>> groups = {{McapOp::kSchema, schemas_},
                                                        {McapOp::kChannel, channels_}};
  std::string statistics, indexes;
  uint64_t messages = 0, first_ns = 0, last_ns = 0;
  for (const auto& [channel, count] : counts_) messages += count;
  bool any = false;
  for (const Chunk& c : chunks_) {
    if (c.index_at.empty()) continue;
    first_ns = any ? std::min(first_ns, c.first_ns) : c.first_ns;
    last_ns = any ? std::max(last_ns, c.last_ns) : c.last_ns;
    any = true;
  }
  std::string content;
  addLittleEndian(content, messages);
  addLittleEndian(content, static_cast<uint16_t>(schema_ids_.size()));
  addLittleEndian(content, static_cast<uint32_t>(counts_.size()));
  addLittleEndian(content, uint32_t{0});  // attachments
  addLittleEndian(content, uint32_t{0});  // metadata
  addLittleEndian(content, static_cast<uint32_t>(chunks_.size()));
  addLittleEndian(content, first_ns);
  addLittleEndian(content, last_ns);
  addLittleEndian(content, static_cast<uint32_t>(counts_.size() * 10));
  for (const auto& [channel, count] : counts_) {
    addLittleEndian(content, channel);
    addLittleEndian(content, count);
  }
  addMcapRecord(statistics, McapOp::kStatistics, content);
  groups.emplace_back(McapOp::kStatistics, statistics);
  for (const Chunk& c : chunks_) {
    content.clear();
    for (const uint64_t number : {c.first_ns, c.last_ns, c.at, c.size}) addLittleEndian(content, number);
    addLittleEndian(content, static_cast<uint32_t>(c.index_at.size() * 10));
    for (const auto& [channel, at] : c.index_at) {
      addLittleEndian(content, channel);
      addLittleEndian(content, at);
    }
    addLittleEndian(content, c.index_size);
    addMcapText(content, "");
    addLittleEndian(content, c.records_size);
    addLittleEndian(content, c.records_size);
    addMcapRecord(indexes, McapOp::kChunkIndex, content);
  }
  groups.emplace_back(McapOp::kChunkIndex, indexes);

  std::string offsets;
  for (const auto& [op, records] : groups) {
    if (records.empty()) continue;
    content.clear();
    content += static_cast<char>(op);
    addLittleEndian(content, static_cast<uint64_t>(file_.size()));
    addLittleEndian(content, static_cast<uint64_t>(records.size()));
    addMcapRecord(offsets, McapOp::kSummaryOffset, content);
    file_ += records;
  }
  const uint64_t offsets_at = file_.size();
  file_ += offsets;
  // The footer's checksum covers the summary and the footer up to itself.
  file_ += static_cast<char>(McapOp::kFooter);
  addLittleEndian(file_, uint64_t{20});
  addLittleEndian(file_, summary_at);
  addLittleEndian(file_, offsets_at);
  addLittleEndian(file_, mcapCrc(std::string_view(file_).substr(summary_at)));
  file_ += kMcapMagic;
  return std::move(file_);
}

}  // namespace shoal::console
