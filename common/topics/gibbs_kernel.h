// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shoal/topics/aligned.h"
#include "shoal/topics/cell_words.h"

namespace shoal::topics {

/// Cells that are re-sampled side by side, each in a lane of its own, whatever the width of the processor's
/// registers.
inline constexpr int32_t kLanes = 16;

/// Histograms over slots are whole multiples of this long.
inline constexpr int32_t kSlotsTogether = 4;

/// The cells being re-sampled, lane by lane. Matrices are [slot][lane], as many slots as a row of the table.
struct Lanes {
  explicit Lanes(int32_t num_slots);

  AlignedVector<float> counts;                         ///< n_ck; whole numbers, exact up to 2^24
  AlignedVector<float> prior;                          ///< α + g_σ Σ_neighbours n_gk
  AlignedVector<float> sums;                           ///< the kernel's own
  std::array<Token*, kLanes> next{};                   ///< the token to draw next
  std::array<Token*, kLanes> end{};                    ///< the first that is not to be drawn
  alignas(64) std::array<uint32_t, kLanes> counter{};  ///< names its random numbers, with the key
  alignas(64) std::array<uint32_t, kLanes> key{};
};

/// Counts that draws are made from. Arrays are over slots, `stride` long.
struct Table {
  int32_t stride = 0;                ///< slots, a multiple of kSlotsTogether
  int32_t num_slots = 0;             ///< those that are weighed, the first so many: a multiple of it too
  int32_t* word_counts = nullptr;    ///< n_kw, word-major
  const int32_t* outside = nullptr;  ///< n_k without the words of the lanes' cells
  const int32_t* open = nullptr;     ///< -1: has a topic, 0: has none
  const float* eligible = nullptr;   ///< 1: may be drawn, 0: may not
  float beta = 0;
  float beta_sum = 0;      ///< Vβ
  float opening_mass = 0;  ///< γ α / V if a topic may open, else 0
};

/// What refresh() found.
struct Totals {
  float max_inverse = 0;  ///< largest 1 / (n_k + Vβ) of those that may be drawn
  int64_t num_words = 0;  ///< Σ n_k
  bool stale = false;     ///< `open` is not n_k > 0
};

/// n_k = outside + the counts of the lanes named; inverse_k = 1 / (n_k + Vβ), 0 for slots that may not be
/// drawn.
Totals refresh(const Table& table, const Lanes& lanes, const int32_t* named, int32_t num_named,
               int32_t* topic_counts, float* inverse);

/// What drawRounds() did.
struct Drawn {
  int32_t num_drawn = 0;  ///< tokens
  int32_t opening = -1;   ///< the lane whose next token is to open a topic; -1: none
};

/// Draws topics for the next tokens of some lanes and moves the counts. In a round one token of each lane is
/// drawn, all from the counts as they were before the round, each without its own word (slot -1: it has no
/// topic yet):
///
///     (n_kw + β) · inverse_k · (n_ck + prior_k)
///
/// Float; summed over slots in one order, lane by lane, so that any instruction set gives the same bytes. A
/// topic opens with probability opening_mass of the total: this token is left as it is, those of the lanes
/// after it are not drawn in this round, and the call ends.
///
/// @param running       Lanes with tokens left, none twice: the order in which their words are moved.
/// @param max_rounds    Ends after so many rounds,
/// @param max_finished  or when so many lanes, at least 1, have none left.
Drawn drawRounds(const Table& table, const float* inverse, Lanes& lanes, const int32_t* running,
                 int32_t num_running, int32_t max_rounds, int32_t max_finished);

/// The instruction sets compiled in that this processor has, for useGibbsTarget().
std::vector<int64_t> gibbsTargets();

/// Uses one of gibbsTargets() from now on; 0: the best again. For tests; not thread-safe.
void useGibbsTarget(int64_t target);

}  // namespace shoal::topics
