// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "shoal/topics/aligned.h"
#include "shoal/topics/cell_words.h"

namespace shoal::topics {

/// Slots are weighed in vectors of this many, whatever the width of the processor's registers.
inline constexpr int32_t kLanes = 8;

/// Cells that are re-sampled in turns, so that one's draw need not wait for another's.
inline constexpr int32_t kMaxChains = 4;

/// A cell being re-sampled: one of up to kMaxChains.
struct Chain {
  int32_t cell = -1;  ///< its name for the caller
  Token* tokens = nullptr;
  int32_t size = 0;
  int32_t next = 0;                      ///< the token to draw next
  int32_t* counts = nullptr;             ///< n_ck, a histogram over slots
  AlignedVector<float> prior;            ///< α + g_σ Σ_neighbours n_gk, over slots
  std::vector<float> uniforms;           ///< one a token, in (0, 1)
  std::vector<double> opening_uniforms;  ///< one a token, in [0, 1), where a topic may open
};

/// Counts that a block of draws is made from. Arrays are over slots, `num_vectors` x kLanes long.
struct Table {
  int32_t num_vectors = 0;
  int32_t* word_counts = nullptr;    ///< n_kw, word-major
  const int32_t* outside = nullptr;  ///< n_k without the words of the chains' cells
  const int32_t* open = nullptr;     ///< -1: has a topic, 0: has none
  const float* eligible = nullptr;   ///< 1: may be drawn, 0: may not
  float beta = 0;
  float beta_sum = 0;         ///< Vβ
  double opening_mass = 0;    ///< γ α / V if a topic may open, else 0
  bool all_eligible = false;  ///< all slots below max_topics may be drawn, and nothing opens apart
};

/// What refresh() found.
struct Totals {
  float max_inverse = 0;  ///< largest 1 / (n_k + Vβ) of those that may be drawn
  bool stale = false;     ///< `open` is not n_k > 0
  bool confined = false;  ///< an open topic has no word outside the running chains' cells
};

/// n_k = outside + the chains' counts; inverse_k = 1 / (n_k + Vβ), 0 for slots that may not be drawn.
/// @param num_running  The first so many chains are to run.
Totals refresh(const Table& table, const Chain* chains, int32_t num_chains, int32_t num_running,
               int32_t* topic_counts, float* inverse);

/// Draws a topic for `num_rounds` tokens of each chain, one of each in turn, and moves the counts. Weights:
///
///     (n_kw + β) · inverse_k · (n_ck + prior_k)
///
/// without the token's own word in n_kw and n_ck (slot -1: it has none). Float; the sums have one fixed
/// order, the same for every instruction set, so the draws are the same bytes.
///
/// @returns the chain whose next token is to open a topic, with probability opening_mass of the total: this
///          token is left as it is and the block ends. -1 if the block is done.
int32_t drawRounds(const Table& table, const float* inverse, Chain* chains, int32_t num_chains,
                   int32_t num_rounds);

/// The instruction sets compiled in that this processor has, for useGibbsTarget().
std::vector<int64_t> gibbsTargets();

/// Uses one of gibbsTargets() from now on; 0: the best again. For tests; not thread-safe.
void useGibbsTarget(int64_t target);

}  // namespace shoal::topics
