// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/lcm_bus.h"

#include <poll.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdint>
#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <stdexcept>
#include <utility>

#include "shoal/comms/channels.h"
#include "shoal/comms/datagram_receiver.h"
#include "shoal/comms/lcm_url.h"
#include "shoal/demand.h"

namespace shoal::comms {
namespace {

using Clock = std::chrono::steady_clock;

int millisecondsUntil(Clock::time_point deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
  return static_cast<int>(std::max<decltype(left)>(left, 0));
}

}  // namespace

struct LcmBus::Impl {
  Impl(const std::string& url_in, const LcmBusOptions& options_in)
      : url(url_in), options(options_in), transport(url_in) {}

  void onMessage(const lcm::ReceiveBuffer& buffer, const std::string& channel) noexcept;

  bool hearsOurs() const { return options.channels.empty() && !options.everything; }

  bool isKnown(const std::string& channel) const {
    if (options.everything) return channel != "LCM_SELF_TEST";
    return options.channels.empty() ? parseChannel(channel).has_value()
                                    : std::ranges::find(options.channels, channel) != options.channels.end();
  }

  std::string url;
  LcmBusOptions options;
  std::deque<Packet> queue;
  LcmBusCounts counts;
  lcm::LCM transport;
  std::unique_ptr<DatagramReceiver> ours;  // of our channels; LCM itself hears those of others
  int fd = -1;

  void drain();
};

// Takes what has arrived into the queue. Bounded, so that a flood faster than this cannot hold it.
void LcmBus::Impl::drain() {
  if (ours == nullptr) {
    for (size_t i = 0; i < 2 * options.max_queue && transport.handleTimeout(0) > 0; ++i) {
    }
    return;
  }
  for (Packet& packet : ours->take()) queue.push_back(std::move(packet));
  const DatagramCounts of_ours = ours->counts();
  counts.dropped = of_ours.dropped;
  counts.bad_channel = of_ours.bad_channel;
  counts.bad_size = of_ours.bad_size;
}

// Called from inside LCM, which an exception would leave locked. A datagram without a channel's NUL arrives
// with a data_size near 2^32: nothing is read before the sizes are known to be sound.
void LcmBus::Impl::onMessage(const lcm::ReceiveBuffer& buffer, const std::string& channel) noexcept {
  if (messageSize(channel.size(), buffer.data_size) > options.max_message_bytes) {
    ++counts.bad_size;
    return;
  }
  if (queue.size() >= options.max_queue) {
    ++counts.dropped;
    return;
  }
  try {
    if (!isKnown(channel)) {
      ++counts.bad_channel;
      return;
    }
    const auto* bytes = static_cast<const uint8_t*>(buffer.data);
    queue.push_back({channel, Bytes(bytes, bytes + buffer.data_size)});
  } catch (...) {  // no memory
    ++counts.dropped;
  }
}

LcmBus::LcmBus(const std::string& url, const LcmBusOptions& options) {
  if (options.max_queue < 1) throw std::invalid_argument("max_queue must be at least 1, got 0");
  if (options.max_message_bytes < kMaxMessageBytes || options.max_message_bytes > size_t{1} << 28) {
    throw std::invalid_argument("max_message_bytes must lie in [1400, 2^28], got " +
                                std::to_string(options.max_message_bytes));
  }
  for (const std::string& channel : options.channels) {
    const auto plain = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
    if (channel.empty() || channel.size() > kMaxChannelLength || !std::ranges::all_of(channel, plain)) {
      throw std::invalid_argument("channel \"" + channel +
                                  "\" should be 1 to 63 letters, digits and underscores");
    }
  }
  impl_ = std::make_unique<Impl>(withReceiveBuffer(url), options);
  const auto fail = [&](const char* what) {
    throw std::runtime_error("LCM cannot use " + impl_->url + ": " + what +
                             "; without a multicast route, run: sudo ip route add 224.0.0.0/4 dev lo");
  };
  if (!impl_->transport.good()) fail("the socket cannot be set up");
  if (impl_->hearsOurs()) {
    try {
      impl_->ours = std::make_unique<DatagramReceiver>(parseUrl(impl_->url), options.max_queue);
    } catch (const std::runtime_error& error) {
      fail(error.what());
    }
    impl_->fd = impl_->ours->fileDescriptor();
    return;
  }
  // A function, for g++ 12 miscompiles LCM's way of calling a member under -fsanitize=vptr.
  using Handler = void (*)(const lcm::ReceiveBuffer*, const std::string&, Impl*);
  const Handler handler = [](const lcm::ReceiveBuffer* buffer, const std::string& channel, Impl* impl) {
    impl->onMessage(*buffer, channel);
  };
  const auto subscribe = [&](const std::string& pattern, int capacity) {
    lcm::Subscription* subscription = impl_->transport.subscribeFunction(pattern, handler, impl_.get());
    if (subscription == nullptr) fail("subscribing failed");
    subscription->setQueueCapacity(capacity);
  };
  const int most = static_cast<int>(std::min<size_t>(options.max_queue, INT32_MAX));
  if (options.everything) subscribe(".*", most);
  for (const std::string& channel : options.channels) subscribe(channel, most);
  impl_->fd = impl_->transport.getFileno();  // starts the receiving thread, with LCM's self test
  if (impl_->fd < 0) fail("the receiving thread did not start");
}

LcmBus::~LcmBus() = default;

void LcmBus::publish(const Packet& packet) {
  SHOAL_DEMAND(messageSize(packet) <= impl_->options.max_message_bytes);
  SHOAL_DEMAND(impl_->isKnown(packet.channel));
  impl_->transport.publish(packet.channel, packet.bytes.data(),
                           static_cast<unsigned int>(packet.bytes.size()));
}

int LcmBus::receive(int timeout_ms, const std::function<void(const Packet&)>& handler) {
  std::deque<Packet>& queue = impl_->queue;
  const auto deadline = Clock::now() + std::chrono::milliseconds(timeout_ms);
  while (true) {
    pollfd readable{impl_->fd, POLLIN, 0};
    if (poll(&readable, 1, queue.empty() ? millisecondsUntil(deadline) : 0) <= 0) break;
    impl_->drain();
    if (!queue.empty() || Clock::now() >= deadline) break;  // else all of it was refused
  }
  int delivered = 0;
  while (!queue.empty()) {
    const Packet packet = std::move(queue.front());
    queue.pop_front();
    ++impl_->counts.received;
    ++delivered;
    handler(packet);  // when it throws, the rest waits for the next call
  }
  return delivered;
}

int LcmBus::fileDescriptor() const { return impl_->fd; }
const std::string& LcmBus::url() const { return impl_->url; }
const LcmBusCounts& LcmBus::counts() const { return impl_->counts; }

}  // namespace shoal::comms
