// SPDX-License-Identifier: MIT
#include "gpu_ref/skin.h"

#include <algorithm>
#include <cmath>

namespace cuboct::gpu {

Skin::Skin(double radius, double largest, double particles)
    : making_(kMaking + kMakingOfFew * std::min(1.0, kFew / std::max(particles, 1.0))) {
  constexpr double kThinnest = 0.012, kStep = 1.25, kFirst = 0.09;
  for (int k = 0; k < kSkins; ++k) {
    const double skin = radius * kThinnest * std::pow(kStep, k);
    skin_[k] = std::min(skin, largest);
    if (skin <= radius * kFirst) at_ = k;
    if (skin < largest) largest_ = std::min(k + 1, kSkins - 1);
  }
  at_ = std::min(at_, largest_);
}

void Skin::listed(double near, double further) {
  entries_ = near + kFurther * further;
}

uint64_t Skin::review() const {
  if (at_ == 0 || entries_ <= 0) return kForGood;  // there is nothing to gain
  // By then the making costs less than what is to be gained.
  if (!known(at_ - 1)) return static_cast<uint64_t>(std::ceil(making_ / (kWorthwhile * entries_)));
  const double saved = entries_ - cost_[at_ - 1];
  return saved > kWorthwhile * entries_ ? static_cast<uint64_t>(std::ceil(2 * making_ / saved)) : patience_;
}

void Skin::aged(uint64_t steps) {
  if (steps == 0) return;  // the first list, or one that never served
  const bool reviewed = steps >= review();
  ++lists_;
  const double making = making_ / static_cast<double>(steps);
  const double cost = entries_ + making;
  // What was long ago may have been another motion.
  cost_[at_] = when_[at_] + 1 == lists_ && cost_[at_] > 0 ? (cost_[at_] + cost) / 2 : cost;
  when_[at_] = lists_;
  const int thinner = at_ - 1, thicker = at_ + 1;
  int next = at_;
  if (thinner >= 0 && known(thinner) && cost_[thinner] < cost_[next]) next = thinner;
  if (thicker <= largest_ && known(thicker) && cost_[thicker] < cost_[next]) next = thicker;
  // What is not known is tried where there is something to gain.
  if (reviewed)
    next = thinner;
  else if (thicker <= largest_ && !known(thicker) && making > 2 * kWorthwhile * entries_)
    next = thicker;
  if (reviewed)
    trying_ = true;
  else if (trying_) {
    patience_ = next > at_ ? std::min(2 * patience_, kMostPatience) : kLeastPatience;
    trying_ = false;
  }
  at_ = next;
}

}  // namespace cuboct::gpu
