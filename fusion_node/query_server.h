// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace shoal::fusion_node {

/// The socket in a node's state folder.
std::string socketPath(const std::string& state_dir);

/// Answers questions about a running node on a Unix socket: one line of JSON in, one line of JSON out, then
/// the connection closes. Single-threaded: answers are given inside poll().
class QueryServer {
 public:
  using Handler = std::function<nlohmann::ordered_json(const nlohmann::ordered_json& question)>;

  /// Listens on `DIR/node.sock`; a socket left by a dead process is taken over.
  /// @throws std::runtime_error when the folder cannot be made, the path is too long for a socket, or another
  ///         live node answers there.
  QueryServer(const std::string& state_dir, Handler handler);
  ~QueryServer();
  QueryServer(const QueryServer&) = delete;
  QueryServer& operator=(const QueryServer&) = delete;

  /// Serves whoever is waiting; never blocks. A client that sends nonsense gets {"error": ...}.
  void poll();

 private:
  struct Client {
    std::string inbox, outbox;
    size_t sent = 0;  // bytes of outbox
    int polls = 0;
  };
  bool serve(int fd, Client& client);
  nlohmann::ordered_json answerTo(const nlohmann::ordered_json& question) const;

  std::string path_;
  Handler handler_;
  int listener_ = -1;
  std::map<int, Client> clients_;
};

/// Asks a running node. @throws std::runtime_error naming the folder when no node answers there.
nlohmann::ordered_json askNode(const std::string& state_dir, const nlohmann::ordered_json& question);

}  // namespace shoal::fusion_node
