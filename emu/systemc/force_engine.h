// SPDX-License-Identifier: MIT
// The force engine of a node of one cell, with wide memories or narrow ones. docs/reference/node.md, "Force
// engine" and "Narrow memories".
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "emu/systemc/force_machine.h"
#include "emu/systemc/planar.h"

namespace cuboct::emu {

// Cycles in which halo records came, and the end beats behind them; by face. 0 where there is
// no link.
struct HaloTimes {
  std::array<std::vector<uint64_t>, kFaces> came;
  std::array<uint64_t, kFaces> ended{};
};

class ForceEngine final : public ForceMachine {
 public:
  // Keeps references to all; writes `fault`. `times` is used where halos are used on arrival.
  // Of a bonded rule it writes the bonds of `own` too.
  ForceEngine(const Plan& plan, std::vector<Slot>& own,
              const std::array<std::vector<Candidate>, kFaces>& halo, const HaloTimes& times,
              FaultKeeper& fault);

  uint64_t run() override {
    return plan_.arch.narrow_memories ? walk() : plan_.arch.halos == Halos::arrival ? arrive() : stream();
  }

 private:
  struct Stream;
  uint64_t stream();
  uint64_t walk();    // with narrow memories
  uint64_t arrive();  // with halos used on arrival
  void begin_filter(Stream& stream) const;
  // Tests a record against all own slots but `self`.
  void meet_slots(Stream& stream, const Candidate& c, uint32_t self) const;
  void filter(Stream& stream) const;
  void count_faces(const Stream& stream);
  void issue(const Stream& stream, uint32_t entry, uint64_t& mask);

  std::vector<Slot>& own_;
  const std::array<std::vector<Candidate>, kFaces>& halo_;
  const HaloTimes& times_;
  const PlanarTest test_{plan_.rule};
  const bool bonded_;
};

}  // namespace cuboct::emu
