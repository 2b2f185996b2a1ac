// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/serve/foxglove_server.h"

#include <algorithm>
#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include <spdlog/spdlog.h>

#include "operator_console/export/foxglove_messages.h"
#include "operator_console/export/foxglove_schemas.h"
#include "operator_console/export/little_endian.h"

namespace shoal::console {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
namespace asio = boost::asio;
using asio::ip::tcp;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

// The newer name is of the same messages; clients offer one or both.
constexpr std::array<const char*, 2> kSubprotocols = {"foxglove.websocket.v1", "foxglove.sdk.v1"};
constexpr size_t kMaxSessions = 8, kMaxComplaints = 64, kMaxAsked = size_t{64} << 10;
constexpr auto kLookEvery = std::chrono::milliseconds(200);
constexpr auto kMapEvery = std::chrono::seconds(1);
constexpr int kMapLeisure = 10;  // a map is made again after 10 times what it took
constexpr std::string_view kAnyObject = R"({"type":"object"})";

struct FoxgloveChannel {
  const char* topic;
  const char* schema_name;
  std::string_view schema;
};

enum ChannelId : uint32_t { kMap, kTf, kEvents, kLabels, kStatus };

const std::array<FoxgloveChannel, 5>& channels() {
  static const std::array<FoxgloveChannel, 5> all = {
      {{"/map", "foxglove.PointCloud", kPointCloudSchema},
       {"/tf", "foxglove.FrameTransform", kFrameTransformSchema},
       {"/events", "foxglove.Log", kLogSchema},
       {"/labels", "shoal.Labels", kAnyObject},
       {"/status", "shoal.Status", kAnyObject}}};
  return all;
}

std::string textOf(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string hello(const std::string& session) {
  return textOf({{"op", "serverInfo"},
                 {"name", "Shoal"},
                 {"capabilities", Json::array()},
                 {"supportedEncodings", Json::array()},
                 {"metadata", Json::object()},
                 {"sessionId", session}});
}

std::string advertisement() {
  Json list = Json::array();
  for (size_t i = 0; i < channels().size(); ++i)
    list.push_back({{"id", i},
                    {"topic", channels()[i].topic},
                    {"encoding", "json"},
                    {"schemaName", channels()[i].schema_name},
                    {"schema", channels()[i].schema},
                    {"schemaEncoding", "jsonschema"}});
  return textOf({{"op", "advertise"}, {"channels", list}});
}

uint32_t numberOf(const Json& json) {
  if (!json.is_number_unsigned() || json.get<uint64_t>() > UINT32_MAX)
    throw std::invalid_argument(textOf(json) + " is no number of a subscription or channel");
  return json.get<uint32_t>();
}

// Cells as the tiles hold them: times to a tenth of a second, certainties in steps of 1/255.
std::vector<mapping::GlobalCell> cellsOf(const Moment& moment) {
  std::vector<mapping::GlobalCell> cells;
  const auto add = [&](int32_t x, int32_t y, int16_t z, int32_t label, int32_t seen, int16_t robot,
                       uint8_t certainty) {
    const double seen_s = moment.base_s + seen / 10.0;
    cells.push_back({{x, y, z},
                     world::GlobalLabel{label},
                     world::RobotId{robot},
                     world::Timestamp{static_cast<int64_t>(seen_s * 1e6)},
                     static_cast<float>(certainty) / 255.f});
  };
  for (const auto& [key, versioned] : moment.tiles) {
    const Tile& t = *versioned.tile;
    const auto xOf = [k = key](size_t i) {
      return k.first * kTileSide + static_cast<int32_t>(i) % kTileSide;
    };
    const auto yOf = [k = key](size_t i) {
      return k.second * kTileSide + static_cast<int32_t>(i) / kTileSide;
    };
    for (size_t i = 0; i < kTileColumns; ++i)
      if (t.label[i] >= 0)
        add(xOf(i), yOf(i), t.height[i], t.label[i], t.seen[i], t.robot[i], t.certainty[i]);
    for (const LowerCell& c : t.lower)
      add(xOf(c.place), yOf(c.place), c.height, c.label, c.seen, c.robot, c.certainty);
  }
  return cells;
}

// One who looks. Lives as long as something waits for it.
class Session : public std::enable_shared_from_this<Session> {
 public:
  Session(tcp::socket socket, const Gate& gate, const FoxgloveOptions& options, const MissionFeed& feed,
          std::set<Session*>& alive)
      : ws_(std::move(socket)), gate_(gate), options_(options), feed_(feed), alive_(alive) {
    alive_.insert(this);
  }
  ~Session() { alive_.erase(this); }

  void begin() {
    parser_.header_limit(16 << 10);
    parser_.body_limit(0);
    beast::get_lowest_layer(ws_).expires_after(std::chrono::seconds(10));
    http::async_read_header(ws_.next_layer(), buffer_, parser_,
                            [self = shared_from_this()](beast::error_code error, size_t) {
                              if (!error) self->judge();
                            });
  }

  // What is new for whom it has been promised, when the last has been taken.
  void look() {
    const auto moment = feed_.now();
    if (!is_open_ || !outbox_.empty() || !moment) return;
    const uint64_t now = foxgloveTime(moment->time_s);
    if (const auto id = asked_.find(kMap); id != asked_.end() && Clock::now() >= next_map_ &&
                                           (told_map_ != moment->sequence || told_to_.map != id->second)) {
      const auto begun = Clock::now();
      tell(id->second, now, foxgloveCloud(cellsOf(*moment), moment->cell_size_m, now));
      told_map_ = moment->sequence;
      told_to_.map = id->second;
      next_map_ = std::max(begun + kMapEvery, Clock::now() + (Clock::now() - begun) * kMapLeisure);
    }
    if (const auto id = asked_.find(kLabels);
        id != asked_.end() && (told_labels_ != moment->labels || told_to_.labels != id->second)) {
      tell(id->second, now, moment->labels);
      told_labels_ = moment->labels;
      told_to_.labels = id->second;
    }
    const bool moved = told_status_ != moment->status;
    if (const auto id = asked_.find(kStatus);
        id != asked_.end() && (moved || told_to_.status != id->second)) {
      tell(id->second, now, moment->status);
      told_to_.status = id->second;
    }
    if (const auto id = asked_.find(kTf); id != asked_.end() && (moved || told_to_.tf != id->second)) {
      for (const Json& row : moment->status.at("nodes")) {
        const mapping::NodeStatus node = mapping::nodeFromJson(row);
        if (node.phase == "node" || node.observation < 0) continue;
        tell(id->second, foxgloveTime(node.heard_s), foxgloveTransform(node));
      }
      told_to_.tf = id->second;
    }
    told_status_ = moment->status;
    if (const auto id = asked_.find(kEvents); id != asked_.end()) tellEvents(id->second);
  }

 private:
  struct ToldTo {  // by which number of subscription the newest was told
    std::optional<uint32_t> map, labels, status, tf, events;
  };

  void judge() {
    const auto& request = parser_.get();
    const auto header = [&request](http::field name) { return std::string(request[name]); };
    HttpRequest asked{.method = "GET",
                      .path = "/",
                      .body = {},
                      .query = {},
                      .host = header(http::field::host),
                      .origin = header(http::field::origin),
                      .authorization = {}};
    if (std::ranges::find(options_.origins, asked.origin) != options_.origins.end()) asked.origin.clear();
    if (const std::string refusal = gate_.refusal(asked); !refusal.empty())
      return refuse(http::status::forbidden, refusal);
    const std::string wanted = header(http::field::sec_websocket_protocol);
    const auto spoken = std::ranges::find_if(
        kSubprotocols, [&wanted](const char* name) { return wanted.find(name) != std::string::npos; });
    if (!websocket::is_upgrade(request) || spoken == kSubprotocols.end())
      return refuse(http::status::upgrade_required,
                    std::string("this is a WebSocket of the subprotocol ") + kSubprotocols.front());
    beast::get_lowest_layer(ws_).expires_never();
    ws_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
    ws_.set_option(websocket::stream_base::decorator([name = *spoken](websocket::response_type& response) {
      response.set(http::field::sec_websocket_protocol, name);
    }));
    ws_.read_message_max(kMaxAsked);
    ws_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
      if (error) return;
      self->is_open_ = true;
      self->buffer_.consume(self->buffer_.size());
      self->send(false, hello(std::to_string(reinterpret_cast<uintptr_t>(self.get()))));
      self->send(false, advertisement());
      self->listen();
    });
  }

