// SPDX-License-Identifier: MIT
// What moves in a step's three migrations, and what that costs: the part of the MIGRATE phases that does not
// depend on time. docs/reference/node.md, "MIGRATE_a".
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "emu/timing/slots.h"
#include "hw/arch/bricks.h"
#include "hw/cost/events.h"
#include "model/contract/lattice.h"

namespace cuboct::emu {

class Migration {
 public:
  // `beats`: of a migrate record. `on_the_way`: cycles from the one that loads a record's last beat to that
  // in which the receiver sees it. Keeps a reference to `lattice`.
  Migration(const Lattice& lattice, int beats, int on_the_way);

  // A particle that comes over a face: in the receiver's FIFO `after` cycles after the start of the sender's
  // phase.
  struct Arrival {
    uint32_t from;
    int32_t after;
    uint32_t departure;  // which of departures(axis)
  };
  // A particle that leaves over a face, met by SCAN in this slot.
  struct Departure {
    uint32_t node, slot;
    int face;
  };

  // Plans one step. `count`: particles by node at its start, and after the call those at its end. `leaving`
  // in any order, all within the lattice.
  void plan(std::span<uint32_t> count, std::span<const Leaving> leaving);

  // changed[node] = 1 where the planned step takes particles away or brings some.
  void mark(std::span<uint8_t> changed) const;

  // Whether anything moves in the step; if not, no node scans and nothing arrives.
  bool any() const { return any_; }
  // What SCAN does.
  struct Scan {
    int32_t slots = 0;  // that it reads
    int32_t left = 0;   // particles that leave
  };
  const Scan& scanned(int axis, uint32_t node) const { return scan_[static_cast<size_t>(axis)][node]; }
  // Its cycles.
  int64_t scan(int axis, uint32_t node) const {
    const Scan& s = scanned(axis, node);
    return s.slots + int64_t{s.left} * (beats_ - 1);
  }
  // Adds what the migrations of the planned step do to a node.
  void count(uint32_t node, int axes, MachineEvents& events) const;
  // Of the planned step, by node, then slot.
  std::span<const Departure> departures(int axis) const { return departures_[static_cast<size_t>(axis)]; }
  // Those of one node, and the number of the first.
  struct OfNode {
    uint32_t first;
    std::span<const Departure> departures;
  };
  OfNode departures(int axis, uint32_t node) const;
  // What comes over -a (side 0) or +a (side 1), in order.
  std::span<const Arrival> arrivals(int axis, uint32_t node, int side) const;

 private:
  struct Mover {
    uint32_t node, slot;
    std::array<int8_t, 3> away;  // axes still to go
  };
  struct Landing {
    uint32_t to;
    uint32_t side;
    uint32_t order;  // of departure
    std::array<int8_t, 3> away;
    Arrival arrival;
  };
  void forget();
  void depart(int axis, std::span<uint32_t> count);
  void land(int axis, std::span<uint32_t> count);
  void set_leaving(uint32_t node, int axis);

  const Lattice& lattice_;
  const int beats_, on_the_way_;
  bool any_ = false;
  std::vector<Mover> movers_;  // by node, then slot
  std::vector<Landing> landings_;
  std::array<std::vector<Departure>, 3> departures_;  // [axis]
  std::array<std::vector<uint32_t>, 3> leaving_;      // [axis] nodes whose `leaving_a` is set, each once
  std::vector<uint8_t> leaving_bits_;                 // [node] bit a: `leaving_a`
  std::array<std::vector<Scan>, 3> scan_;             // [axis][node]
  std::array<std::vector<int32_t>, 3> group_;         // [axis][node]: its arrivals, -1 for none
  std::array<std::vector<uint32_t>, 3> received_;     // [axis] nodes with arrivals
  std::vector<std::array<uint32_t, 3>> groups_;       // arrivals from -a, from +a, end: into arrivals_
  std::vector<Arrival> arrivals_;
};

}  // namespace cuboct::emu
