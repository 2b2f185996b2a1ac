// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/serve/http_server.h"

#include <arpa/inet.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <exception>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include <spdlog/spdlog.h>

namespace shoal::console {
namespace {

constexpr size_t kMaxWaiting = 64;  // requests that wait for a thread
constexpr int kThreads = 2;
constexpr size_t kWorthZipping = 1024;
constexpr auto kPingEvery = std::chrono::seconds(10);

std::string gzip(const std::string& plain) {
  z_stream z{};
  if (deflateInit2(&z, 1, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK) return {};
  std::string packed(deflateBound(&z, plain.size()), '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(plain.data()));  // zlib reads only
  z.avail_in = static_cast<uInt>(plain.size());
  z.next_out = reinterpret_cast<Bytef*>(packed.data());
  z.avail_out = static_cast<uInt>(packed.size());
  const int end = deflate(&z, Z_FINISH);
  packed.resize(z.total_out);
  deflateEnd(&z);
  return end == Z_STREAM_END ? packed : std::string();
}

std::string header(MHD_Connection* connection, const char* name) {
  const char* value = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, name);
  return value == nullptr ? "" : value;
}

MHD_Result keep(void* map, MHD_ValueKind, const char* key, const char* value) {
  (*static_cast<std::map<std::string, std::string>*>(map))[key] = value == nullptr ? "" : value;
  return MHD_YES;
}

MHD_Response* made(HttpResponse& answer, bool accepts_gzip) {
  const bool zips = accepts_gzip && answer.body.size() >= kWorthZipping;
  std::string packed = zips ? gzip(answer.body) : std::string();
  const std::string& body = packed.empty() ? answer.body : packed;
  MHD_Response* response =
      MHD_create_response_from_buffer(body.size(), const_cast<char*>(body.data()), MHD_RESPMEM_MUST_COPY);
  if (!packed.empty()) MHD_add_response_header(response, "Content-Encoding", "gzip");
  if (!answer.file_name.empty()) {
    const std::string disposition = "attachment; filename=\"" + answer.file_name + "\"";
    MHD_add_response_header(response, "Content-Disposition", disposition.c_str());
  }
  return response;
}

void addCommonHeaders(MHD_Response* response, const std::string& type) {
  MHD_add_response_header(response, "Content-Type", type.c_str());
  MHD_add_response_header(response, "Cache-Control", "no-store");
  MHD_add_response_header(response, "X-Content-Type-Options", "nosniff");
  MHD_add_response_header(response, "X-Frame-Options", "DENY");
  MHD_add_response_header(response, "Referrer-Policy", "no-referrer");
  MHD_add_response_header(
      response, "Content-Security-Policy",
      "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; base-uri 'none'");
}

}  // namespace

struct HttpServer::Core {
  // A request on its way: filled by the thread of bytes, answered by a worker.
  struct Exchange {
    MHD_Connection* connection = nullptr;
    HttpRequest request;
    bool too_large = false;
    MHD_Response* response = nullptr;  // when it has been answered
    int status = 0;
  };
  struct Stream {
    Core* core = nullptr;
    MHD_Connection* connection = nullptr;
    std::string outbox;   // what is being sent
    std::string pending;  // the newest event that waits
    bool is_waiting = false;
  };

  HttpOptions options;
  Handler handler;
  MHD_Daemon* daemon = nullptr;
  std::mutex mutex;
  std::condition_variable wake;
  std::deque<Exchange*> jobs;
  std::set<Stream*> streams;
  bool stopping = false;
  std::vector<std::thread> threads;

  ~Core() { stop(); }

