// SPDX-License-Identifier: MIT
// How thick the skin of pair lists should be. A thick one lives long and holds many pairs, which are gone
// over whenever a near list is made of it (emu/gpu/step.h); a near one is used up soon. In a solid lists live
// for ever beyond the amplitude of its vibrations, and each shell of neighbours counts at once; in a fluid
// both go smoothly. So the skin follows what lists have cost, per step and particle. It depends on steps and
// lists alone: runs repeat to the bit.
#pragma once

#include <array>
#include <cstdint>

namespace cuboct::gpu {

class Skin {
 public:
  // `radius` of the interaction; `largest`: what the cells leave room for. Same unit. `particles` in all, on
  // however many devices.
  Skin(double radius, double largest, double particles);

  double now() const { return skin_[learned_.at]; }

  // Entries per particle of the list just made.
  void listed(double entries) { entries_ = entries; }
  // The list has served for so many steps and a new one is to be made: chooses its skin.
  void aged(uint64_t steps);

  // What it has learned so far, in plain words.
  static constexpr int kSkins = 14;
  struct Memory {
    std::array<double, kSkins> cost{};    // 0: never tried
    std::array<uint64_t, kSkins> when{};  // number of the list that told
    uint64_t at = 0, lists = 0;
  };
  Memory memory() const { return learned_; }
  // False where it cannot be that of such lists.
  bool recall(const Memory& memory) {
    if (memory.at > static_cast<uint64_t>(largest_)) return false;
    learned_ = memory;
    return true;
  }

 private:
  // In the time of a pair of a near list: making a list takes that of so many pairs per particle, and where
  // there are few particles that of more, as it is then a matter of waiting for the host; an entry that is
  // met now and then, when near lists are made, takes so much a step.
  static constexpr double kMaking = 400, kMakingOfFew = 1100, kFew = 50e3, kEntry = 0.06;
  // Of particles that go through steps together, which have no near lists: each step meets each entry.
  static constexpr double kMakingTogether = 1500, kEntryTogether = 1;
  // The share of the cost that is worth a try, and for how many lists one remembers what it gave.
  static constexpr double kWorthwhile = 0.05, kOthers = 20;
  static constexpr uint64_t kRemembered = 64;

  bool known(int skin) const {
    return skin >= 0 && skin <= largest_ && learned_.cost[skin] > 0 &&
           learned_.lists - learned_.when[skin] < kRemembered;
  }

  std::array<double, kSkins> skin_{};
  double making_, entry_;
  int largest_ = 0;
  double entries_ = 0;
  Memory learned_;
};

}  // namespace cuboct::gpu
