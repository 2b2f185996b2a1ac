// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/checkpoint_saver.h"

#include <exception>
#include <stdexcept>
#include <utility>

#include <spdlog/spdlog.h>

#include "fusion_node/process.h"
#include "shoal/mapping/atomic_file.h"

namespace shoal::robot_agent {

CheckpointSaver::CheckpointSaver(const SaverOptions& options, std::function<Checkpoint()> snapshot,
                                 Voice& voice)
    : options_(options),
      snapshot_(std::move(snapshot)),
      voice_(voice),
      counts_images_(options.counts_images) {}

void CheckpointSaver::say(const mapping::Piece& part, wire::Bytes message, bool repeatable) {
  if (repeatable || options_.folder.empty()) return voice_.say(part, std::move(message));
  unsaid_.insert_or_assign(Voice::queueKey(part.key, part.part), wire::EncodedPart{part, std::move(message)});
}

void CheckpointSaver::forget(const mapping::PieceKey& key, int32_t part) {
  voice_.forget(key, part);
  unsaid_.erase(Voice::queueKey(key, part));
  being_saved_.erase(Voice::queueKey(key, part));
}

void CheckpointSaver::save() {
  if (options_.folder.empty() || isSaving()) return;
  being_saved_ = std::exchange(unsaid_, {});
  was_begun_ = true;
  try {
    saving_.begin([&] {
      Checkpoint checkpoint = snapshot_();
      // What is said when this is written. Newer than what was said of the same.
      for (const auto& [key, each] : being_saved_) checkpoint.said.push_back({each.part, true, each.message});
      writeCheckpoint(checkpointPath(options_.folder, options_.robot), checkpoint);
      // Not before there is a checkpoint, and nothing has been said yet: who is killed in between has not
      // begun.
      if (!epoch_is_kept_) {
        mapping::writeFileAtomically(epochPath(options_.folder, options_.robot),
                                     std::to_string(options_.epoch) + "\n");
      }
    });
  } catch (const std::exception& error) {  // no child could be made
    return noteFailure(error.what());
  }
  look();
}

void CheckpointSaver::finish() {
  wait();
  for (bool failed = false; (isHolding() || isSaving() || is_failing_) && !failed; failed = is_failing_) {
    save();
    wait();
  }
  if (isHolding()) spdlog::error("{} pieces stay unsaid, for no checkpoint has them", unsaid_.size());
}

void CheckpointSaver::settle(bool waits) {
  try {
    if (waits) saving_.wait();
    if (saving_.look()) return;
  } catch (const std::runtime_error& error) {
    return noteFailure(error.what());
  }
  if (was_begun_) noteSuccess();
  sayWhatIsSaved();
}

void CheckpointSaver::sayWhatIsSaved() {
  for (auto& [key, each] : std::exchange(being_saved_, {})) voice_.say(each.part, std::move(each.message));
  const bool awaits_an_image = counts_images_ && !fusion_node::stopRequested();
  const bool is_due = is_failing_ ? std::chrono::steady_clock::now() >= retry_at_ : !unsaid_.empty();
  if (is_due && !awaits_an_image) save();
}

// Said once, and once when it is over.
void CheckpointSaver::noteFailure(const std::string& why) {
  was_begun_ = false;
  unsaid_.merge(std::exchange(being_saved_, {}));  // of the same, what is newer stays
  retry_at_ = std::chrono::steady_clock::now() + options_.retry_after;
  if (!std::exchange(is_failing_, true))
    spdlog::error("{}; goes on, and tries again: until then a crash would lose what is learnt", why);
}

void CheckpointSaver::noteSuccess() {
  was_begun_ = false;
  epoch_is_kept_ = true;
  if (std::exchange(is_failing_, false)) spdlog::info("checkpoints are written again");
}

}  // namespace shoal::robot_agent
