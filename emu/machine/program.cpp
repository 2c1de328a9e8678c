// SPDX-License-Identifier: MIT
#include "emu/machine/program.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

#include "emu/machine/machine_engine.h"
#include "hw/engine/engine_kind.h"
#include "hw/program/options.h"
#include "hw/program/program.h"
#include "model/program/integer_program.h"

namespace cuboct::emu {
namespace {

double node_cycles(const Trace& trace) {  // per s
  const double cycles = trace.counters.front().second;
  return cycles * static_cast<double>(trace.nodes) / std::max(trace.seconds, 1e-9);
}

class MachineProgram : public EngineProgram {
 public:
  explicit MachineProgram(const Machine& machine) : machine_(machine) {
    name = machine.name;
    description = machine.description;
    abilities.always_cycles = true;
    abilities.text = machine.text;
    abilities.steps = std::numeric_limits<uint32_t>::max();
  }

  void add_options(Command& app) override {
    app.option("--stall-rate", run_.stall_rate, "Share of cycles in which a link passes nothing")
        .range(0.0, 0.99);
    app.option("--stall-seed", run_.stall_seed, "Seed of the stalls").show_default();
    app.option("--inject-faults", faults_,
               "Faults on the wires: their share of all beats, or their number in the run");
    app.option("--fault-seed", run_.faults.seed, "Seed of the faults").show_default();
    app.option("--threads", run_.threads, "Threads that step the nodes; default: one per core")
        .range(1, 4096);
    machine_.add_options(app);
  }

  bool prepare(ProgramOptions&) override {
    if (faults_.empty()) return false;
    const FaultShare share = read_fault_share(faults_);
    run_.faults.rate = share.rate;
    run_.faults.count = share.count;
    return false;
  }

  EngineKind kind(Scene& scene, const Plan& plan, const ProgramOptions& options) override {
    run_.steps = options.run.steps;
    run_.frames = asked_steps(options.run);
    run_.keep_last = asks_for_last(options.run);
    if (plan.program && plan.program->rows) {  // broken bonds are counted at the end
      run_.keep_last = true;
      run_.frames.push_back(run_.steps);
    }
    if (run_.faults.enabled() && plan.arch.boards.several())
      throw InputError("--inject-faults: links between devices have no faults here",
                       "leave out [boards], or the faults");
    EngineKind kind = fixed_kind(machine_.engine, scene, plan);
    kind.batches = kind.hashes_come = true;
    if (const std::string why = machine_refusal(plan); !why.empty())
      throw InputError(fmt::format("the {} engine: {}", machine_.engine, why)).about({"rule.file", "rule"});
    kind.make = [this, &scene, &plan](CheckpointReader* from, bool) -> std::unique_ptr<Engine> {
      if (plan.program)
        return integer_run(scene, plan, from, [this, &plan](const State& initial) {
          return std::make_unique<MachineIntegers>(plan, initial, run_, machine_.nodes(plan),
                                                   machine_.engine);
        });
      const State initial = to_fixed(scene.body, plan.rule, plan.lattice, plan.origin);
      return std::make_unique<MachineEngine>(setting_of(scene, plan), plan, initial, run_,
                                             machine_.nodes(plan), machine_.engine);
    };
    return kind;
  }

  void print_bench(const Scene&, const Plan&, const Recorded& run) override {
    fmt::print("{}.node_cycles {:.4g} 1/s\n", machine_.engine, node_cycles(run.trace));
  }

  void print_end(const Plan& plan, const Trace& trace) override {
    const auto& shape = plan.bricks.shape();
    fmt::print(
        "{} steps of {} particles on {} nodes{} in {:.0f} cycles, {:.3g} node-cycles/s\n", trace.steps(),
        plan.particles, trace.nodes,
        plan.bricks.cells() == 1 ? std::string() : fmt::format(" of {} cells", fmt::join(shape, " x ")),
        trace.counters.front().second, node_cycles(trace));
  }

 private:
  const Machine& machine_;
  RunOptions run_;
  std::string faults_;
};

}  // namespace

int run_machine(int argc, char** argv, const Machine& machine) {
  MachineProgram program(machine);
  return run_program(argc, argv, program);
}

}  // namespace cuboct::emu
