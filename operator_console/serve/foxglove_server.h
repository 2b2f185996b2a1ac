// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "operator_console/serve/gate.h"
#include "operator_console/serve/mission_feed.h"

namespace shoal::console {

struct FoxgloveOptions {
  std::string host = "127.0.0.1";    ///< an IPv4 address of this machine
  uint16_t port = 8765;              ///< 0: any free one
  std::vector<std::string> origins;  ///< of pages of other sites that may ask: "https://app.foxglove.dev"
};

/// What Foxglove and Lichtblick look at while a mission goes on: a WebSocket of the subprotocol
/// foxglove.websocket.v1. Channels are JSON in the schemas of the MCAP export: /map, /tf, /events, /labels
/// and /status. Whoever has subscribed is sent the newest: the map at most once a second and a tenth of the
/// time, never more than it takes. It only tells; nothing that is sent here changes anything.
///
/// One thread on Boost.Beast does everything. At most 8 connections, messages of at most 64 KiB from them.
class FoxgloveServer {
 public:
  /// @throws std::runtime_error when the address cannot be listened on, std::invalid_argument when it is
  /// none.
  FoxgloveServer(const FoxgloveOptions& options, Gate gate, const MissionFeed& feed);
  ~FoxgloveServer();
  FoxgloveServer(const FoxgloveServer&) = delete;
  FoxgloveServer& operator=(const FoxgloveServer&) = delete;

  uint16_t port() const;

 private:
  struct Core;
  std::unique_ptr<Core> core_;
};

}  // namespace shoal::console
