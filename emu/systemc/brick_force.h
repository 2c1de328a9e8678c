// SPDX-License-Identifier: MIT
// The force engine of a node with a brick: one streamer walks the own cells and the candidates of each;
// lanes, queue, issue and pipes are those of any node. docs/reference/node.md, "Bricks".
#pragma once

#include <cstdint>
#include <vector>

#include "emu/systemc/force_machine.h"
#include "hw/arch/bricks.h"

namespace cuboct::emu {

// What a node with a brick holds.
struct BrickCells {
  std::vector<std::vector<Slot>> own;        // [local]
  std::vector<std::vector<Candidate>> halo;  // [grid]; coordinates in the record's own cell
};

class BrickForce final : public ForceMachine {
 public:
  // Keeps references to all four; writes `fault`.
  BrickForce(const Plan& plan, const BrickWalk& walk, const BrickCells& cells, FaultKeeper& fault)
      : ForceMachine(plan, cells.own.size(), fault), walk_(walk), cells_(cells) {}

  uint64_t run() override;

 private:
  struct Stream;
  void filter(Stream& stream) const;
  void present(Stream& stream, uint32_t own, const BrickWalk::Near& near) const;
  void issue(const Stream& stream, uint32_t entry, uint64_t& mask);

  const BrickWalk& walk_;
  const BrickCells& cells_;
};

}  // namespace cuboct::emu
