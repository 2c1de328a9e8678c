// SPDX-License-Identifier: MIT
// Equality of two engines: bits, stops and cycles. Host times and counters are no part of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/contract/lattice.h"
#include "model/trace/trace.h"

namespace cuboct {

// The first place where two traces part.
struct Mismatch {
  enum class Kind : uint8_t {
    plan,     // the plans' hashes: the engines ran different machines
    nodes,    // number of nodes
    state,    // the state's hash after `step`, the first of those that both traces hashed
    length,   // one engine did fewer steps
    stop,     // why the run stopped
    cycles,   // a phase's start or end
    particle  // a field of a particle after `step`
  };
  Kind kind = Kind::plan;
  uint64_t step = 0;             // state, cycles, particle. In cycles: the step that begins with state `step`
  uint64_t equal_at = 0;         // state: the latest step before it at which both hashes are there and equal
  std::optional<uint32_t> node;  // cycles, of a step that both did
  uint32_t cell = kNoCell;       // particle (where a has it)
  uint64_t nodes = 0;            // cycles: of the machine; as many as cells, but where nodes serve several
  uint32_t particle = 0;         // particle
  std::string field;             // stop, cycles, particle: "fault", "force end", "v.y", ...
  std::string value_a, value_b;  // as text

  // One line, e.g. "step 13, cell 5 (1 2 0), particle 17, v.y: golden 120, rtl 121", or where steps in
  // between were not hashed "step 40 (equal at step 30), state hash: ...".
  std::string text(const std::string& engine_a, const std::string& engine_b, const Lattice& lattice) const;
};

// In this order: plans, nodes, state hashes at the steps that both traces hashed (Trace::hash_every), number
// of steps, stop reasons, cycles step by step (only where both engines count them).
std::optional<Mismatch> compare(const Trace& a, const Trace& b);

// Particle by particle in the order of ids, field by field: missing, type, cell, x, v, u, and what a program
// keeps besides.
std::optional<Mismatch> compare(const State& a, const State& b);

// The frame of that step; null where the trace has none.
const State* frame_at(const Trace& trace, uint64_t step);

// How many steps, 0 included, both traces hashed: at those `compare` looks at the states. All of them where
// it is a.steps() + 1.
uint64_t states_compared(const Trace& a, const Trace& b);

// Particle updates that `compare` found equal in two traces without a mismatch.
uint64_t updates_compared(const Trace& trace, uint64_t particles);

}  // namespace cuboct
