// SPDX-License-Identifier: MIT
// Rules of text in floats and doubles, with loops for kernels, beside the reference: every rule that ships.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "emu/gpu/rounds/real_rounds_engine.h"
#include "model/rules/rounds_rule.h"
#include "model/real/reference.h"
#include "model/run/start.h"
#include "tests/gpu/host_compiler.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

const std::string kRules = CUBOCT_SOURCE_DIR "/scenes/rules/";

// Of several stages the first.
Scene rule_scene(const std::string& name) {
  const std::string file = kRules + name + ".toml";
  const std::vector<StageName> stages = stages_of(file);
  return read_scene(file, {.stage = stages.empty() ? "" : stages.front().name});
}

Body begin_of(const Scene& scene) {
  Body body = with_bonds(scene.rule, scene.body, scene.body);
  const bool held = std::ranges::any_of(scene.rule.types, &ParticleType::pd);
  if (held && body.u.empty()) body.u.assign(body.size(), Vec3::Zero());
  return body;
}

double furthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0;
  for (size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

double largest(const std::vector<Vec3>& a) {
  double most = 0;
  for (const Vec3& v : a) most = std::max(most, v.norm());
  return most;
}

TEST(RealRounds, Probe) {
  for (const char* name : {"heat", "glass", "plastic", "copper", "langevin", "dpd"})
    for (const bool doubles : {false, true}) {
      const Scene scene = rule_scene(name);
      const Body body = begin_of(scene);
      const auto device = gpu::make_real_rounds(scene.rule, body, scene.periodic, doubles, {},
                                                host_compiler(std::string("real_") + name));
      Reference reference(scene.rule, body, scene.periodic);
      const gpu::RealLook look = device->look();
      const std::vector<Vec3> force = reference.forces();
      std::printf("%s %d: force off %g of %g", name, doubles, look.force.empty() ? 0 : furthest(look.force, force), largest(force));
      const uint64_t steps = 60;
      device->advance(steps);
      reference.step(steps);
      Body now = body;
      device->read(now);
      std::printf("; x off %g of %g, v off %g of %g\n", furthest(now.x, reference.body().x),
                  furthest(reference.body().x, body.x), furthest(now.v, reference.body().v), largest(reference.body().v));
      const auto shown = reference.terms()->shown();
      const gpu::RealLook after = device->look();
      for (size_t f = 0; f < shown.size(); ++f) {
        double off = 0, most = 0;
        for (size_t i = 0; i < shown[f].size(); ++i) most = std::max(most, std::abs(shown[f][i]));
        (void)off;
        std::printf("   field %zu most %g, first %g\n", f, most, after.fields[f][0] - shown[f][0]);
      }
    }
}

}  // namespace
}  // namespace cuboct::test
