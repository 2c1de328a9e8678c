// SPDX-License-Identifier: MIT
// Faults on the wires between nodes, outside what checks the links: one beat is changed, lost or repeated, or
// one acknowledgement changed. Which beat meets which fault is a hash of (seed, wire, number of the beat), so
// it depends on no order of evaluation and is the same for every node implementation.
// docs/reference/links.md.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "emu/machine/node_model.h"
#include "hw/plan/plan.h"

namespace cuboct::emu {

enum class FaultKind : uint8_t { none, flip, drop, repeat, ack };

// One beat, or with FaultKind::ack one acknowledgement, of a run.
struct FaultTarget {
  uint32_t node = 0;  // the sender of the beat
  int face = 0;       // of the sender
  uint64_t beat = 0;  // counted from 0 on that wire
  FaultKind kind = FaultKind::none;
};

struct FaultOptions {
  double rate = 0;     // share of beats and acknowledgements that meet a fault, [0, 1]
  uint64_t count = 0;  // ... or how many in the run, spread evenly; 0: `rate` holds
  FaultTarget target;  // with a kind: this one alone
  uint64_t seed = 1;
  // Shares of the kinds among faults; what has none is left out.
  uint32_t flips = 1, drops = 1, repeats = 1, acks = 1;
  bool enabled() const { return rate > 0 || count > 0 || target.kind != FaultKind::none; }
};

struct FaultCounts {
  uint64_t flips = 0, drops = 0, repeats = 0, acks = 0;
  uint64_t detected = 0;  // told by the node at either end of the wire
  uint64_t healed = 0;    // detected, and the same beat then went through; a repeated one was dropped
  uint64_t injected() const { return flips + drops + repeats + acks; }
};

// The first fault of a run, where it stood.
struct FaultPlace {
  uint64_t cycle = 0;
  uint32_t node = 0;  // the sender
  int face = 0;       // of the sender
};

// Cycles that a bench goes on after the run, so that a fault of its last beats is told.
inline constexpr int kAftermath = 32;

// What all wires of a run share.
class FaultSource {
 public:
  // `state`: at the start, from which the number of beats per step is told. Keeps a reference to `plan`.
  FaultSource(const Plan& plan, const FaultOptions& options, const State& initial, uint64_t steps);
  bool enabled() const { return options_.enabled() && open_; }
  void close() { open_ = false; }  // no faults from now on
  const FaultCounts& counts() const { return counts_; }
  const FaultPlace& first() const { return first_; }
  Counters counters() const;

 private:
  friend class FaultyWire;
  void begin(uint64_t cycle);
  const Plan& plan_;
  const FaultOptions options_;
  // Of a hash of 64 bits. For a count it is set anew in each cycle, as in Knuth's selection sampling (The Art
  // of Computer Programming, 3.4.2, algorithm S): those left over the beats left.
  uint64_t threshold_ = 0;
  uint64_t cycle_ = kNever;
  double expected_ = 0;  // beats and acknowledgements of the run
  uint64_t seen_ = 0;    // of them
  bool open_ = true;
  FaultCounts counts_;
  FaultPlace first_;
};

// One direction of a link with its acknowledgements. In each cycle both ends see it through `look`.
class FaultyWire {
 public:
  // What is true of the wire in a cycle, or what its ends see.
  struct View {
    bool valid = false;  // the receiver sees a beat
    const Beat* beat = nullptr;
    bool ready = false;  // the sender sees that the receiver is ready
    uint16_t ack = 0;    // the sender sees this acknowledgement
  };
  FaultyWire(FaultSource& source, uint32_t node, int face) : source_(source), node_(node), face_(face) {}

  // Both ends call it, with the same arguments in a cycle; cycles ascend.
  const View& look(uint64_t cycle, const View& truth);
  // The receiver will be shown a beat that the wire does not hold.
  bool repeats() const { return repeat_; }
  // One of the ends found something wrong with the beats, or with the acknowledgements, of this wire.
  void detected();

 private:
  FaultKind draw(uint64_t cycle, bool ack);
  FaultKind choose(uint64_t number, bool ack, uint64_t dice) const;
  void flip(uint64_t dice);
  void pass(uint64_t cycle, const View& truth);
  uint32_t sequence(const Beat& beat) const;

  FaultSource& source_;
  const uint32_t node_;
  const int face_;
  uint64_t cycle_ = kNever;
  View view_;
  Beat other_;  // what the receiver sees instead
  bool repeat_ = false;
  uint64_t beats_ = 0, acks_ = 0;
  uint16_t last_ack_ = 0;
  // The fault that is not over yet; one at a time where links are checked.
  FaultKind open_ = FaultKind::none;
  uint32_t sequence_ = 0;
  bool detected_ = false;
};

// The wires of a run by sender * 6 + face; none without faults.
struct FaultyWires {
  FaultyWires(const Plan& plan, const FaultOptions& options, const State& initial, uint64_t steps);
  FaultyWire* at(uint32_t node, int face) const {
    return wires.empty() ? nullptr : wires[node * kFaces + static_cast<uint32_t>(face)].get();
  }
  // What a node told of a cycle.
  void heed(const Plan& plan, uint32_t node, const NodeOutputs& out);
  FaultSource source;
  std::vector<std::unique_ptr<FaultyWire>> wires;
};

// Beats and end beats that all links carry in a step in which nothing moves.
uint64_t beats_per_step(const Plan& plan, const State& state);

}  // namespace cuboct::emu
