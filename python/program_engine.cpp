// SPDX-License-Identifier: MIT
#include "python/program_engine.h"

#include <fmt/format.h>
#include <optional>

#include <utility>

#include "cli/run/outputs.h"
#include "hw/engine/engine_kind.h"
#include "model/base/interrupt.h"
#include "model/run/start.h"
#include "python/program_run.h"

namespace cuboct::python {
namespace {

StopReason reason_of(Fault fault, uint64_t step, const Lattice& lattice, uint32_t cell, uint32_t particle) {
  const Cell& c = lattice.cell(cell);
  const RunError error(fault, step, cell, particle, 0, fmt::format(" at ({}, {}, {})", c[0], c[1], c[2]));
  return {fault, step, cell, particle, 0, error.what()};
}

// Of a particle that goes in one step where the lattice has no cell: axis by axis, as it migrates.
StopReason left(const Lattice& lattice, uint64_t step, const Particle& before, const Cell& to) {
  uint32_t cell = before.cell;
  for (int a = 0;; ++a) {
    Cell next = lattice.cell(cell);
    next[static_cast<size_t>(a)] = to[static_cast<size_t>(a)];
    const uint32_t found = lattice.find(next);
    if (found == kNoCell)
      return reason_of(static_cast<Fault>(static_cast<int>(Fault::left_x) + 2 * a), step, lattice, cell,
                       before.id);
    cell = found;
  }
}

// The reason as a whole run tells it, `before` steps later and by its own cells.
StopReason later(const StopReason& of, uint64_t before, const Lattice& theirs, const Lattice& ours) {
  StopReason reason = of;
  reason.step += before;
  const Cell& c = theirs.cell(reason.cell);
  if (const uint32_t cell = ours.find(c); cell != kNoCell) reason.cell = cell;
  reason.text = RunError(reason.fault, reason.step, reason.cell, reason.particle, reason.number,
                         fmt::format(" at ({}, {}, {})", c[0], c[1], c[2]))
                    .what();
  return reason;
}

}  // namespace

ProgramEngine::ProgramEngine(const Sources& sources, const std::string& engine, const EngineOptions& options,
                             const Scene& scene, const Setup& setup)
    : StateEngine(setting_of(scene, setup.plan, options.threads)),
      sources_(sources),
      engine_(engine),
      options_(options),
      scene_(scene),
      setup_(setup),
      input_(write_sources(sources, scratch_)),
      state_(setup.initial) {}

// The state so far, as a run that ended.
void ProgramEngine::leave_state() const {
  const Plan& plan = setup_.plan;
  Trace rest;
  rest.engine = engine_;
  rest.plan_hash = plan.hash;
  rest.nodes = plan.nodes();
  rest.steps_done = state_.step;
  cuboct::leave_state(input_.from, {scene_, &plan.rule, &plan.lattice, plan.origin, plan.arch.text}, state_,
                      rest);
}

// The scene and the plan that the program will make of it: its cells are those that can be reached from here.
Loaded ProgramEngine::going_on() {
  Sources at = sources_;
  if (state_.step > 0) {
    at.from = input_.from = scratch_.path("from");
    leave_state();
  }
  Loaded now = load_plan(at);
  const Plan& plan = now.setup.plan;
  if (now.scene.body.exact && !now.scene.body.exact->fits(plan.rule, plan.origin))
    throw InputError(fmt::format("the {} engine cannot go on from {}", engine_,
                                 start_text(now.scene, &plan.rule, plan.origin)),
                     "an arch file that sets the widths keeps them");
  return now;
}

// False: a particle has left the cells of the whole run for some that the program had. `lost` is then the
// reason, if that was one step.
bool ProgramEngine::take(State state, const Lattice& theirs, StopReason& lost) {
  const Lattice& ours = setup_.plan.lattice;
  bool whole = true;
  for (Particle& p : state.particles) {
    const Cell& to = theirs.cell(p.cell);
    p.cell = ours.find(to);
    if (p.cell != kNoCell) continue;
    whole = false;
    if (state.step > 1) break;
    const StopReason reason = left(ours, state_.step, state_.particles[p.id], to);
    if (lost.fault == Fault::none || reason.fault < lost.fault) lost = reason;  // the least, as everywhere
  }
  if (!whole) return false;
  state.step += state_.step;
  state_ = std::move(state);
  return true;
}

void ProgramEngine::advance(uint64_t steps, std::vector<uint64_t>*) {
  if (steps == 0) return;
  const Loaded now = going_on();
  const Plan& plan = now.setup.plan;
  std::optional<State> last;
  RunRequest request;
  request.steps = steps;
  request.frames = {steps};
  request.hash_every = 0;
  request.log = LogRows::quiet;
  request.keep = [&](const RunState& frame) { last = std::get<State>(frame); };
  const std::optional<Recorded> run =
      run_program(engine_, input_, now, options_, std::move(request), scratch_.path("run.h5"));
  if (!run) return;
  if (run->interrupted && !interrupted())
    throw std::runtime_error(fmt::format("the {} engine ended after step {} of {}", engine_,
                                         state_.step + run->trace.steps(), state_.step + steps));
  const uint64_t before = state_.step;
  StopReason lost;
  if (last && !take(std::move(*last), plan.lattice, lost)) {
    if (lost.fault != Fault::none) throw StepError(lost);
    advance(steps / 2, nullptr);
    advance(steps - steps / 2, nullptr);
    return;
  }
  if (run->trace.stop) throw StepError(later(*run->trace.stop, before, plan.lattice, setup_.plan.lattice));
}

}  // namespace cuboct::python
