// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/query_server.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace shoal::fusion_node {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kMaxQuestionBytes = 64 * 1024;
constexpr size_t kMaxClients = 64;
constexpr int kMaxPolls = 10000;  // a client that neither asks nor reads is let go

sockaddr_un addressOf(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    throw std::runtime_error("the state folder's path is too long for a socket (" + path + ", " +
                             std::to_string(path.size()) + " bytes, at most " +
                             std::to_string(sizeof address.sun_path - 1) + ")");
  }
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  return address;
}

int connectTo(const std::string& path) {
  const sockaddr_un address = addressOf(path);
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd >= 0 && ::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return fd;
  if (fd >= 0) ::close(fd);
  return -1;
}

}  // namespace

std::string socketPath(const std::string& state_dir) { return state_dir + "/node.sock"; }

QueryServer::QueryServer(const std::string& state_dir, Handler handler)
    : path_(socketPath(state_dir)), handler_(std::move(handler)) {
  std::filesystem::create_directories(state_dir);
  const sockaddr_un address = addressOf(path_);
  if (const int other = connectTo(path_); other >= 0) {
    ::close(other);
    throw std::runtime_error("another node runs with the state folder " + state_dir);
  }
  ::unlink(path_.c_str());
  listener_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (listener_ < 0 || ::bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(listener_, 16) != 0) {
    const std::string reason = std::strerror(errno);
    if (listener_ >= 0) ::close(listener_);
    throw std::runtime_error("cannot listen on " + path_ + ": " + reason);
  }
}

QueryServer::~QueryServer() {
  for (const auto& [fd, client] : clients_) ::close(fd);
  ::close(listener_);
  ::unlink(path_.c_str());
}

void QueryServer::poll() {
  for (int fd; clients_.size() < kMaxClients &&
               (fd = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK)) >= 0;) {
    clients_.emplace(fd, Client{});
  }
  for (auto it = clients_.begin(); it != clients_.end();) {
    if (serve(it->first, it->second)) {
      ++it;
    } else {
      ::close(it->first);
      it = clients_.erase(it);
    }
  }
}

// A client's question is a peer's bytes: whatever is wrong with it goes back as an error.
Json QueryServer::answerTo(const Json& question) const {
  if (!question.is_object()) return {{"error", "a question is one line holding a JSON object"}};
  try {
    return handler_(question);
  } catch (const Json::exception& error) {
    return {{"error", error.what()}};
  }
}

// False when the connection is over.
bool QueryServer::serve(int fd, Client& client) {
  if (++client.polls > kMaxPolls) return false;
  if (client.outbox.empty()) {
    char buffer[4096];
    ssize_t n;
    while ((n = ::recv(fd, buffer, sizeof buffer, 0)) > 0)
      client.inbox.append(buffer, static_cast<size_t>(n));
    const bool ended = n == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
    const size_t line_end = client.inbox.find('\n');
    if (line_end == std::string::npos) return !ended && client.inbox.size() <= kMaxQuestionBytes;
    const Json question = Json::parse(client.inbox.substr(0, line_end), nullptr, false);
    client.outbox = answerTo(question).dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  }
  while (client.sent < client.outbox.size()) {
    const ssize_t n =
        ::send(fd, client.outbox.data() + client.sent, client.outbox.size() - client.sent, MSG_NOSIGNAL);
    if (n < 0) return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
    client.sent += static_cast<size_t>(n);
  }
  return false;
}

nlohmann::ordered_json askNode(const std::string& state_dir, const nlohmann::ordered_json& question) {
  const int fd = connectTo(socketPath(state_dir));
  if (fd < 0) throw std::runtime_error("no running node answers in " + state_dir + " (fusion_node --state)");
  const timeval patience{.tv_sec = 20, .tv_usec = 0};
  ::setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  const std::string line = question.dump() + "\n";
  std::string answer;
  bool good = ::send(fd, line.data(), line.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(line.size());
  char buffer[65536];
  for (ssize_t n; good && (n = ::recv(fd, buffer, sizeof buffer, 0)) != 0;) {
    good = n > 0;
    if (good) answer.append(buffer, static_cast<size_t>(n));
  }
  ::close(fd);
  const Json json = Json::parse(answer, nullptr, false);
  if (!good || json.is_discarded()) throw std::runtime_error("the node in " + state_dir + " did not answer");
  return json;
}

}  // namespace shoal::fusion_node
