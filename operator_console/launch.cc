// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/launch.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>

#include <spdlog/spdlog.h>

#include "fusion_node/authentication.h"
#include "operator_console/finish_run.h"
#include "operator_console/kill_plan.h"
#include "operator_console/log_check.h"
#include "operator_console/mission_commands.h"
#include "operator_console/mission_watch.h"
#include "operator_console/progress.h"
#include "operator_console/recording_repair.h"
#include "operator_console/remains.h"
#include "operator_console/stop_signal.h"
#include "operator_console/summary.h"
#include "operator_console/supervisor.h"
#include "shoal/comms/kernel_limits.h"
#include "shoal/comms/lcm_bus.h"
#include "shoal/comms/lcm_url.h"
#include "shoal/comms/link_model.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/random.h"
#include "shoal/wire/message_kind.h"

namespace shoal::console {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kListenFirst{1500};  // a heartbeat comes about once a second
constexpr milliseconds kRedraw{250};
constexpr std::chrono::seconds kPatience{5};   // between SIGTERM and SIGKILL when interrupted
constexpr std::chrono::seconds kWriting{60};   // for writing files at the end
constexpr std::chrono::seconds kStarting{20};  // for the logger and the fusion node to be there
constexpr milliseconds kLoggerFlush{500};      // lcm-logger flushes every 100 ms
constexpr milliseconds kLogCheck{2000};        // between two looks at the recording
constexpr int64_t kThinBudget =
    50;  // bytes per second with which a mission of some size settles within the hour
constexpr int64_t kHeartbeatBytes = 210;  // on the wire, about
constexpr int kMaxCrashes = 3;            // of one process, unplanned

struct Interrupted {
  int signal;
};

struct Failed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

std::string joined(const std::vector<std::string>& items, size_t most = 5) {
  std::string text;
  for (size_t i = 0; i < std::min(items.size(), most); ++i) text += (i ? ", " : "") + items[i];
  if (items.size() > most) text += " and " + std::to_string(items.size() - most) + " more";
  return text;
}

// A number that no other mission has: it is an identity, nothing is computed from it.
int32_t newMissionId() {
  const auto now = static_cast<uint64_t>(std::chrono::system_clock::now().time_since_epoch().count());
  return static_cast<int32_t>(hashCombine(now, static_cast<uint64_t>(getpid())) % 0x7fffffffu) + 1;
}

void refuseOldMission(const LaunchOptions& options) {
  if (options.overwrite) return;
  const char* const choice = "; name another folder, or add --overwrite";
  if (fs::exists(fs::path(options.out) / "summary.json")) {
    throw std::invalid_argument("--out " + options.out + " holds a finished mission" + choice);
  }
  const auto remains = remainsOf(options.out);
  if (remains.empty()) {
    const std::string file = fileOfMission(options.out);
    if (file.empty() || fs::exists(fs::path(options.out) / "logs" / "OPERATOR.log")) return;
    throw std::invalid_argument("--out " + options.out + " holds a " + file + " of its own" + choice);
  }
  const std::string ask = howToAsk(options.out);
  throw std::invalid_argument("--out " + options.out + " holds what is left of a mission that did not end (" +
                              joined(remains) + ")" + (ask.empty() ? "" : ", which answers: " + ask) +
                              choice);
}

// Makes the folder ready: without the files of a mission that was there before.
void prepareFolder(const LaunchOptions& options) {
  const fs::path out = options.out;
  if (fs::exists(out / "logs" / "OPERATOR.log") || !remainsOf(options.out).empty())
    removeMission(options.out);
  std::error_code error;
  fs::create_directories(out / "logs", error);
  if (error) throw std::invalid_argument("--out " + options.out + " cannot be made: " + error.message());
}

class Mission {
 public:
  Mission(const LaunchOptions& options, std::vector<KillStep> plan)
      : options_(options),
        plan_(std::move(plan)),
        air_(options.lcm_url),
        sealed_(fusion_node::authenticated(air_, fusion_node::readKey(options.key))),
        bus_(sealed_ ? static_cast<comms::Bus&>(*sealed_) : air_),
        watch_(options.mission, options.num_robots, options.budget),
        started_(Clock::now()) {}

  int run(bool url_was_given);

 private:
  void refuseOtherMissions();
  void startAll();
  void turn();
  void checkEnded(const Ended& ended);
  bool comesBack(const Ended& ended);
  void restart(world::RobotId robot, double start_s, const char* why);
  bool isHeard(const std::string& name) const;
  void followPlan();
  bool isDue(const KillStep& step) const;
  std::vector<std::string> notBack() const;
  template <typename Done>
  bool turnUntil(Clock::duration limit, Done&& done);
  std::vector<std::string> settle();
  std::vector<std::string> settleRecording();
  void askForRecording();
  void stop(const std::vector<std::string>& names, int signal, const char* doing);
  void stopTeam();
  std::string singleProgress() const;
  void stopLogger();