  void refuse(http::status status, const std::string& why) {
    auto response = std::make_shared<http::response<http::string_body>>(status, 11);
    response->set(http::field::content_type, "application/json");
    response->body() = textOf({{"error", why}});
    response->keep_alive(false);
    response->prepare_payload();
    http::async_write(
        ws_.next_layer(), *response, [self = shared_from_this(), response](beast::error_code, size_t) {
          beast::error_code ignored;
          beast::get_lowest_layer(self->ws_).socket().shutdown(tcp::socket::shutdown_send, ignored);
        });
  }

  void listen() {
    ws_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, size_t) {
      if (error) return self->end();
      self->hear(beast::buffers_to_string(self->buffer_.data()), self->ws_.got_text());
      self->buffer_.consume(self->buffer_.size());
      self->listen();
    });
  }

  // Whatever is not understood is left out: clients of newer versions ask for more than there is.
  void hear(const std::string& text, bool is_text) {
    if (!is_text) return;
    const Json asked = Json::parse(text, nullptr, false);
    if (!asked.is_object()) return complain("a request is a JSON object");
    try {
      const std::string op = asked.value("op", "");
      if (op == "subscribe") {
        for (const Json& one : asked.at("subscriptions"))
          subscribe(numberOf(one.at("id")), numberOf(one.at("channelId")));
      } else if (op == "unsubscribe") {
        for (const Json& id : asked.at("subscriptionIds"))
          std::erase_if(asked_, [n = numberOf(id)](const auto& one) { return one.second == n; });
      }
    } catch (const Json::exception& error) {
      complain(error.what());
    } catch (const std::invalid_argument& error) {
      complain(error.what());
    }
    look();
  }

  void subscribe(uint32_t id, uint32_t channel) {
    if (channel >= channels().size())
      throw std::invalid_argument("there is no channel " + std::to_string(channel));
    asked_[channel] = id;
  }

  void complain(const std::string& what) {
    if (outbox_.size() < kMaxComplaints)
      send(false, textOf({{"op", "status"}, {"level", 2}, {"message", what}}));
  }

  void tellEvents(uint32_t id) {
    const Json events = feed_.chronicle("events").at("events");
    if (told_to_.events != id || told_events_ > events.size()) told_events_ = 0;
    told_to_.events = id;
    for (; told_events_ < events.size(); ++told_events_) {
      const Json& e = events.at(told_events_);
      const uint64_t ns = foxgloveTime(e.at("time_s").get<double>());
      const std::string kind = e.at("kind");
      tell(id, ns, foxgloveLog(ns, kind == "alarm" || kind == "rejected", e.at("text"), ""));
    }
  }

  void tell(uint32_t subscription, uint64_t ns, const Json& message) {
    std::string bytes(1, '\1');  // message data
    addLittleEndian(bytes, subscription);
    addLittleEndian(bytes, ns);
    send(true, bytes + textOf(message));
  }

  void send(bool is_binary, std::string message) {
    outbox_.emplace_back(is_binary, std::move(message));
    if (outbox_.size() == 1) write();
  }

  void write() {
    ws_.binary(outbox_.front().first);
    ws_.async_write(asio::buffer(outbox_.front().second),
                    [self = shared_from_this()](beast::error_code error, size_t) {
                      if (error) return self->end();
                      self->outbox_.pop_front();
                      if (!self->outbox_.empty()) self->write();
                    });
  }

  void end() {
    is_open_ = false;
    beast::get_lowest_layer(ws_).close();
  }

  websocket::stream<beast::tcp_stream> ws_;
  beast::flat_buffer buffer_{kMaxAsked};
  http::request_parser<http::empty_body> parser_;
  const Gate& gate_;
  const FoxgloveOptions& options_;
  const MissionFeed& feed_;
  std::set<Session*>& alive_;
  bool is_open_ = false;
  std::map<uint32_t, uint32_t> asked_;  // the subscription of each channel
  std::deque<std::pair<bool, std::string>> outbox_;
  ToldTo told_to_;
  uint64_t told_map_ = 0;
  size_t told_events_ = 0;
  Json told_labels_, told_status_;
  Clock::time_point next_map_;
};

}  // namespace

