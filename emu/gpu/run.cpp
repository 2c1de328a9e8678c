// SPDX-License-Identifier: MIT
#include "emu/gpu/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "emu/gpu/rounds/nvrtc.h"
#include "emu/gpu/rounds/rounds_engine.h"
#include "emu/gpu/text_run.h"
#include "hw/engine/engine_kind.h"
#include "model/base/resources.h"
#include "model/contract/pair_program.h"
#include "model/program/integer_program.h"
#include "model/rules/rounds_rule.h"
#include "model/run/state_engine.h"

namespace cuboct::gpu {
namespace {

class Runner : public cuboct::Engine {
 public:
  Runner(const Scene& scene, const Plan& plan, const GpuChoice& choice, CheckpointReader* from);

  uint64_t step_count() const override { return engine_->step_count(); }
  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override;
  uint64_t hash() override { return engine_->hash(); }
  RunState frame(bool forces) override;
  cuboct::Reading read(const Asked& asked) override;
  Momentum momentum() override;
  double largest_speed() override;
  cuboct::Counters counters() override;
  Notes notes() override { return notes_; }
  void for_each_slot(const std::function<void(const Particle&)>& see) override {
    if (fixed())
      for (const Particle& particle : engine_->state().particles) see(particle);
  }
  EngineMemory memory() override;

 private:
  bool fixed() const { return choice_.arithmetic == Arithmetic::fixed; }
  void begin_fixed(CheckpointReader* from);
  void begin_real(CheckpointReader* from);
  void probe(std::span<const uint32_t> ids);
  std::vector<Mat3> stress(std::span<const AskedStress> sets);
  void show(Watch& watch, const Energies& energies);
  Momentum momentum_of(const std::vector<Vec3>& v) const;

