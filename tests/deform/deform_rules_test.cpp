// SPDX-License-Identifier: MIT
// Boxes that deform under rules of several rounds: embedded atoms as text, and Tersoff's bond order.
#include <gtest/gtest.h>

#include <cmath>

#include "model/atoms/bond_order/crystal_rest.h"
#include "model/run/reference_kind.h"
#include "model/run/rounds_run.h"
#include "tests/rules/metal.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

const SceneChoice kOfARun{.begins = true, .stage = {}};

// A warm crystal whose box is pulled along x and pressed along z.
std::string of_rule(const std::string& place, const std::string& rule, const std::string& rate, int steps) {
  return "mass = \"63.546 u\"\n" + place + "periodic = \"xyz\"\ndeform = { strain_rate = \"" + rate +
         " 1/s\" }\n" + rule +
         "[[velocity]]\ntemperature = \"600 K\"\nseed = 4\n"
         "[[probe]]\nname = \"box\"\nkind = \"stress\"\nvirial = true\n"
         "[run]\ndt = \"1 fs\"\nprobe_every = 1\nsteps = " +
         std::to_string(steps) + "\n";
}
Scene scene_at_rules(const std::string& text) {
  return parse_scene(text, CUBOCT_SOURCE_DIR "/scenes/rules/test.toml", kOfARun);
}
Scene copper(const std::string& rate, int steps = 100) {
  return scene_at_rules(of_rule(
      "[packing]\npitch = \"2.556191 angstrom\"\n[box]\ncells = [4, 4, 4]\n",
      "[rule]\nfile = \"texts/eam.toml\"\npotential.file = \"texts/copper.eam.alloy\"\n", rate, steps));
}
Scene silicon(const std::string& rate, int steps = 100) {
  return scene_at_rules(of_rule("[crystal]\nlattice = \"diamond\"\n[box]\ncells = [2, 2, 3]\n",
                                "[rule]\nkind = \"tersoff\"\npotential = \"si_1989\"\n", rate, steps));
}

// What the energy gains is the box's work, whose trapezoids err by the square of a step's strain.
void expect_work(const Scene& scene) {
  RunRequest request;
  request.steps = scene.steps;
  for (uint64_t step = 0; step <= scene.steps; ++step) request.probes.push_back(step);
  request.energies = true;
  const Recorded done =
      record(scene, scene_reference_kind(scene, scene.body, {.integrator = Integrator::velocity_verlet}, 1),
             request);
  ASSERT_FALSE(done.trace.stop) << done.trace.stop->text;
  const auto values = [&](const std::string& name) -> const std::vector<double>& {
    for (const Curve& one : done.trace.curves)
      if (one.name == name) return one.value;
    throw std::runtime_error("no curve " + name);
  };
  double work = 0;
  for (const int axis : {0, 2}) {
    const std::vector<double>& stress = values(axis == 0 ? "box.xx" : "box.zz");
    for (size_t k = 1; k < stress.size(); ++k) {
      const Periodic before = scene.box_at(k - 1), now = scene.box_at(k);
      work += (stress[k - 1] * before.extent.prod() + stress[k] * now.extent.prod()) / 2 *
              std::log(now.extent[axis] / before.extent[axis]);
    }
  }
  const double gained = values("energy.total").back() - values("energy.total").front();
  EXPECT_GT(std::abs(gained) / test::kEv, 0.3);
  EXPECT_NEAR(work, gained, 5e-3 * std::abs(gained));
}

// An engine that is made anew at each step has the same bits: no list lasts too long.
void expect_same_bits(const Scene& scene) {
  RoundsRun whole(scene, scene.body, {}, 1);
  Body body = scene.body;
  for (uint64_t step = 0; step < 60; ++step) {
    RoundsRun one(scene, body, {}, 1, step);
    one.advance(1, nullptr);
    body = *one.saved_body();
    whole.advance(1, nullptr);
    const Body& there = *whole.saved_body();
    for (size_t i = 0; i < body.size(); ++i)
      ASSERT_EQ(body.x[i], there.x[i]) << "step " << step << ", particle " << i;
  }
}

TEST(BoxDeformRules, EmbeddedAtomsTakeTheWorkOfTheBox) { expect_work(copper("[6e11, 0, -4e11]")); }
TEST(BoxDeformRules, TersoffTakesTheWorkOfTheBox) { expect_work(silicon("[3e11, 0, -2e11]")); }
TEST(BoxDeformRules, ListsOfEmbeddedAtomsLeaveNoMark) { expect_same_bits(copper("[-6e12, 1e12, 0]", 60)); }
TEST(BoxDeformRules, ListsOfTersoffLeaveNoMark) { expect_same_bits(silicon("[-2e12, 1e12, 0]")); }

TEST(BoxDeformRules, LastingBondsTakeABoxOfOneSize) {
  EXPECT_EQ(
      refused_with([] {
        parse_scene(
            "density = \"1 g/cm^3\"\npacking = { pitch = \"1 mm\" }\n[box]\ncells = [4, 4, 4]\nperiodic = "
            "\"xyz\"\ndeform = { final_strain = [0.1, 0, 0] }\n[rule]\nkind = \"lps\"\n"
            "bulk_modulus = \"40 GPa\"\npoissons_ratio = 0.2\n[run]\nsteps = 10\n",
            "a.toml", kOfARun);
      }),
      "a.toml:6:10: the rule 'lps' has bonds of the body as packed, in a box of one size\n"
      "  hint: pair laws, Tersoff's potential and rules of text without lasting bonds let the box deform");
}

}  // namespace
}  // namespace cuboct
