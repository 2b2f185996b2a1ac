// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "operator_console/mission_sources.h"
#include "operator_console/serve/chronicle.h"
#include "operator_console/serve/map_tiles.h"
#include "operator_console/serve/node_map.h"
#include "shoal/mapping/held_pictures.h"

namespace shoal::console {

/// The map as it was at one time, ready to be handed out.
struct Moment {
  uint64_t sequence = 0;
  uint64_t chain = 0;  ///< the first map of which this one can be told as a difference
  double time_s = 0;   ///< mission time
  double cell_size_m = 1, base_s = 0;
  TileMap tiles;
  nlohmann::ordered_json status, labels;                   ///< as the questions of these names are answered
  std::shared_ptr<const mapping::LabelPictures> pictures;  ///< of every topic
  uint64_t pictures_sequence = 0;  ///< of the map with which they became what they are
};

/// The legend as an answer, each row with the colour of global_map.png.
nlohmann::ordered_json colored(nlohmann::ordered_json answer);

/// Keeps looking at a mission from a thread of its own: asks a running node, or reads files once and again
/// when something was decided. Pages read what it has found, and never make a node work. What a node
/// remembers of the time before is read meanwhile by a second thread, and goes before what was seen.
class MissionFeed {
 public:
  using OnChange = std::function<void()>;

  /// @param on_change  Called from the feed's thread when there is something new.
  MissionFeed(Where where, OnChange on_change);
  ~MissionFeed();
  MissionFeed(const MissionFeed&) = delete;
  MissionFeed& operator=(const MissionFeed&) = delete;

  /// The newest; nullptr before the first.
  std::shared_ptr<const Moment> now() const;
  /// The last one not after that mission time; the first when there is none; nullptr before the first.
  std::shared_ptr<const Moment> at(double time_s) const;

  /// {"phase": "live"|"lost"|"reading"|"whole", "problem", "sequence", "pictures", "time_s",
  /// "times_s": [..]}, "pictures" being the newest's pictures_sequence.
  nlohmann::ordered_json report() const;
  /// Tracks, traffic and events up to now.
  nlohmann::ordered_json chronicle(const std::string& what) const;

  /// Something was decided: look again, now.
  void lookAgain();

 private:
  void run();
  void watchNode();
  void lookAtFiles();
  struct Past {
    std::vector<std::shared_ptr<const Moment>> moments;  // by time
    Chronicle chronicle;
  };

  Past readPast(const std::string& path, double until_s);
  void beginMission(int32_t mission);
  void remember(const std::string& path);
  void endRemembering();
  bool isStopping() const;
  void thinOut();
  void lookAtNode(const nlohmann::ordered_json& status, double time_s);
  std::shared_ptr<Moment> momentOf(const mapping::MissionView& view, const mapping::ToldSurprises& surprises,
                                   nlohmann::ordered_json labels, mapping::LabelPictures pictures,
                                   double time_s, const Moment* before);
  std::shared_ptr<Moment> begun(double time_s, double cell_size_m,
                                const std::vector<mapping::GlobalCell>& cells, const Moment* before);
  void add(std::shared_ptr<const Moment> moment);
  void setPhase(const std::string& phase, const std::string& problem = {});

  const Where where_;
  const OnChange on_change_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false, stale_ = true;
  std::string phase_ = "reading", problem_;
  uint64_t sequence_ = 0;
  std::optional<double> base_s_;
  std::vector<std::shared_ptr<const Moment>> moments_;  // by time
  Chronicle chronicle_;
  std::optional<int32_t> mission_;  // of the node; of the feed's thread, as what follows
  bool knows_past_ = false;         // or somebody is at it
  std::atomic<bool> forgets_ = false;
  bool remembers_ = false;                      // the second thread is at it
  std::vector<mapping::NodeStatus> meanwhile_;  // what the chronicle heard while it is
  nlohmann::ordered_json events_;               // as the node told them last
  NodeMap node_map_;                            // of the feed's thread, as what follows
  std::string looked_at_, pictured_;  // what the node said it had when its map, its pictures were asked for
  std::chrono::steady_clock::time_point next_map_, next_pictures_, next_events_;
  std::thread memory_, thread_;
};

}  // namespace shoal::console
