// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/agent.h"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "fusion_node/last_heartbeat.h"
#include "fusion_node/picture_files.h"
#include "fusion_node/process.h"
#include "robot_agent/later_life.h"
#include "robot_agent/robot_files.h"
#include "robot_agent/roll_call.h"
#include "shoal/cpu_time.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/map_files.h"
#include "shoal/robot/team_topics.h"
#include "shoal/wire/piece_codec.h"

namespace shoal::robot_agent {
namespace {

using fusion_node::stopRequested;

// What was flown since the last checkpoint is flown again after a crash, with the same result; a live source
// cannot be, so then every word that is said stands in a checkpoint first.
constexpr size_t kSaveEvery = 5 * Mapper::kTurns;

double wallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Agent::Agent(const AgentOptions& options, world::ObservationSource& source, comms::Bus& bus)
    : options_(options),
      source_(source),
      clock_(options.rate, options.start_us),
      state_(options.mission, options.matcher),
      mapper_(options.explorer),
      voice_({.robot = options.explorer.robot,
              .mission = options.mission,
              .budget = options.budget,
              .resumed_at_us = options.start_us > 0 ? std::optional(options.start_us) : std::nullopt,
              .make_heartbeat = [this](int64_t now_us) { return heartbeat(now_us); }},
             bus, state_),
      saver_(
          {.folder = options.checkpoint_dir,
           .robot = options.explorer.robot,
           .epoch = options.explorer.epoch,
           .counts_images = options.live},
          [this] { return snapshot(); }, voice_),
      publisher_(options.mission, saver_, voice_),
      listener_({.robot = options.explorer.robot,
                 .mission = options.mission,
                 .budget = options.budget,
                 .fuses = options.fuse,
                 .make_wanted = [this](uint64_t key) { sharper_.want(key); }},
                bus, clock_, state_, voice_),
      time_(options.rate, clock_, saver_, voice_, listener_, [this] { answer(); }) {
  if (options.resume) resume(*options.resume);
  const mapping::Piece settings =
      mapping::pieceOf(options.explorer.robot, options.explorer.epoch, mapper_.explorer().settings());
  if (voice_.said().find(settings.key, 0) == nullptr)
    voice_.say(settings, wire::encode(settings, options.mission, {}));
}

void Agent::run() {
  fly();
  if (!stopRequested()) awaitTeam();
  if (!stopRequested()) lookAgain();
  write();
  if (!stopRequested()) linger();
  saver_.finish();
  if (options_.fuse) write();  // with the map as it ended
  phase_ = wire::Phase::kLeaving;
  fusion_node::sayLastHeartbeat(voice_.sender(), clock_);
  for (const auto& [reason, count] : voice_.sender().stats().rejected)
    spdlog::warn("refused {} messages: {}", count, reason);
}

// ---------- in flight

void Agent::fly() {
  if (!options_.resume) {  // nothing is said before
    saver_.save();
    saver_.wait();
  }
  LaterLife later(options_.live, options_.has_mission_time ? 0 : options_.start_us);
  while (!stopRequested()) {
    time_.awaitObservation(source_);
    if (stopRequested()) break;
    auto observation = source_.next();
    if (!observation) break;
    if (!later.follows(mapper_.explorer().lastObservation(), *observation)) continue;
    // What a camera has seen is not to come. What an earlier life had reached is caught up with at once.
    if (options_.live && options_.rate != 0)
      clock_.advanceTo(observation->time.us);
    else
      time_.passTimeUntil((options_.resume ? 0 : options_.start_us) + observation->time.us);
    takeIn(*observation);
    time_.passTimeUntil(clock_.now());
  }
  publishAll();
  time_.awaitSaved();
  saver_.save();
  time_.awaitSaved();  // who has landed has said all it has, if only to its queue
  if (stopRequested()) return;
  saver_.landed();
  phase_ = willLookAgain() ? wire::Phase::kListening : wire::Phase::kLanded;
  const size_t images = mapper_.path().size();
  spdlog::info("landed after {} observations: {} topics, {} cells, {:.1f} ms each", images,
               mapper_.belief().topics.size(), mapper_.belief().cells.size(),
               images == 0 ? 0.0 : total_ms_ / static_cast<double>(images));
}

void Agent::takeIn(const world::Observation& observation) {
  const auto start = std::chrono::steady_clock::now();
  ImageTimes times{.stages = mapper_.learn(observation), .num_cells = mapper_.explorer().numCells()};
  const double learnt_ms = threadCpuMs();
  const size_t images = mapper_.path().size();
  if (images >= Mapper::kTurns)  // what it makes of the first images will not last
    publisher_.publish(mapper_.changesInTurn(), isRepeatable());
  if (images % Mapper::kTurns == 0) {
    publisher_.publishPictures(mapper_.changedPictures(), isRepeatable());
    sharpenWanted();
  }
  const double published_ms = threadCpuMs();
  times.publish_ms = published_ms - learnt_ms;
  if (images % (options_.live ? Mapper::kTurns : kSaveEvery) == 0) saver_.save();
  times.save_ms = threadCpuMs() - published_ms;
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  total_ms_ += took.count();
  const robot::StageTimes& t = times.stages;
  spdlog::debug(
      "observation {}: {:.1f} ms; of CPU words {:.1f}, topics {:.1f}, belief {:.1f}, pictures {:.1f}, "
      "publish "
      "{:.1f}, save {:.1f} ms",
      observation.number, took.count(), t.words_ms, t.topics_ms, t.belief_ms, t.pictures_ms, times.publish_ms,
      times.save_ms);
  if (options_.watch) options_.watch(times);
}

void Agent::publishAll() {
  publisher_.publish(mapper_.allChanges(), isRepeatable());
  publisher_.publishPictures(mapper_.changedPictures(), isRepeatable());
}

// Others may not want them the next time, so after a crash the robot would say other things.
void Agent::sharpenWanted() {
  for (const mapping::Piece& layer : sharper_.made(mapper_.belief(), voice_.said(), options_.explorer.epoch))
    saver_.say(layer, wire::encode(layer, options_.mission, {}), false);
}

// What was heard may want an answer. In flight that has time until pictures have their turn.
void Agent::answer() {
  if (phase_ == wire::Phase::kFlying) return;
  sharpenWanted();
  if (options_.fuse) state_.refresh();
}

// ---------- after landing

bool Agent::willLookAgain() const {
  const robot::Explorer& explorer = mapper_.explorer();
  return options_.looks_again && explorer.canLookAgain() && !explorer.hasLookedAgain() &&
         !mapper_.path().empty();
}

// Tells what is still to be told, and hears what others had to tell when they had landed.
void Agent::awaitTeam() {
  if (!willLookAgain()) return;
  RollCall roll_call(options_.explorer.robot, options_.team_size, wallSeconds());
  listener_.wantAll(true);
  for (bool said = false; !stopRequested(); said = true) {
    roll_call.look(state_, wallSeconds());
    const std::vector<std::string> missing = roll_call.missing(wallSeconds());
    if (missing.empty()) break;
    if (!said)
      spdlog::info("waits for {}, to look again at its map with what they know", fmt::join(missing, ", "));
    time_.passSecond();
  }
  listener_.wantAll(false);
  for (const std::string& robot : roll_call.silent(wallSeconds()))
    spdlog::warn("waits no more for {}, which is silent", robot);
}

void Agent::lookAgain() {
  if (willLookAgain()) {
    const double start_ms = threadCpuMs();
    const auto team = robot::teamTopics(state_.beliefs(), options_.explorer.robot, options_.matcher);
    if (!team.others.empty()) {
      mapper_.lookAgain(team, [this] { time_.breathe(); });
      publishAll();
      time_.awaitSaved();
      saver_.save();
      time_.awaitSaved();
      spdlog::info("looked again with {} topics of others, {:.1f} ms", team.others.size(),
                   threadCpuMs() - start_ms);
    }
  }
  phase_ = wire::Phase::kLanded;
}

void Agent::linger() {
  while (!stopRequested()) {
    time_.passSecond();
    if (options_.linger || time_.isBusy() || !listener_.isHeard()) continue;
    spdlog::info("a fusion node holds all that {} had to say", name(options_.explorer.robot));
    return;
  }
}

void Agent::write() {
  if (options_.out_dir.empty()) return;
  const std::string folder = options_.out_dir + "/robots/" + name(options_.explorer.robot);
  writeRobotFiles(folder, mapper_.belief(), options_.explorer.cell_size_m, mapper_.path());
  fusion_node::writeTopicPictures(folder + "/pictures", voice_.said(), options_.explorer.robot);
  if (!options_.fuse) return;
  const world::Grid grid(options_.explorer.cell_size_m);
  state_.refreshMap();
  mapping::writeFileAtomically(folder + "/global_map.csv", mapping::globalMapCsv(state_.map(), grid));
  mapping::writeFileAtomically(folder + "/labels.csv", mapping::labelsCsv(state_.map(), grid));
}

// ---------- what is said of all of it

// As if there had been no crash: what was learnt, what was said, what was still to be said.
void Agent::resume(const Checkpoint& checkpoint) {
  if (checkpoint.detail != options_.explorer.detail) {  // a version would have two contents
    throw std::invalid_argument(fmt::format(
        "--detail {}: the checkpoint of {} tells in detail {}; go on in that, or name another folder",
        mapping::toText(options_.explorer.detail), name(options_.explorer.robot),
        mapping::toText(checkpoint.detail)));
  }
  mapper_.restore(checkpoint);
  voice_.restore(checkpoint);
  publisher_.restore(checkpoint);
  spdlog::info("goes on from a checkpoint after {} observations, at {:.1f} s", mapper_.path().size(),
               static_cast<double>(options_.start_us) * 1e-6);
}

Checkpoint Agent::snapshot() {
  Checkpoint checkpoint{.mission = options_.mission,
                        .robot = options_.explorer.robot,
                        .epoch = options_.explorer.epoch,
                        .mission_us = clock_.now(),
                        .saved = fusion_node::thisMoment(),
                        .detail = options_.explorer.detail,
                        .explorer = {},
                        .said = {},
                        .untold = {},
                        .looked_until = {},
                        .seen = {},
                        .path = {}};
  mapper_.saveTo(checkpoint);
  voice_.saveTo(checkpoint);
  return checkpoint;
}

wire::Heartbeat Agent::heartbeat(int64_t now_us) {
  wire::Heartbeat h;
  h.time = {now_us};
  h.mission = options_.mission;
  h.epoch = options_.explorer.epoch;
  h.phase = phase_;
  h.num_observations = source_.numObservations().value_or(0);
  h.cell_size_m = options_.explorer.cell_size_m;
  h.host = fusion_node::hostHash();
  h.pid = ::getpid();
  const world::Vehicle vehicle = source_.vehicle();
  h.battery_percent = vehicle.battery_percent.value_or(-1);
  if (vehicle.depth_m) h.depth_cm = static_cast<int32_t>(std::lround(100 * *vehicle.depth_m));
  const size_t images = mapper_.path().size();
  h.ms_per_frame = images == 0 ? 0.f : static_cast<float>(total_ms_ / static_cast<double>(images));
  mapper_.report(h);
  voice_.report(h);
  listener_.report(h, now_us);
  return h;
}

}  // namespace shoal::robot_agent
