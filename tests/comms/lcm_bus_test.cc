// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/lcm_bus.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "shoal/comms/camera_channels.h"
#include "shoal/comms/kernel_limits.h"
#include "shoal/comms/lcm_url.h"
#include "shoal/comms/sender.h"

// Run by tests/support/in_namespace.sh, alone in a network namespace.
namespace shoal::comms {
namespace {

constexpr const char* kUrl = "udpm://239.255.76.67:27667?ttl=0";

Packet packet(const std::string& channel, Bytes bytes) { return {channel, std::move(bytes)}; }

// Hears until `enough` packets came or nothing came for a second.
std::vector<Packet> hear(Bus& bus, size_t enough) {
  std::vector<Packet> heard;
  while (heard.size() < enough && bus.receive(1000, [&](const Packet& each) { heard.push_back(each); }) > 0) {
  }
  return heard;
}

// Anybody's datagram to the group.
class RawSocket {
 public:
  RawSocket() : fd_(socket(AF_INET, SOCK_DGRAM, 0)) {
    to_.sin_family = AF_INET;
    to_.sin_port = htons(27667);
    inet_pton(AF_INET, "239.255.76.67", &to_.sin_addr);
  }
  ~RawSocket() { close(fd_); }
  RawSocket(const RawSocket&) = delete;
  RawSocket& operator=(const RawSocket&) = delete;

  void send(const Bytes& bytes) {
    ASSERT_EQ(
        sendto(fd_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to_), sizeof(to_)),
        static_cast<ssize_t>(bytes.size()));
  }

