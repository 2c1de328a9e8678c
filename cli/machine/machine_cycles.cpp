// SPDX-License-Identifier: MIT
#include "cli/machine/machine_cycles.h"

#include <algorithm>
#include <vector>

#include "emu/lattice/engine.h"
#include "emu/timing/kicks.h"
#include "emu/timing/timing.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/base/progress.h"

namespace cuboct {
namespace {

// Particles times steps: some seconds of one core.
constexpr uint64_t kMostWork = 20'000'000;

}  // namespace

std::optional<CountedCycles> count_cycles(const Plan& plan, const State& initial, uint64_t run_steps) {
  const uint64_t affordable = std::max<uint64_t>(1, kMostWork / std::max<uint64_t>(1, plan.particles));
  const auto run = count_run(plan, initial, std::min({kCountedSteps, affordable, run_steps}));
  if (!run) return std::nullopt;
  return run->cycles;
}

std::optional<CountedRun> count_run(const Plan& plan, const State& initial, uint64_t steps,
                                    const std::string& label) {
  CountedRun run;
  run.nodes.resize(plan.nodes());
  CountedCycles& counted = run.cycles;
  emu::TimingModel timing(plan, 0);
  try {
    emu::LatticeEngine engine(plan, initial.step, plan.particles,
                              [&](uint32_t k) { return initial.particles[k]; }, {},
                              {initial.fields, initial.bonds});  // of an initial state in the order of ids
    emu::CellSlots slots;
    std::optional<emu::KickCounter> kicks;  // of the pair law, which says which pairs are near
    if (plan.program == nullptr) kicks.emplace(plan, 0);
    std::vector<Particle> particles;
    std::vector<PhaseSpan> spans(spans_of_step(plan));
    Progress progress(label, steps, plan.particles);
    while (counted.steps < steps && !interrupted()) {
      progress.at(counted.steps);
      engine.slots(slots);
      particles.clear();
      if (kicks) engine.for_each_slot([&](const Particle& p) { particles.push_back(p); });
      engine.step();
      if (kicks) kicks->add(particles, run.nodes);
      timing.step(slots, engine.leaving(), spans);
      uint64_t end = 0;  // the slowest node's
      for (const PhaseSpan& span : spans) end = std::max(end, span.end + 1);
      counted.most = std::max(counted.most, end - counted.cycles);
      counted.cycles = end;
      ++counted.steps;
    }
  } catch (const RunError&) {
    // What a run would stop at; the steps before it took what they took.
  }
  if (counted.steps == 0) return std::nullopt;
  for (size_t n = 0; n < run.nodes.size(); ++n) run.nodes[n] += timing.events()[n];
  return run;
}

}  // namespace cuboct
