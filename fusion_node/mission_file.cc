// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/mission_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <sqlite3.h>

namespace shoal::fusion_node {
namespace {

constexpr int kFormat = 1;
constexpr int kPatienceMs = 5000;  // with a reader that makes a checkpoint of the log

using Database = std::unique_ptr<sqlite3, CloseSqlite>;
using Statement = std::unique_ptr<sqlite3_stmt, CloseSqlite>;

[[noreturn]] void fail(const std::string& path, sqlite3* database) {
  throw std::runtime_error(path + ": " + (database == nullptr ? "out of memory" : sqlite3_errmsg(database)));
}

Database open(const std::string& path, int flags) {
  sqlite3* opened = nullptr;
  const int result = sqlite3_open_v2(path.c_str(), &opened, flags, nullptr);
  Database database(opened);
  if (result != SQLITE_OK) fail(path, opened);
  sqlite3_busy_timeout(opened, kPatienceMs);
  sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, 1 << 20);  // no message is as long
  return database;
}

void run(const std::string& path, sqlite3* database, const char* sql) {
  if (sqlite3_exec(database, sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail(path, database);
}

Statement prepared(const std::string& path, sqlite3* database, const char* sql) {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database, sql, -1, &statement, nullptr) != SQLITE_OK) fail(path, database);
  return Statement(statement);
}

// Runs a statement that gives no rows, and makes it ready to be run again.
void step(const std::string& path, sqlite3* database, sqlite3_stmt* statement) {
  const int result = sqlite3_step(statement);
  sqlite3_reset(statement);
  if (result != SQLITE_DONE) fail(path, database);
}

void bind(sqlite3_stmt* statement, int place, const std::string& text) {
  sqlite3_bind_text(statement, place, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
}

std::string textIn(sqlite3_stmt* row, int column) {
  const auto* text = static_cast<const char*>(sqlite3_column_blob(row, column));
  return text == nullptr ? "" : std::string(text, static_cast<size_t>(sqlite3_column_bytes(row, column)));
}

std::string meta(const std::string& path, sqlite3* database, const std::string& key) {
  const Statement row = prepared(path, database, "SELECT value FROM meta WHERE key = ?");
  bind(row.get(), 1, key);
  return sqlite3_step(row.get()) == SQLITE_ROW ? textIn(row.get(), 0) : "";
}

void setMeta(const std::string& path, sqlite3* database, const std::string& key, const std::string& value) {
  const Statement row = prepared(path, database, "INSERT OR REPLACE INTO meta VALUES (?, ?)");
  bind(row.get(), 1, key);
  bind(row.get(), 2, value);
  step(path, database, row.get());
}

void checkFormat(const std::string& path, sqlite3* database) {
  if (const std::string format = meta(path, database, "format"); format != std::to_string(kFormat)) {
    throw std::runtime_error(path + " has format \"" + format + "\", not 1, the only one known");
  }
}

// What the node wrote last lies in a file beside it, which only who may write can take in. Without one, who
// may only read can do so too.
Database openToRead(const std::string& path) {
  const auto mayWrite = [](const std::filesystem::path& file) {
    return ::faccessat(AT_FDCWD, file.c_str(), W_OK, AT_EACCESS) == 0;
  };
  std::error_code none;
  const auto whole = std::filesystem::absolute(path);
  const bool is_all = std::filesystem::file_size(path + "-wal", none) == 0 || none;
  if (!is_all || (mayWrite(whole) && mayWrite(whole.parent_path()))) return open(path, SQLITE_OPEN_READWRITE);
  std::string uri = "file:";
  for (const char c : whole.string()) {
    if (c == '%' || c == '?' || c == '#') {
      uri += c == '%' ? "%25" : c == '?' ? "%3f" : "%23";
    } else {
      uri += c;
    }
  }
  return open(uri + "?immutable=1", SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
}

}  // namespace

void CloseSqlite::operator()(sqlite3* database) const { sqlite3_close_v2(database); }
void CloseSqlite::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

MissionFile::MissionFile(const std::string& path, const std::string& node, int32_t mission)
    : path_(path), database_(open(path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE)) {
  run(path_, database_.get(), "PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; BEGIN IMMEDIATE;");
  run(path_, database_.get(),
      "CREATE TABLE IF NOT EXISTS meta (key TEXT PRIMARY KEY, value TEXT);"
      "CREATE TABLE IF NOT EXISTS heard (id INTEGER PRIMARY KEY, wall_us INTEGER, channel TEXT, bytes BLOB);"
      "CREATE TABLE IF NOT EXISTS events (id INTEGER PRIMARY KEY, at_s REAL, kind TEXT, node TEXT, says "
      "TEXT);");
  if (meta(path_, database_.get(), "format").empty()) {
    setMeta(path_, database_.get(), "format", std::to_string(kFormat));
    setMeta(path_, database_.get(), "mission", std::to_string(mission));
    setMeta(path_, database_.get(), "node", node);
  }
  run(path_, database_.get(), "COMMIT");
  checkFormat(path_, database_.get());
  if (const std::string of = meta(path_, database_.get(), "mission"); of != std::to_string(mission)) {
    throw std::runtime_error(path_ + " is of mission " + of + ", not of " + std::to_string(mission));
  }
  put_packet_ =
      prepared(path_, database_.get(), "INSERT INTO heard (wall_us, channel, bytes) VALUES (?, ?, ?)");
  put_event_ =
      prepared(path_, database_.get(), "INSERT INTO events (at_s, kind, node, says) VALUES (?, ?, ?, ?)");
}

void MissionFile::begin() {
  if (is_open_) return;
  run(path_, database_.get(), "BEGIN IMMEDIATE");
  is_open_ = true;
}

void MissionFile::append(const comms::Packet& packet, int64_t wall_us) {
  begin();
  sqlite3_bind_int64(put_packet_.get(), 1, wall_us);
  bind(put_packet_.get(), 2, packet.channel);
  sqlite3_bind_blob(put_packet_.get(), 3, packet.bytes.data(), static_cast<int>(packet.bytes.size()),
                    SQLITE_TRANSIENT);
  step(path_, database_.get(), put_packet_.get());
}

void MissionFile::append(const mapping::MissionEvent& event) {
  begin();
  sqlite3_bind_double(put_event_.get(), 1, event.at_s);
  bind(put_event_.get(), 2, event.kind);
  bind(put_event_.get(), 3, event.node);
  bind(put_event_.get(), 4, event.says);
  step(path_, database_.get(), put_event_.get());
}

void MissionFile::set(const std::string& key, const std::string& value) {
  begin();
  setMeta(path_, database_.get(), key, value);
}

std::string MissionFile::get(const std::string& key) const { return meta(path_, database_.get(), key); }

void MissionFile::commit() {
  if (!is_open_) return;
  run(path_, database_.get(), "COMMIT");
  is_open_ = false;
}

std::vector<mapping::MissionEvent> MissionFile::events() const {
  const Statement rows =
      prepared(path_, database_.get(), "SELECT at_s, kind, node, says FROM events ORDER BY id");
  std::vector<mapping::MissionEvent> events;
  int result = SQLITE_ROW;
  while ((result = sqlite3_step(rows.get())) == SQLITE_ROW) {
    events.push_back({sqlite3_column_double(rows.get(), 0), textIn(rows.get(), 1), textIn(rows.get(), 2),
                      textIn(rows.get(), 3)});
  }
  if (result != SQLITE_DONE) fail(path_, database_.get());
  return events;
}

MissionFileReader::MissionFileReader(const std::string& path) : path_(path), database_(openToRead(path)) {
  checkFormat(path_, database_.get());
  rows_ = prepared(path_, database_.get(), "SELECT wall_us, channel, bytes FROM heard ORDER BY id");
}

std::optional<comms::LogEvent> MissionFileReader::next() {
  const int result = sqlite3_step(rows_.get());
  if (result == SQLITE_DONE) return std::nullopt;
  if (result != SQLITE_ROW) fail(path_, database_.get());
  const std::string bytes = textIn(rows_.get(), 2);
  return comms::LogEvent{sqlite3_column_int64(rows_.get(), 0),
                         {textIn(rows_.get(), 1), {bytes.begin(), bytes.end()}}};
}

bool isSqlite(const std::string& path) {
  std::array<char, 16> magic{};
  std::ifstream file(path, std::ios::binary);
  file.read(magic.data(), magic.size());
  return file && std::string(magic.data(), magic.size() - 1) == "SQLite format 3";
}

}  // namespace shoal::fusion_node
