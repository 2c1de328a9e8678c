// SPDX-License-Identifier: MIT
#include "emu/gpu/skin.h"

#include <algorithm>
#include <cmath>

#include "emu/gpu/engine.h"

namespace cuboct::gpu {

Skin::Skin(double radius, double largest, double particles)
    : making_(kMaking + kMakingOfFew * std::min(1.0, kFew / std::max(particles, 1.0))), entry_(kEntry) {
  if (particles <= kMostTogether) making_ = kMakingTogether, entry_ = kEntryTogether;
  constexpr double kThinnest = 0.02, kStep = 1.25, kFirst = 0.1;
  for (int k = 0; k < kSkins; ++k) {
    const double skin = radius * kThinnest * std::pow(kStep, k);
    skin_[k] = std::min(skin, largest);
    if (skin <= radius * kFirst) learned_.at = k;
    if (skin < largest) largest_ = std::min(k + 1, kSkins - 1);
  }
  learned_.at = std::min(learned_.at, static_cast<uint64_t>(largest_));
}

void Skin::aged(uint64_t steps) {
  if (steps == 0) return;  // the first list, or one that never served
  auto& [cost, when, at, lists] = learned_;
  const int now = static_cast<int>(at);
  ++lists;
  const double making = making_ / static_cast<double>(steps), keeping = entry_ * entries_;
  // What was long ago may have been another motion.
  const bool again = cost[now] > 0 && when[now] + 1 == lists;
  cost[now] = again ? (cost[now] + making + keeping) / 2 : making + keeping;
  when[now] = lists;
  const int thinner = now - 1, thicker = now + 1;
  int next = now;
  if (known(thinner) && cost[thinner] < cost[next]) next = thinner;
  if (known(thicker) && cost[thicker] < cost[next]) next = thicker;
  // What is not known is tried where there is something to gain.
  const double worth = kWorthwhile * (kOthers + making + keeping);
  if (thicker <= largest_ && !known(thicker) && making > worth)
    next = thicker;
  else if (thinner >= 0 && !known(thinner) && making < keeping / 2 && keeping > worth)
    next = thinner;
  at = static_cast<uint64_t>(next);
}

}  // namespace cuboct::gpu
