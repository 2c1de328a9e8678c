// SPDX-License-Identifier: MIT
#include "hw/plan/real_plan.h"

#include <bit>
#include <string>

#include "hw/arch/auto_widths.h"
#include "hw/plan/setup.h"
#include "model/base/hash.h"
#include "model/contract/quantise.h"
#include "model/rules/rounds_rule.h"

namespace cuboct {
namespace {

void add(Hash& hash, const std::string& text) {
  for (const char c : text) hash.add(c);
}
void add(Hash& hash, double value) { hash.add(std::bit_cast<int64_t>(value)); }
void add(Hash& hash, const Vec3& value) {
  for (const double x : value) add(hash, x);
}

// What a law is, by what it does: at distances up to the cutoff.
void add(Hash& hash, const PairLaw& law) {
  constexpr int kSamples = 256;
  add(hash, law.cutoff());
  add(hash, law.core());
  for (int k = 1; k < kSamples; ++k) add(hash, law.force(law.cutoff() * k / kSamples));
}

// What moves a type's particles, whatever its bonds are.
void add_types(Hash& hash, const Rule& rule) {
  for (size_t i = 0; i < rule.types.size(); ++i) {
    const ParticleType& type = rule.types[i];
    add(hash, rule.mass_of(static_cast<int>(i)));
    for (const bool imposed : type.imposed) hash.add(imposed);
    for (const Vec3& value : {type.velocity, type.gravity}) add(hash, value);
    for (const double value : {type.pd ? 1.0 : 0.0, type.kp, type.kd}) add(hash, value);
  }
  add(hash, rule.damping.coefficient);
}

void add_pairs(Hash& hash, const Rule& rule) {
  for (size_t n = 0; n < rule.laws(); ++n) add(hash, rule.law_at(n));
  for (size_t i = 0; i < rule.types.size(); ++i)
    for (size_t j = 0; j < rule.types.size(); ++j) {
      const int a = static_cast<int>(i), b = static_cast<int>(j);
      add(hash, rule.strength_of(a, b));
      hash.add(rule.only_touch(a, b));
      hash.add(static_cast<int64_t>(rule.law_index_of(a, b)));
    }
  add(hash, rule.contact_distance);
}

}  // namespace

bool formats_hold(const Scene& scene, const Arch& arch) {
  try {
    const double edge = cell_edges_of(scene, arch, CellForm::cubes).longest;
    const AutoWidths chosen = auto_widths(scene, edge, arch.widths);
    quantise(scene.rule, edge, chosen.widths, arch.table, chosen.half_unit);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

Plan real_plan_of(const Scene& scene, const Arch& arch) {
  Plan plan;
  plan.arch = arch;
  plan.rule.cell_edge = scene.rule.cutoff();
  plan.rule.dt = scene.rule.dt;
  plan.rule.mass = scene.rule.mass;
  plan.particles = static_cast<uint32_t>(scene.body.size());
  Hash hash;
  if (const RoundsRule* rounds = scene.rule.rounds.get(); rounds != nullptr) {
    for (const DeclarationLine& line : rounds->settings()) add(hash, line.name + line.text + line.note);
  } else {
    add_pairs(hash, scene.rule);
  }
  add_types(hash, scene.rule);
  add(hash, scene.rule.dt);
  add(hash, scene.periodic.extent);
  if (scene.deform)
    for (const Vec3& value : {scene.deform->packed.extent, scene.deform->strain, scene.deform->per_step})
      add(hash, value);
  if (scene.loading) {
    for (const uint64_t value : {scene.loading->every, scene.loading->evaluations})
      hash.add(static_cast<int64_t>(value));
    add(hash, scene.loading->tolerance);
  }
  for (size_t i = 0; i < scene.body.size(); ++i) {
    add(hash, scene.packing().x[i]);
    add(hash, scene.body.x[i]);
    add(hash, scene.body.v[i]);
    if (!scene.body.u.empty()) add(hash, scene.body.u[i]);
    hash.add(scene.body.type[i]);
  }
  if (scene.body.bonds)
    for (const uint64_t word : scene.body.bonds->kept) hash.add(static_cast<int64_t>(word));
  plan.hash = hash.value();
  return plan;
}

}  // namespace cuboct
