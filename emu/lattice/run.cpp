// SPDX-License-Identifier: MIT
#include "emu/lattice/run.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "emu/timing/timing.h"
#include "hw/engine/engine_kind.h"
#include "hw/plan/setup.h"
#include "hw/plan/state_bounds.h"
#include "model/base/resources.h"
#include "model/run/state_engine.h"

namespace cuboct::emu {
namespace {

bool leads(const Ranks* ranks) { return ranks == nullptr || ranks->rank() == 0; }

std::pair<bool, bool> all_agree(Ranks* ranks, bool stop, bool save) {
  if (ranks == nullptr) return {stop, save};
  std::array<uint8_t, 2> asked{stop, save};
  ranks->any(asked);
  return {asked[0] != 0, asked[1] != 0};
}

int readers(const LatticeOptions& options) { return options.threads > 0 ? options.threads : usable_cores(); }

// Throws InputError where the timing model counts no cycles.
void check_timed(const Plan& plan, const Ranks* ranks) {
  if (const std::string why = machine_refusal(plan); !why.empty())
    throw InputError("--cycles: the timing model counts those of a machine, and " + why)
        .about({"box.size", "box.cells", "box", "particles.file", "rule.file", "rule"});
  if (ranks != nullptr && ranks->size() > 1)
    throw InputError("--cycles: the timing model runs on one rank alone");
}

class Runner : public StateEngine {
 public:
  Runner(const Scene& scene, const Plan& plan, const LatticeChoice& choice, CheckpointReader* from,
         bool cycles);

  uint64_t step_count() const override { return engine_->step_count(); }
  void advance(uint64_t steps, std::vector<uint64_t>*) override;
  uint64_t hash() override { return engine_->hash(); }
  Reading read(const Asked& asked) override;
  double largest_speed() override { return std::max(largest_speed_, StateEngine::largest_speed()); }
  Momentum momentum() override { return {engine_->momentum(), {}}; }
  std::vector<PhaseSpan> phase_times() override { return std::exchange(spans_, {}); }
  Counters counters() override;
  void for_each_slot(const std::function<void(const Particle&)>& see) override {
    engine_->for_each_slot(see);
  }
  EngineMemory memory() override;
  bool leads() const override { return emu::leads(ranks_); }
  std::pair<bool, bool> agreed(bool stop, bool save) override { return all_agree(ranks_, stop, save); }

 protected:
  State make_state() override { return engine_->state(); }
  std::vector<Int3> make_kicks() override { return failed_ ? std::vector<Int3>() : engine_->kicks(); }

 private:
  void feed(const Scene& scene, const LatticeChoice& choice, CheckpointReader* from);
  void step();

