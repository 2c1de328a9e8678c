// SPDX-License-Identifier: MIT
#include "emu/lattice/members.h"

#include <algorithm>
#include <tuple>

namespace cuboct::emu {

Members::Members(const Lattice& lattice, int capacity, size_t particles)
    : lattice_(&lattice),
      capacity_(capacity),
      head_(lattice.size()),
      next_(particles),
      count_(lattice.size()),
      cell_(particles) {}

bool Members::append(uint32_t cell, uint32_t particle) {
  cell_[particle] = cell;
  if (count_[cell] == capacity_) return false;
  if (count_[cell] == 0) {
    head_[cell] = particle;
  } else {
    uint32_t last = head_[cell];
    for (int k = 1; k < count_[cell]; ++k) last = next_[last];
    next_[last] = particle;
  }
  ++count_[cell];
  return true;
}

uint32_t Members::slot_of(uint32_t cell, uint32_t particle) const {
  uint32_t slot = 0;
  for (uint32_t p = head_[cell]; p != particle; p = next_[p]) ++slot;
  return slot;
}

void Members::remove(uint32_t cell, uint32_t particle) {
  --count_[cell];
  if (head_[cell] == particle) {
    head_[cell] = next_[particle];
    return;
  }
  uint32_t before = head_[cell];
  while (next_[before] != particle) before = next_[before];
  next_[before] = next_[particle];
}

std::vector<Refused> Members::migrate(std::span<const Crossing> crossings, std::vector<Leaving>& leaving) {
  leaving.clear();
  for (const Crossing& c : crossings)
    leaving.push_back({cell_[c.particle], slot_of(cell_[c.particle], c.particle), c.away});
  std::sort(leaving.begin(), leaving.end(),
            [](const auto& a, const auto& b) { return std::tie(a.cell, a.slot) < std::tie(b.cell, b.slot); });

  struct Move {
    uint32_t to;
    bool from_above;
    uint32_t slot, particle;
  };
  std::vector<Refused> refused;
  std::vector<Move> moves;
  for (int axis = 0; axis < 3; ++axis) {
    const auto fault = [axis](Fault along_x) {
      return static_cast<Fault>(static_cast<int>(along_x) + 2 * axis);
    };
    moves.clear();
    for (const Crossing& c : crossings) {
      const auto direction = static_cast<int>(c.away[axis]);
      if (direction == 0) continue;
      const uint32_t from = cell_[c.particle], to = lattice_->neighbour(from, 2 * axis + (direction > 0));
      moves.push_back({to, direction < 0, slot_of(from, c.particle), c.particle});
    }
    for (const Move& m : moves) remove(cell_[m.particle], m.particle);
    std::sort(moves.begin(), moves.end(), [](const Move& a, const Move& b) {
      return std::tie(a.to, a.from_above, a.slot) < std::tie(b.to, b.from_above, b.slot);
    });
    for (const Move& m : moves) {
      if (m.to == kNoCell) {
        refused.push_back({fault(Fault::left_x), cell_[m.particle], m.particle});
        continue;
      }
      if (!append(m.to, m.particle)) refused.push_back({fault(Fault::full_x), m.to, m.particle});
    }
    if (!refused.empty()) break;
  }
  return refused;
}

}  // namespace cuboct::emu
