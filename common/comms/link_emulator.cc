// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/link_emulator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "shoal/comms/channels.h"
#include "shoal/comms/fading.h"
#include "shoal/random.h"
#include "shoal/text_hash.h"

namespace shoal::comms {
namespace {

// A hostile peer must not make us remember without end.
constexpr size_t kMaxSenders = 600;
constexpr size_t kMaxHeld = 65536;

constexpr int64_t kBegunAnewUs = 60'000'000;

int64_t microseconds(double seconds) { return std::llround(seconds * 1e6); }

// The number of the group that names the node; as many as there are groups when none does.
size_t groupOf(const Partition& partition, const std::string& node) {
  const auto names = [&node](const std::vector<std::string>& group) {
    return std::ranges::find(group, node) != group.end();
  };
  return static_cast<size_t>(std::ranges::find_if(partition.groups, names) - partition.groups.begin());
}

}  // namespace

LinkEmulator::LinkEmulator(Bus& air, const LinkModel& model, LinkEmulatorOptions options)
    : air_(air), model_(model), options_(std::move(options)) {
  check(model_);
  if (!options_.look) throw std::invalid_argument("a link emulator needs a way to look at messages");
}

void LinkEmulator::publish(const Packet& packet) {
  if (const auto on_air = options_.look(packet); on_air && on_air->position_m) {
    own_position_m_ = on_air->position_m;
  }
  air_.publish(packet);
}

int LinkEmulator::receive(int timeout_ms, const Handler& handler) {
  num_delivered_ = 0;
  air_.receive(shortened(timeout_ms), [&](const Packet& packet) {
    const auto channel = parseChannel(packet.channel);
    const auto on_air = channel ? options_.look(packet) : std::nullopt;
    if (!on_air || channel->node == options_.receiver) {
      ++num_delivered_;
      handler(packet);
      return;
    }
    Sender* sender = senderOf(channel->node);
    if (sender == nullptr) return;
    if (on_air->sent_us < sender->clock_us - kBegunAnewUs) {
      deliver(*sender, INT64_MAX, handler);
      sender->clock_us = sender->idle_us = sender->last_due_us = on_air->sent_us;
    }
    sender->clock_us = std::max(clockOf(*sender), on_air->sent_us);
    sender->wall_us = options_.wall.now_us();
    take(packet, *on_air, channel->node, *sender);
    deliver(*sender, sender->clock_us, handler);
  });
  if (options_.rate != 0) {
    for (auto& [name, sender] : senders_) deliver(sender, clockOf(sender), handler);
  }
  return num_delivered_;
}

LinkEmulator::Sender* LinkEmulator::senderOf(const std::string& name) {
  const auto found = senders_.find(name);
  if (found != senders_.end()) return &found->second;
  if (senders_.size() >= kMaxSenders) return nullptr;
  Sender sender;
  sender.key = hashCombine(hashCombine(mix64(options_.seed), hashText(name)), hashText(options_.receiver));
  sender.wall_us = options_.wall.now_us();
  return &senders_.emplace(name, std::move(sender)).first->second;
}

// Decides what becomes of a message. As many random numbers are drawn whatever happens.
void LinkEmulator::take(const Packet& packet, const OnAir& on_air, const std::string& name, Sender& sender) {
  ++counts_.sent;
  if (on_air.position_m) sender.position_m = on_air.position_m;
  Random random(sender.key, 1, sender.num_sent++);
  const double survives = random.uniform();
  const double jitter = random.uniform();
  const double overtaken = random.uniform();
  const double doubled = random.uniform();
  const double lateness = random.uniform();
  const double echo = random.uniform();

  int64_t gone_us = on_air.sent_us;
  if (model_.rate_bytes_per_s > 0) {
    const int64_t start_us = std::max(on_air.sent_us, sender.idle_us);
    if (start_us - on_air.sent_us > microseconds(model_.queue_s)) {
      ++counts_.overflowed;
      return;
    }
    const auto bytes = static_cast<double>(wireSize(packet));
    gone_us = start_us + microseconds(bytes / model_.rate_bytes_per_s);
    sender.idle_us = gone_us;
  }
  if (!comesThrough(on_air, name, sender, survives)) return;

  const int64_t due_us = std::max(
      sender.last_due_us, gone_us + microseconds(model_.delay_s) + microseconds(model_.jitter_s * jitter));
  if (overtaken < model_.reordering) {
    ++counts_.overtaken;
    hold(sender, due_us + microseconds(model_.late_s * lateness), packet);
  } else {
    sender.last_due_us = due_us;
    hold(sender, due_us, packet);
  }
  if (doubled < model_.duplication) {
    ++counts_.doubled;
    hold(sender, due_us + microseconds(model_.late_s * echo), packet);
  }
}

bool LinkEmulator::comesThrough(const OnAir& on_air, const std::string& name, const Sender& sender,
                                double chance) {
  if (isParted(name, on_air.sent_us)) {
    ++counts_.parted;
    return false;
  }
  if (isOutOfRange(sender)) {
    ++counts_.out_of_range;
    return false;
  }
  if (isBad(model_.bursts, hashCombine(sender.key, 2), on_air.sent_us)) {
    if (chance >= model_.bursts.loss) return true;
    ++counts_.faded;
    return false;
  }
  if (chance >= model_.loss) return true;
  ++counts_.lost;
  return false;
}

bool LinkEmulator::isParted(const std::string& name, int64_t sent_us) const {
  const double sent_s = static_cast<double>(sent_us) * 1e-6;
  return std::ranges::any_of(model_.partitions, [&](const Partition& partition) {
    return sent_s >= partition.from_s && sent_s < partition.until_s &&
           groupOf(partition, name) != groupOf(partition, options_.receiver);
  });
}

bool LinkEmulator::isOutOfRange(const Sender& sender) const {
  const Position& from = sender.position_m ? sender.position_m : model_.base_m;
  const Position& to = own_position_m_ ? own_position_m_ : model_.base_m;
  if (model_.range_m == 0 || !from || !to) return false;
  return std::hypot((*from)[0] - (*to)[0], (*from)[1] - (*to)[1], (*from)[2] - (*to)[2]) > model_.range_m;
}

void LinkEmulator::hold(Sender& sender, int64_t due_us, const Packet& packet) {
  if (num_held_ >= kMaxHeld) {
    ++counts_.overflowed;
    return;
  }
  sender.held.emplace(due_us, packet);
  ++num_held_;
}

int64_t LinkEmulator::clockOf(const Sender& sender) const {
  if (options_.rate == 0) return sender.clock_us;
  const auto elapsed_us = static_cast<double>(options_.wall.now_us() - sender.wall_us);
  return sender.clock_us + static_cast<int64_t>(std::max(elapsed_us, 0.0) * options_.rate);
}

void LinkEmulator::deliver(Sender& sender, int64_t until_us, const Handler& handler) {
  while (!sender.held.empty() && sender.held.begin()->first <= until_us) {
    const Packet packet = std::move(sender.held.extract(sender.held.begin()).mapped());
    --num_held_;
    ++counts_.delivered;
    ++num_delivered_;
    handler(packet);  // when it throws, the rest waits for the next call
  }
}

// No longer than until the first of all that is held is due.
int LinkEmulator::shortened(int timeout_ms) const {
  if (options_.rate == 0) return timeout_ms;
  double wait_ms = timeout_ms;
  for (const auto& [name, sender] : senders_) {
    if (sender.held.empty()) continue;
    const auto left_us = static_cast<double>(sender.held.begin()->first - clockOf(sender));
    wait_ms = std::min(wait_ms, std::max(0.0, std::ceil(left_us / options_.rate / 1000)));
  }
  return static_cast<int>(wait_ms);
}

}  // namespace shoal::comms