  const Plan& plan_;
  Ranks* const ranks_;
  std::unique_ptr<LatticeEngine> engine_;
  std::optional<TimingModel> timing_;
  bool failed_ = false;
  std::array<uint64_t, 3> earlier_{};  // counts of the runs before this one, up to the checkpoint
  CellSlots slots_;
  std::vector<PhaseSpan> spans_;
  double largest_speed_ = 0;  // cells per step, of the states that were read without being made
};

Runner::Runner(const Scene& scene, const Plan& plan, const LatticeChoice& choice, CheckpointReader* from,
               bool cycles)
    : StateEngine(setting_of(scene, plan, readers(choice.engine))), plan_(plan), ranks_(choice.engine.ranks) {
  if (cycles) check_timed(plan, ranks_);
  if (cycles) timing_.emplace(plan, choice.engine.threads);
  feed(scene, choice, from);
  if (!from) return;
  std::copy_n(from->head().engine.counters.begin(), earlier_.size(), earlier_.begin());
  if (timing_) timing_->resume(from->head().engine.own);
}

void Runner::feed(const Scene& scene, const LatticeChoice& choice, CheckpointReader* from) {
  if (!from && choice.spare && choice.spare->size() == 0) *choice.spare = choice.body_again();
  // One process alone takes each particle once: the body shrinks as the engine grows.
  const bool shrink = !from && choice.spare && (!ranks_ || ranks_->size() == 1);
  std::optional<InitialParticles> shrinking;
  if (shrink) shrinking.emplace(std::exchange(*choice.spare, {}), plan_);
  std::vector<bool> seen;
  const auto next = [&](uint32_t k) {
    if (k == 0 && from) from->rewind(), seen.assign(plan_.particles, false);  // ranks take them twice
    if (from) return checked_particle(*from, plan_, seen);
    if (choice.from) return choice.from->particles[k];
    return shrinking ? (*shrinking)(k)
                     : fixed_particle(scene.body, k, plan_.rule, plan_.lattice, plan_.origin);
  };
  const uint64_t step = from ? from->head().step : choice.from ? choice.from->step : 0;
  engine_ = std::make_unique<LatticeEngine>(plan_, step, plan_.particles, next, choice.engine);
  if (choice.spare) *choice.spare = {};
}

void Runner::advance(uint64_t steps, std::vector<uint64_t>*) {
  try {
    for (; steps > 0; --steps) step();
  } catch (const RunError&) {
    failed_ = true;
    throw;
  }
}

void Runner::step() {
  if (timing_) engine_->slots(slots_);
  engine_->step();
  if (!timing_) return;
  const size_t row = spans_of_step(plan_);
  spans_.resize(spans_.size() + row);
  timing_->step(slots_, engine_->leaving(), std::span(spans_).last(row));
}

// Probes ask for some particles: without a state of all.
Reading Runner::read(const Asked& asked) {
  if (asked.energies || !asked.stress.empty() || ranks_ || failed_) return StateEngine::read(asked);
  std::vector<Int3> kicks(asked.ids.size());
  if (takes_kicks(asked) && !engine_->kicks(asked.ids, kicks)) return StateEngine::read(asked);
  Reading reading;
  reading.step = step_count();
  const ParticleReader particles(plan_.rule, plan_.lattice, plan_.origin, asked);
  particles.make_room(asked.ids.size(), reading);
  for (size_t k = 0; k < kicks.size(); ++k) particles.add(engine_->particle(asked.ids[k]), kicks[k], reading);
  largest_speed_ = std::max(largest_speed_, engine_->largest_speed());
  return reading;
}

EngineMemory Runner::memory() {
  const LatticeCounters& now = engine_->counters();
  return {{earlier_[0] + now.list_builds, earlier_[1] + now.node_steps, earlier_[2] + now.quiet_node_steps},
          timing_ ? timing_->starts() : std::vector<uint64_t>()};
}

Counters Runner::counters() {
  Counters counters;
  if (timing_ && !failed_) {
    engine_->slots(slots_);
    counters.emplace_back("cycles", static_cast<double>(timing_->cycles(slots_)));
  }
  const std::vector<uint64_t> counts = memory().counters;
  const std::array<const char*, 3> names{"list_builds", "node_steps", "quiet_node_steps"};
  for (size_t k = 0; k < names.size(); ++k) counters.emplace_back(names[k], static_cast<double>(counts[k]));
  counters.emplace_back("threads", engine_->threads());
  return counters;
}

// A rule that is text.
class IntegerRunner : public IntegerEngine {
 public:
  // `cycles`: counts them; `clocks`: as IntegerEngine::clocks left them, or nothing.
  IntegerRunner(const Plan& plan, const State& from, const LatticeOptions& options, bool cycles = false,
                const std::vector<uint64_t>& clocks = {})
      : plan_(plan),
        engine_(
            plan, from.step, static_cast<uint32_t>(from.particles.size()),
            [&](uint32_t k) { return from.particles[k]; }, options, by_id(from)),
        ranks_(options.ranks) {
    if (!cycles) return;
    timing_.emplace(plan, options.threads);
    if (!clocks.empty()) timing_->resume(clocks);
  }

  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override {
    for (; steps > 0; --steps) {
      if (timing_) engine_.slots(slots_);
      failed_ = true;
      engine_.step();
      failed_ = false;
      if (timing_) {
        const size_t row = spans_of_step(plan_);
        spans_.resize(spans_.size() + row);
        timing_->step(slots_, engine_.leaving(), std::span(spans_).last(row));
      }
      if (hashes != nullptr) hashes->push_back(engine_.hash());
    }
  }
  uint64_t step_count() const override { return engine_.step_count(); }
  State state() const override { return engine_.state(); }
  uint64_t hash() const override { return engine_.hash(); }
  std::vector<Int3> next_velocities() override { return engine_.next_velocities(); }
  void for_each_slot(const std::function<void(const Particle&)>& see) const override {
    engine_.for_each_slot(see);
  }
  Counters counters() const override {
    const LatticeCounters& counts = engine_.counters();
    Counters all;
    if (timing_ && !failed_) {
      CellSlots slots;
      engine_.slots(slots);
      all.emplace_back("cycles", static_cast<double>(timing_->cycles(slots)));
    }
    all.insert(all.end(), {{"list_builds", static_cast<double>(counts.list_builds)},
                           {"node_steps", static_cast<double>(counts.node_steps)},
                           {"quiet_node_steps", static_cast<double>(counts.quiet_node_steps)},
                           {"compiled_steps", static_cast<double>(counts.compiled_steps)},
                           {"threads", engine_.threads()}});
    return all;
  }
  std::vector<PhaseSpan> phase_times() override { return std::exchange(spans_, {}); }
  std::vector<uint64_t> clocks() const override {
    return timing_ ? timing_->starts() : std::vector<uint64_t>();
  }
  bool leads() const override { return emu::leads(ranks_); }
  std::pair<bool, bool> agreed(bool stop, bool save) override { return all_agree(ranks_, stop, save); }

