// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/serve/mission_feed.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <limits>
#include <utility>

#include <spdlog/spdlog.h>

#include "fusion_node/node_memory.h"
#include "fusion_node/query_server.h"
#include "operator_console/label_pictures.h"
#include "operator_console/message_log.h"
#include "operator_console/recorded_mission.h"
#include "operator_console/render.h"
#include "shoal/mapping/edits_file.h"
#include "shoal/mapping/questions.h"
#include "shoal/wire/heartbeat_codec.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr auto kAskEvery = std::chrono::milliseconds(50);
constexpr int kLeisure = 4;  // a map is asked for again after 4 times what it took: nodes have other work
constexpr auto kPicturesEvery = std::chrono::seconds(2);
constexpr auto kEventsEvery = std::chrono::seconds(1);
constexpr size_t kMaxMoments = 64;      // of a live mission
constexpr size_t kHistoryMoments = 32;  // of a recording, or of what a node remembers
constexpr size_t kMostMeanwhile = 100000;
constexpr double kTold = 0.5e-3;      // times are told in whole milliseconds, and asked for as they were told
constexpr size_t kMostPictures = 64;  // of a label

double timeOf(const mapping::MissionView& view) {
  double time_s = 0;
  for (const mapping::NodeStatus& node : view.nodes) time_s = std::max(time_s, node.heard_s);
  return time_s;
}

// First and last mission time of the heartbeats of a recording, or of all else: a node that remembers a
// mission keeps few heartbeats, and goes on keeping them long after it is over. 0 and 0 without any.
std::pair<double, double> spanOf(const std::string& path, const std::string& key_file, bool of_heartbeats) {
  double first = 0, last = 0;
  bool any = false;
  MessageLog log(path, key_file);
  while (const auto event = log.next()) {
    const auto header = wire::peek(event->packet.bytes);
    if (!header || (header->kind == wire::MessageKind::kHeartbeat) != of_heartbeats) continue;
    const double t = header->time.seconds();
    if (!of_heartbeats && !(t > 0)) continue;  // said again without a time
    first = any ? std::min(first, t) : t;
    last = any ? std::max(last, t) : t;
    any = true;
  }
  return {first, last};
}

// Thrown through a recording's reader when nobody wants to know any more.
struct Forgotten {};

std::string recordingOrNone(const Where& where) {
  if (!where.log.empty()) return where.log;
  const std::string beside = where.run + "/mission.lcmlog";
  return std::filesystem::exists(beside) ? beside : std::string();
}

}  // namespace

Json colored(Json answer) {
  for (Json& row : answer["labels"]) {
    const Rgb c = colorOf(world::GlobalLabel{row["label"].get<int32_t>()});
    row["color"] = fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]);
  }
  return answer;
}

MissionFeed::MissionFeed(Where where, OnChange on_change)
    : where_(std::move(where)), on_change_(std::move(on_change)), thread_([this] { run(); }) {}

MissionFeed::~MissionFeed() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
  endRemembering();
}

std::shared_ptr<const Moment> MissionFeed::now() const {
  const std::lock_guard lock(mutex_);
  return moments_.empty() ? nullptr : moments_.back();
}

std::shared_ptr<const Moment> MissionFeed::at(double time_s) const {
  const std::lock_guard lock(mutex_);
  if (moments_.empty()) return nullptr;
  const auto after =
      std::ranges::upper_bound(moments_, time_s + kTold, {}, [](const auto& m) { return m->time_s; });
  return after == moments_.begin() ? moments_.front() : *(after - 1);
}

Json MissionFeed::report() const {
  const std::lock_guard lock(mutex_);
  Json times = Json::array();
  for (const auto& moment : moments_) times.push_back(std::round(moment->time_s * 1e3) / 1e3);
  return {{"phase", phase_},
          {"problem", problem_},
          {"sequence", moments_.empty() ? 0 : moments_.back()->sequence},
          {"pictures", moments_.empty() ? 0 : moments_.back()->pictures_sequence},
          {"time_s", moments_.empty() ? 0.0 : std::round(moments_.back()->time_s * 1e3) / 1e3},
          {"times_s", std::move(times)}};
}

Json MissionFeed::chronicle(const std::string& what) const {
  const std::lock_guard lock(mutex_);
  if (what == "tracks") return chronicle_.tracks();
  if (what == "traffic") return chronicle_.traffic();
  return chronicle_.events();
}

void MissionFeed::lookAgain() {
  {
    const std::lock_guard lock(mutex_);
    stale_ = true;
  }
  wake_.notify_all();
}