 private:
  int fd_;
  sockaddr_in to_{};
};

// An unfragmented LCM datagram: magic LC02, sequence number, channel, NUL, payload.
Bytes datagram(uint32_t magic, std::string_view channel, const Bytes& payload, bool terminated = true) {
  Bytes out;
  for (const int shift : {24, 16, 8, 0}) out.push_back(static_cast<uint8_t>(magic >> shift));
  out.insert(out.end(), 4, 0);
  out.insert(out.end(), channel.begin(), channel.end());
  if (terminated) out.push_back(0);
  out.insert(out.end(), payload.begin(), payload.end());
  return out;
}
constexpr uint32_t kMagic = 0x4c433032;

TEST(LcmBusTest, EverybodyHearsEverybodyAndOneself) {
  LcmBus a(kUrl);
  LcmBus b(kUrl);
  EXPECT_EQ(a.url(), std::string(kUrl) + "&recv_buf_size=2097152");
  a.publish(packet("SHOAL_R00_X", {1, 2, 3}));
  b.publish(packet("SHOAL_R01_X", {}));
  for (LcmBus* bus : {&a, &b}) {
    const auto heard = hear(*bus, 2);
    ASSERT_EQ(heard.size(), 2u);
    EXPECT_EQ(heard[0].channel, "SHOAL_R00_X");
    EXPECT_EQ(heard[0].bytes, (Bytes{1, 2, 3}));
    EXPECT_EQ(heard[1].channel, "SHOAL_R01_X");
    EXPECT_TRUE(heard[1].bytes.empty());
  }
  EXPECT_EQ(a.receive(0, [](const Packet&) {}), 0);
}

TEST(LcmBusTest, AnotherPortIsAnotherGroup) {
  LcmBus a(kUrl);
  LcmBus b("udpm://239.255.76.67:27668?ttl=0");
  b.publish(packet("SHOAL_R00_X", {1}));
  a.publish(packet("SHOAL_R00_X", {2}));
  EXPECT_EQ(hear(a, 1).at(0).bytes, Bytes{2});
  EXPECT_EQ(a.receive(50, [](const Packet&) {}), 0);
}

TEST(LcmBusTest, AHandlerMayPublishAndThrow) {
  LcmBus bus(kUrl);
  for (uint8_t i = 0; i < 3; ++i) bus.publish(packet("SHOAL_R00_X", {i}));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_THROW(bus.receive(1000, [](const Packet&) { throw std::runtime_error("caller's"); }),
               std::runtime_error);
  bus.receive(1000, [&](const Packet& heard) {
    if (heard.bytes[0] == 1) bus.publish(packet("SHOAL_R00_X", {9}));
  });
  EXPECT_EQ(hear(bus, 1).at(0).bytes, Bytes{9});
  EXPECT_EQ(bus.counts().received, 4u);
}

TEST(LcmBusTest, CraftedDatagramsDoNotDisturb) {
  LcmBus bus(kUrl);
  LcmBus other(kUrl);
  RawSocket raw;
  std::vector<Bytes> crafted = {
      {0},
      {'L', 'C', '0', '2'},
      datagram(kMagic, "", {}),
      datagram(kMagic, "", {}, false),
      datagram(0x12345678, "SHOAL_R00_X", {1, 2, 3}),
      datagram(kMagic, "SHOAL_R00_X", {}, false),  // no NUL: a size near 2^32
      datagram(kMagic, std::string(63, 'S'), {}, false),
      datagram(kMagic, std::string(64, 'S'), {1}),
      datagram(kMagic, std::string(2000, 'S'), {1}),
      datagram(kMagic, "SHOAL_", {1}),
      datagram(kMagic, "SHOAL_r00_X", {1}),
      datagram(kMagic, "SHOAL_R00_X; rm", {1}),
      datagram(kMagic, "SHOAL_R00_X", Bytes(2000, 1)),
      datagram(kMagic, "SHOAL_R00_X", Bytes(60000, 1)),
      datagram(kMagic, "LCM_SELF_TEST", {1}),
      datagram(kMagic, "NOT_OURS", {1}),
  };
  for (size_t i = 0; i < crafted.size(); ++i) {
    raw.send(crafted[i]);
    const auto n = static_cast<uint8_t>(i);
    other.publish(packet("SHOAL_R00_ALIVE", {n}));
    const auto heard = hear(bus, 1);
    ASSERT_EQ(heard.size(), 1u) << i;
    EXPECT_EQ(heard[0].channel, "SHOAL_R00_ALIVE") << i;
    EXPECT_EQ(heard[0].bytes, Bytes{n}) << i;
  }
  EXPECT_EQ(bus.counts().bad_channel, 3u);
  EXPECT_GE(bus.counts().bad_size, 2u);
  EXPECT_EQ(bus.counts().dropped, 0u);
}

// Each of the first two crashes liblcm 1.3.1 and all that listen through it: a fragment shorter than its own
// header, and one whose offset wraps around 32 bits.
TEST(LcmBusTest, FragmentsThatCrashLiblcmDoNotHarmUs) {
  const auto fragment = [](uint32_t size, uint32_t offset, uint32_t number_and_count, const Bytes& rest) {
    Bytes out = {'L', 'C', '0', '3', 0, 0, 0, 9};
    for (const uint32_t value : {size, offset, number_and_count})
      for (const int shift : {24, 16, 8, 0}) out.push_back(static_cast<uint8_t>(value >> shift));
    out.insert(out.end(), rest.begin(), rest.end());
    return out;
  };
  Bytes channel_and_more = {'S', 'H', 'O', 'A', 'L', '_', 'R', '0', '0', '_', 'X', 0};
  channel_and_more.resize(1000, 7);
  LcmBus bus(kUrl), other(kUrl);
  RawSocket raw;
  for (const Bytes& crafted :
       {Bytes{'L', 'C', '0', '3', 0, 0, 0, 9, 0, 1}, fragment(2000, 0xfffffff0, 0x00010002, channel_and_more),
        fragment(3000, 0, 0x00000002, channel_and_more),
        fragment(0x0fffffff, 0, 0x00000002, channel_and_more), fragment(1000, 0, 0, channel_and_more)}) {
    for (int times = 0; times < 5; ++times) raw.send(crafted);
    other.publish(packet("SHOAL_R00_ALIVE", {1}));
    ASSERT_EQ(hear(bus, 1).size(), 1u);
    hear(other, 1);
  }
}

TEST(LcmBusTest, DropsAndCountsWhatDoesNotFitItsQueue) {
  LcmBus bus(kUrl, {.max_queue = 10});
  for (uint8_t i = 0; i < 15; ++i) bus.publish(packet("SHOAL_R00_X", {i}));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  const auto heard = hear(bus, 10);
  ASSERT_EQ(heard.size(), 10u);
  EXPECT_EQ(heard.back().bytes, Bytes{9});  // the newest went
  EXPECT_EQ(bus.counts().dropped, 5u);
}

// 4000 full datagrams as fast as the pacing lets them out: all arrive, nothing is lost in the kernel.
TEST(LcmBusTest, PacedFullDatagramsAllArrive) {
  LcmBus from(kUrl);
  LcmBus to(kUrl);
  const int64_t lost_before = udpReceiveErrors();
  constexpr int kCount = 4000;
  Sender sender(from, nullptr, {});
  for (int i = 0; i < kCount; ++i) {
    Bytes bytes(kMaxMessageBytes - 8 - 12, static_cast<uint8_t>(i));
    sender.offer(TrafficClass::kBricks, std::to_string(i), packet("SHOAL_R00_X", bytes));
  }
  const auto start = std::chrono::steady_clock::now();
  sender.pump(0);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  EXPECT_EQ(hear(to, kCount).size(), static_cast<size_t>(kCount));
  EXPECT_EQ(udpReceiveErrors(), lost_before);
  RecordProperty("datagrams_per_s", std::to_string(kCount / seconds.count()));
  EXPECT_GE(seconds.count(), (kCount - 8) * 1e-3);
}

TEST(LcmBusTest, FindsAPortThatNobodyHas) {
  const uint16_t first = freePort(1);
  EXPECT_GE(first, 20000);
  EXPECT_LE(first, 60000);
  EXPECT_EQ(freePort(1), first);
  const LcmBus taken(chooseFreeUrl(1));  // bound with SO_REUSEADDR, as LCM does
  EXPECT_NE(freePort(1), first);
  EXPECT_EQ(parseUrl(taken.url()).port, first);
}

TEST(LcmBusTest, RejectsABadUrl) { EXPECT_THROW(LcmBus("udpm://10.0.0.1:7667"), std::invalid_argument); }

TEST(LcmBusDeathTest, AbortsRatherThanSendAMessageThatIsTooLarge) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  LcmBus bus(kUrl);
  EXPECT_DEATH(bus.publish(packet("SHOAL_R00_X", Bytes(kMaxMessageBytes - 8 - 11))), "demand failed");
  EXPECT_DEATH(bus.publish(packet("NOT_OURS", {})), "demand failed");
}

