// SPDX-License-Identifier: MIT
// An engine that lies as told, to see that `cuboct crosscheck` finds out: golden's states with the fault that
// the variable LIE names. It stands beside a copy of cuboct as cuboct-systemc and cuboct-rtl; only the latter
// lies. With "wait" or "cut" it goes on behind step 2 only once the file that WAIT_FOR names is there; then
// "cut" dies.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <thread>

#include "hw/engine/engine_kind.h"
#include "hw/program/program.h"
#include "model/contract/golden.h"
#include "tests/support/replay_engine.h"

namespace {

using namespace cuboct;

// Says that it stopped, once all steps are done.
class Stopping : public ReplayEngine {
 public:
  Stopping(const FixedSetting& setting, Trace trace) : ReplayEngine(setting, std::move(trace)) {}
  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override {
    ReplayEngine::advance(steps, hashes);
    throw StepError({Fault::sum, step_count(), 1, 2, 3, "stopped by the fake engine"});
  }
};

// Waits for what the command makes of the frames so far.
class Waiting : public ReplayEngine {
 public:
  Waiting(const FixedSetting& setting, Trace trace, bool dies)
      : ReplayEngine(setting, std::move(trace)), dies_(dies) {}
  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override {
    for (int waited = 0; step_count() >= 2 && !std::filesystem::exists(std::getenv("WAIT_FOR")); ++waited) {
      if (waited == 60000) throw std::runtime_error("no frame was taken while the run went on");
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    if (dies_ && step_count() >= 2) std::abort();
    ReplayEngine::advance(steps, hashes);
  }

 private:
  const bool dies_;
};

class Liar : public EngineProgram {
 public:
  explicit Liar(const std::string& program) {
    name = program;
    abilities.always_cycles = true;
    const char* told = std::getenv("LIE");
    lie_ = told && name == "cuboct-rtl" ? told : "";
  }

  bool prepare(ProgramOptions&) override {
    if (lie_ == "refuse") throw InputError("refused by the fake engine");
    if (lie_ == "crash") std::abort();
    if (lie_ == "nothing") std::exit(1);
    return false;
  }

  EngineKind kind(Scene& scene, const Plan& plan, const ProgramOptions& options) override {
    EngineKind kind = fixed_kind(name.substr(name.find('-') + 1), scene, plan);
    kind.plan_hash += lie_ == "plan";
    kind.batches = kind.hashes_come = true;
    kind.make = [this, &scene, &plan, steps = options.run.steps](CheckpointReader*, bool) {
      const FixedSetting setting = setting_of(scene, plan);
      Trace trace = trace_of(scene, plan, steps);
      if (lie_ == "stop") return std::unique_ptr<Engine>(new Stopping(setting, std::move(trace)));
      if (lie_ == "wait" || lie_ == "cut")
        return std::unique_ptr<Engine>(new Waiting(setting, std::move(trace), lie_ == "cut"));
      return std::unique_ptr<Engine>(new ReplayEngine(setting, std::move(trace)));
    };
    return kind;
  }

 private:
  Trace trace_of(const Scene& scene, const Plan& plan, uint64_t steps) const;
  std::string lie_;
};

Trace Liar::trace_of(const Scene& scene, const Plan& plan, uint64_t steps) const {
  Trace trace;
  trace.nodes = plan.lattice.size();
  const State initial = to_fixed(scene.body, plan.rule, plan.lattice, plan.origin);
  Golden golden(plan.rule, plan.lattice, plan.arch.capacity, initial);
  for (uint64_t step = 0;; ++step) {
    State state = golden.state();
    if (lie_ == "state" && step >= 3) state.particles[17].v[1] ^= 1;
    trace.state_hash.push_back(hash_of(plan.lattice, state) + (lie_ == "hash" && step == 2));
    trace.frames.push_back(std::move(state));
    if (step == steps) break;
    for (uint64_t node = 0; node < trace.nodes; ++node)
      for (uint64_t phase = 0; phase < kPhases; ++phase) {
        const uint64_t start = 100 * step + 10 * phase;
        const bool late = lie_ == "cycles" && step == 2 && node == 5 && phase == 3;
        trace.cycles.push_back({start, start + 9 + late});
      }
    try {
      golden.step();
    } catch (const RunError& e) {
      trace.stop = StopReason{e.fault, e.step, e.cell, e.particle, e.number, e.what()};
      break;
    }
  }
  return trace;
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path program = argv[0];
  Liar liar(program.filename().string());
  return run_program(argc, argv, liar);
}