 private:
  static ProgramNumbers by_id(const State& state) {
    ProgramNumbers kept{std::vector<int64_t>(state.fields.size()), state.bonds};
    const size_t numbers = state.fields.size() / std::max<size_t>(1, state.particles.size());
    for (size_t k = 0; k < state.particles.size(); ++k)
      std::copy_n(state.fields.begin() + static_cast<ptrdiff_t>(k * numbers), numbers,
                  kept.fields.begin() + static_cast<ptrdiff_t>(state.particles[k].id * numbers));
    return kept;
  }

  const Plan& plan_;
  LatticeEngine engine_;
  Ranks* const ranks_;
  std::optional<TimingModel> timing_;
  bool failed_ = false;  // the last step
  CellSlots slots_;
  std::vector<PhaseSpan> spans_;
};

}  // namespace

RuleCode rule_code_of(const std::string& name) {
  return name == "compiled"      ? RuleCode::compiled
         : name == "interpreted" ? RuleCode::interpreted
                                 : RuleCode::automatic;
}

std::unique_ptr<IntegerEngine> integer_lattice(const Plan& plan, const State& from,
                                               const LatticeOptions& options) {
  return std::make_unique<IntegerRunner>(plan, from, options);
}

EngineKind lattice_kind(const Scene& scene, const Plan& plan, const LatticeChoice& choice) {
  EngineKind kind = fixed_kind("lattice", scene, plan);
  kind.threads = readers(choice.engine);
  kind.keeps_state = false;
  kind.saves = true;
  if (plan.program != nullptr) {
    kind.make = [&scene, &plan, &choice](CheckpointReader* from, bool cycles) {
      if (cycles) check_timed(plan, choice.engine.ranks);
      std::vector<uint64_t> clocks;
      if (from && cycles) {
        const std::vector<uint64_t>& own = from->head().engine.own;
        const size_t words = program_words(*plan.program, plan.particles);
        clocks.assign(own.begin() + static_cast<ptrdiff_t>(std::min(words, own.size())), own.end());
      }
      return integer_run(scene, plan, from, [&](const State& state) {
        return std::make_unique<IntegerRunner>(plan, state, choice.engine, cycles, clocks);
      });
    };
    return kind;
  }
  kind.make = [&scene, &plan, &choice](CheckpointReader* from, bool cycles) {
    return std::make_unique<Runner>(scene, plan, choice, from, cycles);
  };
  return kind;
}

Recorded run_lattice(const Scene& scene, const Plan& plan, const LatticeRun& request) {
  const LatticeChoice choice{.engine = request.engine};
  return record(scene, lattice_kind(scene, plan, choice), request);
}

}  // namespace cuboct::emu
