// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/lcm_url.h"

#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "shoal/comms/kernel_limits.h"

namespace shoal::comms {
namespace {

TEST(LcmUrlTest, ParsesAndComposes) {
  EXPECT_EQ(parseUrl("udpm://224.1.2.3:4567?ttl=1&recv_buf_size=99"), (LcmUrl{"224.1.2.3", 4567, 1, 99}));
  EXPECT_EQ(parseUrl("udpm://224.1.2.3:4567?recv_buf_size=99"), (LcmUrl{"224.1.2.3", 4567, 0, 99}));
  for (const char* url :
       {kDefaultUrl, "udpm://", "udpm://:7667", "udpm://239.255.76.67", "udpm://239.255.76.67:7667?"}) {
    EXPECT_EQ(parseUrl(url), LcmUrl{}) << url;
  }
  EXPECT_EQ(composeUrl({}), kDefaultUrl);
  EXPECT_EQ(composeUrl({"224.1.2.3", 1, 255, 7}), "udpm://224.1.2.3:1?ttl=255&recv_buf_size=7");
}

TEST(LcmUrlTest, NamesWhatIsWrong) {
  const struct {
    const char* url;
    const char* named;
  } cases[] = {{"", "udpm://"},
               {"tcpq://localhost:7700", "udpm://"},
               {"udpm://10.0.0.1:7667", "10.0.0.1"},
               {"udpm://240.0.0.0:7667", "240.0.0.0"},
               {"udpm://example.org:7667", "example.org"},
               {"udpm://239.255.76.67:0", "port"},
               {"udpm://239.255.76.67:65536", "65536"},
               {"udpm://239.255.76.67:", "port"},
               {"udpm://239.255.76.67:7667x", "7667x"},
               {"udpm://239.255.76.67:7667?ttl=256", "ttl"},
               {"udpm://239.255.76.67:7667?ttl", "ttl"},
               {"udpm://239.255.76.67:7667?ttl=0&recv_buf_size=-1", "recv_buf_size"},
               {"udpm://239.255.76.67:7667?tll=1", "tll"}};
  for (const auto& [url, named] : cases) {
    try {
      parseUrl(url);
      ADD_FAILURE() << url << " was accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
    }
  }
}

TEST(LcmUrlTest, TheLocalUrlDiffersInTtlAlone) {
  EXPECT_EQ(localUrl("udpm://224.1.2.3:4567?ttl=1&recv_buf_size=99"),
            "udpm://224.1.2.3:4567?ttl=0&recv_buf_size=99");
}

TEST(LcmUrlTest, AddsAReceiveBufferWhereTheUrlSaysNothing) {
  EXPECT_EQ(withReceiveBuffer(kDefaultUrl), std::string(kDefaultUrl) + "&recv_buf_size=2097152");
  EXPECT_EQ(withReceiveBuffer("udpm://224.1.2.3:1?ttl=1&recv_buf_size=99"),
            "udpm://224.1.2.3:1?ttl=1&recv_buf_size=99");
}

TEST(KernelLimitsTest, AdvisesOnlyWhenTheLimitIsTooLow) {
  EXPECT_NE(receiveBufferAdvice(212992).value().find("sysctl -w net.core.rmem_max="), std::string::npos);
  EXPECT_EQ(receiveBufferAdvice(2097152), std::nullopt);
  EXPECT_EQ(receiveBufferAdvice(-1), std::nullopt);
}

TEST(KernelLimitsTest, FindsTheDropsOfFullBuffers) {
  EXPECT_EQ(udpReceiveErrors("Tcp: RcvbufErrors\nTcp: 5\n"
                             "Udp: InDatagrams NoPorts InErrors OutDatagrams RcvbufErrors SndbufErrors\n"
                             "Udp: 1 2 3 4 77 6\nUdpLite: RcvbufErrors\nUdpLite: 9\n"),
            77);
  EXPECT_EQ(udpReceiveErrors(""), -1);
  EXPECT_EQ(udpReceiveErrors("Udp: RcvbufErrors\n"), -1);
  EXPECT_EQ(udpReceiveErrors("Udp: InDatagrams\nUdp: 4\n"), -1);
  EXPECT_EQ(udpReceiveErrors("Udp: RcvbufErrors\nUdp: x\n"), -1);
}

}  // namespace
}  // namespace shoal::comms
