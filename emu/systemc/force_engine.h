// SPDX-License-Identifier: MIT
// The force engine of a node of one cell, with wide memories or narrow ones. docs/reference/node.md, "Force
// engine" and "Narrow memories".
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "emu/systemc/force_machine.h"

namespace cuboct::emu {

class ForceEngine final : public ForceMachine {
 public:
  // Keeps references to all four; writes `fault`.
  ForceEngine(const Plan& plan, const std::vector<Slot>& own,
              const std::array<std::vector<Candidate>, kFaces>& halo, FaultKeeper& fault);

  uint64_t run() override { return plan_.arch.narrow_memories ? walk() : stream(); }

 private:
  struct Stream;
  uint64_t stream();
  uint64_t walk();  // with narrow memories
  void filter(Stream& stream) const;
  void issue(const Stream& stream, uint32_t entry, uint64_t& mask);

  const std::vector<Slot>& own_;
  const std::array<std::vector<Candidate>, kFaces>& halo_;
};

}  // namespace cuboct::emu
