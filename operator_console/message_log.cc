// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/message_log.h"

#include <mutex>
#include <nlohmann/json.hpp>

#include <spdlog/spdlog.h>

#include "fusion_node/authentication.h"

namespace shoal::console {

nlohmann::ordered_json SealCounts::json() const {
  return {{"sealed", sealed}, {"checked", checked}, {"refused", refused}};
}

std::string SealCounts::text() const {
  if (checked) return fmt::format("seals: {} right, {} refused\n", sealed, refused);
  return sealed == 0 ? "" : fmt::format("seals: {} messages have one, NOT checked: give --key\n", sealed);
}

void warnOfSeals(const std::string& path, const SealCounts& seals) {
  static std::mutex mutex;
  static std::set<std::string> told;  // guarded by mutex
  std::string text = seals.checked ? "" : seals.text();
  if (text.empty()) return;
  text.pop_back();
  const std::scoped_lock lock(mutex);
  if (told.insert(path).second) spdlog::warn("{}: {}", path, text);
}

MessageLog::MessageLog(const std::string& path, const std::string& key_file)
    : key_(fusion_node::readKey(key_file)) {
  if (fusion_node::isSqlite(path)) {
    file_.emplace(path);
  } else {
    log_.emplace(path);
  }
  seals_.checked = key_.has_value();
}

const comms::LogCounts& MessageLog::counts() const {
  static const comms::LogCounts kNothingWrong;
  return log_ ? log_->counts() : kNothingWrong;
}

std::optional<comms::LogEvent> MessageLog::nextOfFile() { return log_ ? log_->next() : file_->next(); }

std::optional<comms::LogEvent> MessageLog::next() {
  while (auto event = nextOfFile()) {
    if (!event->packet.channel.starts_with("SHOAL_")) return event;  // cameras, LCM's own self test
    const auto seal = key_ ? comms::checkSeal(*key_, event->packet) : std::nullopt;
    const bool is_good = key_ ? seal && heard_.emplace(seal->session, seal->counter).second
                              : fusion_node::isSealed(event->packet);
    if (is_good) {
      ++seals_.sealed;
      comms::removeSeal(event->packet);
    } else if (key_) {
      ++seals_.refused;
      continue;
    }
    return event;
  }
  return std::nullopt;
}

}  // namespace shoal::console
