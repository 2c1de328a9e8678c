// SPDX-License-Identifier: MIT
// link_study SCENE RUNS STEPS systemc|rtl CACHE: runs a scene whose links detect, RUNS times with another
// single fault each, and counts what became of them. Exit code 1 unless each fault was found, the run stopped
// with the link named and every state before it equal to golden's, or nothing was left to go wrong and all
// bits are equal. docs/measured/links.md has the table.
#include <fmt/format.h>

#include <string>

#include "emu/machine/loop_bench.h"
#include "emu/systemc/node.h"
#include "emu/verilated/verilated_node.h"
#include "hw/plan/setup.h"
#include "model/contract/golden.h"

namespace {

using namespace cuboct;

struct Tally {
  emu::FaultCounts counts;
  uint64_t stopped = 0, by_kind[3] = {}, equal = 0, bad = 0;
};

std::vector<uint64_t> golden_hashes(const Setup& setup, uint64_t steps) {
  Golden golden(setup.plan.rule, setup.plan.lattice, setup.plan.arch.capacity, setup.initial);
  std::vector<uint64_t> hashes{hash_of(setup.plan.lattice, golden.state())};
  for (uint64_t k = 0; k < steps; ++k) {
    golden.step();
    hashes.push_back(hash_of(setup.plan.lattice, golden.state()));
  }
  return hashes;
}

// Whether the run is as it must be.
bool is_right(const Plan& plan, const std::vector<uint64_t>& golden, const emu::RunResult& run,
              Tally& tally) {
  const Trace& trace = run.trace;
  if (run.faults.injected() != 1 || run.faults.detected != 1) return false;
  if (!std::equal(trace.state_hash.begin(), trace.state_hash.end(), golden.begin())) return false;
  if (!trace.stop) {
    ++tally.equal;
    return trace.state_hash.size() == golden.size();
  }
  const StopReason& stop = *trace.stop;
  if (!is_of_link(stop.fault)) return false;
  ++tally.stopped;
  ++tally.by_kind[static_cast<int>(stop.fault) - static_cast<int>(Fault::link_check)];
  const emu::FaultPlace& at = run.first_fault;
  const bool by_sender = stop.cell == at.node && stop.number == at.face;
  const bool by_receiver =
      stop.cell == plan.lattice.neighbour(at.node, at.face) && stop.number == (at.face ^ 1);
  return by_sender || by_receiver;
}

int study(int argc, char** argv) {
  if (argc != 6) throw InputError("usage: link_study SCENE RUNS STEPS systemc|rtl CACHE");
  const std::string engine = argv[4];
  Arch arch;
  arch.link_check = LinkCheck::detect;
  const Setup setup = make_setup(read_scene(argv[1]), arch);
  const Plan& plan = setup.plan;
  emu::RunOptions options;
  options.steps = std::stoull(argv[3]);
  const std::vector<uint64_t> golden = golden_hashes(setup, options.steps);
  const emu::NodeFactory nodes =
      engine == "rtl" ? emu::verilated_nodes(plan, argv[5]) : emu::native_nodes(plan);
  Tally tally;
  const uint64_t runs = std::stoull(argv[2]);
  for (uint64_t seed = 0; seed < runs; ++seed) {
    options.faults.count = 1;
    options.faults.seed = seed;
    const emu::RunResult run = emu::run_loop_bench(plan, setup.initial, options, nodes, engine);
    tally.counts.flips += run.faults.flips;
    tally.counts.drops += run.faults.drops;
    tally.counts.repeats += run.faults.repeats;
    tally.counts.acks += run.faults.acks;
    tally.counts.detected += run.faults.detected;
    if (is_right(plan, golden, run, tally)) continue;
    if (++tally.bad == 1) fmt::print(stderr, "seed {} is not as it must be\n", seed);
  }
  fmt::print(
      "{} {}: {} runs of {} steps, {} injected ({} flipped, {} dropped, {} repeated, {} in "
      "acknowledgements), "
      "{} detected, {} stopped with the link named ({} check, {} order, {} silent), {} ended with all bits "
      "equal, "
      "{} wrong\n",
      argv[1], engine, runs, options.steps, tally.counts.injected(), tally.counts.flips, tally.counts.drops,
      tally.counts.repeats, tally.counts.acks, tally.counts.detected, tally.stopped, tally.by_kind[0],
      tally.by_kind[1], tally.by_kind[2], tally.equal, tally.bad);
  return tally.bad == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return study(argc, argv);
  } catch (const std::exception& e) {
    fmt::print(stderr, "link_study: {}\n", e.what());
    return 2;
  }
}
