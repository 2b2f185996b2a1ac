// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/doctor.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <sys/socket.h>
#include <sys/statvfs.h>
#include <sys/timex.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include <spdlog/fmt/fmt.h>

#include "operator_console/supervisor.h"
#include "operator_console/terminal.h"
#include "shoal/comms/kernel_limits.h"
#include "shoal/comms/lcm_bus.h"
#include "shoal/comms/lcm_url.h"
#include "shoal/version.h"
#include "shoal/wire/message_kind.h"

namespace shoal::console {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using State = Finding::State;
using Clock = std::chrono::steady_clock;

constexpr auto kListen = std::chrono::milliseconds(1300);  // a heartbeat comes about once a second
constexpr double kGigabyte = 1e9;
constexpr const char* kRoute = "sudo ip route add 224.0.0.0/4 dev lo";

// The interface with this address; "" when there is none.
std::string interfaceOf(const in_addr& address) {
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) return "";
  std::string name;
  for (const ifaddrs* i = all; i != nullptr; i = i->ifa_next) {
    if (i->ifa_addr == nullptr || i->ifa_addr->sa_family != AF_INET) continue;
    if (reinterpret_cast<const sockaddr_in*>(i->ifa_addr)->sin_addr.s_addr == address.s_addr)
      name = i->ifa_name;
  }
  freeifaddrs(all);
  return name;
}

// The interface of the narrowest IPv4 route to an address, from the kernel's table; "" when there is none.
// For interfaces that have no address of their own.
std::string routedBy(const in_addr& address) {
  std::ifstream table("/proc/net/route");
  std::string line, best;
  std::getline(table, line);  // the header
  uint32_t narrowest = 0;
  while (std::getline(table, line)) {
    std::istringstream row(line);
    std::string name, skipped;
    uint32_t destination = 0, mask = 0;
    row >> name >> std::hex >> destination >> skipped >> skipped >> skipped >> skipped >> skipped >> mask;
    if (!row || (address.s_addr & mask) != destination) continue;
    if (!best.empty() && ntohl(mask) <= ntohl(narrowest)) continue;
    best = name;
    narrowest = mask;
  }
  return best;
}

Finding routeOf(const comms::LcmUrl& url) {
  Finding finding{"multicast route", State::kBad, "", kRoute};
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in group{}, own{};
  group.sin_family = AF_INET;
  group.sin_port = htons(url.port);
  inet_pton(AF_INET, url.group.c_str(), &group.sin_addr);
  socklen_t size = sizeof own;
  if (fd < 0 || ::connect(fd, reinterpret_cast<const sockaddr*>(&group), sizeof group) != 0 ||
      ::getsockname(fd, reinterpret_cast<sockaddr*>(&own), &size) != 0) {
    finding.says = fmt::format("no way to {}: {}", url.group, std::strerror(errno));
  } else {
    std::string interface = interfaceOf(own.sin_addr);
    if (interface.empty()) interface = routedBy(group.sin_addr);
    finding = {"multicast route", State::kGood,
               interface.empty() ? fmt::format("there is a way to {}", url.group)
                                 : fmt::format("{} goes by {}", url.group, interface),
               ""};
    if (url.ttl > 0 && interface == "lo") {
      finding.state = State::kWarning;
      finding.says += ", which leads to no other host";
      finding.type = "sudo ip route replace 224.0.0.0/4 dev INTERFACE";
    }
  }
  if (fd >= 0) ::close(fd);
  return finding;
}

