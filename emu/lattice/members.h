// SPDX-License-Identifier: MIT
// Which particles (by id) a cell holds, in the order of its slots, and their migration. Where ranks share a
// scene each has all of this: it is what decides alike on all of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "emu/lattice/aligned.h"
#include "emu/timing/slots.h"
#include "model/base/error.h"
#include "model/contract/lattice.h"

namespace cuboct::emu {

// A particle that found no place: full_x ... or left_x ..., with the cell that refused it or that it left.
struct Refused {
  Fault fault;
  uint32_t cell, particle;
};

// A list per cell, linked through the particles: 6 bytes per cell and 8 per particle.
class Members {
 public:
  Members() = default;
  Members(const Lattice& lattice, int capacity, size_t particles);

  // False where the cell is full.
  bool append(uint32_t cell, uint32_t particle);
  // By particle; readable kGroup elements beyond either end.
  const uint32_t* cells() const { return cell_.data(); }
  int count(uint32_t cell) const { return count_[cell]; }
  const std::vector<uint16_t>& counts() const { return count_; }
  template <typename See>
  void for_each(uint32_t cell, const See& see) const {
    for (uint32_t p = head_[cell], k = 0; k < count_[cell]; ++k, p = next_[p]) see(p);
  }

  // Moves the particles (ids) that crossed, axis by axis, as the machine does: those who stay keep their
  // order, then come those from below in their order, then those from above. Stops after an axis on which
  // someone was refused. `leaving` becomes what the timing model needs.
  std::vector<Refused> migrate(std::span<const Crossing> crossings, std::vector<Leaving>& leaving);

 private:
  uint32_t slot_of(uint32_t cell, uint32_t particle) const;
  void remove(uint32_t cell, uint32_t particle);

  const Lattice* lattice_ = nullptr;
  int capacity_ = 0;
  std::vector<uint32_t> head_, next_;
  std::vector<uint16_t> count_;
  PaddedArray<uint32_t> cell_;
};

}  // namespace cuboct::emu
