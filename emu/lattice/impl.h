// SPDX-License-Identifier: MIT
// The parts of the lattice engine: engine.cpp (in and out), step.cpp (one step), program_step.cpp (of a rule
// that is text), lists.cpp (neighbour search and near lists), share.cpp (what each rank stores).
#pragma once

#include <optional>

#include "emu/lattice/engine.h"
#include "emu/lattice/kernel.h"
#include "emu/lattice/members.h"
#include "emu/lattice/pair_list.h"
#include "emu/lattice/quiet.h"
#include "emu/lattice/ranks.h"
#include "emu/lattice/rounds/rounds.h"
#include "model/base/parallel.h"

namespace cuboct::emu {

// Of an array.
struct Stretch {
  size_t begin, end;
};

struct LatticeEngine::Impl {
  Impl(const Plan& plan, uint64_t step, uint32_t count, const LatticeOptions& options);
  void fill(const std::function<Particle(uint32_t)>& particle);
  void fill_fields(const std::vector<int64_t>& fields);
  // Of everyone, on rank 0: fields by id, bonds in the order of State::bonds, whose beginnings give_bonds
  // adds.
  std::vector<int64_t> fields() const;
  void give_bonds(State& state) const;
  Particle particle(uint32_t index) const;
  template <typename See>
  void for_each_index(const See& see) const {
    for (const Block& block : blocks_)
      for (uint32_t p = block.begin; p < block.end; ++p) see(p);
  }
  template <typename Work>
  void for_each_block(const Work& work) {
    for_each_part(blocks_.size(), threads_, [&](size_t b, int) { work(blocks_[b]); });
  }
  size_t number_of(const Block& block) const { return static_cast<size_t>(&block - blocks_.data()); }
  std::vector<Particle> everyone() const;  // sorted by id; of all ranks, on rank 0
  uint64_t program_hash() const;           // of this rank's own

  // step.cpp
  void step();
  void take_pairs();
  void clear_blocks();
  void forces_and_update(const Active& active);
  bool sum_pairs();
  std::vector<Int3> kicks();
  // of(index) of all particles, by id, on rank 0.
  std::vector<Int3> by_id(const std::function<Int3(uint32_t)>& of) const;
  std::vector<Crossing> all_crossings() const;
  RunError error(Fault fault, uint32_t cell, uint32_t id, int64_t number) const;
  void fail_if_any(std::vector<RunError> faults) const;
  void fail_if_any(std::vector<Found> Block::*faults) const;

  // program_step.cpp
  void run_rounds();
  bool failed() const;  // in some block of this rank
  void take_rounds();
  void look_ahead();
  void change_places();
  std::vector<Int3> next_velocities();
  void compile_rounds();
  void take_kept_code();
  void compile_if_worth();
  std::vector<PaddedArray<double>*> halo_of_round(size_t k);
  // Numbers that stand by id, of own particles: those of other ranks come to rank 0.
  void gather(std::vector<int64_t>& numbers, const std::function<Stretch(uint32_t id)>& of) const;
  Stretch fields_of(uint32_t id) const;
  Stretch bonds_of(uint32_t id) const;

  // lists.cpp
  void refresh_lists();
  void build();
  bool mend();
  void prune(double skin);
  double displacement() const;
  template <typename See>
  void for_each_moved(const See& see) const;
  bool crystal() const;
  void find_group_cells();
  void widen_group_cells(uint32_t index);
  double reach_of_step() const;  // cells that a particle can have moved in the last step

  // share.cpp
  bool shared() const { return options_.ranks != nullptr && options_.ranks->size() > 1; }
  std::shared_ptr<const graph::BondRows> rows_of_bonds() const;  // null: the program has none
  void own_cells();
  static void check_room(uint64_t particles);  // InputError where one process cannot hold them
  void make_room(uint32_t stored, uint32_t ghosts);
  void cut_blocks(std::vector<Block>& blocks, uint32_t begin, uint32_t end) const;
  void wrap();
  void store_by_cell();
  void redistribute();
  std::vector<PaddedArray<double>*> halo();
  void start_halo(const std::vector<PaddedArray<double>*>& arrays);
  void finish_halo(const std::vector<PaddedArray<double>*>& arrays);
  void exchange(const std::vector<PaddedArray<double>*>& arrays);

  const Plan& plan_;
  const Lattice& lattice_;
  LatticeOptions options_;
  KernelRule rule_;
  Kernels kernels_;
  std::optional<graph::FixedProgram> own_program_;  // of a pair law in cells that are no cubes
  std::optional<Rounds> rounds_;                    // of a program; else the kernels step the pair law
  uint64_t interpreted_ = 0;                        // entries that rounds_ met so far
  // Of a program, while some look at the step to come: what particles and bonds have after it. What it told
  // stands in the blocks.
  struct Ahead {
    std::array<PaddedArray<double>, 3> x, v, u;
    std::array<PaddedArray<int32_t>, 3> residue;
    std::vector<PaddedArray<double>> fields;
    std::vector<Sums> bonds;
  };
  std::optional<Ahead> ahead_;
  bool may_compile_ = true;
  double cutoff_;  // cells
  int threads_;
  uint64_t step_;
  uint32_t count_;       // particles of all ranks
  uint32_t stored_ = 0;  // places for this rank's own; ghosts stand behind them
  Particles particles_;
  PaddedArray<uint32_t> cell_;  // by index; empty where the index is the id
  Index index_;
  std::vector<Block> blocks_;  // those without ghosts first
  Members members_;
  Rows rows_;
  Snapshot snapshot_;
  std::optional<Quiet> quiet_;
  std::vector<Leaving> leaving_;
  LatticeCounters counters_;

  // With another rank: own particles (indices) that it sees as ghosts, and the places of its own that are
  // ghosts here.
  struct Peer {
    std::vector<uint32_t> give;
    uint32_t take_from = 0, take_count = 0;
    std::vector<double> out, in;
  };
  std::vector<uint16_t> owner_;  // by cell, its rank
  std::vector<CellSet> reach_;   // by rank: cells whose particles it may need
  std::vector<Peer> peers_;

  bool listed_ = false;
  double skin_;                            // cells
  double moved_ = 0;                       // cells: no particle is farther from where the far list found it
  double near_skin_ = 0, near_moved_ = 0;  // the same of the near list
  double near_floor_ = -1;                 // all groups were pruned with at least this skin
  double fastest_ = 0;                     // largest |v| after the last step, P+G fractional bits
  uint64_t listed_at_ = 0;                 // step

  // By index, where somebody asked for them before the step: it updates by these.
  std::vector<Int3> sums_;
  bool summed_ = false;
};

}  // namespace cuboct::emu
