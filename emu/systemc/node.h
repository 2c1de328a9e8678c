// SPDX-License-Identifier: MIT
// The cycle-accurate node with native state: docs/reference/node.md to the letter, the datapath by the
// functions of model/fixed_rule.h. Values that only become visible later (sums, written-back slots) are
// computed at once where nothing can see them in between; the cycles are the specified ones.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "emu/systemc/force_engine.h"
#include "emu/systemc/node_model.h"
#include "model/trace.h"

namespace cuboct::emu {

class Node : public NodeModel {
 public:
  // Keeps a reference to `plan`.
  Node(const Plan& plan, uint8_t has_link);

  void clock(const NodeInputs& in, NodeOutputs& out) override;
  uint64_t wakes_at() const override { return wakes_at_; }
  std::string doing() const override;
  Counters counters() const override;

 private:
  enum class Main : uint8_t {  // the first eight are those of Phase
    exchange_x,
    exchange_y,
    exchange_z,
    force,
    update,
    migrate_x,
    migrate_y,
    migrate_z,
    dump,
    idle
  };
  enum class Migrate : uint8_t { scan, end, take_low, take_high };
  // A face's receiving side.
  struct Receiver {
    int beat = 0;  // beats of the current record that have come
    Bits partial;
    std::vector<Slot> fifo;  // particles not yet popped, oldest at `popped`
    size_t popped = 0;
    uint64_t came = 0;       // cycle in which the last one of `fifo` came
  };

  void reset();
  int axis() const;
  bool linked(int face) const { return has_link_ >> face & 1; }
  bool can_load(int face) const { return can_load_ >> face & 1; }
  Bits& load(int face, bool end);
  uint8_t faces_of(int axis) const { return static_cast<uint8_t>(has_link_ & 3u << 2 * axis); }
  void load_end(int low);
  void load_slice(int face);

  Main after(Main phase) const;
  void enter(Main next);
  void finish_phase(Main next);
  void idle();
  void exchange();
  void force();
  void update();
  void finish_particles();
  void migrate();
  void scan();
  void take(int face, Migrate next, bool last);
  void dump();
  void receive(int face, const Beat& beat);
  const Candidate& relayed(int segment, int record) const;
  int relayed_size(int segment) const;

  const Plan& plan_;
  const uint8_t has_link_;
  const int axes_, capacity_, link_words_;
  FaultKeeper fault_;
  std::vector<Slot> own_;
  std::array<std::vector<Candidate>, kFaces> halo_;
  std::array<Receiver, kFaces> receiver_;
  // By face. Streams alternate: halo, migrate, halo, ...
  uint8_t migrating_ = 0, halo_end_ = 0, migrate_end_ = 0;
  ForceEngine engine_;

  Main main_ = Main::idle;
  Migrate migrate_ = Migrate::scan;
  uint32_t steps_ = 0, step_ = 0;
  uint8_t starting_ = 0;                     // phases whose first cycle is the next one to run
  int segment_ = 0, record_ = 0, beat_ = 0;  // exchange; `record_` and `beat_` also scan and dump
  bool sent_ = false;
  Bits word_;                // the record that is being sent
  uint64_t now_ = 0;         // the cycle that runs
  uint64_t phase_last_ = 0;  // the last cycle of FORCE or UPDATE, known from its start
  uint64_t wakes_at_ = 0;    // as wakes_at()
  int taking_ = 0;           // narrow memories: cycles until the particle is read that TAKE waits for
  size_t kept_ = 0;          // slots that SCAN has moved down
  uint8_t leaving_ = 0;      // bit a: `leaving_a`
  uint8_t valid_ = 0, can_load_ = 0;
  NodeOutputs* out_ = nullptr;  // of the cycle that runs, as is `control_`
  const Control* control_ = nullptr;
  uint64_t link_waits_ = 0, beats_ = 0;
};

// Nodes of one cell, or with the plan's brick (brick_node.h).
NodeFactory native_nodes(const Plan& plan);

}  // namespace cuboct::emu
