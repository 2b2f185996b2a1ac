// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/kill_plan.h"

#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

namespace shoal::console {

std::vector<KillStep> readKillPlan(const std::string& path, int num_robots) {
  std::ifstream file(path);
  if (!file) throw std::invalid_argument("--kill-plan " + path + " cannot be read");
  struct Last {
    KillStep step;
    int line = 0;
  };
  std::map<world::RobotId, Last> last;
  std::vector<KillStep> plan;
  const auto refuse = [&path](int line, const std::string& why) {
    throw std::invalid_argument("--kill-plan " + path + ":" + std::to_string(line) + ": " + why);
  };
  std::string text;
  for (int line = 1; std::getline(file, text); ++line) {
    std::istringstream words(text);
    std::string robot, what, more;
    if (!(words >> std::ws) || words.eof() || words.peek() == '#') continue;
    KillStep step;
    const bool read = static_cast<bool>(words >> step.at_s >> robot >> what) && !(words >> more);
    if (!read || (what != "kill" && what != "restart" && what != "anew")) {
      refuse(line, "\"" + text + "\" should be `t_s ROBOT kill`, `t_s ROBOT restart` or `t_s ROBOT anew`");
    }
    if (!(step.at_s >= 0 && step.at_s <= 1e6)) refuse(line, "the time must lie in [0, 1000000] s");
    const auto id = world::parseRobotId(robot);
    if (!id || number(*id) >= num_robots) {
      refuse(line, robot + " is none of this mission's robots, R00 to " +
                       world::name(world::RobotId{num_robots - 1}));
    }
    step.robot = *id;
    step.restart = what != "kill";
    step.anew = what == "anew";
    const auto before = last.find(step.robot);
    const bool is_dead = before != last.end() && !before->second.step.restart;
    if (step.restart && !is_dead) refuse(line, robot + " is restarted and was not killed before");
    if (!step.restart && is_dead) refuse(line, robot + " is killed twice without a restart between");
    if (before != last.end() && step.at_s <= before->second.step.at_s) {
      refuse(line, robot + "'s times must grow");
    }
    last[step.robot] = {step, line};
    plan.push_back(step);
  }
  for (const auto& [robot, at] : last) {
    if (!at.step.restart) {
      refuse(at.line,
             world::name(robot) + " is killed and never restarted; nobody else can say its pieces again");
    }
  }
  return plan;
}

}  // namespace shoal::console
