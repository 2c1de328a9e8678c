// SPDX-License-Identifier: MIT
// From a scene and an arch to a plan and its initial state.
#pragma once

#include <cstdint>
#include <utility>

#include "hw/plan/plan.h"
#include "model/base/error.h"
#include "model/scene/scene.h"

namespace cuboct {

// What `work` refuses gets the place of the key that it is about.
template <typename Work>
auto with_places(const Scene& scene, const Arch& arch, Work work) {
  try {
    return work();
  } catch (const InputError& error) {
    throw arch.places.placed(scene.places.placed(error));
  }
}

struct Setup {
  Plan plan;
  State initial;
};

// Chooses the cell edge and the reachable cells, quantises rule and body. Deterministic. InputError where the
// machine cannot hold the scene: a cell too full, a particle too fast, ...
Setup make_setup(const Scene& scene, const Arch& arch);

// Nodes of a machine have cubic cells. In a periodic box that no cube divides other engines
// take cells whose edge differs by axis.
enum class CellForm : uint8_t { cubes, any };

// A cell's edges, m: the law's cutoff or the arch's, in a box that repeats the next length that divides it.
CellEdges cell_edges_of(const Scene& scene, const Arch& arch, CellForm form);

// `arch` with the formats that are automatic settled by this scene, but for the tables' width: for studies
// that change the scene and mean the same machine.
Arch settled(const Scene& scene, Arch arch);

// The same plan and errors, without a State in memory.
Plan plan_of(const Scene& scene, const Arch& arch, CellForm form = CellForm::cubes);

// Of a rule that is text too: Plan::program has it in integers.
Plan program_plan_of(const Scene& scene, const Arch& arch, CellForm form = CellForm::any);

// The plan and the state with which a run goes on from `now`, a state of `before`, under constraints or
// gravity that have changed: formats, cells and origin stay, so `now` is kept to the last bit. `scene` has
// the new rule and, as its body, `now` in real units: from there cells are reached. `begin`: the body of
// which `before` was made; of it formats of a rule that is text are made. InputError where the formats cannot
// hold the new rule.
Setup going_on(const Scene& scene, const Plan& before, const State& now, const Body& begin);

// The particles of make_setup's initial state, out of the body that plan_of saw. It uses the body up: what
// was asked for is given back to the system, so that an engine that is fed from here grows as the body
// shrinks.
class InitialParticles {
 public:
  InitialParticles(Body body, const Plan& plan) : body_(std::move(body)), plan_(plan) {}
  InitialParticles(const InitialParticles&) = delete;
  InitialParticles& operator=(const InitialParticles&) = delete;

  // Each id once, ascending from 0.
  Particle operator()(uint32_t id);

 private:
  Body body_;
  const Plan& plan_;
};

}  // namespace cuboct
