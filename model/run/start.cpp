// SPDX-License-Identifier: MIT
#include "model/run/start.h"

#include <fmt/format.h>

#include <filesystem>

#include "model/base/error.h"
#include "model/base/input_file.h"
#include "model/config/config.h"
#include "model/contract/material_name.h"
#include "model/rules/rounds_rule.h"
#include "model/scene/first_step.h"
#include "model/scene/scene_parts.h"
#include "model/trace/guarded_trace.h"
#include "model/trace/trace_head.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void differ(const Scene& scene, const std::vector<std::string>& keys, const std::string& from,
                         const std::string& what) {
  std::vector<std::string> at{"start.from"};
  at.insert(at.end(), keys.begin(), keys.end());
  scene.places.fail(at, fmt::format("{} was left by other particles: {}", from, what),
                    "packing, geometry, box and materials must be those of the run that is to go on");
}

void check_alike(const Scene& scene, const LeftState& left, const std::string& from) {
  const Body& body = scene.body;
  const size_t count = left.body.size();
  if (count != body.size())
    differ(scene, {"geometry", "packing", "particles.file", "particle"}, from,
           fmt::format("{} there, {} here", count, body.size()));
  if (left.packing != packing_hash(scene))
    differ(scene, {"packing.pitch", "geometry", "particles.file", "particle"}, from,
           "their packing or its box is another one");
  for (size_t id = 0; id < count; ++id) {
    const std::string there = material_of(left.types[left.body.type[id]]);
    const std::string here = material_of(scene.rule.types[body.type[id]].name);
    if (there != here)
      differ(scene, {"material", "geometry", "packing"}, from,
             fmt::format("particle {} is of '{}' there, of '{}' here", id, there, here));
  }
}

// What the bonds of the scene's rule went through must have come with the state, and nothing else.
std::shared_ptr<const BondState> bonds_of(const Scene& scene, const LeftState& left,
                                          const std::string& from) {
  const auto refuse = [&](const std::string& what) {
    scene.places.fail({"start.from", "rule"}, fmt::format("{} {}", from, what),
                      "a run of this scene's [rule] leaves a state that it can go on from");
  };
  const BondState* there = left.body.bonds.get();
  if (has_memory(scene.rule) && there == nullptr)
    refuse(has_bond_memory(scene.rule)
               ? "does not say which bonds are broken: another rule left it, or an older program"
               : "does not hold the fields of the rule's particles: another rule left it");
  if (!has_memory(scene.rule) && there != nullptr && !there->kept.empty())
    refuse("holds bonds that can break, and here none can: they would heal");
  if (!has_reference_bonds(scene.rule) && !has_memory(scene.rule)) return nullptr;
  return std::make_shared<BondState>(
      BondState{scene.packing().x, there != nullptr ? there->kept : std::vector<uint64_t>()});
}

// Whether a particle's displacement from its anchor goes on: the same constraint holds it by force. Else the
// anchor stands where the particle is.
bool keeps_anchor(const Scene& scene, const LeftState& left, size_t id) {
  const ParticleType& type = scene.rule.types[scene.body.type[id]];
  return type.pd && !left.body.u.empty() && left.types[left.body.type[id]] == type.name;
}

}  // namespace

void begin_at(Scene& scene, const std::string& directory) {
  const std::string path = directory + "/trace.h5";
  if (!is_file(path))
    scene.places.fail({"start.from"}, fmt::format("{} holds no finished run: no file trace.h5", directory),
                      "'cuboct run SCENE --out DIR' leaves one");
  LeftState left = guarded_left_state(path);
  check_alike(scene, left, directory);

  if (!left.box_strain.isZero(0) && scene.rule.rounds && !scene.rule.rounds->lets_box_deform())
    differ(scene, {"rule"}, directory, "they stand in a box that was deformed, and the rule's bonds do not");
  begin_box(scene, left.box_strain);
  scene.packed = std::make_shared<Body>(scene.body);
  Body& body = scene.body;
  body.x = std::move(left.body.x);
  body.v = std::move(left.body.v);
  auto exact = left.body.exact ? std::make_shared<ExactBody>(*left.body.exact) : nullptr;
  for (size_t id = 0; id < body.size(); ++id) {
    const ParticleType& type = scene.rule.types[body.type[id]];
    for (int a = 0; a < 3; ++a)
      if (type.imposed[a]) body.v[id][a] = type.velocity[a];
    if (keeps_anchor(scene, left, id))
      body.u[id] = left.body.u[id];
    else if (exact)
      exact->u[id] = {};
  }
  body.exact = std::move(exact);
  body.bonds = bonds_of(scene, left, directory);
  for (Probe& probe : scene.probes)
    if (probe.from_start)
      for (const uint32_t id : probe.set.ids) probe.begin.push_back(body.x[id]);
  begin_at_step(scene.rule, left.first_step + left.step);
  scene.began = Began{directory, left.engine, left.step};
}

Scene load_scene(const std::string& path, const StartChoice& choice) {
  return load_scene(read_config_text(path), path, choice);
}

Scene load_scene(const std::string& text, const std::string& path, const StartChoice& choice) {
  Scene scene = parse_scene(text, path, {.begins = true, .stage = choice.stage});
  std::string from = choice.from;
  const bool first = scene.stage.empty() || stages_in(text, path).front().name == scene.stage;
  if (from.empty() && first && !scene.start.empty())
    from = (fs::path(path).parent_path() / scene.start).lexically_normal().string();
  if (from.empty() && !first && !choice.looks_only)
    throw InputError(fmt::format(
        "stage '{}' begins where the stage before it ended: --from DIR says where that is", scene.stage));
  if (!from.empty()) begin_at(scene, from);
  return scene;
}

std::vector<StageName> stages_in(const std::string& text, const std::string& path) {
  return stage_names(parse_config(text, path));
}

std::string start_text(const Scene& scene, const FixedRule* rule, const Vec3& origin) {
  std::string where = fmt::format("step {} of {}", scene.began->step, scene.began->from);
  const ExactBody* exact = scene.body.exact.get();
  if (!exact || !rule) return where;
  if (exact->fits(*rule, origin)) return where + ", bit for bit";
  std::string why = "other formats";
  if (exact->dt != rule->dt)
    why = fmt::format("dt {:.6g} s there, {:.6g} s here", exact->dt, rule->dt);
  else if (exact->cell_edge != rule->cell_edge)
    why = fmt::format("cell edge {:.6g} m there, {:.6g} m here", exact->cell_edge, rule->cell_edge);
  else if (exact->shape != rule->shape)
    why = "cells of another shape";
  else if (exact->widths.velocity_frac() != rule->widths.velocity_frac())
    why = fmt::format("{} fractional bits there, {} here", exact->widths.velocity_frac(),
                      rule->widths.velocity_frac());
  return fmt::format("{}, rounded anew: {}", where, why);
}

}  // namespace cuboct
