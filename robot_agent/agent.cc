// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/agent.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "fusion_node/picture_files.h"
#include "fusion_node/process.h"
#include "robot_agent/roll_call.h"
#include "shoal/comms/channels.h"
#include "shoal/cpu_time.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/belief_files.h"
#include "shoal/mapping/held_pictures.h"
#include "shoal/mapping/map_files.h"
#include "shoal/robot/team_topics.h"
#include "shoal/wire/piece_codec.h"
#include "shoal/wire/repair_codec.h"

namespace shoal::robot_agent {
namespace {

using fusion_node::stopRequested;

constexpr int64_t kSecondUs = 1'000'000;
constexpr int kAwaitMs = 20;  // between two looks at a live source
// As fast as possible still leaves the others time to listen: wall time for a mission second after landing.
constexpr auto kBusySecond = std::chrono::milliseconds(40);    // new content waits
constexpr auto kIdleSecond = std::chrono::milliseconds(120);   // somebody may still lack something
constexpr auto kHeardSecond = std::chrono::milliseconds(300);  // nobody does

comms::TrafficClass trafficOf(mapping::PieceKind kind) {
  switch (kind) {
    case mapping::PieceKind::kSettings:
    case mapping::PieceKind::kTopic:
      return comms::TrafficClass::kTopics;
    case mapping::PieceKind::kBrick:
      return comms::TrafficClass::kBricks;
    case mapping::PieceKind::kPicture:
      return comms::TrafficClass::kPictures;
    case mapping::PieceKind::kEdit:
      return comms::TrafficClass::kMatches;
    case mapping::PieceKind::kCertainty:
      break;
  }
  return comms::TrafficClass::kCertainty;
}

// Bytes of a piece's datagram that are no content: headers, channel, fixed fields.
constexpr size_t kPieceOverheadBytes = 110;
constexpr size_t kSmallDatagramBytes = 400;

// Topics change with every image, bricks with every image that shows them, and both are dear to encode and to
// send: each is told in one of so many images, and at the end. Counts, so that what is said does not depend
// on how fast the robot flew, and in turns, so that no image takes long.
constexpr size_t kTurns = 5;

// Bricks of labels or certainties told with an image in flight, so that it takes no longer on large maps: in
// all turns all of what a robot of a team usually holds. What has changed without being seen waits, at last
// for the end.
constexpr size_t kMostBricks = 128 / kTurns;

// Cells looked at for what has changed, beside those of the bricks seen: the same, and all of a usual map.
constexpr size_t kMostCells = 16384 / kTurns;

// A multiple of that. What was flown since the last checkpoint is flown again after a crash, with the same
// result; a live source cannot be, so then every word that is said stands in a checkpoint first.
constexpr size_t kSaveEvery = 25;

// Pieces that others want made, between two publications.
constexpr size_t kMostWanted = 256;

std::string queueKey(const mapping::PieceKey& key, int32_t part) {
  std::string text = std::to_string(static_cast<int>(key.kind));
  for (const int32_t i : key.index) text += '/' + std::to_string(i);
  return text + '/' + std::to_string(part);
}

// Bytes of a message on a channel that carry most under a thin budget: comms/budget.h. Under the thinnest a
// full datagram would wait for half a minute: then the sooner is worth more than a tenth of the bytes, see
// docs/benchmarks.md.
size_t mostBytes(const std::string& channel, int64_t budget, size_t trailer) {
  size_t best = comms::efficientDatagram(budget, kPieceOverheadBytes);
  if (budget > 0) best = std::min(best, std::max(kSmallDatagramBytes, static_cast<size_t>(8 * budget)));
  const size_t most = std::min(wire::maxPayload(channel.size()), wire::kMaxRepairableBytes);
  return std::min(most, best - comms::wireSize(channel.size(), trailer));
}

int64_t wallMs() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

double wallSeconds() { return static_cast<double>(wallMs()) * 1e-3; }

int64_t wallUs() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

void writeOut(const std::string& folder, const mapping::LocalBelief& belief, double cell_size_m,
              const std::vector<mapping::StampedPose>& path) {
  mapping::writeBelief(folder, belief, world::Grid(cell_size_m));
  mapping::writeFileAtomically(folder + "/poses.txt", mapping::posesTxt(path));
}

}  // namespace

Agent::Agent(const AgentOptions& options, world::ObservationSource& source, comms::Bus& bus)
    : options_(options),
      name_(name(options.explorer.robot)),
      source_(source),
      bus_(bus),
      explorer_(options.explorer),
      belief_{.robot = options.explorer.robot, .version = {}, .groups = {}, .topics = {}, .cells = {}},
      others_(options.mission, options.matcher),
      clock_(options.rate, options.start_us),
      sender_(bus, nullptr,
              [&] {
                comms::SenderOptions sender;
                sender.bytes_per_s = options.budget;
                // A third more of the map by landing than the other way round: docs/benchmarks.md.
                sender.queue.topics_weight = 4;
                sender.queue.bricks_weight = 8;
                sender.stamp = [](comms::Packet& packet, int64_t now_us) {
                  wire::stampTime(packet.bytes, {now_us});
                };
                sender.join = [this](std::span<const comms::SendQueue::Next> together) {
                  return join(together);
                };
                sender.most_joined_bytes =
                    mostBytes(comms::channelName(name_, wire::channelKind(wire::MessageKind::kCertainty)),
                              options.budget, bus.trailerBytes());
                if (options.start_us > 0) sender.resumed_at_us = options.start_us;
                sender.make_heartbeat = [this](int64_t now_us) { return heartbeat(now_us); };
                return sender;
              }()),
      repair_({name_, options.mission, options.budget, number(options.explorer.robot), options.fuse,
               [this](const mapping::Piece& piece) {
                 return piece.key.robot == options_.explorer.robot &&
                        sender_.queue().isWaiting(queueKey(piece.key, piece.part));
               },
               [this](uint64_t key) {
                 if (wanted_.size() < kMostWanted) wanted_.insert(key);
               }},
              others_, sender_),
      silence_(options.budget, wallMs()) {
  bus_.countInto(sender_.stats());
  if (options.resume) resume();
  const mapping::Piece settings =
      mapping::pieceOf(options.explorer.robot, options.explorer.epoch, explorer_.settings());
  if (own_.find(settings.key, 0) == nullptr) say(settings);
}

void Agent::run() {
  fly();
  if (!stopRequested()) awaitTeam();
  if (!stopRequested()) lookAgain();
  write();
  if (!stopRequested()) linger();
  while (isHolding() || saving_.isRunning()) lookAtSave(true);
  if (options_.fuse) write();  // with the map as it ended
  phase_ = wire::Phase::kLeaving;
  passTimeUntil(sender_.heartbeatDue());  // or it would seem lost
  sender_.pump(clock_.now());
  for (const auto& [reason, count] : sender_.stats().rejected)
    spdlog::warn("refused {} messages: {}", count, reason);
}

void Agent::fly() {
  if (!options_.resume) {  // nothing is said before
    save();
    lookAtSave(true);
  }
  int32_t skipped = 0;
  while (!stopRequested()) {
    awaitObservation();
    if (stopRequested()) break;
    auto observation = source_.next();
    if (!observation) break;
    const int32_t last = explorer_.lastObservation();
    if (options_.live) {  // a later life: its numbers and its time go on
      if (path_.empty() || observation->number > last) {
        observation->number += skipped;
      } else {
        skipped = last + 1 - observation->number;
        observation->number = last + 1;
      }
      if (skipped > 0) observation->time.us += options_.start_us;
    } else if (observation->number <= last) {
      continue;  // learnt from in an earlier life
    }
    // What an earlier life had reached is caught up with at once.
    passTimeUntil((options_.resume ? 0 : options_.start_us) + observation->time.us);
    takeIn(*observation);
    passTimeUntil(clock_.now());
  }
  publishAll();
  awaitSaved();
  save();
  awaitSaved();  // who has landed has said all it has, if only to its queue
  if (stopRequested()) return;
  phase_ = willLookAgain() ? wire::Phase::kListening : wire::Phase::kLanded;
  spdlog::info("landed after {} observations: {} topics, {} cells, {:.1f} ms each", path_.size(),
               belief_.topics.size(), belief_.cells.size(),
               path_.empty() ? 0.0 : total_ms_ / static_cast<double>(path_.size()));
}

// Tells what is still to be told, and hears what others had to tell when they had landed.
void Agent::awaitTeam() {
  if (!willLookAgain()) return;
  RollCall roll_call(options_.explorer.robot, options_.team_size, wallSeconds());
  repair_.wantAll(true);
  for (bool said = false; !stopRequested(); said = true) {
    roll_call.look(others_, wallSeconds());
    const std::vector<std::string> missing = roll_call.missing(wallSeconds());
    if (missing.empty()) break;
    if (!said)
      spdlog::info("waits for {}, to look again at its map with what they know", fmt::join(missing, ", "));
    passSecond();
  }
  repair_.wantAll(false);
  for (const std::string& robot : roll_call.silent(wallSeconds()))
    spdlog::warn("waits no more for {}, which is silent", robot);
}

void Agent::lookAgain() {
  if (willLookAgain()) {
    const double start_ms = threadCpuMs();
    const auto team = robot::teamTopics(others_.beliefs(), options_.explorer.robot, options_.matcher);
    if (!team.others.empty()) {
      explorer_.lookAgain(team, [this] { breathe(); });
      publishAll();
      awaitSaved();
      save();
      awaitSaved();
      spdlog::info("looked again with {} topics of others, {:.1f} ms", team.others.size(),
                   threadCpuMs() - start_ms);
    }
  }
  phase_ = wire::Phase::kLanded;
}

// Sends and listens meanwhile. Mission time as fast as possible does not pass: only observations move it.
void Agent::awaitObservation() {
  while (!stopRequested() && !source_.ready()) {
    const int64_t now = clock_.now();
    lookAtSave(false);
    repair_.pump(now);
    sender_.pump(now);
    listen(kAwaitMs);
  }
}

void Agent::takeIn(const world::Observation& observation) {
  const auto start = std::chrono::steady_clock::now();
  explorer_.observe(observation);
  const double learnt_ms = threadCpuMs();
  belief_ = explorer_.outline();
  path_.push_back({observation.time, observation.world_from_camera});
  ImageTimes times{.stages = explorer_.lastTimes(), .num_cells = explorer_.numCells()};
  times.stages.belief_ms += threadCpuMs() - learnt_ms;
  const double believed_ms = threadCpuMs();
  if (path_.size() >= kTurns) publish();  // what it makes of the first images will not last
  if (path_.size() % kTurns == 0) {
    publishPictures();
    sharpenWanted();
  }
  const double published_ms = threadCpuMs();
  times.publish_ms = published_ms - believed_ms;
  if (path_.size() % (options_.live ? kTurns : kSaveEvery) == 0) save();
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

// Offers what is found to have changed and has its turn.
void Agent::publish() {
  const mapping::BeliefChanges::Turn turn{static_cast<int32_t>(path_.size() % kTurns), int32_t{kTurns}};
  publish(changes_.update(belief_, explorer_, explorer_.takeSeenBricks(), kMostBricks, kMostCells, turn));
}

// Offers all that has changed. Takes longer the larger the map is.
void Agent::publishAll() {
  if (path_.empty()) return;
  belief_ = explorer_.belief();
  explorer_.takeSeenBricks();
  publish(changes_.update(belief_));
  publishPictures();
}

void Agent::publish(const std::vector<mapping::Piece>& changed) {
  for (const mapping::Piece& whole : changed) {
    const std::string channel = comms::channelName(name_, wire::channelKind(wire::kindOf(whole)));
    const size_t most = mostBytes(channel, options_.budget, bus_.trailerBytes());
    auto parts = wire::encodeToFit(whole, most, options_.mission);
    for (wire::EncodedPart& each : parts) sayWhenSaved(each.part, std::move(each.message));
    int32_t& offered = num_parts_[whole.key];
    for (auto stale = static_cast<int32_t>(parts.size()); stale < offered; ++stale)
      forget(queueKey(whole.key, stale));
    offered = static_cast<int32_t>(parts.size());
  }
}

void Agent::publishPictures() {
  for (const mapping::Piece& layer : picture_changes_.update(belief_)) {
    sayWhenSaved(layer, wire::encode(layer, options_.mission, {}));
    for (int32_t stale = layer.num_parts; stale < wire::kMaxPictureLayers; ++stale)
      forget(queueKey(layer.key, stale));
  }
}

void Agent::forget(const std::string& key) {
  sender_.forget(key);
  said_.erase(key);
  unsaid_.erase(key);
}

void Agent::say(const mapping::Piece& part) { say(part, wire::encode(part, options_.mission, {})); }

void Agent::say(const mapping::Piece& part, wire::Bytes message) {
  own_.apply(part);
  others_.apply(part);
  offer(part, std::move(message));
}

// What a live source has shown it will not show again, and others may be silent the next time: then after a
// crash the robot would say other things.
void Agent::sayWhenSaved(const mapping::Piece& part, wire::Bytes message) {
  const bool can_say_it_again = !options_.live && !explorer_.hasLookedAgain();
  if (can_say_it_again || options_.checkpoint_dir.empty()) return say(part, std::move(message));
  unsaid_.insert_or_assign(queueKey(part.key, part.part), wire::EncodedPart{part, std::move(message)});
}

// Topics and bricks that wait share datagrams.
std::optional<comms::Packet> Agent::join(std::span<const comms::SendQueue::Next> together) const {
  std::vector<const mapping::Piece*> pieces;
  for (const comms::SendQueue::Next& each : together) {
    const auto said = said_.find(each.key);
    if (said == said_.end()) return std::nullopt;  // a request or a repair
    pieces.push_back(&said->second);
  }
  auto bytes = wire::encodeTogether(pieces, options_.mission);
  if (!bytes) return std::nullopt;
  return comms::Packet{together.front().packet->channel, std::move(*bytes)};
}

void Agent::offer(const mapping::Piece& part, wire::Bytes message) {
  const std::string key = queueKey(part.key, part.part);
  sender_.offer(trafficOf(part.key.kind), key,
                {comms::channelName(name_, wire::channelKind(wire::kindOf(part))), std::move(message)});
  said_.insert_or_assign(key, part);
}

// Sharper pictures are the only thing that is made because somebody wants it, so they are said when a
// checkpoint has them.
void Agent::sharpenWanted() {
  for (const mapping::ExamplePicture& example : belief_.examples) {
    const mapping::PieceKey shown = {
        options_.explorer.robot, mapping::PieceKind::kPicture, {number(example.topic), example.number, 0}};
    mapping::PieceKey sharper = shown;
    sharper.index[1] += mapping::kSharperBy;
    if (!wanted_.contains(fusion_node::nameOf(sharper, 0).second) &&
        !wanted_.contains(fusion_node::nameOf(sharper, 1).second)) {
      continue;
    }
    const world::Version version{options_.explorer.epoch, example.observation};
    const auto isSaid = [&](const mapping::PieceKey& key) {
      const mapping::Piece* said = own_.find(key, 0);
      return said != nullptr && said->version == version;
    };
    if (!isSaid(shown) || isSaid(sharper)) continue;
    for (const mapping::Piece& layer : wire::sharperPieces(example, sharper.robot, version.epoch)) {
      wire::Bytes message = wire::encode(layer, options_.mission, {});
      if (options_.checkpoint_dir.empty()) {
        say(layer, std::move(message));
      } else {
        unsaid_.insert_or_assign(queueKey(layer.key, layer.part),
                                 wire::EncodedPart{layer, std::move(message)});
      }
    }
    spdlog::info("was asked for a sharper picture of topic {}", number(example.topic));
  }
  wanted_.clear();
}

// As if there had been no crash: what was learnt, what was said, what was still to be said.
void Agent::resume() {
  const Checkpoint& c = *options_.resume;
  explorer_.restore(c.explorer);
  path_ = c.path;
  if (!path_.empty()) {
    belief_ = explorer_.belief();
    changes_.restore(belief_, c.untold, c.looked_until, c.seen);
  }
  for (const Checkpoint::Said& said : c.said) {
    own_.apply(said.piece);
    others_.apply(said.piece);
    num_parts_[said.piece.key] = said.piece.num_parts;
    if (said.waits) offer(said.piece, wire::encode(said.piece, options_.mission, {}));
  }
  spdlog::info("goes on from a checkpoint after {} observations, at {:.1f} s", path_.size(),
               static_cast<double>(options_.start_us) * 1e-6);
}

// Begins to save, unless the last time is not done yet. Between images only.
void Agent::save() {
  if (options_.checkpoint_dir.empty() || saving_.isRunning()) return;
  const std::string path = checkpointPath(options_.checkpoint_dir, options_.explorer.robot);
  saving_.begin([&] {
    writeCheckpoint(path, snapshot());
    // Not before there is a checkpoint, and nothing has been said yet: who is killed in between has not
    // begun.
    if (!epoch_is_kept_) {
      mapping::writeFileAtomically(epochPath(options_.checkpoint_dir, options_.explorer.robot),
                                   std::to_string(options_.explorer.epoch) + "\n");
    }
  });
  epoch_is_kept_ = true;
  being_saved_ = std::exchange(unsaid_, {});
  lookAtSave(false);
}

// Says what a checkpoint has by now, and begins another for what waits for one.
void Agent::lookAtSave(bool waits) {
  if (waits) {
    saving_.wait();
  } else if (saving_.look()) {
    return;
  }
  for (auto& [key, each] : std::exchange(being_saved_, {})) say(each.part, std::move(each.message));
  const bool counts_images = options_.live && phase_ == wire::Phase::kFlying && !stopRequested();
  if (!unsaid_.empty() && !counts_images) save();
}

// Until no checkpoint is being written any more.
void Agent::awaitSaved() {
  while (saving_.isRunning()) {
    breathe();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    lookAtSave(false);
  }
}

Checkpoint Agent::snapshot() {
  Checkpoint c{.mission = options_.mission,
               .robot = options_.explorer.robot,
               .epoch = options_.explorer.epoch,
               .mission_us = clock_.now(),
               .wall_us = wallUs(),
               .explorer = explorer_.checkpoint(),
               .said = {},
               .untold = changes_.waiting(belief_, explorer_),
               .looked_until = changes_.lookedUntil(),
               .seen = changes_.seen(),
               .path = path_};
  own_.visit([&](const mapping::Piece& piece) {
    const std::string key = queueKey(piece.key, piece.part);
    const comms::Packet* held = sender_.queue().held(key);
    c.said.push_back({piece, sender_.queue().isWaiting(key), held ? held->bytes : wire::Bytes{}});
  });
  // What is said when this is written. Newer than the same above.
  for (const auto& [key, each] : unsaid_) c.said.push_back({each.part, true, each.message});
  return c;
}

// Sends what the budget allows and listens, until mission time `to_us`.
void Agent::passTimeUntil(int64_t to_us) {
  while (!stopRequested()) {
    const int64_t now = clock_.now();
    lookAtSave(false);
    const int64_t repair_due = repair_.pump(now);
    const int64_t next = std::min({sender_.pump(now), repair_due, to_us});
    const auto wait_ms = static_cast<int>(std::min<int64_t>(clock_.wallUntil(next) / 1000, 50));
    listen(wait_ms);
    if (now >= to_us) return;
    if (options_.rate == 0) clock_.advanceTo(next);
  }
}

void Agent::listen(int timeout_ms) {
  const std::string own = "SHOAL_" + name_ + "_";
  bus_.receive(timeout_ms, [&](const comms::Packet& packet) {
    if (!packet.channel.starts_with(own)) silence_.heard(wallMs());
    others_.hear(packet, sender_.stats());
    repair_.hear(packet, clock_.now());
  });
  if (phase_ != wire::Phase::kFlying) sharpenWanted();
  if (const auto warning = silence_.check(wallMs())) spdlog::warn("{}", *warning);
  if (options_.fuse && phase_ != wire::Phase::kFlying) others_.refresh();
  for (; warned_of_missions_ < others_.otherMissions().size(); ++warned_of_missions_) {
    spdlog::warn("another mission is heard on this URL; ours is {}", options_.mission);
  }
  const auto twin = others_.heartbeats().find(name_);
  if (!warned_of_twin_ && twin != others_.heartbeats().end() &&
      (twin->second.pid != ::getpid() || twin->second.host != fusion_node::hostHash())) {
    spdlog::error("another process (pid {}) also calls itself {}", twin->second.pid, name_);
    warned_of_twin_ = true;
  }
}

// While something takes long: sends what is due and hears what has come, which changes nothing of that.
void Agent::breathe() {
  const auto now = std::chrono::steady_clock::now();
  if (options_.rate == 0 && now - breathed_ >= kIdleSecond) {
    clock_.advanceTo(clock_.now() + kSecondUs);
    breathed_ = now;
  }
  repair_.pump(clock_.now());
  sender_.pump(clock_.now());
  listen(0);
}

void Agent::linger() {
  while (!stopRequested()) {
    passSecond();
    const bool busy = sender_.queue().waitingBytes() > 0 || isHolding();
    if (options_.linger || busy || !isHeard()) continue;
    spdlog::info("a fusion node holds all that {} had to say", name_);
    return;
  }
}

// One of mission time. As fast as possible it still takes a while, so that others get to listen.
void Agent::passSecond() {
  const auto start = std::chrono::steady_clock::now();
  passTimeUntil(clock_.now() + kSecondUs);
  if (options_.rate != 0) return;
  const bool busy = sender_.queue().waitingBytes() > 0 || isHolding();
  std::this_thread::sleep_until(start + (busy ? kBusySecond : isHeard() ? kHeardSecond : kIdleSecond));
}

bool Agent::isHeard() const {
  bool heard = false;
  for (const auto& [node, heartbeat] : others_.heartbeats()) {
    const bool fuses = heartbeat.phase == wire::Phase::kNode || heartbeat.map_of_state != 0;
    if (node == name_ || !fuses || heartbeat.roster.empty()) continue;
    const auto mine =
        std::ranges::find(heartbeat.roster, options_.explorer.robot, &wire::Heartbeat::Share::robot);
    if (mine == heartbeat.roster.end() ||
        mine->digest != wire::shareDigest(own_.digestOf(options_.explorer.robot))) {
      return false;
    }
    heard = true;
  }
  return heard;
}

void Agent::write() {
  if (options_.out_dir.empty()) return;
  const std::string folder = options_.out_dir + "/robots/" + name_;
  writeOut(folder, belief_, options_.explorer.cell_size_m, path_);
  fusion_node::writeTopicPictures(folder + "/pictures", own_, options_.explorer.robot);
  if (!options_.fuse) return;
  const world::Grid grid(options_.explorer.cell_size_m);
  others_.refreshMap();
  mapping::writeFileAtomically(folder + "/global_map.csv", mapping::globalMapCsv(others_.map(), grid));
  mapping::writeFileAtomically(folder + "/labels.csv", mapping::labelsCsv(others_.map(), grid));
}

comms::Packet Agent::heartbeat(int64_t now_us) {
  uint64_t rejected = 0;
  for (const auto& [reason, count] : sender_.stats().rejected) rejected += count;
  wire::Heartbeat h;
  h.time = {now_us};
  h.mission = options_.mission;
  h.epoch = options_.explorer.epoch;
  h.phase = phase_;
  h.observation = path_.empty() ? -1 : belief_.version.observation - (explorer_.hasLookedAgain() ? 1 : 0);
  h.num_observations = source_.numObservations().value_or(0);
  h.num_topics = static_cast<int32_t>(belief_.topics.size());
  h.num_cells = explorer_.numCells();
  h.cell_size_m = options_.explorer.cell_size_m;
  h.own_digest = own_.digestOf(options_.explorer.robot);
  h.state_digest = options_.fuse ? others_.beliefs().digest() : own_.digest();
  if (options_.fuse) {
    h.map_digest = others_.mapDigest();
    h.map_of_state = others_.fused().stateDigest();
  }
  h.roster = repair_.roster(now_us);
  h.vocabulary = explorer_.fingerprint();
  h.host = fusion_node::hostHash();
  h.pid = ::getpid();
  if (!path_.empty()) {
    const Eigen::Vector3f position = path_.back().world_from_camera.translation().cast<float>();
    h.x_m = position.x();
    h.y_m = position.y();
    h.z_m = position.z();
  }
  const world::Vehicle vehicle = source_.vehicle();
  h.battery_percent = vehicle.battery_percent.value_or(-1);
  if (vehicle.depth_m) h.depth_cm = static_cast<int32_t>(std::lround(100 * *vehicle.depth_m));
  h.bytes_sent = static_cast<int64_t>(sender_.stats().linkBytes());
  h.budget = static_cast<int32_t>(options_.budget);
  h.queue_bytes = static_cast<int32_t>(std::min<int64_t>(sender_.backlog(), INT32_MAX));
  h.rejected = static_cast<int32_t>(std::min<uint64_t>(rejected, INT32_MAX));
  h.conflicts = others_.conflicts() + (warned_of_twin_ ? 1 : 0);
  h.ms_per_frame = path_.empty() ? 0.f : static_cast<float>(total_ms_ / static_cast<double>(path_.size()));
  for (size_t i = 0; i < wire::Heartbeat::kNumClasses; ++i) {
    h.class_bytes[i] = static_cast<int64_t>(sender_.stats().sent[i].bytes);
  }
  const std::string channel = comms::channelName(name_, "HEARTBEAT");
  return {channel, wire::encode(h, wire::maxPayload(channel.size()))};
}

void runAlone(const AgentOptions& options, world::ObservationSource& source) {
  robot::Explorer explorer(options.explorer);
  std::vector<mapping::StampedPose> path;
  const int32_t total = source.numObservations().value_or(0);
  while (!stopRequested()) {
    const auto observation = source.next();
    if (!observation) break;
    explorer.observe(*observation);
    path.push_back({observation->time, observation->world_from_camera});
    if (path.size() % 10 == 0) spdlog::info("{} of {} observations", path.size(), total);
  }
  const mapping::LocalBelief belief = explorer.belief();
  writeOut(options.out_dir, belief, options.explorer.cell_size_m, path);
  spdlog::info("flew {} observations alone: {} topics, {} cells", path.size(), belief.topics.size(),
               belief.cells.size());
}

}  // namespace shoal::robot_agent
