// SPDX-License-Identifier: MIT
#include "hw/engine/engine_kind.h"

#include <algorithm>

#include "hw/plan/state_bounds.h"
#include "model/rules/rounds_rule.h"
#include "model/run/golden_engine.h"

namespace cuboct {
namespace {

ProgramSetting program_setting(const Plan& plan) {
  return {*plan.program, plan.rule, plan.lattice, plan.origin, plan.arch.capacity};
}

}  // namespace

FixedSetting setting_of(const Scene& scene, const Plan& plan, int threads) {
  return {scene.rule, plan.rule, plan.lattice, plan.origin, threads};
}

Vec3 packed_place(const Scene& scene, const Plan& plan, uint32_t id) {
  return position_of(plan.rule, plan.lattice, plan.origin,
                     fixed_particle(scene.packing(), id, plan.rule, plan.lattice, plan.origin));
}

EngineKind fixed_kind(const std::string& name, const Scene& scene, const Plan& plan) {
  EngineKind kind;
  kind.name = name;
  kind.plan_hash = plan.hash;
  kind.nodes = plan.nodes();
  kind.rounds = static_cast<int>(plan.rounds.size());
  kind.particles = plan.particles;
  kind.displaced = plan.rule.pd;
  kind.table_error = plan.rule.error().worst_force;
  kind.initial = [&scene, &plan](uint32_t id) { return packed_place(scene, plan, id); };
  return kind;
}

EngineKind real_kind(const std::string& name, const Scene& scene, const Plan& plan, bool floats) {
  EngineKind kind;
  kind.name = name;
  kind.plan_hash = plan.hash;
  kind.nodes = plan.nodes();
  kind.particles = scene.body.size();
  kind.fixed = false;
  kind.floats = floats;
  kind.displaced = std::ranges::any_of(scene.rule.types, &ParticleType::pd);
  kind.initial = [&scene](uint32_t id) { return scene.packing().x[id]; };
  return kind;
}

State begin_of(const Scene& scene, const Plan& plan, CheckpointReader* from) {
  if (from == nullptr)
    return plan.program ? program_beginning(scene, program_setting(plan))
                        : to_fixed(scene.body, plan.rule, plan.lattice, plan.origin);
  State state = checked_state(*from, plan);
  if (!plan.program) return state;
  std::vector<uint64_t> own = from->head().engine.own;  // behind the state's words are clocks
  own.resize(std::min(own.size(), program_words(*plan.program, state.particles.size())));
  return state_of_checkpoint(std::move(state), *plan.program, own);
}

std::unique_ptr<IntegerRun> integer_run(const Scene& scene, const Plan& plan, const State& from,
                                        const MakeIntegerEngine& make) {
  return std::make_unique<IntegerRun>(scene, program_setting(plan), from, make);
}

std::unique_ptr<IntegerRun> integer_run(const Scene& scene, const Plan& plan, CheckpointReader* from,
                                        const MakeIntegerEngine& make) {
  return integer_run(scene, plan, begin_of(scene, plan, from), make);
}

GoldenIntegers golden_of(const Plan& plan, const State& state) {
  return {plan.program->program, plan.lattice, plan.arch.capacity, state, plan.program->rows};
}

EngineKind golden_kind(const Scene& scene, const Plan& plan) {
  // A plan that was made for doubles has no program.
  if (plan.program == nullptr) refuse_rounds(scene.rule, "the golden engine");
  EngineKind kind = fixed_kind("golden", scene, plan);
  kind.saves = true;
  if (plan.program != nullptr) {
    kind.make = [&scene, &plan](CheckpointReader* from, bool) { return integer_run(scene, plan, from); };
    return kind;
  }
  kind.make = [&scene, &plan](CheckpointReader* from, bool) {
    return std::make_unique<GoldenEngine>(setting_of(scene, plan), plan.arch.capacity,
                                          begin_of(scene, plan, from));
  };
  return kind;
}

}  // namespace cuboct