struct FoxgloveServer::Core {
  Core(const FoxgloveOptions& given, Gate gate_given, const MissionFeed& feed_given)
      : options(given), gate(std::move(gate_given)), feed(feed_given) {}

  void accept() {
    acceptor.async_accept([this](beast::error_code error, tcp::socket socket) {
      if (!acceptor.is_open()) return;
      if (!error && sessions.size() < kMaxSessions)
        std::make_shared<Session>(std::move(socket), gate, options, feed, sessions)->begin();
      accept();
    });
  }

  void tick() {
    timer.expires_after(kLookEvery);
    timer.async_wait([this](beast::error_code error) {
      if (error) return;
      for (Session* session : std::vector<Session*>(sessions.begin(), sessions.end())) session->look();
      tick();
    });
  }

  const FoxgloveOptions options;
  const Gate gate;
  const MissionFeed& feed;
  std::set<Session*> sessions;  // outlives the handlers that io holds
  asio::io_context io{1};
  tcp::acceptor acceptor{io};
  asio::steady_timer timer{io};
  std::thread thread;
};

FoxgloveServer::FoxgloveServer(const FoxgloveOptions& options, Gate gate, const MissionFeed& feed)
    : core_(std::make_unique<Core>(options, std::move(gate), feed)) {
  beast::error_code error;
  const auto address =
      asio::ip::make_address_v4(options.host == "localhost" ? "127.0.0.1" : options.host, error);
  if (error) throw std::invalid_argument("--host \"" + options.host + "\" is no IPv4 address; 127.0.0.1 is");
  tcp::acceptor& acceptor = core_->acceptor;
  acceptor.open(tcp::v4(), error);
  if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor.bind({address, options.port}, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error) {
    throw std::runtime_error("cannot listen on " + options.host + ":" + std::to_string(options.port) +
                             " for Foxglove: " + error.message());
  }
  core_->accept();
  core_->tick();
  core_->thread = std::thread([core = core_.get()] {
    for (;;) {
      try {
        core->io.run();
        return;
      } catch (const std::exception& problem) {
        spdlog::warn("Foxglove: {}", problem.what());
      }
    }
  });
}

FoxgloveServer::~FoxgloveServer() {
  core_->io.stop();
  core_->thread.join();
}

uint16_t FoxgloveServer::port() const { return core_->acceptor.local_endpoint().port(); }

}  // namespace shoal::console
