// SPDX-License-Identifier: MIT
// What all cycle-accurate nodes with native state have in common, whatever they hold: the walk through the
// phases, link registers, streams, faults. docs/reference/node.md to the letter, the datapath by the
// functions of model/contract/fixed_rule.h. Values that only become visible later (sums, written-back slots)
// are computed at once where nothing can see them in between; the cycles are the specified ones.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "emu/machine/node_model.h"
#include "emu/systemc/fault_keeper.h"
#include "emu/systemc/force_machine.h"
#include "model/trace/trace.h"

namespace cuboct::emu {

class NodeMachine : public NodeModel {
 public:
  void clock(const NodeInputs& in, NodeOutputs& out) final;
  uint64_t wakes_at() const final { return wakes_at_; }
  std::string doing() const final;
  Counters counters(uint64_t) const final;

 protected:
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

  // Keeps a reference to `plan`. The constructor that calls this one makes `engine_`.
  NodeMachine(const Plan& plan, uint8_t has_link);

  static constexpr uint8_t bit(int i) { return static_cast<uint8_t>(1u << i); }
  // `left_x` and `full_x` for another axis.
  static constexpr Fault along(Fault x, int axis) {
    return static_cast<Fault>(static_cast<int>(x) + 2 * axis);
  }
  int rounds() const { return static_cast<int>(plan_.rounds.size()); }
  bool last_round() const { return round_ + 1 == rounds(); }
  // Of phase_start_o, phase_end_o.
  uint32_t phase_bit(Main phase) const {
    return 1u << phase_index(static_cast<Phase>(phase), round_, rounds());
  }
  // Faces whose halo stream of this round has ended.
  uint8_t halo_ended() const { return halo_end_[round_ % 2]; }
  int axis() const { return static_cast<int>(main_) % 5; }  // exchange_* are 0...2, migrate_* are 5...7
  bool linked(int face) const { return has_link_ >> face & 1; }
  bool migrates() const { return main_ >= Main::migrate_x && main_ <= Main::migrate_z; }
  // The linked ones.
  uint8_t faces_of(int axis) const { return static_cast<uint8_t>(has_link_ & 3u << 2 * axis); }

  // Whether all these faces can load in this cycle; if not, it counts as one of waiting.
  bool can_load(uint8_t faces);
  // The register of a linked face, for what is loaded in this cycle; zeros.
  Bits& load(int face, bool end);
  // Packs a particle, for the host to see, or as `word_`.
  void show(const Slot& slot);
  void take_up(const Slot& slot);
  // Loads beat `beat_` of `word_`, where there is a link.
  void load_slice(int face);
  // Loads end beats, if all the faces can; whether it did.
  bool load_ends(uint8_t faces);
  // Whether all these faces' registers were empty at the cycle's start.
  bool empty(uint8_t faces) const { return (faces & full_) == 0; }

  void count_relayed(bool own) { ++relayed_, relayed_own_ += own; }

  void enter(Main next);
  void finish_phase(Main next);
  Main after(Main phase) const;
  // The last cycle of MIGRATE_a.
  void finish_migration();
  // Takes the sum of slot `index` of an own cell and puts the results of UPDATE there.
  void finish_slot(Slot& slot, uint32_t cell, size_t index);

  // What the nodes differ in. The first clears all that the node holds; a derived one calls the base's.
  virtual void reset();
  virtual void append(uint32_t cell, const Slot& slot) = 0;  // by the host
  // Prepares the node's own registers for the phase `main_`, whose first cycle is the next one. Of UPDATE it
  // sets `phase_last_`.
  virtual void begin() = 0;
  // A cycle of the phase; of EXCHANGE_a until `sent_`. Where halos are used on arrival, every cycle: the node
  // walks beside the phases and ends them.
  virtual void exchange() = 0;
  virtual void update() = 0;
  virtual void migrate() = 0;
  virtual void dump() = 0;
  virtual void clear_halos() = 0;
  // A record that has come over a face in this cycle: a particle, or one of its halo.
  virtual void take_particle(int face, std::span<const uint64_t> record) = 0;
  virtual void take_halo(int face, int round, std::span<const uint64_t> record) = 0;
  // The end beat of a face's halo stream has come in this cycle.
  virtual void take_halo_end(int) {}
  // Faces whose particles MIGRATE_a waits for, for doing().
  virtual uint8_t awaited() const = 0;

  const Plan& plan_;
  const uint8_t has_link_;
  const int axes_, capacity_;
  FaultKeeper fault_;
  std::unique_ptr<ForceMachine> engine_;
  Main main_ = Main::idle;
  int round_ = 0;
  // By face; of halos by the round's parity, as a neighbour may be a round ahead.
  std::array<uint8_t, 2> halo_end_{};
  uint8_t migrate_end_ = 0;
  int beat_ = 0;                // of `word_`, the record that is being sent
  bool sent_ = false;           // EXCHANGE_a has loaded its end beats
  uint64_t now_ = 0;            // the cycle that runs
  uint64_t phase_last_ = 0;     // the last cycle of FORCE or UPDATE, known from its start
  uint64_t wakes_at_ = 0;       // as wakes_at()
  NodeOutputs* out_ = nullptr;  // of the cycle that runs
  Word word_;
  // Records read to send them on, slots read by SCAN, particles that left over a link or for another own
  // cell.
  uint64_t relayed_ = 0, relayed_own_ = 0, scanned_ = 0, left_ = 0, inner_moves_ = 0;

 private:
  // A record of several beats on its way in.
  struct Assembly {
    int beat = 0;  // that have come
    Word partial;
  };

  void idle(const Control& host);
  void await_halos();
  void force();
  void receive(int face, const Beat& beat);

  const int link_words_;
  std::array<Assembly, kFaces> assembly_;
  // Of the stream that comes over a face: its round, or their number in a migration.
  std::array<uint8_t, kFaces> stream_{};
  uint32_t starting_ = 0;  // phases whose first cycle is the next one to run
  uint8_t valid_ = 0, can_load_ = 0;
  uint8_t full_ = 0;  // link registers that held a beat at the cycle's start
  uint32_t steps_ = 0, step_ = 0;
  uint64_t all_steps_ = 0;  // since the reset
  uint64_t link_waits_ = 0, beats_ = 0, updates_ = 0, moved_ = 0;
  std::array<uint64_t, 3> halos_{};  // records that came, by axis
};

}  // namespace cuboct::emu
