// SPDX-License-Identifier: MIT
#include "model/analysis/synopsis.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "model/base/output.h"
#include "model/base/quantity_text.h"

namespace cuboct {
namespace {

// The note, where there is one, stands behind a bar.
std::string line_of(const Scene& scene, const std::string& name) {
  for (const SynopsisLine& line : synopsis_of(scene))
    if (line.name == name) return line.note.empty() ? line.text : line.text + " | " + line.note;
  return "none";
}

Scene sheet_with(const std::string& run) {
  std::string text = read_text(CUBOCT_SOURCE_DIR "/scenes/sheet.toml");
  const std::string duration = "duration = \"0.3 ms\"\n";
  const size_t at = text.find(duration);
  EXPECT_NE(at, std::string::npos);
  return parse_scene(text.replace(at, duration.size(), run), "sheet");
}

// Bonds of stiffness k between particles of mass m at the pitch a carry waves at c = a sqrt(k/m); a run of T
// crosses a body of length L T c/L times.
TEST(Synopsis, TellsWavesByTheBonds) {
  const Scene scene = sheet_with("steps = 1000\n");
  const double c = scene.pitch * std::sqrt(1e6 / scene.rule.mass), length = body_size(scene)[0],
               duration = 1000 * scene.rule.dt;
  EXPECT_EQ(line_of(scene, "waves"),
            fmt::format("{}, {} from end to end", quantity_text(c, "m/s"), quantity_text(length / c, "s")));
  EXPECT_EQ(line_of(scene, "run"),
            fmt::format("1000 steps of {} = {}, {:.3g} crossings", quantity_text(scene.rule.dt, "s"),
                        quantity_text(duration, "s"), duration * c / length));
  EXPECT_EQ(line_of(scene, "body"),
            fmt::format("30 mm x 19.9 mm, {} particles of {}, 500 um apart", scene.body.size(),
                        quantity_text(1e3 * scene.rule.mass, "g")));
  EXPECT_EQ(line_of(scene, "loading"), "none");
  EXPECT_EQ(line_of(scene, "until"), "none");
  EXPECT_EQ(line_of(scene, "mesh"), "none");
}

TEST(Synopsis, CountsOneStepAsOne) {
  EXPECT_TRUE(line_of(sheet_with("steps = 1\n"), "run").starts_with("1 step of "));
}

TEST(Synopsis, TellsWhatEndsARun) {
  const Scene scene = sheet_with("steps = 400\nuntil = { probe = \"pull.force_x\", above = \"2 N\" }\n");
  EXPECT_EQ(line_of(scene, "until"), "pull.force_x is above 2 | or the last step");
  EXPECT_EQ(stage_synopsis(scene),
            fmt::format("400 steps of {} = {}, until pull.force_x is above 2, damped",
                        quantity_text(scene.rule.dt, "s"), quantity_text(400 * scene.rule.dt, "s")));
}

TEST(Synopsis, TellsStaticLoading) {
  const Scene scene = sheet_with("steps = 400\nstatic = { load_steps = 8, tolerance = 1e-3 }\n");
  EXPECT_EQ(line_of(scene, "loading"),
            "static: 8 load steps of 50 steps each, 0.001 of the load unbalanced at most");
}

// The box where it repeats; plain numbers in reduced units.
TEST(Synopsis, OfReducedUnitsHasNone) {
  const Scene scene = read_scene(CUBOCT_SOURCE_DIR "/scenes/lj_block.toml");
  const Vec3& box = scene.periodic.extent;
  EXPECT_EQ(line_of(scene, "body"),
            fmt::format("{:.3g} x {:.3g} x {:.3g}, repeats along xyz, 256 particles of mass 1, {:.3g} apart",
                        box[0], box[1], box[2], scene.pitch));
  EXPECT_TRUE(line_of(scene, "run").starts_with("1000 steps of 0.004 = 4, ")) << line_of(scene, "run");
}

}  // namespace
}  // namespace cuboct
