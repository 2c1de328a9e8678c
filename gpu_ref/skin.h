// SPDX-License-Identifier: MIT
// How thick the skin of pair lists should be. A thick one holds more pairs than interact, a thin one is used up soon.
// In a solid lists live for ever beyond the amplitude of its vibrations, and each shell of neighbours in the skin
// costs at once; in a fluid both go smoothly. So the skin follows what lists have cost, per step and particle: their
// entries, and the making over their life. It depends on steps and lists alone: runs repeat to the bit.
#pragma once

#include <array>
#include <cstdint>

namespace cuboct::gpu {

class Skin {
 public:
  // `radius` of the interaction; `largest`: what the cells leave room for. Same unit. `particles` in all, on however
  // many devices.
  Skin(double radius, double largest, double particles);

  double now() const { return skin_[at_]; }
  double thinner() const { return skin_[at_ > 0 ? at_ - 1 : 0]; }

  // Of the list just made, per particle: entries within the next thinner skin, and further ones.
  void listed(double near, double further);
  // The list has served for so many steps and a new one is to be made: chooses its skin.
  void aged(uint64_t steps);
  // The age at which a list is to be made anew with a thinner skin though it still serves; never: kForGood.
  uint64_t review() const;

  static constexpr uint64_t kForGood = ~uint64_t{0};

 private:
  static constexpr int kSkins = 14;
  // Making a list takes about the time of this many entries per particle, and where there are few particles that of
  // more: it is then a matter of waiting for the host (docs/reference/gpu.md has the measurement).
  static constexpr double kMaking = 400, kMakingOfFew = 1100, kFew = 50e3;
  // Further entries are met by few (gpu_ref/grid_view.h), which holds up those that are computed beside them.
  static constexpr double kFurther = 0.15;
  static constexpr double kWorthwhile = 0.04;  // a share of the cost
  static constexpr uint64_t kRemembered = 64;  // lists
  // Steps after which a thinner skin that was worse is tried again: twice as many each time that it is worse still.
  static constexpr uint64_t kLeastPatience = 256, kMostPatience = 16384;

  bool known(int skin) const { return lists_ - when_[skin] < kRemembered && cost_[skin] > 0; }

  std::array<double, kSkins> skin_{};
  std::array<double, kSkins> cost_{};    // 0: never tried
  std::array<uint64_t, kSkins> when_{};  // number of the list that told
  double making_;
  int at_ = 0, largest_ = 0;
  uint64_t patience_ = kLeastPatience;
  bool trying_ = false;  // a thinner skin, after a review
  uint64_t lists_ = 0;
  double entries_ = 0;  // by what they cost
};

}  // namespace cuboct::gpu
