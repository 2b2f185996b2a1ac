// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/progress.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include <spdlog/fmt/fmt.h>

#include "shoal/world/ids.h"

namespace shoal::console {
namespace {

constexpr size_t kRobotWidth = 46;
constexpr size_t kMaxBar = 40;

// Where there is no terminal.
constexpr double kSaidEveryS = 60;
constexpr size_t kLineWidth = 120;

std::string bytesText(int64_t bytes) {
  return bytes < 100'000 ? fmt::format("{} B", bytes)
                         : fmt::format("{:.1f} kB", static_cast<double>(bytes) / 1000);
}

std::string timeText(double seconds) {
  const auto whole = static_cast<int64_t>(seconds + 0.5);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

std::string robotText(const std::string& name, const wire::Heartbeat* robot) {
  if (!robot) return fmt::format("{}  not heard yet", name);
  const std::string frames = fmt::format("{}/{}", robot->observation + 1, robot->num_observations);
  return fmt::format("{} {:>9} frames {:>3} topics {:>9}{}", name, frames, robot->num_topics,
                     bytesText(robot->bytes_sent), robot->phase == wire::Phase::kFlying ? "" : " landed");
}

}  // namespace

std::vector<std::string> progressLines(const MissionProgress& progress, size_t width, size_t height) {
  std::vector<std::string> robots;
  int64_t flown = 0, planned = 0;
  for (int32_t number = 0; number < progress.num_robots; ++number) {
    const std::string name = world::name(world::RobotId{number});
    const auto found = progress.nodes->find(name);
    const wire::Heartbeat* robot = found == progress.nodes->end() ? nullptr : &found->second;
    robots.push_back(robotText(name, robot));
    flown += robot ? robot->observation + 1 : 0;
    planned += robot && robot->num_observations > 0 ? robot->num_observations : progress.observations;
  }

  std::vector<std::string> lines;
  const size_t columns = std::max<size_t>(1, width / (kRobotWidth + 1));
  const size_t rows = (robots.size() + columns - 1) / columns;
  if (rows < height) {
    for (size_t row = 0; row < rows; ++row) {
      std::string line;
      for (size_t i = row; i < robots.size(); i += rows)
        line += fmt::format("{:<{}} ", robots[i], kRobotWidth);
      line.erase(line.find_last_not_of(' ') + 1);
      lines.push_back(line);
    }
  }
  const double done =
      planned > 0 ? std::min(1.0, static_cast<double>(flown) / static_cast<double>(planned)) : 0;
  const auto filled = static_cast<size_t>(done * kMaxBar);
  std::string eta;
  if (flown > 0 && flown < planned) eta = "  ETA " + timeText(progress.elapsed_s * (1 - done) / done);
  lines.push_back(fmt::format("[{}{}] {:3.0f} %  {}/{} frames  {}{}  {}", std::string(filled, '#'),
                              std::string(kMaxBar - filled, '.'), 100 * done, flown, planned,
                              timeText(progress.elapsed_s), eta, progress.doing));
  for (std::string& line : lines) line.resize(std::min(line.size(), width));
  return lines;
}

// To the line's beginning, for a typed ^C stands there; up, and away with all below.
std::string erasing(size_t lines) { return lines > 0 ? fmt::format("\r\033[{}A\033[J", lines) : ""; }

TerminalBlock::TerminalBlock() : is_terminal_(isatty(STDERR_FILENO) == 1) {}

void TerminalBlock::draw(const MissionProgress& progress) {
  if (!is_terminal_) {
    if (progress.elapsed_s - said_s_ < kSaidEveryS) return;
    said_s_ = progress.elapsed_s;
    std::fprintf(stderr, "%s\n", progressLines(progress, kLineWidth, 2).back().c_str());
    return;
  }
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 && size.ws_row > 1;
  const auto lines = progressLines(progress, known ? size.ws_col - 1u : 79, known ? size.ws_row - 1u : 24);
  clear();
  for (const std::string& line : lines) std::fprintf(stderr, "%s\n", line.c_str());
  std::fflush(stderr);
  drawn_ = lines.size();
}

void TerminalBlock::clear() {
  std::fputs(erasing(drawn_).c_str(), stderr);
  drawn_ = 0;
}

}  // namespace shoal::console
