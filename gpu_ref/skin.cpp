// SPDX-License-Identifier: MIT
#include "gpu_ref/skin.h"

#include <algorithm>
#include <cmath>

namespace cuboct::gpu {

Skin::Skin(double radius, double largest, double particles)
    : making_(kMaking + kMakingOfFew * std::min(1.0, kFew / std::max(particles, 1.0))) {
  constexpr double kThinnest = 0.02, kStep = 1.25, kFirst = 0.1;
  for (int k = 0; k < kSkins; ++k) {
    const double skin = radius * kThinnest * std::pow(kStep, k);
    skin_[k] = std::min(skin, largest);
    if (skin <= radius * kFirst) at_ = k;
    if (skin < largest) largest_ = std::min(k + 1, kSkins - 1);
  }
  at_ = std::min(at_, largest_);
}

void Skin::aged(uint64_t steps) {
  if (steps == 0) return;  // the first list, or one that never served
  ++lists_;
  const double making = making_ / static_cast<double>(steps), keeping = kEntry * entries_;
  // What was long ago may have been another motion.
  const bool again = cost_[at_] > 0 && when_[at_] + 1 == lists_;
  cost_[at_] = again ? (cost_[at_] + making + keeping) / 2 : making + keeping;
  when_[at_] = lists_;
  const int thinner = at_ - 1, thicker = at_ + 1;
  int next = at_;
  if (known(thinner) && cost_[thinner] < cost_[next]) next = thinner;
  if (known(thicker) && cost_[thicker] < cost_[next]) next = thicker;
  // What is not known is tried where there is something to gain.
  const double worth = kWorthwhile * (kOthers + making + keeping);
  if (thicker <= largest_ && !known(thicker) && making > worth)
    next = thicker;
  else if (thinner >= 0 && !known(thinner) && making < keeping / 2 && keeping > worth)
    next = thinner;
  at_ = next;
}

}  // namespace cuboct::gpu
