// SPDX-License-Identifier: BSD-3-Clause
// publish_messages URL SECONDS CHANNEL FILE [CHANNEL FILE]...: publishes the bytes of each file on its
// channel, ten times a second.
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

int main(int argc, char** argv) {
  if (argc < 5 || argc % 2 == 0) {
    std::fprintf(stderr, "usage: publish_messages URL SECONDS CHANNEL FILE [CHANNEL FILE]...\n");
    return 2;
  }
  lcm::LCM bus(argv[1]);
  if (!bus.good()) return 1;
  std::vector<std::pair<std::string, std::string>> messages;
  for (int i = 3; i < argc; i += 2) {
    std::ifstream file(argv[i + 1], std::ios::binary);
    messages.emplace_back(argv[i], std::string(std::istreambuf_iterator<char>(file), {}));
    if (messages.back().second.empty()) {
      std::fprintf(stderr, "cannot read %s\n", argv[i + 1]);
      return 1;
    }
  }
  for (int i = 0; i < 10 * std::stoi(argv[2]); ++i) {
    for (const auto& [channel, bytes] : messages) {
      bus.publish(channel, bytes.data(), static_cast<unsigned>(bytes.size()));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return 0;
}
