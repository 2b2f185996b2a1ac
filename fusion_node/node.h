// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "fusion_node/mission_state.h"
#include "fusion_node/node_memory.h"
#include "fusion_node/query_server.h"
#include "fusion_node/repair.h"
#include "fusion_node/silence_alarm.h"
#include "shoal/comms/authenticated_bus.h"
#include "shoal/comms/bus.h"
#include "shoal/comms/mission_clock.h"
#include "shoal/comms/sender.h"
#include "shoal/mapping/library.h"
#include "shoal/mapping/map_changes.h"
#include "shoal/mapping/told_surprises.h"

namespace shoal::fusion_node {

struct NodeOptions {
  std::string name = "OPERATOR";  ///< [A-Z0-9]{1,16}
  int32_t mission = 1;
  int64_t budget = 2000;   ///< bytes per second of mission time on the link, 0 = unlimited
  double cell_size_m = 1;  ///< edge of a cell, until a robot has said
  double rate = 1.0;       ///< seconds of mission time per wall second; 0 = follow the robots
  matching::MatcherOptions matcher = matching::usualMatcher();
  std::string state_dir;                         ///< where questions are answered; empty = nowhere
  std::string out_dir;                           ///< where the map's files go at the end; empty = nowhere
  std::optional<mapping::Library> library = {};  ///< names from missions before
  const comms::AuthenticatedBus* authentication = nullptr;  ///< what the link is heard through, with a key
};

/// A fusion node: hears everybody, fuses when something changed, tells the link what matches what and the
/// local bus how the map looks, answers questions, and says what its operator decided: edits are kept in
/// `edits.json` of the state folder before they are acknowledged, and come back from there. So does all that
/// it had heard: NodeMemory.
class Node {
 public:
  /// `link` and `local` outlive the node.
  /// @throws std::invalid_argument naming a wrong option; std::runtime_error when the state folder is taken.
  Node(const NodeOptions& options, comms::Bus& link, comms::Bus& local);

  /// One turn of the loop: hear, fuse when due, send what is due. Waits up to `timeout_ms` for something; of
  /// a map for the local bus it says a few chunks, and the rest in later turns.
  void turn(int timeout_ms);

  /// Fuses what was heard last, tells the local bus, and writes global_map.csv and labels.csv.
  /// @throws std::runtime_error naming the file that cannot be written.
  void finish();

  const MissionState& state() const { return state_; }

 private:
  comms::Packet heartbeat(int64_t now_us);
  void hear(const comms::Packet& packet);
  void keep(const comms::Packet& packet, bool is_new);
  void commit();
  void onDisk(const std::function<void()>& act);
  void recall();
  std::vector<comms::Packet> mapPackets();
  void publishMap();
  mapping::MissionView view() const;
  mapping::MissionView overview() const;
  void warnOfStrangers();
  void warnOfMixtures();
  nlohmann::ordered_json answer(const nlohmann::ordered_json& question);
  nlohmann::ordered_json answerStatus() const;
  nlohmann::ordered_json answerChanges(const nlohmann::ordered_json& question);
  nlohmann::ordered_json answerAsk(const nlohmann::ordered_json& question);
  nlohmann::ordered_json answerEdit(const nlohmann::ordered_json& question);
  void loadEdits();
  void enterLibrary();
  void checkLibrary();
  nlohmann::ordered_json libraryStatus() const;
  void offer(const mapping::Edit& edit);
  int64_t wallMs() const;

  NodeOptions options_;
  MissionState state_;
  comms::Bus& link_;
  comms::Bus& local_;
  comms::MissionClock clock_;
  comms::Sender sender_;
  Repair repair_;
  std::optional<NodeMemory> memory_;
  std::optional<QueryServer> queries_;
  mapping::ToldSurprises surprises_;  // as of the last time that a console asked
  mapping::MapChanges map_changes_;   // as consoles were told
  SilenceAlarm silence_;
  std::map<std::string, size_t> num_chunks_;  // in the send queue, by channel
  size_t warned_of_strangers_ = 0;
  bool warned_of_library_ = false;
  std::set<std::pair<std::string, std::string>> warned_of_;  // kinds and nodes of mixtures
  int64_t looked_for_mixtures_ms_ = 0;
  uint64_t published_digest_ = 0;
  std::deque<comms::Packet> publishing_;  // chunks of the map that is told at present
  int64_t fused_at_ms_ = 0, published_at_ms_ = 0;
};

}  // namespace shoal::fusion_node