  LaunchOptions options_;
  std::vector<KillStep> plan_;            // still to come
  std::map<world::RobotId, int> epochs_;  // of robots that began anew
  std::set<std::string> crashing_;        // killed by the plan, not gone yet
  std::set<std::string> restarted_;       // by plan or after a crash
  std::map<std::string, int> crashes_;    // unplanned
  comms::LcmBus air_;
  std::unique_ptr<comms::AuthenticatedBus> sealed_;  // with a key
  comms::Bus& bus_;
  MissionWatch watch_;
  Supervisor children_;
  TerminalBlock block_;
  Clock::time_point started_, drawn_;
  std::set<std::string> may_end_ = {"single"};  // in good order
  std::string doing_ = "starting";
  double asked_at_s_ = 0;  // mission time
};

// Listens, redraws, and throws when the mission cannot go on.
void Mission::turn() {
  bus_.receive(50, [this](const comms::Packet& packet) { watch_.hear(packet); });
  if (stopSignal() != 0) throw Interrupted{stopSignal()};
  for (const Ended& ended : children_.reap()) checkEnded(ended);
  followPlan();
  if (const auto other = watch_.otherMission()) {
    throw Failed("another mission (" + std::to_string(*other) + ") is heard on " + options_.lcm_url);
  }
  if (Clock::now() - drawn_ < kRedraw) return;
  drawn_ = Clock::now();
  block_.draw({options_.num_robots, options_.observations,
               std::chrono::duration<double>(Clock::now() - started_).count(), doing_, &watch_.nodes()});
}

// Kills and restarts who is due, each robot one step after the other.
void Mission::followPlan() {
  std::set<world::RobotId> looked_at;
  std::erase_if(plan_, [&](const KillStep& step) {
    if (!looked_at.insert(step.robot).second || !isDue(step)) return false;
    const std::string name = world::name(step.robot);
    if (step.restart) {
      if (step.anew) {
        fs::remove(checkpointDir(options_) + "/" + name + ".checkpoint");
        ++epochs_[step.robot];
      }
      restart(step.robot, std::max(step.at_s, watch_.lastSentAt(name)), "as planned");
    } else {
      spdlog::info("{} is killed at {:.1f} s, as planned", name, watch_.lastSentAt(name));
      crashing_.insert(name);
      children_.signal(name, SIGKILL);
    }
    return true;
  });
}

// Its clock goes on: two lives in the same mission time would both spend its budget.
void Mission::restart(world::RobotId robot, double start_s, const char* why) {
  const std::string name = world::name(robot);
  const auto epoch = epochs_.find(robot);
  start_s = std::max(start_s, 1e-6);
  spdlog::info("{} {} at {:.1f} s, {}", name, epoch == epochs_.end() ? "comes back" : "begins anew", start_s,
               why);
  children_.start(robotCommand(options_, number(robot), epoch == epochs_.end() ? 0 : epoch->second, start_s));
  restarted_.insert(name);
}

// A robot is killed by its own clock, and comes back by that of who is furthest; or at once when everybody
// else has landed, for then there is nothing to wait for.
bool Mission::isDue(const KillStep& step) const {
  const std::string name = world::name(step.robot);
  if (!step.restart) {
    return isHeard(name) && watch_.nodes().at(name).time.seconds() >= step.at_s;
  }
  if (children_.isRunning(name)) return false;
  return watch_.missionTime() >= step.at_s || watch_.allLanded(name);
}

// Whether the last heartbeat of that name is of the process that runs now.
bool Mission::isHeard(const std::string& name) const {
  const auto heard = watch_.nodes().find(name);
  return heard != watch_.nodes().end() && heard->second.pid == children_.pidOf(name);
}

// Processes that were started again and not heard since.
std::vector<std::string> Mission::notBack() const {
  std::vector<std::string> names;
  for (const std::string& name : restarted_) {
    if (!isHeard(name) && !may_end_.contains(name))
      names.push_back(name + " was not heard since it came back");
  }
  return names;
}

// A process that crashed (a fragment on the network can crash liblcm) comes back from what it kept.
bool Mission::comesBack(const Ended& ended) {
  const auto robot = world::parseRobotId(ended.name);
  if (!ended.crashed() || may_end_.contains(ended.name) || (!robot && ended.name != "OPERATOR")) return false;
  if (++crashes_[ended.name] > kMaxCrashes) return false;
  spdlog::warn("{} {}", ended.name, ended.how());
  if (robot) {
    restart(*robot, watch_.lastSentAt(ended.name), "from its checkpoint");
  } else {
    Command again = operatorCommand(options_);
    again.goes_on = true;
    children_.start(again);
    restarted_.insert(ended.name);
  }
  return true;
}

void Mission::checkEnded(const Ended& ended) {
  if (crashing_.erase(ended.name) > 0 || comesBack(ended)) return;
  if (may_end_.contains(ended.name) && ended.inGoodOrder()) return;
  std::string message = ended.name + " " + ended.how() + (may_end_.contains(ended.name) ? "" : " too early");
  const auto lines = lastLines(ended.log, 10);
  message += lines.empty() ? "; " + ended.log + " is empty" : "; the end of " + ended.log + ":";
  for (const std::string& line : lines) message += "\n  " + line;
  throw Failed(message);
}

template <typename Done>
bool Mission::turnUntil(Clock::duration limit, Done&& done) {
  const auto deadline = Clock::now() + limit;
  while (!done()) {
    if (Clock::now() >= deadline) return false;
    turn();
  }
  return true;
}

void Mission::refuseOtherMissions() {
  turnUntil(kListenFirst, [] { return false; });
  if (!watch_.nodes().empty()) {
    throw Failed("mission " + std::to_string(options_.mission) + " is heard already on " + options_.lcm_url);
  }
}

void Mission::startAll() {
  if (options_.record) {
    children_.start(loggerCommand(options_));
    if (!turnUntil(kStarting, [this] { return fs::exists(recordingPath(options_)); })) {
      throw Failed("lcm-logger did not begin " + recordingPath(options_));
    }
  }
  // What is said before OPERATOR listens is said again later; waiting only saves time.
  children_.start(operatorCommand(options_));
  turnUntil(kStarting, [this] { return fs::exists(operatorStateDir(options_) + "/node.sock"); });
  for (int robot = 0; robot < options_.num_robots; ++robot) children_.start(robotCommand(options_, robot));
  if (options_.single) {
    fs::create_directories(options_.out + "/single");
    children_.start(singleCommand(options_));
  }
}

// Until the team has landed and agrees, or nothing has changed for too long. Returns what lacks then.
std::vector<std::string> Mission::settle() {
  doing_ = "flying";
  const auto limit =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options_.settle_timeout_s));
  uint64_t progress = 0;
  auto changed = Clock::now();
  while (true) {
    turn();
    if (!plan_.empty()) changed = Clock::now();  // something is to come
    const bool landed = watch_.allLanded() && plan_.empty() && notBack().empty();
    if (landed) doing_ = "landed; the nodes come to agree";
    if (watch_.progress() != progress) {
      progress = watch_.progress();
      changed = Clock::now();
      if (landed && watch_.lacking().empty()) return {};
    }
    if (Clock::now() - changed < limit) continue;
    if (const auto unheard = watch_.unheard(); !unheard.empty()) {
      throw Failed("nothing was heard from " + joined(unheard) + " on " + options_.lcm_url + " for " +
                   std::to_string(static_cast<int>(options_.settle_timeout_s)) + " s");
    }
    if (landed) return watch_.lacking();
    if (const auto dead = notBack(); !dead.empty()) return dead;
  }
}