// A message to oneself, on a port that nobody uses.
Finding loopback(const comms::LcmUrl& url) {
  const Finding bad{"loopback", State::kBad, "a message to this host did not come back",
                    "sudo ip link set lo up; sudo ip link set lo multicast on; " + std::string(kRoute)};
  try {
    comms::LcmUrl own = url;
    own.ttl = 0;
    own.port = comms::freePort(static_cast<uint64_t>(::getpid()));
    comms::LcmBus bus(comms::composeUrl(own));
    const comms::Packet packet{"SHOAL_DOCTOR_HEARTBEAT", {1, 2, 3}};
    bool came_back = false;
    for (const auto start = Clock::now(); !came_back && Clock::now() - start < kListen;) {
      bus.publish(packet);
      bus.receive(100, [&](const comms::Packet& heard) { came_back |= heard.bytes == packet.bytes; });
    }
    if (came_back) return {"loopback", State::kGood, "a message to this host came back", ""};
    return bad;
  } catch (const std::runtime_error& error) {
    Finding finding = bad;
    finding.says = error.what();
    return finding;
  }
}

std::vector<Finding> air(const std::string& url) {
  try {
    comms::LcmBus bus(url);
    std::set<int32_t> missions;
    for (const auto start = Clock::now(); Clock::now() - start < kListen;) {
      bus.receive(100, [&](const comms::Packet& packet) {
        if (const auto header = wire::peek(packet.bytes)) missions.insert(header->mission);
      });
    }
    if (missions.empty()) return {{"group", State::kGood, "nobody speaks on " + url, ""}};
    std::string who;
    for (const int32_t mission : missions) who += (who.empty() ? "" : ", ") + std::to_string(mission);
    return {{"group", missions.size() > 1 ? State::kBad : State::kWarning,
             fmt::format("{} heard on {}: a new one needs another port",
                         missions.size() > 1 ? "missions " + who + " are" : "mission " + who + " is", url),
             "--lcm-url '" + comms::chooseFreeUrl(static_cast<uint64_t>(::getpid())) + "'"}};
  } catch (const std::runtime_error&) {
    return {};  // the loopback has said so
  }
}

std::vector<Finding> buffers() {
  std::vector<Finding> findings;
  const int64_t limit = comms::kernelReceiveLimit();
  if (const auto advice = comms::receiveBufferAdvice(limit)) {
    findings.push_back({"receive buffers", State::kWarning,
                        fmt::format("the kernel grants {} bytes of {}: bursts will be lost, and said again",
                                    limit, comms::kReceiveBufferBytes),
                        "sudo sysctl -w net.core.rmem_max=4194304"});
  } else {
    findings.push_back({"receive buffers", State::kGood, fmt::format("{} bytes are granted", limit), ""});
  }
  const int64_t lost = comms::udpReceiveErrors();
  findings.push_back({"datagrams dropped", lost > 0 ? State::kWarning : State::kGood,
                      lost < 0   ? "the kernel does not say"
                      : lost > 0 ? fmt::format("{} since this host started, as buffers were full", lost)
                                 : "none since this host started",
                      ""});
  return findings;
}

Finding reach(const comms::LcmUrl& url) {
  if (url.ttl == 0) return {"reach", State::kGood, "ttl=0: messages stay on this host; ttl=1 leaves it", ""};
  return {"reach", State::kGood,
          fmt::format("ttl={}: messages leave this host, by up to {} routers", url.ttl, url.ttl - 1), ""};
}

Finding clock() {
  timex state{};
  const int how = ::adjtimex(&state);
  if (std::chrono::system_clock::now().time_since_epoch() < std::chrono::years(54)) {
    return {"clock", State::kWarning, "it says a year before 2024", "sudo date -s '2026-01-31 12:00'"};
  }
  if (how == TIME_ERROR || (state.status & STA_UNSYNC) != 0) {
    return {"clock", State::kWarning, "nothing keeps it right; recordings of several hosts will not line up",
            "sudo apt-get install systemd-timesyncd && sudo timedatectl set-ntp true"};
  }
  return {"clock", State::kGood, "kept right", ""};
}

// What a program prints first.
std::string firstLineOf(const std::string& command) {
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return {};
  char line[256] = {};
  const bool read = std::fgets(line, sizeof line, pipe) != nullptr;
  ::pclose(pipe);
  std::string text = read ? line : "";
  if (text.ends_with('\n')) text.pop_back();
  return text;
}

