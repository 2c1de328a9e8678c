// SPDX-License-Identifier: MIT
// Runs the rounds of a program over particles: golden's inner loops, a block of lanes at a time.
#pragma once

#include <span>
#include <vector>

#include "model/contract/state.h"
#include "model/graph/interpret.h"
#include "model/graph/program.h"

namespace cuboct {

// A particle as a graph reads it. `fields`: its numbers of FixedProgram::fields; null where there are none.
// `bond`, `bond_constants`: those of the bond to who looks, as that one keeps them.
struct Seen {
  const Particle* particle = nullptr;
  Int3 x{};  // visible, in the frame of the cell of who looks
  const int64_t* fields = nullptr;
  int64_t* bond = nullptr;
  const int64_t* bond_constants = nullptr;
};

// Whether the bond counts no more.
bool is_broken(const graph::FixedProgram& program, const Seen& bond);

// Pairs of one particle and its partners. Only the nodes that `when` needs are computed of all of them; those
// that count then move together, and the rest is computed of these.
class PairRun {
 public:
  // The values of a pair law stay in the nearest cache.
  static constexpr size_t kPairRoom = 128;
  // `room`: pairs that are computed together.
  PairRun(const graph::FixedProgram& program, const graph::Round& round, uint64_t step,
          size_t room = kPairRoom);
  void at_step(uint64_t step) { step_ = step; }

  // Adds the terms of all partners, but of `own` itself, to `sums`: all components of all sums. Writes what
  // the round makes of their bonds.
  void add(const Seen& own, std::span<const Seen> partners, std::span<int64_t> sums);
  // Of the last add(): the pairs that counted; of each pair its first fault.
  uint64_t counted() const { return counted_; }
  const std::vector<graph::LaneFault>& faults() const { return faults_; }

 private:
  void fill(const std::vector<int>& inputs, const Seen& own, std::span<const Seen> partners,
            std::span<const uint32_t> chosen);
  void add_block(const Seen& own, std::span<const Seen> partners, std::span<int64_t> sums);

  const graph::FixedProgram& program_;
  const graph::Round& round_;
  const graph::Graph& graph_;
  uint64_t step_;
  size_t room_;
  int when_;
  std::vector<int> terms_;
  // Nodes that `when` needs, and those that the terms need besides; inputs apart. What both need is kept.
  std::vector<int> early_inputs_, early_, late_inputs_, late_, kept_;
  graph::Block<int64_t> block_;
  std::vector<uint32_t> chosen_;
  uint64_t counted_ = 0;
  std::vector<graph::LaneFault> faults_;
};

// The finish of one particle after another, as lanes.
class FinishRun {
 public:
  static constexpr size_t kRoom = 64;
  FinishRun(const graph::FixedProgram& program, const graph::Round& round, uint64_t step,
            size_t room = kRoom);
  void at_step(uint64_t step) { step_ = step; }

  // At most `room` particles; `sums` has all components of each in turn.
  void run(std::span<const Seen> particles, std::span<const int64_t> sums);
  int64_t value(int node, size_t lane) { return block_.values(node)[lane]; }
  const std::vector<graph::LaneFault>& faults() const { return block_.faults(); }

 private:
  const graph::FixedProgram& program_;
  const graph::Round& round_;
  uint64_t step_;
  std::vector<int> nodes_;
  graph::Block<int64_t> block_;
};

}  // namespace cuboct
