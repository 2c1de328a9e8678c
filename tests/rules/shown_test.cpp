// SPDX-License-Identifier: MIT
// What a rule shows of its particles, and its way into a frame, a journal included.
#include <gtest/gtest.h>

#include <algorithm>

#include "model/run/journal.h"
#include "model/run/rounds_run.h"
#include "model/trace/trace.h"
#include "tests/rules/lps_body.h"
#include "tests/support/folder.h"

namespace cuboct {
namespace {

using Fields = std::vector<std::vector<double>>;

std::vector<std::string> names_of(const RuleDeclaration& rule) {
  std::vector<std::string> names;
  for (const RuleField& field : rule.shown) names.push_back(field.name);
  return names;
}

// A body that grows by e along each axis has the dilatation 3 e everywhere, at its surface too.
TEST(Shown, DilatationIsTheGrowthOfTheVolume) {
  const LpsMaterial m = test::cubic_material();
  const auto full = simple_cubic_bonds(1, 3);
  EXPECT_EQ(names_of(LpsRule(m, full).declaration()), std::vector<std::string>{"dilatation"});
  const Body body = test::cubic_block(5, 4, 4);
  test::LpsBody solid(m, full, body);
  std::vector<Vec3> grown = body.x;
  for (Vec3& x : grown) x *= 1.002;
  solid.forces(grown);
  const Fields shown = solid.terms().shown();
  ASSERT_EQ(shown.size(), 1u);
  ASSERT_EQ(shown[0].size(), body.size());
  for (const double dilatation : shown[0]) EXPECT_NEAR(dilatation, 3 * 0.002, 1e-14);
}

// Two halves torn apart: of each particle the bonds across are gone, counted one by one.
TEST(Shown, DamageIsTheShareOfTheBondsThatAreGone) {
  LpsMaterial m = test::cubic_material();
  m.critical_stretch = 0.01;
  const auto full = simple_cubic_bonds(1, 3);
  EXPECT_EQ(names_of(LpsRule(m, full).declaration()), (std::vector<std::string>{"dilatation", "damage"}));
  const Body body = test::cubic_block(8, 4, 4);
  test::LpsBody solid(m, full, body);
  const auto right = [&](size_t i) { return body.x[i][0] > 3.5; };
  std::vector<Vec3> torn = body.x;
  for (size_t i = 0; i < torn.size(); ++i)
    if (right(i)) torn[i][0] += 5;
  solid.forces(torn, true);
  const Fields shown = solid.terms().shown();
  ASSERT_EQ(shown.size(), 2u);
  ASSERT_EQ(shown[1].size(), body.size());
  double most = 0;
  for (size_t i = 0; i < body.size(); ++i) {
    double bonds = 0, across = 0;
    for (size_t j = 0; j < body.size(); ++j)
      if (j != i && (body.x[j] - body.x[i]).norm() < 3 + 1e-9) bonds += 1, across += right(i) != right(j);
    EXPECT_NEAR(shown[1][i], across / bonds, 1e-12) << i;
    most = std::max(most, shown[1][i]);
  }
  EXPECT_GT(most, 0.3);
  EXPECT_EQ(shown[1].front(), 0);
}

// Of an engine: at the state of the frame, not of the step before it.
TEST(Shown, FramesHaveWhatTheRuleShowsOfTheirState) {
  const Scene scene = parse_scene(
      "density = \"2440 kg/m^3\"\npacking = { pitch = \"1 mm\" }\n"
      "geometry = { shape = \"box\", min = \"[0, 0, 0] mm\", max = \"[6, 6, 3] mm\" }\n"
      "[[velocity]]\nregion = { shape = \"half_space\", point = \"[0, 3.1, 0] mm\", normal = \"y\" }\n"
      "uniform = \"[0, 40, 0] m/s\"\n"
      "[rule]\nkind = \"lps\"\nyoungs_modulus = \"72 GPa\"\npoissons_ratio = 0.22\n"
      "fracture_energy = \"3.8 J/m^2\"\n[run]\ndt = \"auto\"\nsteps = 40\n",
      "plate");
  RoundsRun run(scene, scene.body, {}, 1e-3);
  run.advance(40, nullptr);
  const RealFrame frame = std::get<RealFrame>(run.frame(false));
  ASSERT_EQ(frame.shown.size(), 2u);
  // The dilatation of these positions with these bonds: by a second look at the state alone.
  const auto* rounds = scene.rule.rounds.get();
  const auto terms = rounds->bind(scene.rule, scene.packing(), scene.periodic, 1);
  recall_bonds(*terms, *run.saved_body());
  terms->begin(frame.x);
  run_rounds(*terms, 2, frame.x.size(), false);
  EXPECT_EQ(frame.shown, terms->shown());
  EXPECT_GT(*std::max_element(frame.shown[1].begin(), frame.shown[1].end()), 0);
}

// A resumed run writes the frames of before from its journal.
TEST(Shown, AJournalKeepsIt) {
  const test::Folder folder;
  const std::string path = folder.path("journal");
  const std::vector<Vec3> x{Vec3(1, 2, 3), Vec3(4, 5, 6)};
  const RealFrame frames[] = {{0, x, x, {}, {}, {{7, 8}, {1, 2, 3, 4, 5, 6}}}, {9, x, x, {}, {}}};
  std::vector<RealFrame> read;
  WordMark end;
  {
    Journal journal(path, 5, false);
    for (const RealFrame& frame : frames) journal.frame(frame), journal.hash(frame.step, 1);
    end = journal.sync();
  }
  Trace trace;
  Journal(path, 5, false, end, trace).for_each_frame([&](const RunState& state) {
    read.push_back(std::get<RealFrame>(state));
  });
  ASSERT_EQ(read.size(), 2u);
  for (size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(read[k].step, frames[k].step);
    EXPECT_EQ(read[k].x, frames[k].x);
    EXPECT_EQ(read[k].v, frames[k].v);
    EXPECT_EQ(read[k].shown, frames[k].shown);
  }
}

}  // namespace
}  // namespace cuboct
