// SPDX-License-Identifier: MIT
#include "hw/engine/scene_engine.h"

#include <fmt/format.h>

#include "hw/engine/engine_kind.h"
#include "hw/engine/engines.h"
#include "hw/plan/probe_accuracy.h"
#include "hw/plan/real_plan.h"
#include "model/base/error.h"
#include "model/rules/rounds_rule.h"
#include "model/run/static_engine.h"

namespace cuboct {

namespace {

bool is_text(const Scene& scene) {
  const RoundsRule* rounds = scene.rule.rounds.get();
  return rounds != nullptr && rounds->text() != nullptr;
}

bool runs_text(const Scene& scene, const std::string& engine) {
  const EngineRow* row = find_engine(engine);
  return is_text(scene) && row != nullptr && row->text;
}

}  // namespace

std::string engine_for(const Scene& scene) {
  return scene.loading || scene.deforms() || scene.rule.rounds != nullptr ? "reference" : "lattice";
}

void check_runs(const Scene& scene, const Arch& arch, const std::string& engine) {
  if (engine_row(engine).here == Here::reference) return;
  const std::string who = fmt::format("the {} engine", engine);
  refuse_static(scene, who);
  refuse_deform(scene, who);
  if (runs_text(scene, engine)) return;
  with_places(scene, arch, [&] { refuse_rounds(scene.rule, who); });
}

Plan scene_plan_of(const Scene& scene, const Arch& arch, const std::string& engine, bool real) {
  const EngineRow* row = find_engine(engine.empty() ? engine_for(scene) : engine);
  const CellForm form = row != nullptr && row->any_cells ? CellForm::any : CellForm::cubes;
  if (!real && !scene.deforms() && runs_text(scene, engine)) return program_plan_of(scene, arch, form);
  if (scene.rule.rounds != nullptr || scene.deforms()) return real_plan_of(scene, arch);
  const bool doubles = row != nullptr && row->here == Here::reference;
  try {
    return plan_of(scene, arch, form);
  } catch (const InputError&) {
    if (!doubles) throw;
    if (!formats_hold(scene, arch)) return real_plan_of(scene, arch);
    if (!asks_accuracy(scene)) throw;
    // What no formats keep, doubles do.
    Scene calm = scene;
    for (Probe& probe : calm.probes) probe.accuracy = 0;
    return plan_of(calm, arch, form);
  }
}

Setup machine_setup(const Scene& scene, const Arch& arch) {
  refuse_deform(scene, "a machine");
  if (scene.rule.rounds == nullptr) return make_setup(scene, arch);
  Plan plan = program_plan_of(scene, arch, CellForm::cubes);
  State initial;
  with_places(scene, arch, [&] { initial = begin_of(scene, plan, nullptr); });
  return {std::move(plan), std::move(initial)};
}

const std::string& strictest(const std::vector<std::string>& engines) {
  const auto cubes = std::ranges::find_if(engines, [](const std::string& engine) {
    const EngineRow* row = find_engine(engine);
    return row != nullptr && row->bits && !row->any_cells;
  });
  return cubes == engines.end() ? engines.front() : *cubes;
}

Plan shared_plan_of(const Scene& scene, const Arch& arch, const std::vector<std::string>& engines) {
  for (const std::string& engine : engines) check_runs(scene, arch, engine);
  return scene_plan_of(scene, arch, strictest(engines));
}

std::vector<std::string> engines_to_cross(const Scene& scene, const Arch& arch) {
  if (is_text(scene)) return {"golden", "lattice"};
  if (scene.rule.rounds == nullptr &&
      with_places(scene, arch, [&] { return cell_edges_of(scene, arch, CellForm::any).shape; }) != kCube)
    return {"golden", "lattice"};
  return {"golden", "lattice", "systemc", "rtl"};
}

uint64_t whole_steps(const Scene& scene, uint64_t steps) {
  return scene.loading ? scene.loading->whole(steps) : steps;
}

EngineKind scene_reference_kind(const Scene& scene, const Plan& plan, const RealOptions& options) {
  EngineKind kind = scene_reference_kind(scene, scene.body, options, plan.rule.cell_edge);
  kind.plan_hash = plan.hash;
  kind.nodes = scene.rule.rounds != nullptr && !scene.loading ? 0 : plan.nodes();
  kind.initial = [&scene](uint32_t id) { return scene.packing().x[id]; };
  return kind;
}

}  // namespace cuboct
