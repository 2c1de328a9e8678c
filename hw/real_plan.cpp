// SPDX-License-Identifier: MIT
#include "hw/real_plan.h"

#include <bit>
#include <string>

#include "model/base/hash.h"
#include "model/rules/rounds_rule.h"

namespace cuboct {
namespace {

void add(Hash& hash, const std::string& text) {
  for (const char c : text) hash.add(c);
}
void add(Hash& hash, const Vec3& value) {
  for (const double x : value) hash.add(std::bit_cast<int64_t>(x));
}

}  // namespace

Plan real_plan_of(const Scene& scene, const Arch& arch) {
  Plan plan;
  plan.arch = arch;
  plan.rule.cell_edge = scene.rule.cutoff();
  plan.rule.dt = scene.rule.dt;
  plan.rule.mass = scene.rule.mass;
  plan.particles = static_cast<uint32_t>(scene.body.size());
  Hash hash;
  for (const DeclarationLine& line : rounds_of(scene.rule)->settings())
    add(hash, line.name + line.text + line.note);
  hash.add(std::bit_cast<int64_t>(scene.rule.dt));
  for (size_t i = 0; i < scene.body.size(); ++i) {
    add(hash, scene.packing().x[i]);
    add(hash, scene.body.x[i]);
    add(hash, scene.body.v[i]);
    hash.add(scene.body.type[i]);
  }
  if (scene.body.bonds)
    for (const uint64_t word : scene.body.bonds->kept) hash.add(static_cast<int64_t>(word));
  plan.hash = hash.value();
  return plan;
}

}  // namespace cuboct
