// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/bag/bag_reader.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <stdexcept>

#include <sqlite3.h>

#include "fusion_node/mission_file.h"

namespace shoal::console {
namespace {

namespace fs = std::filesystem;
using fusion_node::CloseSqlite;

// rosbag2_storage_sqlite3: topics (id, name, type, serialization_format), messages (topic_id, timestamp,
// data).
void readDb3(const std::string& path, const OnBagMessage& on_message) {
  sqlite3* opened = nullptr;
  const int result = sqlite3_open_v2(path.c_str(), &opened, SQLITE_OPEN_READONLY, nullptr);
  const std::unique_ptr<sqlite3, CloseSqlite> database(opened);
  const auto fail = [&] { throw std::runtime_error(path + ": " + sqlite3_errmsg(opened)); };
  if (result != SQLITE_OK) fail();
  const auto prepare = [&](const char* sql) {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(opened, sql, -1, &statement, nullptr) != SQLITE_OK) fail();
    return std::unique_ptr<sqlite3_stmt, CloseSqlite>(statement);
  };
  const auto text = [](sqlite3_stmt* row, int column) {
    const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
    return bytes == nullptr ? std::string() : std::string(bytes);
  };
  struct Topic {
    std::string name, type;
  };
  std::map<int64_t, Topic> topics;
  const auto listed = prepare("SELECT id, name, type FROM topics WHERE serialization_format = 'cdr'");
  int stepped = SQLITE_ROW;
  while ((stepped = sqlite3_step(listed.get())) == SQLITE_ROW) {
    topics[sqlite3_column_int64(listed.get(), 0)] = {text(listed.get(), 1), text(listed.get(), 2)};
  }
  if (stepped != SQLITE_DONE) fail();
  const auto rows = prepare("SELECT topic_id, data FROM messages ORDER BY timestamp, id");
  while ((stepped = sqlite3_step(rows.get())) == SQLITE_ROW) {
    const auto topic = topics.find(sqlite3_column_int64(rows.get(), 0));
    if (topic == topics.end()) continue;
    const auto* data = static_cast<const uint8_t*>(sqlite3_column_blob(rows.get(), 1));
    const auto size = static_cast<size_t>(sqlite3_column_bytes(rows.get(), 1));
    on_message({topic->second.name, topic->second.type, std::span(data, data == nullptr ? 0 : size)});
  }
  if (stepped != SQLITE_DONE) fail();
}

void readFile(const fs::path& file, const OnBagMessage& on_message) {
  if (file.extension() == ".db3") return readDb3(file, on_message);
  if (file.extension() != ".mcap") {
    throw std::runtime_error(file.string() + " is no ROS 2 bag: .db3 and .mcap are, and folders of them");
  }
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file.string() + " cannot be opened");
  readMcap(in, file, on_message);
}

}  // namespace

void readBag(const std::string& path, const OnBagMessage& on_message) {
  if (!fs::exists(path)) throw std::runtime_error(path + " does not exist");
  if (!fs::is_directory(path)) return readFile(path, on_message);
  std::vector<std::pair<std::pair<size_t, std::string>, fs::path>> files;  // bag_2 before bag_10
  for (const auto& entry : fs::directory_iterator(path)) {
    const fs::path extension = entry.path().extension();
    const std::string name = entry.path().filename();
    if (extension == ".db3" || extension == ".mcap") files.push_back({{name.size(), name}, entry.path()});
  }
  if (files.empty()) throw std::runtime_error(path + " holds no .db3 and no .mcap file");
  std::ranges::sort(files);
  for (const auto& [order, file] : files) readFile(file, on_message);
}

}  // namespace shoal::console