// Asks for what the recording lacks, within a node's budget.
void Mission::askForRecording() {
  const size_t most =
      options_.budget == 0 ? 1000 : std::clamp<size_t>(static_cast<size_t>(options_.budget) / 2, 100, 1000);
  for (comms::Packet& packet :
       requestsForRecording(recordingPath(options_), options_.mission, watch_.nodes(), most)) {
    const double pause_s = options_.budget == 0
                               ? 0.1
                               : std::max(1.1, 1.1 * static_cast<double>(comms::wireSize(packet)) /
                                                   static_cast<double>(options_.budget));
    const bool passed = turnUntil(kLogCheck, [&] { return watch_.missionTime() > asked_at_s_ + pause_s; });
    if (!passed) return;  // mission time stands still: somebody else will be missed first
    asked_at_s_ = watch_.missionTime();
    wire::stampTime(packet.bytes, {std::llround(asked_at_s_ * 1e6)});
    bus_.publish(packet);
  }
}

// Until the recording alone adds up to the state: what it missed, whoever holds it says again.
std::vector<std::string> Mission::settleRecording() {
  doing_ = "landed; the recording is checked";
  const auto deadline = Clock::now() + std::chrono::duration<double>(options_.settle_timeout_s);
  while (true) {
    turnUntil(kLoggerFlush, [] { return false; });
    const auto lacking = lackingInLog(recordingPath(options_), options_.mission, watch_.stateDigest(),
                                      watch_.nodes(), options_.key);
    if (lacking.empty() || Clock::now() >= deadline) return lacking;
    askForRecording();
    turnUntil(kLogCheck, [] { return false; });
  }
}