void MissionFeed::setPhase(const std::string& phase, const std::string& problem) {
  {
    const std::lock_guard lock(mutex_);
    if (phase_ == phase && problem_ == problem) return;
    phase_ = phase;
    problem_ = problem;
  }
  if (!problem.empty()) spdlog::warn("{}", problem);
  on_change_();
}

// A moment that lacks tiles, status and labels.
std::shared_ptr<Moment> MissionFeed::begun(double time_s, double cell_size_m,
                                           const std::vector<mapping::GlobalCell>& cells,
                                           const Moment* before) {
  const std::lock_guard lock(mutex_);
  if (!base_s_ && !cells.empty()) {
    const auto oldest = std::ranges::min_element(cells, {}, &mapping::GlobalCell::seen);
    base_s_ = std::floor(oldest->seen.seconds());
  }
  auto moment = std::make_shared<Moment>();
  moment->sequence = ++sequence_;
  moment->chain = before != nullptr ? before->chain : moment->sequence;
  moment->time_s = time_s;
  moment->cell_size_m = cell_size_m;
  moment->base_s = base_s_.value_or(0);
  return moment;
}

namespace {

void showPictures(Moment& moment, mapping::LabelPictures pictures, const Moment* before) {
  if (before != nullptr && *before->pictures == pictures) {
    moment.pictures = before->pictures;
    moment.pictures_sequence = before->pictures_sequence;
  } else {
    moment.pictures = std::make_shared<const mapping::LabelPictures>(std::move(pictures));
    moment.pictures_sequence = moment.sequence;
  }
}

}  // namespace

std::shared_ptr<Moment> MissionFeed::momentOf(const mapping::MissionView& view,
                                              const mapping::ToldSurprises& surprises, Json labels,
                                              mapping::LabelPictures pictures, double time_s,
                                              const Moment* before) {
  auto moment = begun(time_s, view.cell_size_m, view.map.cells, before);
  moment->tiles = tilesOf(view.map, surprises.of(view.map.cells), moment->base_s, moment->sequence,
                          before != nullptr ? before->tiles : TileMap());
  moment->status = mapping::statusAnswer(view);
  moment->labels = colored(std::move(labels));
  showPictures(*moment, std::move(pictures), before);
  return moment;
}

// Of a live mission: the newest joins the others, of which the one goes that leaves the shortest gap when
// there are many, so that they stay spread over all of it.
void MissionFeed::add(std::shared_ptr<const Moment> moment) {
  const std::lock_guard lock(mutex_);
  moments_.push_back(std::move(moment));
  thinOut();
}

void MissionFeed::thinOut() {
  const auto gap = [this](size_t i) { return moments_[i + 1]->time_s - moments_[i - 1]->time_s; };
  while (moments_.size() > kMaxMoments) {
    size_t dropped = 1;
    for (size_t i = 2; i + 1 < moments_.size(); ++i)
      if (gap(i) < gap(dropped)) dropped = i;
    moments_.erase(moments_.begin() + static_cast<std::ptrdiff_t>(dropped));
  }
}

void MissionFeed::run() {
  for (;;) {
    try {
      if (!where_.node.empty()) {
        watchNode();
      } else {
        lookAtFiles();
      }
    } catch (const std::exception& error) {
      setPhase("lost", error.what());
    }
    std::unique_lock lock(mutex_);
    const auto over = [this] { return stopping_ || (stale_ && where_.node.empty()); };
    wake_.wait_for(lock, std::chrono::seconds(1), over);
    if (stopping_) return;
  }
}

// Until it is lost: throws then.
void MissionFeed::watchNode() {
  looked_at_ = pictured_ = "";
  next_map_ = next_pictures_ = next_events_ = {};
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      if (wake_.wait_for(lock, kAskEvery, [this] { return stopping_ || std::exchange(stale_, false); }) &&
          stopping_)
        return;
    }
    const Json status = fusion_node::askNode(where_.node, {{"query", "status"}});
    if (status.contains("error")) throw std::runtime_error(status.at("error").get<std::string>());
    beginMission(status.at("mission_id"));
    double time_s = 0;
    {
      const std::lock_guard lock(mutex_);
      for (const Json& row : status.at("nodes")) {
        const mapping::NodeStatus node = mapping::nodeFromJson(row);
        time_s = std::max(time_s, node.heard_s);
        chronicle_.hear(node);
        if (remembers_ && meanwhile_.size() < kMostMeanwhile) meanwhile_.push_back(node);
      }
    }
    if (Clock::now() >= next_events_) {
      const Json events = fusion_node::askNode(where_.node, {{"query", "events"}});
      next_events_ = Clock::now() + kEventsEvery;
      const std::lock_guard lock(mutex_);
      chronicle_.hearEvents(events);
      events_ = events;
    }
    lookAtNode(status, time_s);
    if (!std::exchange(knows_past_, true)) remember(fusion_node::missionFilePath(where_.node, *mission_));
  }
}

