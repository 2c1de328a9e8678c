// SPDX-License-Identifier: MIT
// Rules of text in floats and doubles on several devices that do their work in any order that events allow:
// the bits of one device, however many slabs a scene has, and whatever crosses their borders.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "emu/gpu/device/device.h"
#include "emu/gpu/rounds/real_rounds_engine.h"
#include "emu/gpu/rounds/real_space.h"
#include "model/real/real_engine.h"
#include "tests/gpu/host_compiler.h"
#include "tests/gpu/rule_scenes.h"
#include "tests/gpu/torn_glass.h"

namespace cuboct::test {
namespace {

// Each text once.
gpu::CompileRounds compile_once(const std::string& name) {
  auto path = std::make_shared<std::string>();
  return [path, compile = host_compiler("slabs_" + name)](const std::string& source,
                                                          const std::string& architecture) {
    if (path->empty()) *path = compile(source, architecture);
    return *path;
  };
}

class RealSlabs : public testing::Test {
 protected:
  RealSlabs() { gpu::Shuffle::all().on = true; }
  ~RealSlabs() override { gpu::Shuffle::all().on = false; }
};

struct OneScene {
  std::unique_ptr<gpu::RealRounds> make(int slabs) const { return make(slabs, begin, {}); }
  std::unique_ptr<gpu::RealRounds> make(int slabs, const Body& from, const gpu::Memory& memory) const {
    return gpu::make_real_rounds(scene.rule, from, scene.periodic, doubles, of_slabs(slabs), compile, memory);
  }
  // Another run goes on from where this one is, with as many slabs as asked for.
  std::unique_ptr<gpu::RealRounds> gone_on(const gpu::RealRounds& run, int slabs) const {
    Body here = begin;
    run.read(here);
    const auto holder = make_real_engine(scene.rule, begin, scene.periodic, {});
    holder->recall(run.kept());
    keep_bonds(here, *holder->kept_terms());
    const std::vector<uint64_t> words = run.memory();
    return make(slabs, here, {run.step_count(), words});
  }

