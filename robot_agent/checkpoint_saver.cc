// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/checkpoint_saver.h"

#include <utility>

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
}

void CheckpointSaver::save() {
  if (options_.folder.empty() || isSaving()) return;
  saving_.begin([&] {
    Checkpoint checkpoint = snapshot_();
    // What is said when this is written. Newer than what was said of the same.
    for (const auto& [key, each] : unsaid_) checkpoint.said.push_back({each.part, true, each.message});
    writeCheckpoint(checkpointPath(options_.folder, options_.robot), checkpoint);
    // Not before there is a checkpoint, and nothing has been said yet: who is killed in between has not
    // begun.
    if (!epoch_is_kept_) {
      mapping::writeFileAtomically(epochPath(options_.folder, options_.robot),
                                   std::to_string(options_.epoch) + "\n");
    }
  });
  epoch_is_kept_ = true;
  being_saved_ = std::exchange(unsaid_, {});
  look();
}

void CheckpointSaver::look() {
  if (!saving_.look()) sayWhatIsSaved();
}

void CheckpointSaver::wait() {
  saving_.wait();
  sayWhatIsSaved();
}

void CheckpointSaver::sayWhatIsSaved() {
  for (auto& [key, each] : std::exchange(being_saved_, {})) voice_.say(each.part, std::move(each.message));
  const bool awaits_an_image = counts_images_ && !fusion_node::stopRequested();
  if (!unsaid_.empty() && !awaits_an_image) save();
}

}  // namespace shoal::robot_agent
