// SPDX-License-Identifier: MIT
// The cycle-accurate node of one cell: docs/reference/node.md.
#pragma once

#include <array>
#include <vector>

#include "emu/systemc/force_engine.h"
#include "emu/systemc/node_machine.h"

namespace cuboct::emu {

class Node final : public NodeMachine {
 public:
  // Keeps a reference to `plan`.
  Node(const Plan& plan, uint8_t has_link);

 private:
  enum class Migrate : uint8_t { scan, end, take_low, take_high };
  // What comes over a face in a migration.
  struct Inbox {
    std::vector<Slot> fifo;  // particles not yet popped, oldest at `popped`
    size_t popped = 0;
    uint64_t came = 0;  // cycle in which the last one of `fifo` came
  };

  void reset() override;
  void append(uint32_t cell, const Slot& slot) override;
  void begin() override;
  void exchange() override;
  void update() override;
  void migrate() override;
  void dump() override;
  void clear_halos() override;
  void take_particle(int face, const Bits& record) override;
  void take_halo(int face, const Bits& record) override;
  uint8_t awaited() const override;

  void scan();
  void take(int face, Migrate next, bool last);
  const Candidate& relayed(int segment, int record) const;
  int relayed_size(int segment) const;

  std::vector<Slot> own_;
  std::array<std::vector<Candidate>, kFaces> halo_;
  std::array<Inbox, kFaces> inbox_;
  Migrate migrate_ = Migrate::scan;
  int segment_ = 0, record_ = 0;  // exchange; `record_` also scan and dump
  int taking_ = 0;                // narrow memories: cycles until the particle is read that TAKE waits for
  size_t kept_ = 0;               // slots that SCAN has moved down
  uint8_t leaving_ = 0;           // bit a: `leaving_a`
};

// Nodes of one cell, or with the plan's brick (brick_node.h).
NodeFactory native_nodes(const Plan& plan);

}  // namespace cuboct::emu