// A node may come back with another mission: nothing of the one before is its past.
void MissionFeed::beginMission(int32_t mission) {
  if (mission_ == mission) return;
  mission_ = mission;
  knows_past_ = false;
  looked_at_ = pictured_ = "";
  endRemembering();
  const std::lock_guard lock(mutex_);
  moments_.clear();
  chronicle_ = {};
  base_s_.reset();
}

void MissionFeed::endRemembering() {
  forgets_ = true;
  if (memory_.joinable()) memory_.join();
  forgets_ = false;
}

// Puts what the node heard before it was looked at before what was seen of it. Takes as long as the recording
// of a mission takes to read; nobody waits for it.
void MissionFeed::remember(const std::string& path) {
  if (!std::filesystem::exists(path)) return;
  double until_s = 0;
  {
    const std::lock_guard lock(mutex_);
    until_s = moments_.front()->time_s;
    remembers_ = true;
    meanwhile_.clear();
  }
  memory_ = std::thread([this, path, until_s] {
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 10);
    Past past;
    try {
      past = readPast(path, until_s);
    } catch (const Forgotten&) {
    } catch (const std::exception& error) {
      spdlog::warn("the time slider begins now: {}", error.what());
    }
    {
      const std::lock_guard lock(mutex_);
      remembers_ = false;
      if (past.moments.empty() || forgets_) return;
      moments_.insert(moments_.begin(), past.moments.begin(), past.moments.end());
      thinOut();
      for (const mapping::NodeStatus& node : meanwhile_) past.chronicle.hear(node);
      past.chronicle.hearLabels(moments_.back()->time_s, moments_.back()->labels);
      if (!events_.is_null()) past.chronicle.hearEvents(events_);
      chronicle_ = std::move(past.chronicle);
      meanwhile_.clear();
    }
    on_change_();
  });
}

// Asks for what is new of the map at its pace, of the pictures at theirs.
void MissionFeed::lookAtNode(const Json& status, double time_s) {
  const auto last = now();
  const std::string has = status.at("digest").dump() + status.at("labels").dump();
  const auto is_due = [&has](const std::string& had, Clock::time_point next) {
    return has != had && Clock::now() >= next;
  };
  const bool draws = is_due(looked_at_, next_map_), pictures = is_due(pictured_, next_pictures_);
  std::shared_ptr<Moment> moment;
  if (draws || pictures) {
    const NodeMap::News news = node_map_.ask(where_.node);
    next_map_ = Clock::now() + node_map_.asking() * kLeisure;
    moment = begun(time_s, news.cell_size_m, news.change.part.cells, last.get());
    moment->tiles =
        changedTiles(news.change, moment->base_s, moment->sequence, last ? last->tiles : TileMap());
    moment->labels = colored(news.labels);
    moment->status = status;
    if (pictures) {
      showPictures(*moment,
                   mapping::picturesFrom(
                       fusion_node::askNode(where_.node, {{"query", "pictures"}, {"most", kMostPictures}})),
                   last.get());
      pictured_ = has;
      next_pictures_ = Clock::now() + kPicturesEvery;
    } else {
      moment->pictures = last->pictures;
      moment->pictures_sequence = last->pictures_sequence;
    }
    looked_at_ = has;
    {
      const std::lock_guard lock(mutex_);
      chronicle_.hearLabels(time_s, moment->labels);
    }
    add(std::move(moment));
  } else if (last && status != last->status) {  // the map is as it was; robots have moved
    moment = std::make_shared<Moment>(*last);
    moment->status = status;
    moment->time_s = std::max(time_s, last->time_s);
    const std::lock_guard lock(mutex_);
    moments_.back() = std::move(moment);
  } else {
    return;
  }
  setPhase("live");
  on_change_();
}

