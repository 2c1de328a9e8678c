// SPDX-License-Identifier: MIT
#include "tests/run/kinds.h"

#include "emu/machine/loop_bench.h"
#include "emu/systemc/node.h"
#include "tests/support/replay_engine.h"

namespace cuboct::test {
namespace {

// The cycle-accurate nodes in a plain loop: of SystemC a process has one run.
EngineKind machine_kind(const Bed& bed, const RunRequest& request) {
  EngineKind kind = fixed_kind("systemc", bed.scene, bed.plan);
  kind.batches = kind.hashes_come = true;
  kind.make = [&bed, request](CheckpointReader*, bool) {
    emu::RunOptions options;
    options.steps = request.steps;
    options.frames = asked_steps(request);
    options.keep_last = asks_for_last(request);
    const State initial = to_fixed(bed.scene.body, bed.plan.rule, bed.plan.lattice, bed.plan.origin);
    Trace trace =
        emu::run_loop_bench(bed.plan, initial, options, emu::native_nodes(bed.plan), "systemc").trace;
    return std::make_unique<ReplayEngine>(setting_of(bed.scene, bed.plan), std::move(trace));
  };
  return kind;
}

}  // namespace

const std::vector<Kind>& fixed_kinds() {
  static const std::vector<Kind> kinds{
      {"golden", [](const Bed& bed, const RunRequest&) { return golden_kind(bed.scene, bed.plan); }},
      {"lattice", [](const Bed& bed,
                     const RunRequest&) { return emu::lattice_kind(bed.scene, bed.plan, bed.one_thread); }},
      {"lattice_two_threads",
       [](const Bed& bed, const RunRequest&) {
         return emu::lattice_kind(bed.scene, bed.plan, bed.two_threads);
       }},
      {"systemc", machine_kind},
      {"gpu", [](const Bed& bed, const RunRequest&) { return gpu::gpu_kind(bed.scene, bed.plan, bed.gpu); }},
  };
  return kinds;
}

}  // namespace cuboct::test
