// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/traffic_audit.h"

#include <algorithm>

namespace shoal::console {

void TrafficAudit::hear(const std::string& node, const wire::Header& header, const comms::Packet& packet,
                        const wire::Heartbeat* heartbeat) {
  if (header.kind == wire::MessageKind::kMap) return;
  std::vector<Life>& lives = lives_[node];
  if (lives.empty()) lives.emplace_back();
  if (heartbeat != nullptr) {
    if (lives.back().pid != 0 && lives.back().pid != heartbeat->pid) lives.emplace_back();
    Life& life = lives.back();
    life.pid = heartbeat->pid;
    life.budget = heartbeat->budget;
    // It counts what it had sent before this very message.
    life.claims.push_back({header.time.us, heartbeat->bytes_sent - life.bytes});
  }
  Life& life = lives.back();
  life.sent.push_back({header.time.us, comms::wireSize(packet)});
  life.bytes += static_cast<int64_t>(comms::wireSize(packet));
}

// Datagrams may have been recorded a little out of order, so what lacked at a heartbeat may follow it: it
// lacks only as far as it lacks at every later heartbeat too.
std::vector<Gap> TrafficAudit::gapsOf(const Life& life) {
  std::vector<Claim> claims = life.claims;
  for (size_t i = claims.size(); i > 1; --i) {
    claims[i - 2].lacking = std::min(claims[i - 2].lacking, claims[i - 1].lacking);
  }
  std::vector<Gap> gaps;
  Claim before{0, 0};
  for (const Claim& claim : claims) {
    if (claim.lacking > before.lacking) {
      gaps.push_back({world::Timestamp{before.at_us}.seconds(), world::Timestamp{claim.at_us}.seconds(),
                      claim.lacking - before.lacking});
      before.lacking = claim.lacking;
    }
    before.at_us = claim.at_us;
  }
  return gaps;
}

std::vector<NodeTraffic> TrafficAudit::traffic() const {
  std::vector<NodeTraffic> traffic;
  for (const auto& [node, lives] : lives_) {
    for (auto life = lives.begin(); life != lives.end();) {
      // All that have one budget together.
      comms::WindowMeter meter(life->budget);
      std::vector<int64_t> from_us;
      const auto oldest = life;
      for (int64_t last_us = 0; life != lives.end() && life->budget == oldest->budget; ++life) {
        const auto [first, last] = std::ranges::minmax(life->sent, {}, &Sent::at_us);
        if (life != oldest && first.at_us < last_us) break;
        last_us = last.at_us;
        from_us.push_back(first.at_us);
        for (const Sent& sent : life->sent) meter.add(sent.at_us, sent.bytes);
      }
      const std::vector<comms::MeteredWindow> worst = meter.worstEndingIn(from_us);
      for (size_t i = 0; i < worst.size(); ++i) {
        const Life& one = oldest[static_cast<ptrdiff_t>(i)];
        traffic.push_back({node, one.pid, one.budget, one.bytes, one.sent.size(), worst[i], gapsOf(one)});
      }
    }
  }
  return traffic;
}

}  // namespace shoal::console
