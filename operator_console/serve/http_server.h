// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

namespace shoal::console {

struct HttpRequest {
  std::string method, path, body;
  std::map<std::string, std::string> query;
  std::string host, origin, authorization;  ///< headers, empty when not sent
  bool accepts_gzip = false;
};

struct HttpResponse {
  int status = 200;
  std::string type = "application/json";
  std::string body = {};
  std::string file_name = {};  ///< not empty: to be saved under that name
  bool is_stream = false;      ///< server-sent events: what publish() says from now on, `body` first
};

struct HttpOptions {
  std::string host = "127.0.0.1";  ///< an IPv4 address of this machine
  uint16_t port = 8080;            ///< 0: any free one
  unsigned max_connections = 4000;
  unsigned max_streams = 64;
  unsigned idle_s = 10;                ///< a connection that neither sends nor takes anything is closed
  size_t max_body = size_t{64} << 10;  ///< of a request, bytes
};

/// A small HTTP/1.1 server on libmicrohttpd. One thread moves all bytes, so that slow and vanishing clients
/// cost a connection and nothing else; two more make the answers, at most 64 wait for them, the rest get 503.
class HttpServer {
 public:
  using Handler = std::function<HttpResponse(const HttpRequest&)>;

  /// @param handler  Called by several threads at once; what it throws is answered with 500.
  /// @throws std::runtime_error when the address cannot be listened on.
  HttpServer(const HttpOptions& options, Handler handler);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  uint16_t port() const;

  /// Sends an event to all streams. A stream that has not taken the last one gets the newest instead.
  void publish(const std::string& data);

 private:
  struct Core;
  std::unique_ptr<Core> core_;
};

}  // namespace shoal::console
