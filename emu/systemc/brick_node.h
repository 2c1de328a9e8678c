// SPDX-License-Identifier: MIT
// The cycle-accurate node that serves a brick of cells: docs/reference/node.md, "Bricks", to the letter.
#pragma once

#include <array>
#include <deque>
#include <vector>

#include "emu/systemc/brick_force.h"
#include "emu/systemc/node_machine.h"

namespace cuboct::emu {

class BrickNode final : public NodeMachine {
 public:
  // Keeps a reference to `plan`. `node`: the physical one.
  BrickNode(const Plan& plan, uint32_t node, uint8_t has_link);

 private:
  enum class Migrate : uint8_t { scan, end, wait, land };
  // A particle between two cells of the node, or on its way in.
  struct Mover {
    uint32_t to;
    Slot slot;
  };

  void reset() override;
  void append(uint32_t cell, const Slot& slot) override { cells_.own[cell].push_back(slot); }
  void begin() override;
  void exchange() override;
  void update() override;
  void migrate() override;
  void dump() override;
  void clear_halos() override;
  void take_particle(int face, std::span<const uint64_t> record) override;
  void take_halo(int face, int round, std::span<const uint64_t> record) override;
  uint8_t awaited() const override;

  bool walk_on(size_t count);
  uint32_t walked() const { return walk_.own[place_]; }
  void observe(const Slot& slot);
  uint8_t pass_faces() const;
  void end_pass();
  void scan();
  bool leave(uint32_t local, const Slot& slot);
  void wait();
  void land();
  void settle(uint32_t local, std::deque<Mover>& from);
  size_t landing(uint32_t local) const;
  void mark(uint32_t local, const Slot& slot, int first_axis);

  const uint32_t node_;
  const Cell extent_;
  const BrickGrid grid_;
  const BrickWalk walk_;
  BrickCells cells_;
  std::array<std::deque<Mover>, kFaces> inbox_;  // particles that have not landed
  std::array<std::deque<Mover>, 2> inner_;       // movers within the brick: from below, from above

  Migrate migrate_ = Migrate::scan;
  int pass_ = 0;                  // exchange: 0 to the low face or both, 1 to the high one
  size_t place_ = 0;              // of the walk: a cell
  size_t record_ = 0;             // ... and a record in it
  size_t kept_ = 0;               // slots of the cell that SCAN has moved down
  std::vector<uint8_t> leaving_;  // [local] bit a: `leaving_a`
};

}  // namespace cuboct::emu
