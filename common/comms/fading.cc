// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/fading.h"

#include <cmath>

#include "shoal/random.h"

namespace shoal::comms {

bool isBad(const Bursts& bursts, uint64_t key, int64_t at_us) {
  if (bursts.bad_s == 0) return false;
  const double cycle_s = bursts.good_s + bursts.bad_s;
  const double at_s = static_cast<double>(at_us) * 1e-6;
  const double block = std::floor(at_s / (32 * cycle_s));
  Random random(key, static_cast<uint64_t>(block));
  bool bad = random.uniform() < bursts.bad_s / cycle_s;
  double left_s = at_s - block * 32 * cycle_s;
  while (true) {
    left_s += (bad ? bursts.bad_s : bursts.good_s) * std::log1p(-random.uniform());
    if (left_s < 0) return bad;
    bad = !bad;
  }
}

}  // namespace shoal::comms
