// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/serve/gate.h"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>

namespace shoal::console {
namespace {

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
  return text;
}

// Without the port: "127.0.0.1", "[::1]", "localhost".
std::string_view nameOf(std::string_view host) {
  const size_t colon = host.rfind(':');
  if (colon == std::string_view::npos || host.ends_with(']')) return host;
  return host.substr(0, colon);
}

bool isAddress(std::string_view name) {
  if (name.empty()) return false;
  if (name.starts_with('[')) return name.ends_with(']');
  return std::ranges::all_of(name, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
}

}  // namespace

std::string Gate::refusal(const HttpRequest& request) const {
  const std::string host = lower(request.host);
  const std::string_view name = nameOf(host);
  if (!isAddress(name) && name != "localhost" && name != lower(host_name)) {
    return "the Host header must be an address, localhost or this machine's name";
  }
  if (!request.origin.empty() && lower(request.origin) != "http://" + host) {
    return "pages of other sites may not ask";
  }
  return {};
}

bool Gate::mayWrite(const HttpRequest& request) const {
  const std::string right = "Bearer " + token;
  if (token.empty() || request.authorization.size() != right.size()) return false;
  unsigned differs = 0;
  for (size_t i = 0; i < right.size(); ++i)
    differs |= static_cast<unsigned char>(right[i]) ^ static_cast<unsigned char>(request.authorization[i]);
  return differs == 0;
}

std::string freshToken() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error("the system gives no random bytes");
  }
  std::string text;
  for (const unsigned char b : bytes) {
    text += "0123456789abcdef"[b >> 4];
    text += "0123456789abcdef"[b & 15];
  }
  return text;
}

}  // namespace shoal::console
