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
  void take_particle(int face, std::span<const uint64_t> record) override;
  void take_halo(int face, int round, std::span<const uint64_t> record) override;
  void take_halo_end(int face) override { times_.ended[static_cast<size_t>(face)] = now_; }
  uint8_t awaited() const override;

  // Where halos are used on arrival: a record, or an end beat, on its way through the relay.
  struct Relayed {
    enum class Kind : uint8_t { none, record, end } kind = Kind::none;
    int segment = 0;  // of a record; of an end beat the axis
    int record = 0;
  };
  void relay();
  Relayed ask();
  void next_segment();
  // Loads the end beats of a migration that begins with the next phase, if no own particle leaves along it.
  bool end_early(int axis);

  void take_later();
  void scan();
  void take(int face, Migrate next, bool last);
  const Candidate& relayed(int segment, int record) const;
  // Packs the record that is sent on in this round.
  void pack_relayed(int segment, int record, std::span<uint64_t> out) const;
  int relayed_size(int segment) const;

  std::vector<Slot> own_;
  std::array<std::vector<Candidate>, kFaces> halo_;
  // What came in later rounds, by the round's parity and face: a rule's numbers of each record.
  std::array<std::array<std::vector<std::vector<int64_t>>, kFaces>, 2> later_;
  std::array<Inbox, kFaces> inbox_;
  Migrate migrate_ = Migrate::scan;
  int segment_ = 0, record_ = 0;  // exchange; `record_` also scan and dump
  int taking_ = 0;                // narrow memories: cycles until the particle is read that TAKE waits for
  size_t kept_ = 0;               // slots that SCAN has moved down
  HaloTimes times_;
  Relayed asked_, sending_;   // of the relay: what the memories answer, what the links load
  int relay_axis_ = 0;        // the end beat, or the segment, that the relay is at belongs to
  bool ending_ = false;       // the axis's segments are done
  uint8_t sent_axes_ = 0;     // whose end beats are loaded
  uint64_t took_ = 0;         // cycle after that of the last particle that TAKE took
  bool ended_early_ = false;  // the next phase's end beats are loaded
  uint8_t leaving_ = 0;       // bit a: `leaving_a`
};

// Nodes of one cell, or with the plan's brick (brick_node.h).
NodeFactory native_nodes(const Plan& plan);

}  // namespace cuboct::emu