  Scene scene;
  bool doubles;
  Body begin = begin_of(scene);
  gpu::CompileRounds compile;
};

void expect_same(const OneScene& run, const gpu::RealRounds& found, const gpu::RealRounds& expected) {
  Body a = run.begin, b = run.begin;
  found.read(a), expected.read(b);
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.v, b.v);
  EXPECT_EQ(a.u, b.u);
  EXPECT_EQ(found.kept(), expected.kept());
  EXPECT_EQ(found.memory(), expected.memory());
  EXPECT_EQ(found.step_count(), expected.step_count());
}

double counted(const gpu::RealRounds& run, const std::string& name) {
  for (const auto& [counter, value] : run.counters())
    if (counter == name) return value;
  ADD_FAILURE() << "no counter " << name;
  return 0;
}

// Batches end elsewhere, too, and runs go on with other numbers of slabs.
void compare(const std::string& name, const Scene& scene, bool doubles, int slabs, uint64_t steps) {
  SCOPED_TRACE(fmt::format("{}, {} slabs", name, slabs));
  const OneScene run{scene, doubles, begin_of(scene), compile_once(name)};
  const auto whole = run.make(1);
  const auto parts = run.make(slabs);
  whole->advance(steps / 2);
  parts->advance(steps / 2 - 1), parts->advance(1);
  expect_same(run, *parts, *whole);
  const gpu::RealLook a = parts->look(), b = whole->look();
  EXPECT_EQ(a.force, b.force);
  EXPECT_EQ(a.fields, b.fields);
  const auto fewer = run.gone_on(*parts, 1), others = run.gone_on(*whole, slabs);
  for (const auto* one : {&whole, &parts, &fewer, &others}) (*one)->advance(steps - steps / 2);
  for (const auto* one : {&parts, &fewer, &others}) expect_same(run, **one, *whole);
  EXPECT_GT(counted(*parts, "halo_particles"), 0);
  EXPECT_EQ(counted(*parts, "list_builds"), counted(*whole, "list_builds"));
  EXPECT_EQ(counted(*parts, "longest_list"), counted(*whole, "longest_list"));
  EXPECT_EQ(counted(*parts, "listed_pairs"), counted(*whole, "listed_pairs"));
}

TEST_F(RealSlabs, HaveTheBitsOfOneDevice) {
  compare("heat", rule_scene("heat"), false, 3, 20);
  compare("copper", rule_scene("copper"), false, 2, 10);
  compare("langevin", rule_scene("langevin"), true, 3, 30);
  compare("dpd", rule_scene("dpd"), false, 2, 20);
  EXPECT_GT(gpu::Shuffle::all().overtaken, 1000u);
}

TEST_F(RealSlabs, KeepBondsThatBreakAndYield) {
  compare("torn", torn_glass(CUBOCT_SOURCE_DIR "/scenes/rules/"), false, 3, 30);
  compare("plastic", rule_scene("plastic"), true, 2, 10);
}

// All travel through more than half of the box, across its seam too.
TEST_F(RealSlabs, ExchangeParticles) {
  Scene scene = rule_scene("langevin");
  constexpr int kSteps = 40;
  for (int a = 0; a < 3; ++a)
    for (Vec3& v : scene.body.v) v[a] += 0.6 * scene.periodic.extent[a] / (kSteps * scene.rule.dt);
  compare("langevin", scene, true, 3, kSteps);
  const OneScene run{scene, true, begin_of(scene), compile_once("langevin")};
  const auto parts = run.make(3);
  parts->advance(kSteps);
  EXPECT_GT(counted(*parts, "list_builds"), 5);
}

// The upper half rests: it learns of the lower one alone that near lists serve no longer, and atoms that it
// had not near come within reach.
TEST_F(RealSlabs, TellEachOtherOfOutlivedNearLists) {
  Scene scene = parse_scene(
      "mass = \"40 u\"\npacking = { pitch = \"4 angstrom\" }\nrun = { dt = \"1 fs\", steps = 20 }\n"
      "geometry = { shape = \"box\", min = \"[0, 0, 0] angstrom\", max = \"[40, 12, 12] angstrom\" }\n"
      "[rule]\nname = \"argon\"\nreach = \"5.3 angstrom\"\n"
      "parameters = { depth = \"10 meV\", size = \"3.4 angstrom\" }\n[[rule.round]]\nsum.force = "
      "\"-48 * depth * (size^12 / r^14 - size^6 / r^8 / 2) * d\"\n",
      "halves.toml");
  std::vector<double> along;
  for (const Vec3& x : scene.body.x) along.push_back(x[0]);
  std::ranges::nth_element(along, along.begin() + static_cast<ptrdiff_t>(along.size() / 2));
  const double middle = along[along.size() / 2];
  for (size_t i = 0; i < scene.body.size(); ++i) {
    const bool lower = scene.body.x[i][0] < middle;
    scene.body.v[i] = Vec3(lower ? 3000 : 0, 0, 0);
    scene.body.x[i][0] += lower ? 0 : 5e-10;
  }
  compare("halves", scene, false, 2, 180);
}

// One device finds that a step cannot be, and the others, which could go on, have not gone beyond it.
TEST_F(RealSlabs, StopBeforeTheSameStep) {
  Scene scene = torn_glass(CUBOCT_SOURCE_DIR "/scenes/rules/");
  const gpu::RealSpace space(scene.body, scene.periodic, scene.rule.cutoff(), true);
  const double dt = scene.rule.dt, furthest = space.furthest(0, true) * space.unit[0];
  uint32_t flyer = 0;
  while (scene.rule.types[scene.body.type[flyer]].imposed[0]) ++flyer;
  scene.body.v[flyer] = Vec3((1 - 2.5e-6) * furthest / dt, 0, 0);
  for (ParticleType& type : scene.rule.types) type.gravity[0] = 1e-6 * furthest / (dt * dt);
  const OneScene run{scene, true, begin_of(scene), compile_once("torn")};
  const auto whole = run.make(1);
  EXPECT_THROW(whole->advance(20), gpu::LostPosition);
  EXPECT_EQ(whole->step_count(), 2u);
  for (const int slabs : {2, 3}) {
    const auto parts = run.make(slabs);
    try {
      parts->advance(20);
      FAIL() << slabs;
    } catch (const gpu::LostPosition& error) {
      EXPECT_EQ(error.particle, flyer);
    }
    expect_same(run, *parts, *whole);
  }
}

}  // namespace
}  // namespace cuboct::test