void Mission::stop(const std::vector<std::string>& names, int signal, const char* doing) {
  doing_ = doing;
  for (const std::string& name : names) {
    may_end_.insert(name);
    children_.signal(name, signal);
  }
  const auto gone = [&] {
    return std::ranges::none_of(names, [this](const std::string& name) { return children_.isRunning(name); });
  };
  if (!turnUntil(kWriting, gone)) {
    throw Failed("did not end within " + std::to_string(kWriting.count()) + " s: " + joined(names));
  }
}

void Mission::stopTeam() {
  std::vector<std::string> robots;
  for (int robot = 0; robot < options_.num_robots; ++robot) {
    robots.push_back(world::name(world::RobotId{robot}));
  }
  stop(robots, SIGTERM, "the robots write their files");
  stop({"OPERATOR"}, SIGTERM, "the map is written");
}

// It is off the link, so its log says how far it is: "...: 420 of 720 observations".
std::string Mission::singleProgress() const {
  const auto lines = lastLines(options_.out + "/logs/single.log", 1);
  const size_t said = lines.empty() ? std::string::npos : lines[0].find("single: ");
  return said == std::string::npos ? "" : ": " + lines[0].substr(said + 8);
}

void Mission::stopLogger() {
  turnUntil(kLoggerFlush, [] { return false; });
  may_end_.insert("logger");
  stop({"logger"}, SIGINT, "the recording is closed");
}

int Mission::run(bool url_was_given) {
  try {
    if (url_was_given) refuseOtherMissions();
    prepareFolder(options_);
    started_ = Clock::now();
    startAll();
    std::vector<std::string> lacking = settle();
    RunInfo run;
    run.options = options_;
    run.converged = lacking.empty();
    run.converged_s = watch_.missionTime();
    run.state_digest = watch_.stateDigest();
    run.map_digest = watch_.mapDigest();
    if (lacking.empty() && options_.record) lacking = settleRecording();
    stopTeam();
    if (options_.record) stopLogger();
    turnUntil(Clock::duration::max() / 4, [this] {
      doing_ = "waiting for the robot that flies alone" + singleProgress();
      return !children_.isRunning("single");
    });
    block_.clear();
    run.last_heartbeats = watch_.nodes();
    run.nodes = watch_.statuses();
    run.worst_window = watch_.worstWindow();
    std::fputs(finishRun(run).c_str(), stdout);
    mapping::writeFileAtomically(options_.out + "/summary.html", summaryHtml(readSummaryOf(options_.out)));
    std::printf("map: %s/global_map.png; all on a page: %s/summary.html\n", options_.out.c_str(),
                options_.out.c_str());
    if (lacking.empty()) return 0;
    spdlog::error("{} within {} s: {}",
                  run.converged ? "the recording is not whole" : "the nodes do not agree",
                  options_.settle_timeout_s, joined(lacking));
    return 1;
  } catch (const Interrupted& interrupted) {
    block_.clear();
    spdlog::warn("stopped by signal {}; what was written so far is in {}", interrupted.signal, options_.out);
    children_.stopAll(kPatience);
    return 128 + interrupted.signal;
  } catch (const Failed& failed) {
    block_.clear();
    spdlog::error("{}", failed.what());
    children_.stopAll(kPatience);
    return 1;
  }
}

}  // namespace

int launch(LaunchOptions options) {
  check(options);
  options = completed(std::move(options));
  options.out = fs::absolute(options.out).lexically_normal();
  refuseOldMission(options);
  if (options.mission == 0) options.mission = newMissionId();
  const bool url_was_given = !options.lcm_url.empty();
  if (!url_was_given) options.lcm_url = comms::chooseFreeUrl(static_cast<uint64_t>(options.mission));
  if (const auto advice = comms::receiveBufferAdvice()) {
    spdlog::warn("the kernel's receive buffers are small, datagrams may be lost; this helps: {}", *advice);
  }
  std::vector<KillStep> plan;
  if (!options.kill_plan.empty()) plan = readKillPlan(options.kill_plan, options.num_robots);
  const double carried = comms::readLink(options.link).rate_bytes_per_s;
  if (options.budget > 0 && options.budget < kThinBudget) {
    spdlog::warn(
        "{} bytes per second carry a heartbeat in {} s and little else: the mission takes hours to settle",
        options.budget, kHeartbeatBytes * 10 / options.budget);
  }
  if (carried > 0 && (options.budget == 0 || static_cast<double>(options.budget) > carried)) {
    spdlog::warn("a link of {} carries {} bytes per second and loses what is above; --budget {:.0f} fits it",
                 options.link, carried, std::floor(carried));
  }
  catchStopSignals();
  spdlog::info("mission {}: {} robots over {} on {}, link {}, files in {}", options.mission,
               options.num_robots, options.world, options.lcm_url, options.link, options.out);
  return Mission(options, std::move(plan)).run(url_was_given);
}

}  // namespace shoal::console
