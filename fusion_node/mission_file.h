// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shoal/comms/log_reader.h"
#include "shoal/comms/packet.h"
#include "shoal/mapping/events_answer.h"

struct sqlite3;
struct sqlite3_stmt;

namespace shoal::fusion_node {

struct CloseSqlite {
  void operator()(sqlite3* database) const;
  void operator()(sqlite3_stmt* statement) const;
};

/// What one node heard of one mission, in the order in which it heard it, as an SQLite database: tables
/// `meta` (key, value: format, mission, node and what set() says), `heard` (id, wall_us, channel, bytes) and
/// `events` (id, at_s, kind, node, says). Write-ahead log: readers of other processes do not wait, and a
/// process that is killed at any moment loses what it had not committed and nothing else. A machine that
/// loses power may lose the last transactions, never the file.
class MissionFile {
 public:
  /// Opens the file, or makes it. @throws std::runtime_error naming a file that cannot be opened, is of
  /// another mission, or is no such file.
  MissionFile(const std::string& path, const std::string& node, int32_t mission);

  /// Adds to the transaction that is open, or to a new one. @throws std::runtime_error, as all below.
  void append(const comms::Packet& packet, int64_t wall_us);
  void append(const mapping::MissionEvent& event);
  /// One value for every key, that of the last time.
  void set(const std::string& key, const std::string& value);

  /// What was added is on its way to the disk: no kill takes it back. Costs nothing when nothing was.
  void commit();

  std::vector<mapping::MissionEvent> events() const;
  std::string get(const std::string& key) const;  ///< empty when it was never set

 private:
  void begin();

  std::string path_;
  std::unique_ptr<sqlite3, CloseSqlite> database_;
  std::unique_ptr<sqlite3_stmt, CloseSqlite> put_packet_, put_event_;
  bool is_open_ = false;  // a transaction
};

/// Reads what such a file held when it was opened. Any bytes may stand in it.
class MissionFileReader {
 public:
  /// @throws std::runtime_error naming a file that cannot be opened or is no such file.
  explicit MissionFileReader(const std::string& path);

  /// The next message; nothing at the end. @throws std::runtime_error when the file is broken there.
  std::optional<comms::LogEvent> next();

 private:
  std::string path_;
  std::unique_ptr<sqlite3, CloseSqlite> database_;
  std::unique_ptr<sqlite3_stmt, CloseSqlite> rows_;
};

/// True for files that begin as SQLite's do.
bool isSqlite(const std::string& path);

}  // namespace shoal::fusion_node