Finding programs() {
  const std::string own = std::string(version()) + " (" + commit() + ")";
  for (const std::string name : {"robot_agent", "fusion_node"}) {
    std::string path;
    try {
      path = programBeside(name);
    } catch (const std::exception& error) {
      return {"programs", State::kBad, error.what(), "./shoal build"};
    }
    const std::string said = firstLineOf("'" + path + "' --version 2>/dev/null");
    if (said != name + " " + own) {
      return {"programs", State::kWarning, fmt::format("{} says \"{}\", this is {}", path, said, own),
              "./shoal build"};
    }
  }
  return {"programs", State::kGood, "all are " + own, ""};
}

std::vector<Finding> packages() {
  std::vector<Finding> findings;
  const auto look = [&](const char* program, const char* package, const char* what) {
    try {
      programOnPath(program, package);
      findings.push_back({program, State::kGood, std::string("is there, ") + what, ""});
    } catch (const std::exception&) {
      findings.push_back({program, State::kWarning, std::string("is missing, ") + what,
                          std::string("sudo apt-get install ") + package});
    }
  };
  look("lcm-logger", "liblcm-bin", "for --record");
  look("java", "openjdk-17-jre", "for shoal-spy");
  look("python3", "python3", "for shoal_reader.py");
  return findings;
}

Finding disk(const std::string& folder) {
  fs::path there = fs::absolute(folder).lexically_normal();
  while (!fs::exists(there) && there.has_relative_path()) there = there.parent_path();
  struct statvfs space {};
  if (::access(there.c_str(), W_OK) != 0 || ::statvfs(there.c_str(), &space) != 0) {
    return {"disk", State::kBad, fmt::format("cannot write in {}: {}", there.string(), std::strerror(errno)),
            "--out ANOTHER_FOLDER"};
  }
  const double free = static_cast<double>(space.f_bavail) * static_cast<double>(space.f_frsize);
  const std::string says = fmt::format("{:.1f} GB free in {}", free / kGigabyte, there.string());
  if (free < 0.05 * kGigabyte) return {"disk", State::kBad, says, "df -h"};
  return {"disk", free < kGigabyte ? State::kWarning : State::kGood, says, ""};
}

std::string_view nameOf(State state) {
  return state == State::kGood ? "good" : state == State::kWarning ? "warning" : "bad";
}

}  // namespace

std::vector<Finding> examine(const std::string& url, const std::string& folder) {
  const comms::LcmUrl parsed = comms::parseUrl(url);
  std::vector<Finding> findings;
  const auto add = [&findings](std::vector<Finding> more) {
    findings.insert(findings.end(), std::make_move_iterator(more.begin()),
                    std::make_move_iterator(more.end()));
  };
  const Finding route = routeOf(parsed);
  add({route});
  if (route.state != State::kBad) {
    add({loopback(parsed)});
    add(air(url));
  }
  add({reach(parsed)});
  add(buffers());
  add({clock(), disk(folder), programs()});
  add(packages());
  return findings;
}

bool works(const std::vector<Finding>& findings) {
  for (const Finding& f : findings)
    if (f.state == State::kBad) return false;
  return true;
}

Json toJson(const std::vector<Finding>& findings, const std::string& url) {
  Json answer{{"url", url}, {"works", works(findings)}, {"checks", Json::array()}};
  for (const Finding& f : findings) {
    answer["checks"].push_back(
        {{"check", f.check}, {"state", std::string(nameOf(f.state))}, {"says", f.says}, {"type", f.type}});
  }
  return answer;
}

std::string toText(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& f : findings) {
    std::string state = fmt::format("{:<7}", nameOf(f.state));
    if (f.state == State::kBad) state = alarming(state);
    text += fmt::format("{} {:<18} {}\n", state, f.check, f.says);
    if (!f.type.empty()) text += fmt::format("{:26} type: {}\n", "", f.type);
  }
  return text;
}

}  // namespace shoal::console
