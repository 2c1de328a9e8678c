// SPDX-License-Identifier: MIT
// The engine for real scenes: golden's bits from vector units and threads.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "emu/lattice/ranks.h"
#include "emu/timing/slots.h"
#include "hw/plan/plan.h"
#include "model/contract/state.h"

namespace cuboct::emu {

// How a rule of text runs its pairs: interpreted, compiled by the host's compiler before the first step, or
// (automatic) compiled once the run has lasted. No bit depends on it.
enum class RuleCode { automatic, interpreted, compiled };

struct LatticeOptions {
  int threads = 0;         // 0: one per core that the process may use, fewer for small scenes
  bool quiescence = true;  // cells at rest among cells at rest are skipped; no bit depends on it
  std::string simd;        // "avx512", "avx2", "128-bit", "portable"; empty: the widest that this machine has
  Ranks* ranks = nullptr;  // who shares the scene; null: nobody. Must outlive the engine
  std::string cut = "bricks";  // how: see cut.h
  RuleCode rule_code = RuleCode::automatic;
  std::string code_directory = {};  // of compiled code; empty: cache_directory()
};

// What a run did so far.
struct LatticeCounters {
  uint64_t list_builds = 0;       // of the far pair list
  uint64_t list_mends = 0;        // of parts of it
  uint64_t near_lists = 0;        // taken from the far list
  uint64_t near_parts = 0;        // of those, taken only where something had changed
  uint64_t sorts = 0;             // builds for which particles were stored anew by cell
  uint64_t node_steps = 0;        // cells times steps
  uint64_t quiet_node_steps = 0;  // of those, cells whose particles and neighbours did not change in the step
                                  // before: their clock could stand still (quiescence on)
  uint64_t compiled_steps = 0;    // of a rule of text: taken by compiled code
};

// What a program keeps of particles, by id, and of bonds, in the order of its rows.
struct ProgramNumbers {
  std::vector<int64_t> fields, bonds;
};

// Where ranks share the scene, every call but the plain getters is collective.
class LatticeEngine {
 public:
  // `particle(k)`, k = 0 ... count-1, is called once each in this order (twice with ranks): no second copy of
  // the state is held. Ids are 0 ... count-1. Particles of one cell take its slots in the order in which they
  // come (by id at the start of a run; in the order of for_each_slot when a run resumes). `kept`: what the
  // plan's program keeps besides; the engine steps that program. `plan` must outlive the engine. Throws
  // RunError where a cell would hold more than its capacity, InputError where `simd` is not to be had, or a
  // program not to be run.
  LatticeEngine(const Plan& plan, uint64_t step, uint32_t count,
                const std::function<Particle(uint32_t)>& particle, const LatticeOptions& options,
                const ProgramNumbers& kept = {});
  ~LatticeEngine();
  LatticeEngine(const LatticeEngine&) = delete;
  LatticeEngine& operator=(const LatticeEngine&) = delete;

  // Advances one step. Throws RunError, the same as golden's, at the first step that breaks a width, a
  // capacity or the lattice; the engine's state is lost then.
  void step();

  uint64_t step_count() const;
  uint32_t size() const;  // particles
  State state() const;    // sorted by id
  // By id, of all on rank 0: summed_kicks of the state, as the next step sums them. Empty where some kick
  // does not fit its width: the next step fails.
  std::vector<Int3> kicks();
  // Those of some particles (ids), as many as `to` holds; false where some kick does not fit. Not with ranks.
  bool kicks(std::span<const uint32_t> ids, std::span<Int3> to);
  // Of a program: those of Golden::next_velocities, of all on rank 0. The engine keeps the step that it takes
  // for that until step() asks for it.
  std::vector<Int3> next_velocities();
  Particle particle(uint32_t id) const;  // not with ranks
  double largest_speed() const;          // of this rank, along an axis: cells per step
  void for_each_slot(const std::function<void(const Particle&)>& see) const;  // by cell, then slot; of
                                                                              // all, on rank 0
  uint64_t hash() const;                                                      // hash_of(lattice, state())
  Int3 momentum() const;

  // For the timing model, without ranks: the particles by cell and slot, and those that left their cell in
  // the last step.
  void slots(CellSlots& out) const;
  std::span<const Leaving> leaving() const;

  const LatticeCounters& counters() const;
  int threads() const;
  const std::string& simd() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cuboct::emu