  const Scene& scene_;
  const Plan& plan_;
  const GpuChoice& choice_;
  std::unique_ptr<gpu::Engine> engine_;
  std::vector<uint32_t> probed_;
  // Of the last state that came to the host, and of the start.
  uint64_t known_ = 0;
  Momentum momentum_;
  double largest_speed_ = -1;  // m/s; below 0: not read yet
  Notes notes_;
  uint64_t builds_before_ = 0, golden_before_ = 0;  // of the runs before this one, up to the checkpoint
};

void Runner::begin_fixed(CheckpointReader* from) {
  const State initial = begin_of(scene_, plan_, from);
  momentum_.fixed = cuboct::momentum(plan_.rule, initial);
  known_ = initial.step;
  engine_ = make_fixed_engine(scene_, plan_, initial, choice_.engine);
}

void Runner::begin_real(CheckpointReader* from) {
  momentum_ = momentum_of(scene_.body.v);
  const GpuChoice& of = choice_;
  try {
    engine_ = from ? resume_real_engine(scene_, scene_.body, of.arithmetic, of.engine,
                                        {from->head().step, from->head().engine.own})
                   : make_real_engine(scene_, scene_.body, of.arithmetic, of.engine);
  } catch (const DamagedMemory& error) {
    throw InputError(fmt::format("{} is damaged: {}", from->path(), error.what()));
  }
}

Runner::Runner(const Scene& scene, const Plan& plan, const GpuChoice& choice, CheckpointReader* from)
    : scene_(scene), plan_(plan), choice_(choice) {
  if (from) {
    const EngineMemory& kept = from->head().engine;
    if (kept.own.empty() != fixed() ||
        (!fixed() && kept.counters[2] != static_cast<uint64_t>(choice.arithmetic)))
      refuse_another(*from);
    builds_before_ = kept.counters[0], golden_before_ = kept.counters[1];
  }
  fixed() ? begin_fixed(from) : begin_real(from);
  notes_.emplace_back("precision", to_string(choice.arithmetic));
  if (!fixed()) notes_.emplace_back("integrator", "semi-implicit Euler");
  if (choice.hooks.ready) choice.hooks.ready();
}

void Runner::advance(uint64_t steps, std::vector<uint64_t>* hashes) {
  const uint64_t before = step_count();
  const auto done = [&] {
    if (choice_.hooks.did) choice_.hooks.did(step_count() - before);
  };
  try {
    engine_->advance(steps, hashes);
  } catch (const RunError&) {
    done();
    throw;
  } catch (const LostPosition& error) {
    done();
    throw StepError({Fault::none, error.step, 0, error.particle, 0, error.what()});
  }
  done();
}

void Runner::probe(std::span<const uint32_t> ids) {
  if (std::equal(ids.begin(), ids.end(), probed_.begin(), probed_.end())) return;
  probed_.assign(ids.begin(), ids.end());
  engine_->probe(probed_);
}

RunState Runner::frame(bool forces) {
  known_ = step_count();
  if (fixed()) {
    State state = engine_->state();
    momentum_.fixed = cuboct::momentum(plan_.rule, state);
    return state;
  }
  Body body = engine_->body();
  momentum_ = momentum_of(body.v);
  RealFrame frame{step_count(), std::move(body.x), std::move(body.v), {}, std::move(body.u)};
  if (forces) {
    std::vector<uint32_t> all(frame.x.size());
    std::iota(all.begin(), all.end(), 0);
    probe(all);
    frame.force = engine_->read(false).force;
  }
  return frame;
}

cuboct::Reading Runner::read(const Asked& asked) {
  probe(asked.ids);
  gpu::Reading read = engine_->read(asked.energies);
  if (asked.energies) largest_speed_ = std::max(largest_speed_, read.largest_speed);
  cuboct::Reading reading{.step = read.step,
                          .x = std::move(read.x),
                          .force = std::move(read.force),
                          .v = std::move(read.v),
                          .energies = read.energies};
  if (asked.volume > 0) reading.stress = Mat3::Identity() * (-read.virial / (3 * asked.volume));
  if (!asked.stress.empty()) reading.stress_volume = stress(asked.stress);
  if (asked.watch) show(*asked.watch, read.energies);
  return reading;
}

// On the host.
std::vector<Mat3> Runner::stress(std::span<const AskedStress> sets) {
  Asked asked;
  asked.stress = sets;
  if (fixed())
    return read_state(scene_.rule, plan_.rule, plan_.lattice, plan_.origin, engine_->state(), asked, 0)
        .stress_volume;
  Body body = engine_->body();
  body.type = scene_.body.type;
  const Reference here(scene_.rule, body, scene_.periodic,
                       RealOptions{.threads = reference_threads(body.size())});
  return read_reference(scene_.rule, here, scene_.rule.dt / 2, asked).stress_volume;
}

// On the host.
void Runner::show(Watch& watch, const Energies& energies) {
  if (fixed()) {
    Asked asked;
    asked.energies = true;
    asked.watch = &watch;
    read_state(scene_.rule, plan_.rule, plan_.lattice, plan_.origin, engine_->state(), asked, 0);
    return;
  }
  Body body = engine_->body();
  body.type = scene_.body.type;
  RealOptions options;
  options.precision = choice_.arithmetic == Arithmetic::float32 ? Precision::float32 : Precision::float64;
  options.threads = reference_threads(body.size());
  const Reference here(scene_.rule, body, scene_.periodic, options);
  watch.see(step_count(), body, here.forces(), energies);
}

Momentum Runner::momentum_of(const std::vector<Vec3>& v) const {
  Vec3 sum = Vec3::Zero();
  for (size_t i = 0; i < v.size(); ++i) sum += scene_.rule.relative_mass(scene_.body.type[i]) * v[i];
  return {{}, scene_.rule.mass * sum};
}

Momentum Runner::momentum() {
  if (known_ != step_count()) frame(false);
  return momentum_;
}

double Runner::largest_speed() {
  if (largest_speed_ < 0) largest_speed_ = engine_->read(true).largest_speed;
  return largest_speed_ * scene_.rule.dt / plan_.rule.cell_edge;
}

EngineMemory Runner::memory() {
  const gpu::Counters& counts = engine_->counters();
  return {{builds_before_ + counts.list_builds, golden_before_ + counts.golden_steps,
           static_cast<uint64_t>(choice_.arithmetic)},
          fixed() ? std::vector<uint64_t>() : engine_->memory()};
}

cuboct::Counters Runner::counters() {
  const gpu::Counters& counts = engine_->counters();
  cuboct::Counters counters{{"list_builds", static_cast<double>(builds_before_ + counts.list_builds)}};
  if (fixed())
    counters.emplace_back("golden_steps", static_cast<double>(golden_before_ + counts.golden_steps));
  counters.emplace_back("longest_list", static_cast<double>(counts.longest_list));
  counters.emplace_back("listed_pairs", counts.listed_pairs);
  counters.emplace_back("halo_particles", static_cast<double>(counts.halo_particles));
  counters.emplace_back("device_bytes", static_cast<double>(counts.device_bytes));
  if (choice_.hooks.finish) choice_.hooks.finish(counters, notes_);
  return counters;
}

// A rule that is text, with who measures beside it.
class TextRunner : public IntegerEngine {
 public:
  TextRunner(std::unique_ptr<IntegerEngine> engine, const Hooks& hooks)
      : engine_(std::move(engine)), hooks_(hooks) {}

  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override {
    const uint64_t before = step_count();
    const auto done = [&] {
      if (hooks_.did) hooks_.did(step_count() - before);
    };
    try {
      engine_->advance(steps, hashes);
    } catch (const RunError&) {
      done();
      throw;
    }
    done();
  }
  uint64_t step_count() const override { return engine_->step_count(); }
  State state() const override { return engine_->state(); }
  uint64_t hash() const override { return engine_->hash(); }
  std::vector<Int3> next_velocities() override { return engine_->next_velocities(); }
  void for_each_slot(const std::function<void(const Particle&)>& see) const override {
    engine_->for_each_slot(see);
  }
  cuboct::Counters counters() const override {
    cuboct::Counters counters = engine_->counters();
    notes_ = engine_->notes();
    notes_.emplace_back("precision", to_string(Arithmetic::fixed));
    if (hooks_.finish) hooks_.finish(counters, notes_);
    return counters;
  }
  Notes notes() const override { return notes_; }

