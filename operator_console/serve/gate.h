// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "operator_console/serve/http_server.h"

namespace shoal::console {

/// Who may ask, and who may change something.
struct Gate {
  std::string token;      ///< what a request that changes something must show; empty: nobody may
  std::string host_name;  ///< of this machine

  /// Why a request is turned away; empty when it is let in. A page of another site that a browser was made to
  /// open cannot ask: the Host must be an address, localhost or this machine's name (so that no foreign name
  /// that was pointed here works), and the Origin, when there is one, must be that same host.
  std::string refusal(const HttpRequest& request) const;

  /// True when the request shows the token ("Authorization: Bearer TOKEN"). Takes equally long for every text
  /// of the right length.
  bool mayWrite(const HttpRequest& request) const;
};

/// 32 hexadecimal digits from the system's source of randomness. @throws std::runtime_error without one.
std::string freshToken();

}  // namespace shoal::console