  void start();
  void stop();
  void work();
  void ping();
  void say(const std::string& text);
  MHD_Response* answered(Exchange& exchange);
  MHD_Response* streamed(MHD_Connection* connection, const std::string& first);
  MHD_Result take(MHD_Connection* connection, const char* path, const char* method, const char* upload,
                  size_t* upload_size, void** context);
  static ssize_t read(void* stream, uint64_t, char* buffer, size_t size);
  static void forget(void* stream);
};

namespace {

MHD_Result refuse(MHD_Connection* connection, unsigned status, const char* text) {
  MHD_Response* response =
      MHD_create_response_from_buffer(std::strlen(text), const_cast<char*>(text), MHD_RESPMEM_MUST_COPY);
  addCommonHeaders(response, "application/json");
  const MHD_Result result = MHD_queue_response(connection, status, response);
  MHD_destroy_response(response);
  return result;
}

// As usual, but a NUL, which would end the path early, becomes a character that no path has.
size_t unescaped(void* /*unused*/, MHD_Connection* /*unused*/, char* text) {
  for (char* at = std::strstr(text, "%00"); at != nullptr; at = std::strstr(at, "%00")) at[1] = '1';
  return MHD_http_unescape(text);
}

}  // namespace

void HttpServer::Core::start() {
  rlimit files{};
  if (getrlimit(RLIMIT_NOFILE, &files) == 0) {
    files.rlim_cur = std::min<rlim_t>(files.rlim_max, options.max_connections + 256);
    setrlimit(RLIMIT_NOFILE, &files);
    if (getrlimit(RLIMIT_NOFILE, &files) == 0 && files.rlim_cur < options.max_connections + 128) {
      options.max_connections = static_cast<unsigned>(std::max<rlim_t>(files.rlim_cur, 192) - 128);
    }
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(options.port);
  const std::string host = options.host == "localhost" ? "127.0.0.1" : options.host;
  if (inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1) {
    throw std::invalid_argument("--host \"" + options.host + "\" is no IPv4 address; 127.0.0.1 is");
  }
  const MHD_AccessHandlerCallback access = [](void* core, MHD_Connection* connection, const char* path,
                                              const char* method, const char*, const char* upload,
                                              size_t* upload_size, void** context) {
    return static_cast<Core*>(core)->take(connection, path, method, upload, upload_size, context);
  };
  const MHD_RequestCompletedCallback completed = [](void*, MHD_Connection*, void** context,
                                                    MHD_RequestTerminationCode) {
    auto* exchange = static_cast<Exchange*>(*context);
    if (exchange != nullptr && exchange->response != nullptr) MHD_destroy_response(exchange->response);
    delete exchange;
    *context = nullptr;
  };
  void (*const quiet)(void*, const char*, va_list) = [](void*, const char*, va_list) {};
  daemon = MHD_start_daemon(
      MHD_USE_EPOLL_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME | MHD_USE_ERROR_LOG, 0, nullptr, nullptr,
      access, this, MHD_OPTION_EXTERNAL_LOGGER, quiet, nullptr, MHD_OPTION_SOCK_ADDR,
      reinterpret_cast<sockaddr*>(&address), MHD_OPTION_CONNECTION_LIMIT, options.max_connections,
      MHD_OPTION_CONNECTION_TIMEOUT, options.idle_s, MHD_OPTION_CONNECTION_MEMORY_LIMIT, size_t{16} << 10,
      MHD_OPTION_NOTIFY_COMPLETED, completed, nullptr, MHD_OPTION_UNESCAPE_CALLBACK, unescaped, nullptr,
      MHD_OPTION_LISTENING_ADDRESS_REUSE, 1u, MHD_OPTION_END);
  if (daemon == nullptr) {
    throw std::runtime_error("cannot listen on " + options.host + ":" + std::to_string(options.port) +
                             "; is the port taken? --port chooses another, 0 any free one");
  }
  for (int i = 0; i < kThreads; ++i) threads.emplace_back([this] { work(); });
  threads.emplace_back([this] { ping(); });
}

void HttpServer::Core::stop() {
  if (daemon == nullptr) return;
  {
    const std::lock_guard lock(mutex);
    stopping = true;
    for (Stream* stream : streams) {
      if (!stream->is_waiting) continue;
      stream->is_waiting = false;
      MHD_resume_connection(stream->connection);
    }
  }
  wake.notify_all();
  for (std::thread& thread : threads) thread.join();  // workers answer what waits first
  MHD_stop_daemon(daemon);
  daemon = nullptr;
}

void HttpServer::Core::work() {
  for (;;) {
    Exchange* exchange = nullptr;
    {
      std::unique_lock lock(mutex);
      wake.wait(lock, [this] { return stopping || !jobs.empty(); });
      if (jobs.empty()) return;
      exchange = jobs.front();
      jobs.pop_front();
    }
    exchange->response = answered(*exchange);
    MHD_resume_connection(exchange->connection);
  }
}

void HttpServer::Core::ping() {
  std::unique_lock lock(mutex);
  while (!wake.wait_for(lock, kPingEvery, [this] { return stopping; })) {
    lock.unlock();
    say(": still here\nevent: ping\ndata: {}\n\n");
    lock.lock();
  }
}

MHD_Response* HttpServer::Core::answered(Exchange& exchange) {
  HttpResponse answer;
  try {
    answer = handler(exchange.request);
  } catch (const std::exception& error) {
    spdlog::warn("{} {}: {}", exchange.request.method, exchange.request.path, error.what());
    answer = {.status = 500, .body = R"({"error": "the console failed to answer; its log says why"})"};
  }
  exchange.status = answer.status;
  if (answer.is_stream) {
    if (MHD_Response* response = streamed(exchange.connection, answer.body)) return response;
    answer = {.status = 503, .body = R"({"error": "too many pages listen; ask again and again instead"})"};
    exchange.status = 503;
  }
  MHD_Response* response = made(answer, exchange.request.accepts_gzip);
  addCommonHeaders(response, answer.type);
  return response;
}

MHD_Response* HttpServer::Core::streamed(MHD_Connection* connection, const std::string& first) {
  const std::lock_guard lock(mutex);
  if (stopping || streams.size() >= options.max_streams) return nullptr;
  auto* stream = new Stream{this, connection, first, {}, false};  // forget() deletes it
  MHD_Response* response =
      MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, 4096, &Core::read, stream, &Core::forget);
  streams.insert(stream);
  addCommonHeaders(response, "text/event-stream");
  return response;
}

// Called by the thread of bytes when a stream can take something.
ssize_t HttpServer::Core::read(void* opaque, uint64_t, char* buffer, size_t size) {
  auto* stream = static_cast<Stream*>(opaque);
  const std::lock_guard lock(stream->core->mutex);
  if (stream->core->stopping) return MHD_CONTENT_READER_END_OF_STREAM;
  if (stream->outbox.empty()) stream->outbox.swap(stream->pending);
  if (stream->outbox.empty()) {
    stream->is_waiting = true;
    MHD_suspend_connection(stream->connection);
    return 0;
  }
  const size_t n = std::min(size, stream->outbox.size());
  std::memcpy(buffer, stream->outbox.data(), n);
  stream->outbox.erase(0, n);
  return static_cast<ssize_t>(n);
}

void HttpServer::Core::forget(void* opaque) {
  auto* stream = static_cast<Stream*>(opaque);
  {
    const std::lock_guard lock(stream->core->mutex);
    stream->core->streams.erase(stream);
  }
  delete stream;
}

void HttpServer::Core::say(const std::string& text) {
  const std::lock_guard lock(mutex);
  for (Stream* stream : streams) {
    if (text.starts_with(':') && !stream->pending.empty()) continue;  // news beat a sign of life
    stream->pending = text;
    if (!stream->is_waiting) continue;
    stream->is_waiting = false;
    MHD_resume_connection(stream->connection);
  }
}

// Called by the thread of bytes: once for the headers, again for each stretch of the body, and once more when
// a worker has answered.
MHD_Result HttpServer::Core::take(MHD_Connection* connection, const char* path, const char* method,
                                  const char* upload, size_t* upload_size, void** context) {
  if (*context == nullptr) {
    auto* begun = new Exchange;  // the completed-callback deletes it
    *context = begun;
    begun->connection = connection;
    begun->request.method = method;
    begun->request.path = path;
    return MHD_YES;
  }
  auto& exchange = *static_cast<Exchange*>(*context);
  if (exchange.response != nullptr) {
    return MHD_queue_response(connection, static_cast<unsigned>(exchange.status), exchange.response);
  }
  HttpRequest& request = exchange.request;
  if (*upload_size > 0) {
    exchange.too_large = exchange.too_large || request.body.size() + *upload_size > options.max_body;
    if (!exchange.too_large) request.body.append(upload, *upload_size);
    *upload_size = 0;
    return MHD_YES;
  }
  if (exchange.too_large) return refuse(connection, 413, R"({"error": "a request is at most 64 KiB"})");
  request.host = header(connection, "Host");
  request.origin = header(connection, "Origin");
  request.authorization = header(connection, "Authorization");
  request.accepts_gzip = header(connection, "Accept-Encoding").find("gzip") != std::string::npos;
  MHD_get_connection_values(connection, MHD_GET_ARGUMENT_KIND, keep, &request.query);
  {
    const std::lock_guard lock(mutex);
    if (!stopping && jobs.size() < kMaxWaiting) {
      MHD_suspend_connection(connection);
      jobs.push_back(&exchange);
      wake.notify_all();  // the one that pings waits for the same
      return MHD_YES;
    }
  }
  return refuse(connection, 503, R"({"error": "too many questions at once; ask again"})");
}

HttpServer::HttpServer(const HttpOptions& options, Handler handler) : core_(std::make_unique<Core>()) {
  core_->options = options;
  core_->handler = std::move(handler);
  core_->start();
}

HttpServer::~HttpServer() = default;

uint16_t HttpServer::port() const {
  return MHD_get_daemon_info(core_->daemon, MHD_DAEMON_INFO_BIND_PORT)->port;
}

void HttpServer::publish(const std::string& data) { core_->say("data: " + data + "\n\n"); }

}  // namespace shoal::console