 private:
  std::unique_ptr<IntegerEngine> engine_;
  const Hooks& hooks_;
  mutable Notes notes_;
};

Plan with_pair_program(Plan plan) {
  auto program = std::make_shared<IntegerProgram>();
  program->program = pair_program(plan.rule, plan.arch.capacity);
  plan.program = std::move(program);
  return plan;
}

// A pair law in cells that are no cubes, which its program knows.
class PairProgramRun : public StateEngine {
 public:
  PairProgramRun(const Scene& scene, const Plan& plan, const GpuChoice& choice, CheckpointReader* from)
      : StateEngine(setting_of(scene, plan)),
        plan_(with_pair_program(plan)),
        engine_(make_rounds_engine(plan_, begin_of(scene, plan, from), choice.engine,
                                   rounds_compiler(choice.interpret)),
                choice.hooks) {
    if (choice.hooks.ready) choice.hooks.ready();
  }

  uint64_t step_count() const override { return engine_.step_count(); }
  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override { engine_.advance(steps, hashes); }
  uint64_t hash() override { return engine_.hash(); }
  cuboct::Counters counters() override { return engine_.counters(); }
  Notes notes() override { return engine_.notes(); }
  void for_each_slot(const std::function<void(const Particle&)>& see) override { engine_.for_each_slot(see); }

 protected:
  State make_state() override { return engine_.state(); }

 private:
  const Plan plan_;
  TextRunner engine_;
};

std::unique_ptr<cuboct::Engine> run_of_text(const Scene& scene, const Plan& plan, const GpuChoice& choice,
                                            CheckpointReader* from) {
  auto run = integer_run(scene, plan, from, [&](const State& state) {
    return std::make_unique<TextRunner>(
        make_rounds_engine(plan, state, choice.engine, rounds_compiler(choice.interpret)), choice.hooks);
  });
  if (choice.hooks.ready) choice.hooks.ready();
  return run;
}

}  // namespace

void refuse_another(const CheckpointReader& from) {
  throw InputError(fmt::format("{} was made with another engine or --precision", from.path()),
                   "resume with the options of the run that wrote it");
}

CompileRounds rounds_compiler(bool interpret) {
  if (interpret) return {};
  return [](const std::string& source, const std::string& architecture) {
    return compiled_file(source, architecture, cache_directory());
  };
}

EngineKind gpu_kind(const Scene& scene, const Plan& plan, const GpuChoice& choice) {
  EngineKind kind = choice.arithmetic == Arithmetic::fixed
                        ? fixed_kind("gpu", scene, plan)
                        : real_kind("gpu", scene, plan, choice.arithmetic == Arithmetic::float32);
  kind.batches = kind.hashes_come = true;
  kind.in_pieces = static_cast<bool>(choice.hooks.did);
  kind.looks = [particles = scene.body.size()](const std::vector<uint64_t>& probes) {
    return watch_steps(probes, particles);
  };
  kind.saves = true;
  if (plan.program != nullptr) {
    kind.make = [&scene, &plan, &choice](CheckpointReader* from, bool) {
      return run_of_text(scene, plan, choice, from);
    };
    return kind;
  }
  if (scene.rule.rounds != nullptr) {
    kind.make = [&scene, &plan, &choice](CheckpointReader* from, bool) {
      return TextRun::make(scene, plan.rule.cell_edge, choice, from);
    };
    return kind;
  }
  kind.make = [&scene, &plan, &choice](CheckpointReader* from, bool) -> std::unique_ptr<cuboct::Engine> {
    const bool program = choice.arithmetic == Arithmetic::fixed && !plan.rule.cubic();
    if (program && from && !from->head().engine.own.empty()) refuse_another(*from);
    if (program) return std::make_unique<PairProgramRun>(scene, plan, choice, from);
    return std::make_unique<Runner>(scene, plan, choice, from);
  };
  return kind;
}

Recorded run_gpu(const Scene& scene, const Plan& plan, const GpuRun& request) {
  const GpuChoice choice{request.arithmetic, request.engine, request.hooks};
  return record(scene, gpu_kind(scene, plan, choice), request);
}

}  // namespace cuboct::gpu