void MissionFeed::lookAtFiles() {
  {
    const std::lock_guard lock(mutex_);
    if (!std::exchange(stale_, false)) return;
  }
  if (!where_.run.empty()) {
    const mapping::MissionView view = viewOfRun(where_.run);
    const auto tracks = tracksOf(where_);
    const auto last = now();
    const bool has_library = std::filesystem::exists(where_.run + "/library.json");
    auto moment = momentOf(view, surprisesOfRun(where_.run, world::Grid(view.cell_size_m)),
                           has_library ? ask(where_, {{"query", "labels"}}) : mapping::labelsAnswer(view),
                           picturesOfRun(where_.run), timeOf(view), last.get());
    {
      const std::lock_guard lock(mutex_);
      moments_ = {std::move(moment)};
      chronicle_ = {};
      for (const mapping::NodeStatus& node : view.nodes) chronicle_.hear(node);
      for (const auto& [robot, points] : tracks) chronicle_.track(robot, points);
      chronicle_.hearLabels(moments_.back()->time_s, moments_.back()->labels);
    }
    on_change_();
  }
  if (recordingOrNone(where_).empty()) {
    const Json events = ask(where_, {{"query", "events"}});
    {
      const std::lock_guard lock(mutex_);
      chronicle_.hearEvents(events);
    }
    on_change_();
    return setPhase("whole");
  }
  Past past = readPast(recordingOrNone(where_), std::numeric_limits<double>::infinity());
  {
    const std::lock_guard lock(mutex_);
    moments_ = std::move(past.moments);
    chronicle_ = std::move(past.chronicle);
  }
  on_change_();
  setPhase("whole");
}

// Reads a recording from its beginning, with what was decided since, and keeps its map at even times before
// `until_s`, the last one as well when it is before that. What was decided is in what a node remembers. The
// chronicle is of all of it.
MissionFeed::Past MissionFeed::readPast(const std::string& path, double until_s) {
  const bool is_over = where_.node.empty();
  const auto [first_s, end_s] = spanOf(path, where_.key, is_over);
  const double last_s = std::min(end_s, until_s);
  const double step_s = std::max((last_s - first_s) / static_cast<double>(kHistoryMoments), 1e-3);
  const matching::MatcherOptions matcher = matcherOf(where_);
  Past past;
  std::vector<mapping::Edit> edits;
  const auto keep = [&](const fusion_node::MissionState& heard, double time_s) {
    fusion_node::MissionState state = heard;
    for (const mapping::Edit& edit : edits) state.apply(mapping::pieceOf(edit));
    state.refreshMap();
    const mapping::MissionView view = state.view();
    mapping::ToldSurprises surprises;
    surprises.update(state.beliefs());
    Json labels = mapping::labelsAnswer(view);
    mapping::addLibraryNames(labels["labels"], view.map, state.beliefs());
    past.moments.push_back(momentOf(view, surprises, std::move(labels),
                                    mapping::picturesOfLabels(view.map, state.beliefs(), kMostPictures),
                                    time_s, past.moments.empty() ? nullptr : past.moments.back().get()));
    past.chronicle.hearLabels(time_s, past.moments.back()->labels);
  };
  bool is_first = true;
  double due_s = first_s + step_s;
  const auto on_message = [&](const comms::ChannelName& channel, const wire::Header& header,
                              const comms::Packet&, const fusion_node::MissionState& state) {
    if (!is_over && isStopping()) throw Forgotten();
    if (std::exchange(is_first, false) && is_over)
      edits = mapping::readEdits(editsPathOf(where_), header.mission);
    const bool is_heartbeat = header.kind == wire::MessageKind::kHeartbeat;
    if (!is_heartbeat && is_over) return;
    if (is_heartbeat)
      past.chronicle.hear(
          fusion_node::statusOf(channel.node, state.heartbeats().at(channel.node), false, {}));
    if (header.time.seconds() < due_s || header.time.seconds() >= last_s) return;
    keep(state, header.time.seconds());
    due_s = header.time.seconds() + step_s;
  };
  const RecordedMission recorded = readRecording(path, matcher, on_message, {}, where_.key);
  if (end_s < until_s) keep(recorded.state, end_s);
  if (!is_over) return past;  // the node says what happened
  fusion_node::MissionState decided = recorded.state;
  for (const mapping::Edit& edit : edits) decided.apply(mapping::pieceOf(edit));
  past.chronicle.hearEvents(mapping::eventsAnswer(decided.overview(), decided.beliefs(), decided.events()));
  return past;
}

bool MissionFeed::isStopping() const {
  const std::lock_guard lock(mutex_);
  return stopping_ || forgets_;
}

}  // namespace shoal::console
