// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/link_model.h"

#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "shoal/comms/channels.h"

namespace shoal::comms {
namespace {

// Sums and products of such times stay exact in microseconds, and far below 2^62.
constexpr double kLongestS = 1e6;

[[noreturn]] void refuse(const std::string& field, const std::string& should, double got) {
  std::ostringstream what;
  what << '"' << field << "\" must " << should << ", got " << got;
  throw std::invalid_argument(what.str());
}

void checkShare(const std::string& field, double share) {
  if (!(share >= 0 && share <= 1)) refuse(field, "lie in [0, 1]", share);
}

void checkTime(const std::string& field, double seconds) {
  if (!(seconds >= 0 && seconds <= kLongestS)) refuse(field, "lie in [0, 1000000] s", seconds);
}

void checkAmount(const std::string& field, double amount) {
  if (!(amount >= 0 && std::isfinite(amount))) refuse(field, "be 0 (no limit) or more", amount);
}

void checkPartition(const Partition& partition, const std::string& field) {
  checkTime(field + ".from_s", partition.from_s);
  checkTime(field + ".until_s", partition.until_s);
  if (!(partition.until_s > partition.from_s)) {
    refuse(field + ".until_s", "be later than from_s", partition.until_s);
  }
  if (partition.groups.empty()) {
    throw std::invalid_argument('"' + field + ".groups\" must name the nodes of one group or more");
  }
  std::set<std::string> named;
  for (const auto& group : partition.groups) {
    for (const std::string& node : group) {
      if (!parseChannel("SHOAL_" + node + "_HEARTBEAT")) {
        throw std::invalid_argument('"' + field + ".groups\" names \"" + node +
                                    "\"; nodes are 1 to 16 of A-Z and 0-9, as in R03 and OPERATOR");
      }
      if (!named.insert(node).second) {
        throw std::invalid_argument('"' + field + ".groups\" names " + node + " twice");
      }
    }
  }
}

}  // namespace

bool LinkModel::isClean() const {
  const bool fades = bursts.bad_s > 0 && bursts.loss > 0;
  return rate_bytes_per_s == 0 && delay_s == 0 && jitter_s == 0 && loss == 0 && !fades && reordering == 0 &&
         duplication == 0 && range_m == 0 && partitions.empty();
}

void check(const LinkModel& model) {
  checkAmount("rate_bytes_per_s", model.rate_bytes_per_s);
  if (model.rate_bytes_per_s > 0 && model.rate_bytes_per_s < 1) {
    refuse("rate_bytes_per_s", "be 0 (no limit) or at least 1", model.rate_bytes_per_s);
  }
  checkTime("queue_s", model.queue_s);
  checkTime("delay_s", model.delay_s);
  checkTime("jitter_s", model.jitter_s);
  checkTime("late_s", model.late_s);
  checkShare("loss", model.loss);
  checkTime("bursts.good_s", model.bursts.good_s);
  checkTime("bursts.bad_s", model.bursts.bad_s);
  if (model.bursts.good_s < 0.001) refuse("bursts.good_s", "be at least 0.001 s", model.bursts.good_s);
  checkShare("bursts.loss", model.bursts.loss);
  checkShare("reordering", model.reordering);
  checkShare("duplication", model.duplication);
  checkAmount("range_m", model.range_m);
  for (size_t i = 0; i < model.partitions.size(); ++i) {
    checkPartition(model.partitions[i], "partitions[" + std::to_string(i) + "]");
  }
}

std::optional<LinkModel> linkPreset(std::string_view name) {
  LinkModel link;
  if (name == "clean") return link;
  if (name == "mesh") {
    link.rate_bytes_per_s = 125'000;
    link.delay_s = 0.005;
    link.jitter_s = 0.02;
    link.loss = 0.05;
    link.bursts = {.good_s = 19.5, .bad_s = 0.5, .loss = 0.9};
    link.reordering = 0.01;
    link.duplication = 0.01;
    link.late_s = 0.1;
    return link;
  }
  if (name == "acoustic") {
    link.rate_bytes_per_s = 600;
    link.delay_s = 1;
    link.jitter_s = 2;
    link.loss = 0.1;
    link.bursts = {.good_s = 54, .bad_s = 6, .loss = 0.9};
    return link;
  }
  if (name == "satellite") {
    link.rate_bytes_per_s = 300;
    link.delay_s = 5;
    link.jitter_s = 15;
    link.loss = 0.01;
    link.bursts = {.good_s = 280, .bad_s = 20, .loss = 1};
    return link;
  }
  return std::nullopt;
}

}  // namespace shoal::comms
