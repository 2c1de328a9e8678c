// SPDX-License-Identifier: MIT
// How a scene's box deforms: `deform` of [box] and of stages.
#include <fmt/format.h>

#include "model/rules/rounds_rule.h"
#include "model/scene/scene_parts.h"

namespace cuboct {
namespace {

constexpr Quantity kRate{{{0, 0, -1, 0}}, "a strain rate", "1e9 1/s"};

// The keys that say how the box deforms and how long it is, the likeliest first; a stage's stands for run's.
const std::vector<std::string> kKeys{"run.deform", "box.deform", "box.size", "box.cells", "box"};
void check_axes(const ConfigValue& value, const Vec3& values, const Scene& scene) {
  for (int axis = 0; axis < 3; ++axis)
    if (values[axis] != 0 && !(scene.periodic.extent[axis] > 0))
      value.fail(fmt::format("the box does not repeat along {}: there is no length to change", "xyz"[axis]),
                 "moved and pulled regions strain a body with faces");
}

}  // namespace

void read_deform(const ConfigTable& root, const StagePart* stage, const SceneChoice& choice, Scene& scene) {
  const auto box = root.table_at("box");
  const auto usual = box ? box->find("deform") : std::nullopt;
  const auto own = stage ? stage->find("deform") : std::nullopt;
  const auto value = own ? own : usual;
  if (!value) return;
  if (!value->is_table()) {
    if (!value->is_array() && !value->is_number() && !value->is_string() && !value->boolean()) return;
    value->fail("'deform' needs a table of strain rates or of strains, or false",
                "deform = { final_strain = [0.1, 0, 0] }");
  }
  if (!choice.begins)
    value->fail("a box that deforms is for 'cuboct run' and 'check'", "this command takes a box of one size");
  const ConfigTable keys = value->table();
  keys.record_as("box");
  keys.not_both("strain_rate", "final_strain");
  if (!keys.has("strain_rate") && !keys.has("final_strain")) keys.done();  // a key of others tells more
  AskedDeformation asked;
  if (keys.has("final_strain")) {
    const ConfigValue strain = keys.at("final_strain");
    asked.final_strain = strain.vector(quantity::number);
    check_axes(strain, *asked.final_strain, scene);
    if (!(asked.final_strain->minCoeff() > -1)) strain.fail("a strain of -1 or less leaves no box");
  } else {
    const ConfigValue rate = keys.at("strain_rate");
    asked.rate = rate.vector(kRate);
    check_axes(rate, asked.rate, scene);
  }
  keys.done();
  const RoundsRule* rounds = scene.rule.rounds.get();
  if (rounds != nullptr && !rounds->lets_box_deform())
    value->fail(fmt::format("the rule '{}' has bonds of the body as packed, in a box of one size",
                            rounds->declaration().name),
                "pair laws, Tersoff's potential and rules of text without lasting bonds let the box deform");
  scene.asked_deform = asked;
}

Vec3 asked_strain(const Scene& scene, double time) {
  if (!scene.asked_deform) return Vec3::Zero();
  const AskedDeformation& asked = *scene.asked_deform;
  return asked.final_strain ? *asked.final_strain : Vec3(asked.rate * time);
}

std::string box_fault(const Scene& scene, uint64_t step) {
  const Vec3 strain = scene.deform ? scene.deform->strain_at(step) : Vec3(Vec3::Zero());
  const Vec3 extent = scene.box_at(step).extent;
  const double least = 2 * scene.rule.cutoff();
  for (int axis = 0; axis < 3; ++axis) {
    if (!(scene.packing_box().extent[axis] > 0) || extent[axis] >= least) continue;
    return fmt::format(
        "at step {}, strained by {:.4g} along {}, the box is {:.6g} m long: less than two cutoffs ({:.6g} m)",
        step, strain[axis], "xyz"[axis], extent[axis], least);
  }
  return {};
}

void set_box(Scene& scene, const Vec3& strain) {
  if (!scene.asked_deform && strain.isZero(0)) return;
  for (const Probe& probe : scene.probes)
    if (probe.kind == Probe::Kind::crack)
      scene.places.fail({fmt::format("probe[{}].kind", probe.name), "probe.kind"},
                        "a crack probe counts bonds of the packing, in a box of one size");
  BoxDeformation deform{scene.packing_box(), strain};
  for (int axis = 0; axis < 3; ++axis)
    if (!(deform.packed.extent[axis] > 0)) deform.strain[axis] = 0;
  if (scene.asked_deform) {
    const AskedDeformation& asked = *scene.asked_deform;
    if (!asked.final_strain)
      deform.per_step = asked.rate * scene.rule.dt;
    else if (asked.steps > 0)
      deform.per_step = (*asked.final_strain - deform.strain) / static_cast<double>(asked.steps);
  }
  for (int axis = 0; axis < 3; ++axis)
    if (!(deform.packed.extent[axis] > 0)) deform.per_step[axis] = 0;
  if (scene.loading) deform.every = scene.loading->every;
  scene.deform = deform;
  scene.periodic = deform.at(0);
}

void begin_box(Scene& scene, const Vec3& strain) {
  set_box(scene, strain);
  if (!scene.deforms()) return;
  // The lengths are linear in time: the first step that does not fit follows from those of both ends.
  std::string fault = box_fault(scene, scene.steps);
  if (fault.empty()) return;
  uint64_t fits = 0, fails = scene.steps;
  while (fails - fits > 1) {
    const uint64_t middle = fits + (fails - fits) / 2;
    (box_fault(scene, middle).empty() ? fits : fails) = middle;
  }
  scene.places.fail(kKeys, box_fault(scene, fails), "a longer box, or a smaller strain");
}

}  // namespace cuboct