// Last: it takes the network away.
TEST(LcmBusWithoutARouteTest, SaysWhichCommandHelps) {
  ASSERT_EQ(std::system("ip route del 224.0.0.0/4 dev lo"), 0);
  try {
    LcmBus bus(kUrl);
    ADD_FAILURE() << "worked without a route";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("ip route add 224.0.0.0/4 dev lo"), std::string::npos)
        << error.what();
  }
  ASSERT_EQ(std::system("ip route add 224.0.0.0/4 dev lo"), 0);
}

// A camera's pictures are larger than a datagram; LCM cuts them and puts them together.
TEST(LcmBusTest, CarriesALargeMessageOnAChannelOfOthers) {
  LcmBusOptions options;
  options.channels = CameraChannels("CAM").all();
  options.max_message_bytes = 1 << 20;
  LcmBus camera(kUrl, options), robot(kUrl, options), ours(kUrl);
  Bytes picture(300'000);
  for (size_t i = 0; i < picture.size(); ++i) picture[i] = static_cast<uint8_t>(i * 7 + i / 251);
  camera.publish(packet("CAM_IMAGE", picture));
  camera.publish(packet("CAM_POSE", {1, 2, 3}));
  const auto heard = hear(robot, 2);
  ASSERT_EQ(heard.size(), 2u);
  EXPECT_EQ(heard[0].channel, "CAM_IMAGE");
  EXPECT_EQ(heard[0].bytes, picture);
  EXPECT_EQ(heard[1].channel, "CAM_POSE");
  EXPECT_EQ(ours.receive(100, [](const Packet&) {}), 0);
}

TEST(LcmBusTest, RefusesWhatIsLargerThanTheOptionsSay) {
  LcmBusOptions large, small;
  large.channels = small.channels = {"CAM_IMAGE"};
  large.max_message_bytes = 1 << 20;
  small.max_message_bytes = 100'000;
  LcmBus camera(kUrl, large), robot(kUrl, small);
  camera.publish(packet("CAM_IMAGE", Bytes(100'000)));
  camera.publish(packet("CAM_IMAGE", Bytes(99'000)));
  EXPECT_EQ(hear(robot, 1).size(), 1u);
  EXPECT_EQ(robot.counts().bad_size, 1u);
}

TEST(LcmBusTest, ChannelsOfOthersHavePlainNames) {
  for (const char* bad : {"", "CAM IMAGE", "CAM.*", "CAM-IMAGE"}) {
    LcmBusOptions options;
    options.channels = {bad};
    EXPECT_THROW(LcmBus(kUrl, options), std::invalid_argument) << bad;
  }
  LcmBusOptions options;
  options.max_message_bytes = 100;
  EXPECT_THROW(LcmBus(kUrl, options), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::comms
