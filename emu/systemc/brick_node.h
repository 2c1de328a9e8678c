// SPDX-License-Identifier: MIT
// The cycle-accurate node that serves a brick of cells: docs/reference/node.md, "Bricks", to the letter. As
// in node.h, values that only become visible later are computed at once where nothing can see them in
// between.
#pragma once

#include <array>
#include <deque>
#include <string>
#include <vector>

#include "emu/systemc/brick_force.h"
#include "emu/systemc/node_model.h"
#include "model/trace.h"

namespace cuboct::emu {

class BrickNode : public NodeModel {
 public:
  // Keeps a reference to `plan`. `node`: the physical one.
  BrickNode(const Plan& plan, uint32_t node, uint8_t has_link);

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
  enum class Migrate : uint8_t { scan, end, wait, land };
  // A particle between two cells of the node.
  struct Mover {
    uint32_t to;
    Slot slot;
  };
  // A face's receiving side.
  struct Receiver {
    int beat = 0;  // beats of the current record that have come
    Bits partial;
    std::deque<Mover> fifo;  // particles that have not landed
  };

  void reset();
  int axis() const { return static_cast<int>(main_) % 5; }
  bool linked(int face) const { return has_link_ >> face & 1; }
  bool can_load(int face) const { return can_load_ >> face & 1; }
  uint8_t faces_of(int axis) const { return static_cast<uint8_t>(has_link_ & 3u << 2 * axis); }
  Bits& load(int face, bool end);
  void load_slice(int face);

  Main after(Main phase) const;
  void enter(Main next);
  void finish_phase(Main next);
  bool walk_on(size_t count);
  uint32_t walked() const { return walk_.own[place_]; }
  void observe(const Slot& slot);
  void idle();
  void exchange();
  uint8_t pass_faces() const;
  void end_pass(uint8_t faces);
  void force();
  void update();
  void finish_particles();
  void migrate();
  void scan();
  void leave(uint32_t local, const Slot& slot);
  void wait();
  void land();
  void append(uint32_t local, std::deque<Mover>& from);
  size_t landing(uint32_t local) const;
  void mark(uint32_t local, const Slot& slot, int first_axis);
  void dump();
  void receive(int face, const Beat& beat);

  const Plan& plan_;
  const uint32_t node_;
  const uint8_t has_link_;
  const int axes_, capacity_, link_words_;
  const Cell extent_;
  const BrickGrid grid_;
  const BrickWalk walk_;
  FaultKeeper fault_;
  BrickCells cells_;
  std::array<Receiver, kFaces> receiver_;
  std::array<std::deque<Mover>, 2> inner_;  // movers within the brick: from below, from above
  // By face. Streams alternate: halo, migrate, halo, ...
  uint8_t migrating_ = 0, halo_end_ = 0, migrate_end_ = 0;
  BrickForce engine_;

  Main main_ = Main::idle;
  Migrate migrate_ = Migrate::scan;
  uint32_t steps_ = 0, step_ = 0;
  uint8_t starting_ = 0;  // phases whose first cycle is the next one to run
  int pass_ = 0;          // exchange: 0 to the low face or both, 1 to the high one
  size_t place_ = 0;      // of the walk: a cell
  size_t record_ = 0;     // ... and a record in it
  int beat_ = 0;
  bool sent_ = false;
  Bits word_;                     // the record that is being sent
  uint64_t now_ = 0;              // the cycle that runs
  uint64_t phase_last_ = 0;       // the last cycle of FORCE or UPDATE
  uint64_t wakes_at_ = 0;         // as wakes_at()
  size_t kept_ = 0;               // slots of the cell that SCAN has moved down
  std::vector<uint8_t> leaving_;  // [local] bit a: `leaving_a`
  uint8_t valid_ = 0, can_load_ = 0;
  NodeOutputs* out_ = nullptr;  // of the cycle that runs, as is `control_`
  const Control* control_ = nullptr;
  uint64_t link_waits_ = 0, beats_ = 0;
};

}  // namespace cuboct::emu
