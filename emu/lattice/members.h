// SPDX-License-Identifier: MIT
// Which particles a node holds, in the order of its slots, and their migration.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "emu/lattice/block.h"
#include "emu/lattice/slots.h"
#include "model/lattice.h"

namespace cuboct::emu {

// A particle that found no place: full_x ... or left_x ..., with the node that refused it or that it left.
struct Refused {
  Fault fault;
  uint32_t node, particle;
};

// A list per node, linked through the particles: 5 bytes per node and 4 per particle.
class Members {
 public:
  Members() = default;
  Members(const Lattice& lattice, int capacity, size_t particles);

  // False where the node is full.
  bool append(uint32_t node, uint32_t particle);
  size_t room() const { return next_.size(); }
  int count(uint32_t node) const { return count_[node]; }
  template <typename See>
  void for_each(uint32_t node, const See& see) const {
    for (uint32_t p = head_[node], k = 0; k < count_[node]; ++k, p = next_[p]) see(p);
  }

  // Moves the particles that crossed, axis by axis, as the machine does: those who stay keep their order, then
  // come those from below in their order, then those from above. `node` is kept up to date. Stops after an
  // axis on which someone was refused. `leaving` becomes what the timing model needs.
  std::vector<Refused> migrate(std::span<const Crossing> crossings, PaddedArray<uint32_t>& node,
                               std::vector<Leaving>& leaving);

  // The particles get new indices: particle p is now renamed[p].
  void rename(std::span<const uint32_t> renamed);

 private:
  uint32_t slot_of(uint32_t node, uint32_t particle) const;
  void remove(uint32_t node, uint32_t particle);

  const Lattice* lattice_ = nullptr;
  int capacity_ = 0;
  std::vector<uint32_t> head_, next_;
  std::vector<uint16_t> count_;
};

}  // namespace cuboct::emu
