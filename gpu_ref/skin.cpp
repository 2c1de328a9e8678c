// SPDX-License-Identifier: MIT
#include "gpu_ref/skin.h"

#include <algorithm>
#include <cmath>

namespace cuboct::gpu {

Skin::Skin(double radius, double largest) {
  constexpr double kThinnest = 0.012, kStep = 1.25, kFirst = 0.045;
  for (int k = 0; k < kSkins; ++k) {
    const double skin = radius * kThinnest * std::pow(kStep, k);
    skin_[k] = std::min(skin, largest);
    if (skin <= radius * kFirst) at_ = k;
    if (skin < largest) largest_ = std::min(k + 1, kSkins - 1);
  }
  at_ = std::min(at_, largest_);
}

void Skin::listed(double entries, double within) {
  entries_ = entries;
  within_ = within;
}

uint64_t Skin::review() const {
  // A thinner skin would save this much, and is not known to cost more.
  const double saved = entries_ - within_;
  if (at_ == 0 || saved < kWorthwhile * entries_) return kForGood;
  if (known(at_ - 1) && cost_[at_ - 1] >= entries_) return kForGood;
  // By then the making has cost less than what is to be gained.
  return static_cast<uint64_t>(std::ceil(2 * kMaking / saved));
}

void Skin::aged(uint64_t steps) {
  if (steps == 0) return;  // the first list, or one that never served
  ++lists_;
  const double making = kMaking / static_cast<double>(steps);
  const double cost = entries_ + making;
  cost_[at_] = known(at_) ? (cost_[at_] + cost) / 2 : cost;
  when_[at_] = lists_;
  const int thinner = at_ - 1, thicker = at_ + 1;
  int next = at_;
  double best = cost_[at_];
  if (thinner >= 0 && known(thinner) && cost_[thinner] < best) next = thinner, best = cost_[thinner];
  if (thicker <= largest_ && known(thicker) && cost_[thicker] < best) next = thicker, best = cost_[thicker];
  // What is not known is tried where there is something to gain.
  if (thicker <= largest_ && !known(thicker) && making > 2 * kWorthwhile * entries_)
    next = thicker;
  else if (thinner >= 0 && !known(thinner) && steps >= review())
    next = thinner;
  at_ = next;
}

}  // namespace cuboct::gpu
