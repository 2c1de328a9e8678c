// SPDX-License-Identifier: MIT
#include "python/program_integers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <utility>

#include "cli/run/outputs.h"
#include "emu/lattice/run.h"
#include "hw/engine/engine_kind.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/program/rule_program.h"
#include "model/rules/rounds_rule.h"
#include "python/program_run.h"

namespace cuboct::python {
namespace {

// Whether metres in doubles hold each position: a few roundings of them are less than half of its unit.
bool come_back(const FixedRule& rule, const Lattice& lattice) {
  int32_t most = 1;
  for (uint32_t n = 0; n < lattice.size(); ++n)
    for (const int32_t c : lattice.cell(n)) most = std::max(most, std::abs(c) + 1);
  constexpr int kDoubles = 50;
  return rule.widths.velocity_frac() + std::log2(most) < kDoubles;
}

}  // namespace

ProgramIntegers::ProgramIntegers(const Sources& sources, const std::string& engine,
                                 const EngineOptions& options, const Scene& scene, const Plan& plan,
                                 const State& initial)
    : sources_(sources),
      engine_(engine),
      options_(options),
      scene_(scene),
      plan_(plan),
      input_(write_sources(sources, scratch_)),
      state_(initial),
      hash_(hash_of(plan.lattice, initial)) {}

// The scene and the plan that the program will make of it: its cells are those that can be reached from here.
Loaded ProgramIntegers::going_on() {
  Sources at = sources_;
  if (left_) {
    at.from = input_.from = scratch_.path("from");
    Trace rest;
    rest.engine = engine_;
    rest.plan_hash = plan_.hash;
    rest.nodes = plan_.nodes();
    rest.steps_done = state_.step;
    rest.bonds = bonds_;
    leave_state(input_.from, {scene_, nullptr, nullptr, plan_.origin, plan_.arch.text}, *left_, rest);
  }
  Loaded now = load_plan(at, false, engine_);
  if (!left_) return now;
  const Plan& plan = now.setup.plan;
  const FixedRule& rule = plan_.rule;
  ExactBody formats;
  formats.widths = rule.widths, formats.cell_edge = rule.cell_edge, formats.shape = rule.shape;
  formats.dt = rule.dt, formats.origin = plan_.origin;
  if (!come_back(rule, plan_.lattice) || !formats.fits(plan.rule, plan.origin) ||
      hash_of(plan.lattice, begin_of(now.scene, plan, nullptr)) != hash_of(plan_.lattice, state_))
    throw InputError(
        fmt::format("the {} engine cannot go on from step {} of this scene: it would round the state",
                    engine_, state_.step),
        "an arch file that sets the widths keeps them; cuboct.run runs the scene whole");
  return now;
}

// False: a particle has left the cells of the whole run for some that the program had.
bool ProgramIntegers::take(const RealFrame& frame, const std::vector<uint64_t>& bonds, uint64_t hash) {
  Scene there = scene_;
  there.body = Body{frame.x, frame.v, frame.u, scene_.body.type, nullptr};
  if (has_reference_bonds(scene_.rule) || has_memory(scene_.rule))
    there.body.bonds = std::make_shared<BondState>(BondState{scene_.packing().x, bonds});
  State next;
  try {
    next = begin_of(there, plan_, nullptr);
  } catch (const InputError&) {
    return false;
  }
  const RuleProgram& text = *scene_.rule.rounds->text();
  const bool whole = std::ranges::all_of(text.particle, &ProgramField::kept);
  if (whole && hash_of(plan_.lattice, next) != hash)
    throw std::runtime_error(
        fmt::format("the {} engine's state does not come back to the last bit", engine_));
  next.step = state_.step + frame.step;
  state_ = std::move(next);
  hash_ = hash;
  left_ = frame;
  left_->step = state_.step;
  bonds_ = bonds;
  return true;
}

void ProgramIntegers::step_by_golden() {
  GoldenIntegers(plan_.program->program, plan_.lattice, plan_.arch.capacity, state_, plan_.program->rows)
      .advance(1, nullptr);
  throw std::runtime_error(
      fmt::format("the {} engine stops at step {}, and golden does not", engine_, state_.step));
}

void ProgramIntegers::advance(uint64_t steps, std::vector<uint64_t>* hashes) {
  if (hashes != nullptr) throw std::logic_error("a program's run tells its last hash alone");
  if (steps == 0) return;
  const Loaded now = going_on();
  RunRequest request;
  request.steps = request.hash_every = steps;
  request.frames = {steps};
  request.log = LogRows::quiet;
  const std::optional<Recorded> run =
      run_program(engine_, input_, now, options_, std::move(request), scratch_.path("run.h5"));
  if (!run) return;
  if (run->interrupted && !interrupted())
    throw std::runtime_error(fmt::format("the {} engine ended after step {} of {}", engine_,
                                         state_.step + run->trace.steps(), state_.step + steps));
  const Trace& trace = run->trace;
  const bool moved = !trace.bodies.empty() && trace.bodies.back().step > 0;
  if (moved &&
      !take(trace.bodies.back(), trace.bonds.value_or(std::vector<uint64_t>()), trace.state_hash.back())) {
    if (steps == 1) step_by_golden();
    advance(steps / 2, nullptr);
    advance(steps - steps / 2, nullptr);
    return;
  }
  if (trace.stop) step_by_golden();
}

std::vector<Int3> ProgramIntegers::next_velocities() {
  try {
    emu::LatticeOptions lattice;
    lattice.threads = options_.threads;
    lattice.rule_code = emu::RuleCode::interpreted;
    return emu::integer_lattice(plan_, state_, lattice)->next_velocities();
  } catch (const InputError&) {  // its vectors do not hold the rule's numbers
    return GoldenIntegers(plan_.program->program, plan_.lattice, plan_.arch.capacity, state_,
                          plan_.program->rows)
        .next_velocities();
  }
}

}  // namespace cuboct::python
