// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/node.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <utility>

#include <nlohmann/json.hpp>

#include <spdlog/spdlog.h>

#include "fusion_node/authentication.h"
#include "fusion_node/moment.h"
#include "fusion_node/picture_files.h"
#include "fusion_node/picture_question.h"
#include "fusion_node/process.h"
#include "shoal/comms/channels.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/edit_question.h"
#include "shoal/mapping/edits_answer.h"
#include "shoal/mapping/edits_file.h"
#include "shoal/mapping/judgement.h"
#include "shoal/mapping/map_files.h"
#include "shoal/mapping/questions.h"
#include "shoal/mapping/surprises.h"
#include "shoal/wire/labels_codec.h"
#include "shoal/wire/map_codec.h"
#include "shoal/wire/matches_codec.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/piece_codec.h"
#include "shoal/wire/repair_codec.h"

namespace shoal::fusion_node {
namespace {

using Json = nlohmann::ordered_json;

// Wall time between two fusions, and between two whole maps on the local bus: people look, no result waits.
constexpr int64_t kFusePeriodMs = 200;
constexpr int64_t kPublishPeriodMs = 1000;

// Of a whole map in one turn, and how long a turn may wait for something while there is more of it.
constexpr size_t kMostChunksPerTurn = 8;
constexpr int kPublishTimeoutMs = 4;

// Of a message with a piece of the library: on every node the same, so that its parts are.
constexpr size_t kMostLibraryBytes = 700;

// Robots start one after the other, and messages take their time: in seconds of wall time.
constexpr double kClockToleranceS = 60;

// Lists about the map are no part of the state, so nobody asks for them: they are repeated.
constexpr int kListRepeats = 2;

comms::SenderOptions senderOptions(int64_t budget, std::function<comms::Packet(int64_t)> make_heartbeat) {
  comms::SenderOptions options;
  options.bytes_per_s = budget;
  options.queue.max_resends = kListRepeats;
  options.make_heartbeat = std::move(make_heartbeat);
  options.stamp = [](comms::Packet& packet, int64_t now_us) { wire::stampTime(packet.bytes, {now_us}); };
  return options;
}

}  // namespace

Node::Node(const NodeOptions& options, comms::Bus& link, comms::Bus& local)
    : options_(options),
      state_(options.mission, options.matcher, options.cell_size_m),
      link_(link),
      local_(local),
      clock_(options.rate),
      sender_(link, &local,
              senderOptions(options.budget, [this](int64_t now_us) { return heartbeat(now_us); })),
      repair_({options.name, options.mission, options.budget, {}, true, {}, {}}, state_, sender_),
      silence_(options.budget, wallMs()) {
  link.countInto(sender_.stats());
  if (options.rate > 0) state_.setClockTolerance(kClockToleranceS * std::max(options.rate, 1.0));
  if (!options.state_dir.empty()) {
    recall();
    loadEdits();
  }
  enterLibrary();
  if (!options.state_dir.empty()) {
    queries_.emplace(options.state_dir, [this](const Json& question) { return answer(question); });
  }
}

int64_t Node::wallMs() const {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

void Node::turn(int timeout_ms) {
  const std::string own = "SHOAL_" + options_.name + "_";
  if (!publishing_.empty()) timeout_ms = std::min(timeout_ms, kPublishTimeoutMs);
  link_.receive(timeout_ms, [&](const comms::Packet& packet) {
    if (!packet.channel.starts_with(own)) silence_.heard(wallMs());
    hear(packet);
  });
  commit();
  state_.passTime(static_cast<double>(wallMs()) * 1e-3);
  if (const auto warning = silence_.check(wallMs())) spdlog::warn("{}", *warning);
  warnOfStrangers();
  checkLibrary();
  warnOfMixtures();
  if (options_.rate == 0) clock_.advanceTo(state_.latestTime().us);

  const int64_t wall = wallMs();
  if (state_.mapIsStale() && wall - fused_at_ms_ >= kFusePeriodMs) {
    state_.refresh();
    fused_at_ms_ = wallMs();
    const auto offer = [this](std::string_view kind, std::vector<wire::Bytes> chunks) {
      const std::string channel = comms::channelName(options_.name, kind);
      for (size_t i = 0; i < chunks.size(); ++i) {
        sender_.offer(comms::TrafficClass::kMatches, channel + "/" + std::to_string(i),
                      {channel, std::move(chunks[i])});
      }
      size_t& offered = num_chunks_[channel];
      for (size_t stale = chunks.size(); stale < offered; ++stale) {
        sender_.forget(channel + "/" + std::to_string(stale));
      }
      offered = chunks.size();
    };
    const auto limit = [this](std::string_view kind) {
      return wire::maxPayload(comms::channelName(options_.name, kind).size());
    };
    offer("MATCHES", wire::encodeMatches(state_.fused().correspondences(), state_.mapDigest(),
                                         options_.mission, world::Timestamp{}, limit("MATCHES")));
    offer("LABELS", wire::encodeLabels(state_.fused().labels(), state_.mapDigest(), options_.mission,
                                       world::Timestamp{}, limit("LABELS")));
  }
  publishMap();
  const int64_t now_us = clock_.now();
  onDisk([&] { memory_->keepClock(now_us); });
  repair_.pump(now_us);
  sender_.pump(now_us);
  if (queries_) queries_->poll();
}

void Node::hear(const comms::Packet& packet) {
  const bool is_new = state_.hear(packet, sender_.stats());
  keep(packet, is_new);
  repair_.hear(packet, clock_.now());
}

void Node::keep(const comms::Packet& packet, bool is_new) {
  onDisk([&] { memory_->keep(packet, is_new); });
}

void Node::commit() {
  onDisk([&] { memory_->commit(state_); });
}

// A disk that is full must not end the mission.
void Node::onDisk(const std::function<void()>& act) {
  if (!memory_) return;
  try {
    act();
  } catch (const std::exception& error) {
    spdlog::error("{}; from now on what is heard is kept in memory alone", error.what());
    memory_.reset();
  }
}

// Comes back with all that it had heard before it ended, however it did; its clock goes on.
void Node::recall() {
  state_.passTime(static_cast<double>(wallMs()) * 1e-3);
  memory_.emplace(options_.state_dir, options_.name, options_.mission);
  const auto clock = memory_->recall(state_);
  if (!clock) return;
  const Gap gap = passedBetween(clock->at, thisMoment());
  if (!gap.doubt.empty()) {
    spdlog::warn("what {} remembers of its clock: {}; goes on from there",
                 missionFilePath(options_.state_dir, options_.mission), gap.doubt);
  }
  const double passed_us = options_.rate * static_cast<double>(gap.us);
  clock_.advanceTo(clock->mission_us + std::llround(passed_us));
  sender_.assumeExhausted(std::max(clock_.now(), clock->spoken_until_us));
  spdlog::info("comes back with {} pieces of {} robots, at {:.1f} s", state_.beliefs().numPieces(),
               state_.beliefs().robots().size(), static_cast<double>(clock_.now()) * 1e-6);
}

std::vector<comms::Packet> Node::mapPackets() {
  const std::string channel = comms::channelName(options_.name, "MAP");
  std::vector<comms::Packet> packets;
  for (wire::Bytes& chunk :
       wire::encodeMap(state_.map(), state_.mapDigest(), options_.mission, world::Timestamp{clock_.now()},
                       wire::maxPayload(channel.size()))) {
    packets.push_back({channel, std::move(chunk)});
  }
  return packets;
}

// A few chunks a turn, without waiting. A map that was begun is told to its end, even when there is a newer
// one: who listens would never see a large map whole otherwise.
void Node::publishMap() {
  if (publishing_.empty()) {
    if (state_.mapDigest() == published_digest_ || wallMs() - published_at_ms_ < kPublishPeriodMs) return;
    std::vector<comms::Packet> packets = mapPackets();
    publishing_.assign(std::make_move_iterator(packets.begin()), std::make_move_iterator(packets.end()));
    published_digest_ = state_.mapDigest();
  }
  for (size_t said = 0; said < kMostChunksPerTurn && !publishing_.empty(); ++said) {
    if (!sender_.trySendLocal(publishing_.front())) break;
    publishing_.pop_front();
  }
  if (publishing_.empty()) published_at_ms_ = wallMs();
}

comms::Packet Node::heartbeat(int64_t now_us) {
  uint64_t rejected = 0;
  for (const auto& [reason, count] : sender_.stats().rejected) rejected += count;
  wire::Heartbeat h;
  h.time = {now_us};
  h.mission = options_.mission;
  h.phase = wire::Phase::kNode;
  h.observation = -1;
  h.num_cells = static_cast<int32_t>(std::min<int64_t>(state_.fused().numCells(), INT32_MAX));
  h.state_digest = state_.beliefs().digest();
  h.map_digest = state_.mapDigest();
  h.map_of_state = state_.fused().stateDigest();
  h.cell_size_m = state_.cellSize();
  h.host = hostHash();
  h.pid = ::getpid();
  h.bytes_sent = static_cast<int64_t>(sender_.stats().linkBytes());
  h.budget = static_cast<int32_t>(options_.budget);
  h.queue_bytes = static_cast<int32_t>(std::min<int64_t>(sender_.backlog(), INT32_MAX));
  h.rejected = static_cast<int32_t>(std::min<uint64_t>(rejected, INT32_MAX));
  h.conflicts = state_.conflicts();
  for (size_t i = 0; i < wire::Heartbeat::kNumClasses; ++i) {
    h.class_bytes[i] = static_cast<int64_t>(sender_.stats().sent[i].bytes);
  }
  h.roster = state_.roster();
  const std::string channel = comms::channelName(options_.name, "HEARTBEAT");
  return {channel, wire::encode(h, wire::maxPayload(channel.size()))};
}

void Node::loadEdits() {
  const std::string path = options_.state_dir + "/edits.json";
  try {
    for (const mapping::Edit& edit : mapping::readEdits(path, options_.mission)) {
      state_.apply(mapping::pieceOf(edit));
      offer(edit);
    }
  } catch (const std::runtime_error& error) {
    spdlog::warn("edits of before are left out: {}", error.what());
  }
}

// Known to this node at once, and said once as if somebody had asked, so that nodes that fuse and recordings
// have it. Whoever misses it asks, as for all state.
void Node::enterLibrary() {
  if (!options_.library) return;
  const std::string channel = comms::channelName(options_.name, "REPAIR");
  for (const mapping::Piece& whole : mapping::piecesOf(*options_.library)) {
    for (const mapping::Piece& part : wire::cutToFit(whole, kMostLibraryBytes)) {
      state_.apply(part);
      const auto name = nameOf(part.key, part.part);
      sender_.offer(comms::TrafficClass::kRepairs,
                    "library/" + std::to_string(name.first) + "/" + std::to_string(name.second),
                    {channel, wire::encodeRepair(part, options_.mission, {})});
    }
  }
  spdlog::info("library of {} names, digest {}", options_.library->topics.size(),
               mapping::digestText(mapping::digestOf(*options_.library)));
}

// Two libraries in one mission: all nodes go by the same one, and whose is not followed says so.
void Node::checkLibrary() {
  if (!options_.library || warned_of_library_) return;
  if (state_.beliefs().epochOf(mapping::kLibrary) == mapping::epochOf(*options_.library)) return;
  warned_of_library_ = true;
  spdlog::error("another node has another library, which counts for all; give every node the same file");
}

Json Node::libraryStatus() const {
  const mapping::Library held = mapping::libraryIn(state_.beliefs());
  const bool is_other =
      options_.library && state_.beliefs().epochOf(mapping::kLibrary) != mapping::epochOf(*options_.library);
  return {
      {"names", held.topics.size()},
      {"digest", mapping::digestText(mapping::digestOf(held))},
      {"given", options_.library ? Json(mapping::digestText(mapping::digestOf(*options_.library))) : Json()},
      {"differs", is_other}};
}

// Said again and again, as all pieces are.
void Node::offer(const mapping::Edit& edit) {
  const mapping::Piece piece = mapping::pieceOf(edit);
  const auto& index = piece.key.index;
  sender_.offer(
      comms::TrafficClass::kMatches,
      "EDIT/" + mapping::toText(edit.id) + "/" + std::to_string(index[1]) + "/" + std::to_string(index[2]),
      {comms::channelName(options_.name, "EDIT"), wire::encode(piece, options_.mission, world::Timestamp{})});
}

Json Node::answerEdit(const Json& question) {
  try {
    const world::Timestamp now{std::max(clock_.now(), state_.latestTime().us)};
    const mapping::Edit edit =
        mapping::makeEdit(state_.refreshMap(), state_.beliefs(), question, options_.name, now);
    std::vector<mapping::Edit> all = mapping::editsOf(state_.beliefs());
    all.push_back(edit);
    mapping::writeFileAtomically(options_.state_dir + "/edits.json",
                                 mapping::editsJson(options_.mission, all));
    if (state_.apply(mapping::pieceOf(edit)) == mapping::Applied::kRejected) {
      return {{"error", "too many edits are held already"}};
    }
    const mapping::Piece piece = mapping::pieceOf(edit);
    keep({comms::channelName(options_.name, "EDIT"), wire::encode(piece, options_.mission, now)}, true);
    commit();
    offer(edit);
    spdlog::info("{}: {}", mapping::toText(edit.id), mapping::sentenceOf(edit));
    return mapping::editAnswer(edit, state_.beliefs());
  } catch (const std::exception& error) {  // a peer's text, or a disk that is full
    return {{"error", error.what()}};
  }
}

Json Node::answer(const Json& question) {
  if (mapping::isEdit(question)) return answerEdit(question);
  state_.refresh();
  const std::string query = question.value("query", "");
  if (query == "ask") return answerAsk(question);
  if (query == "status") return answerStatus();
  if (query == "map" && question.contains("has")) return answerChanges(question);
  if (query == "matching") {
    const matching::MatcherOptions& m = state_.matcher();
    return {
        {"matcher", m.matcher}, {"similarity", m.similarity}, {"sigma", m.sigma ? Json(*m.sigma) : Json()}};
  }
  const bool needs_no_cells = query == "pictures" || query == "events";
  const mapping::MissionView known = needs_no_cells ? overview() : view();
  const auto beliefs = [this]() -> const mapping::BeliefStore& { return state_.beliefs(); };
  return mapping::answer({known, beliefs, state_.matcher(), [this] { return state_.events(); }}, question);
}

// Asked several times a second: no cell is looked at.
Json Node::answerStatus() const {
  Json answer = mapping::statusAnswer(overview(), state_.fused().numCells());
  answer["silent_s"] = std::round(silence_.silentSeconds(wallMs()) * 10) / 10;
  if (state_.beliefs().epochOf(mapping::kLibrary) >= 0) answer["library"] = libraryStatus();
  return answer;
}

// Likewise: only cells that have changed.
Json Node::answerChanges(const Json& question) {
  const mapping::FusedMap& fused = state_.fused();
  surprises_.update(state_.beliefs());
  std::map<mapping::BrickColumn, uint64_t> hashes = fused.columnHashes();
  for (auto& [column, hash] : hashes) hash += surprises_.hashOf(column);
  Json answer =
      map_changes_.answer({.cell_size_m = state_.cellSize(),
                           .digest = fused.digest(),
                           .labels = fused.labels(),
                           .hashes = std::move(hashes),
                           .cells_in = [&fused](const auto& columns) { return fused.cellsIn(columns); },
                           .surprises_of = [this](const auto& cells) { return surprises_.of(cells); }},
                          question);
  mapping::addLibraryNames(answer["labels"], overview().map, state_.beliefs());
  return answer;
}

// Says the price, and unless that is all, asks on the link.
Json Node::answerAsk(const Json& question) {
  try {
    const SharperPicture wanted = sharperPicture(state_, question);
    Json answer = priceOf(state_, wanted, options_.name, options_.budget);
    if (question.value("dry_run", false) || answer["state"] == "sharp") return answer;
    const auto robot = state_.heartbeats().find(name(wanted.key.robot));
    if (robot != state_.heartbeats().end() && robot->second.phase == wire::Phase::kLeaving) {
      return {{"error", robot->first + " has ended: nobody can make its pictures sharper"}};
    }
    for (const int32_t part : {0, 1}) {
      const mapping::Piece* held = state_.beliefs().find(wanted.key, part);
      if (held == nullptr || held->version < wanted.version) {
        repair_.ask(wanted.key, part, wanted.version);
      }
    }
    answer["state"] = "asked";
    return answer;
  } catch (const std::exception& error) {  // a peer's text
    return {{"error", error.what()}};
  }
}

mapping::MissionView Node::view() const {
  mapping::MissionView view = overview();
  view.map = state_.map();
  return view;
}

mapping::MissionView Node::overview() const {
  mapping::MissionView view = state_.overview();
  if (options_.authentication != nullptr) view.strangers = strangersOf(*options_.authentication);
  return view;
}

void Node::warnOfStrangers() {
  const bool has_key = options_.authentication != nullptr;
  const size_t heard = has_key ? options_.authentication->strangers().size() : state_.sealedNodes().size();
  if (heard == warned_of_strangers_) return;
  warned_of_strangers_ = heard;
  if (has_key) {
    for (const mapping::StrangerStatus& s : strangersOf(*options_.authentication))
      spdlog::warn("{} is a stranger here: it has {}", s.name, s.has);
  } else {
    spdlog::warn("{} nodes speak with a key that this one lacks: --key FILE", heard);
  }
}

// Each once; who they are of is bounded by the nodes and missions that are remembered.
void Node::warnOfMixtures() {
  if (wallMs() - looked_for_mixtures_ms_ < kPublishPeriodMs) return;
  looked_for_mixtures_ms_ = wallMs();
  for (const mapping::Mixture& mixture : state_.mixtures()) {
    const std::string& whose = mixture.kind == "mission" ? mixture.says : mixture.node;
    if (warned_of_.emplace(mixture.kind, whose).second) spdlog::warn("{}", mixture.says);
  }
}

void Node::finish() {
  for (int turns = 0; turns < 50; ++turns) {  // what already waits in the socket
    if (link_.receive(0, [this](const comms::Packet& packet) { hear(packet); }) == 0) break;
  }
  onDisk([&] { memory_->keepLast(); });
  commit();
  state_.refreshMap();
  for (const comms::Packet& packet : mapPackets()) sender_.sendLocal(packet);  // whole, whatever was begun
  for (const auto& [reason, count] : sender_.stats().rejected)
    spdlog::warn("refused {} messages: {}", count, reason);
  if (options_.out_dir.empty()) return;
  const world::Grid grid(state_.cellSize());
  mapping::writeFileAtomically(options_.out_dir + "/global_map.csv",
                               mapping::globalMapCsv(state_.map(), grid));
  mapping::writeFileAtomically(options_.out_dir + "/labels.csv", mapping::labelsCsv(state_.map(), grid));
  mapping::writeFileAtomically(
      options_.out_dir + "/surprise.csv",
      mapping::surprisesCsv(mapping::surprisesOf(state_.map(), state_.beliefs()), grid));
  if (const auto edits = mapping::editsOf(state_.beliefs()); !edits.empty()) {
    mapping::writeFileAtomically(options_.out_dir + "/edits.json",
                                 mapping::editsJson(options_.mission, edits));
  }
  if (state_.beliefs().epochOf(mapping::kLibrary) >= 0) {
    mapping::writeFileAtomically(options_.out_dir + "/library.json",
                                 mapping::libraryJson(mapping::libraryIn(state_.beliefs())));
  }
  writeLabelPictures(options_.out_dir + "/pictures",
                     mapping::picturesOfLabels(state_.map(), state_.beliefs()));
  spdlog::info("map of {} cells, {} labels written to {}", state_.map().cells.size(),
               state_.map().labels.size(), options_.out_dir);
}

}  // namespace shoal::fusion_node
