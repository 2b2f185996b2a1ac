// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "robot_agent/background_save.h"
#include "robot_agent/checkpoint.h"
#include "robot_agent/voice.h"
#include "shoal/mapping/piece.h"
#include "shoal/wire/piece_codec.h"

namespace shoal::robot_agent {

struct SaverOptions {
  std::string folder;  ///< where checkpoints go; empty = nowhere
  world::RobotId robot{};
  int32_t epoch = 0;
  bool counts_images = false;  ///< until landed() who holds pieces calls save(); else they are saved at once
  std::chrono::milliseconds retry_after{
      10'000};  ///< wall time in which look() leaves a disk alone that failed
};

/// Saves checkpoints while the robot goes on, and says what must be in one first: the write-ahead log of what
/// a robot tells. What it could not say again the same way after a crash is held until a checkpoint that has
/// it is written, so that no version ever has two contents. A disk that is full ends no flight: what waits
/// goes on waiting, and another checkpoint is tried later.
class CheckpointSaver {
 public:
  /// @param snapshot  the robot as it is between two images, but for what waits here; called in the process
  ///                  that saves.
  /// `voice` outlives it.
  CheckpointSaver(const SaverOptions& options, std::function<Checkpoint()> snapshot, Voice& voice);

  /// Says a part: at once when it is `repeatable`, said again the same way after a crash, or when nothing is
  /// saved; else when a checkpoint has it.
  void say(const mapping::Piece& part, wire::Bytes message, bool repeatable);

  /// Does not say any more what waits, here or to be sent.
  void forget(const mapping::PieceKey& key, int32_t part);

  /// Begins to save, unless the last time is not done yet. Between images only.
  void save();

  /// Says what a checkpoint has by now, and begins another for what waits for one.
  void look() { settle(false); }
  /// The same after having waited for the checkpoint that is being written, if one is.
  void wait() { settle(true); }
  /// Waits until nothing is held any more; on a disk that fails, for one more try.
  void finish();

  /// No more images are to be counted.
  void landed() { counts_images_ = false; }

  bool isSaving() const { return saving_.isRunning(); }
  /// True while something waits for a checkpoint.
  bool isHolding() const { return !unsaid_.empty() || !being_saved_.empty(); }

 private:
  void settle(bool waits);
  void sayWhatIsSaved();
  void noteFailure(const std::string& why);
  void noteSuccess();

  const SaverOptions options_;
  const std::function<Checkpoint()> snapshot_;
  Voice& voice_;
  bool counts_images_;
  bool epoch_is_kept_ = false;
  bool was_begun_ = false;  // a checkpoint of which it is not known yet whether it was written
  bool is_failing_ = false;
  std::chrono::steady_clock::time_point retry_at_;
  // What waits for a checkpoint to be begun, and to be done. By keys of the send queue.
  std::map<std::string, wire::EncodedPart> unsaid_, being_saved_;
  BackgroundSave saving_;
};

}  // namespace shoal::robot_agent
