// SPDX-License-Identifier: MIT
// Boxes that deform, as users meet them: frames, traces, measures, checkpoints, stages, runs that go on.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "model/base/output.h"
#include "model/trace/left_state.h"
#include "model/trace/trace.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

class DeformRun : public testing::Test {
 protected:
  // 300 steps of 0.004 at 0.1: 12 %.
  std::string scene(const std::string& more = "",
                    const std::string& box = "deform = { strain_rate = [0.1, 0, 0] }\n") {
    const std::string path = bench_.path("stretched.toml");
    write_text(path,
               "units = \"reduced\"\nmass = 1.0\n[packing]\npitch = \"relaxed\"\n"
               "[box]\ncells = [4, 4, 4]\nperiodic = \"xyz\"\norigin = [1, 0, 0]\n" +
                   box +
                   "[law]\nkind = \"lj\"\nepsilon = 1.0\nsigma = 1.0\ncutoff = 2.0\n"
                   "[[velocity]]\nthermal_energy = 0.1\nseed = 3\n"
                   "[[probe]]\nname = \"box\"\nkind = \"stress\"\n"
                   "[[probe]]\nname = \"all\"\nkind = \"displacement\"\naxis = \"x\"\n"
                   "region = { shape = \"half_space\", point = [99, 0, 0], normal = \"x\" }\n"
                   "[run]\ndt = 0.004\nsteps = 300\nprobe_every = 50\nframe_every = 100\n" +
                   more);
    return path;
  }
  Answer cuboct(std::vector<std::string> words) const { return bench_.cuboct(words); }
  void run(const std::vector<std::string>& more, int code = 0) const {
    std::vector<std::string> words{"run", bench_.path("stretched.toml")};
    words.insert(words.end(), more.begin(), more.end());
    const Answer answer = cuboct(words);
    ASSERT_EQ(answer.code, code) << answer.out << answer.err;
  }
  std::string path(const std::string& name) const { return bench_.path(name); }
  static std::vector<double> curve(const Trace& trace, const std::string& name) {
    for (const Curve& one : trace.curves)
      if (one.name == name) return one.value;
    throw std::runtime_error("no curve " + name);
  }
  const Bench bench_{false};
};

// The lengths along x that a text file of frames has, by frame.
std::vector<double> lengths_in(const std::string& text, const std::string& before) {
  std::vector<double> lengths;
  for (size_t at = text.find(before); at != std::string::npos; at = text.find(before, at + 1))
    lengths.push_back(std::stod(text.substr(at + before.size())));
  return lengths;
}

// The cells of comma-separated lines.
std::vector<std::vector<std::string>> rows_of(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

TEST_F(DeformRun, FramesAndMeasuresHaveTheBoxOfTheirStep) {
  scene();
  run({"--out", path("run"), "--frames", "xyz"});
  const std::vector<double> boxes = lengths_in(contents(path("run/frames.xyz")), "Lattice=\"");
  ASSERT_EQ(boxes.size(), 4u);
  for (size_t k = 0; k < 4; ++k) EXPECT_NEAR(boxes[k] / boxes[0], 1 + 0.04 * static_cast<double>(k), 1e-8);

  // The probe while it ran, and the measure of its frames.
  const Trace trace = read_trace(path("run/trace.h5"));
  const Answer measured = cuboct({"measure", path("run"), "stress"});
  ASSERT_EQ(measured.code, 0) << measured.err;
  const std::vector<std::vector<std::string>> rows = rows_of(measured.out);
  ASSERT_EQ(rows.size(), 5u);
  const auto column = [&](const std::string& name) {
    const auto at = std::ranges::find(rows[0], name) - rows[0].begin();
    std::vector<double> values;
    for (size_t k = 1; k < rows.size(); ++k) values.push_back(std::stod(rows[k].at(static_cast<size_t>(at))));
    return values;
  };
  for (const char* name : {"xx", "yy", "xy"})
    for (size_t k = 0; k < 4; ++k)
      EXPECT_NEAR(column(name)[k], curve(trace, std::string("box.") + name)[2 * k], 1e-9) << name << k;
  EXPECT_NEAR(curve(trace, "box.strain_x").back(), 0.12, 1e-12);
  EXPECT_GT(curve(trace, "box.xx").back() - curve(trace, "box.xx").front(), 1);
  // All particles are carried, in the mean by half of what the box grows but for their own motion.
  EXPECT_NEAR(curve(trace, "all.along").back(), 0.12 * boxes[0] / 2, 0.1);
  for (const char* measure : {"rdf", "msd", "coordination", "cna"})
    EXPECT_EQ(cuboct({"measure", path("run"), measure}).code, 0) << measure;
  EXPECT_EQ(cuboct({"report", path("run")}).code, 0);
  EXPECT_NE(contents(path("run/report.html")).find("Stress: box"), std::string::npos);
}

TEST_F(DeformRun, ACutRunGoesOnWithTheSameBits) {
  scene();
  run({"--out", path("whole")});
  const Answer cut =
      bench_.cuboct({"run", path("stretched.toml"), "--out", path("cut"), "--checkpoint-every", "70 steps"},
                    there(path("cut/checkpoint")));
  if (cut.code == 0) GTEST_SKIP() << "the run had ended before the signal came";
  run({"--out", path("cut"), "--resume"});
  const Trace whole = read_trace(path("whole/trace.h5")), on = read_trace(path("cut/trace.h5"));
  ASSERT_EQ(whole.bodies.size(), on.bodies.size());
  for (size_t k = 0; k < whole.bodies.size(); ++k) EXPECT_EQ(whole.bodies[k].x, on.bodies[k].x) << k;
  EXPECT_EQ(curve(whole, "box.xx"), curve(on, "box.xx"));
  EXPECT_EQ(whole.curves[0].step, on.curves[0].step);
}

// Load, hold, and go back: each begins in the box that the one before left; any engine may run what is held.
TEST_F(DeformRun, StagesLoadHoldAndReturn) {
  scene(
      "[[stage]]\nname = \"load\"\nsteps = 200\n"
      "[[stage]]\nname = \"hold\"\nsteps = 100\ndeform = false\n"
      "[[stage]]\nname = \"back\"\nsteps = 200\ndeform = { final_strain = [0, 0, 0] }\n");
  run({"--out", path("stages")});
  const auto strain = [&](const char* stage) {
    return curve(read_trace(path(std::string("stages/") + stage + "/trace.h5")), "box.strain_x");
  };
  const std::vector<double> load = strain("1-load"), hold = strain("2-hold"), back = strain("3-back");
  EXPECT_NEAR(load.back(), 0.08, 1e-12);
  for (const double held : hold) EXPECT_EQ(held, load.back());
  EXPECT_EQ(back.front(), hold.back());
  EXPECT_NEAR(back.back(), 0, 1e-15);
  EXPECT_NEAR(read_left_state(path("stages/1-load/trace.h5")).box_strain[0], 0.08, 1e-12);
  // Pressures of the end of one stage, in doubles, and of the beginning of the next, in integers.
  const Trace held = read_trace(path("stages/2-hold/trace.h5")),
              loaded = read_trace(path("stages/1-load/trace.h5"));
  EXPECT_NEAR(curve(held, "pressure").front(), curve(loaded, "pressure").back(), 2e-3);

  // In integers, from the box that was left.
  run({"--stage", "hold", "--from", path("stages/1-load"), "--engine", "golden", "--out", path("fixed")});
  const Trace fixed = read_trace(path("fixed/2-hold/trace.h5"));
  EXPECT_NEAR(curve(fixed, "box.xx").front(), curve(held, "box.xx").front(), 1e-3);
  EXPECT_NEAR(curve(fixed, "pressure").front(), curve(held, "pressure").front(), 1e-3);
}

TEST_F(DeformRun, CheckTellsAndOthersRefuse) {
  const std::string file = scene();
  const Answer told = cuboct({"check", file});
  EXPECT_EQ(told.code, 0) << told.err;
  EXPECT_NE(told.out.find("box      deforms, at the end strain 12 % along x, 6.97 long, at 0.1 "
                          "(for the reference engine alone)\n"),
            std::string::npos)
      << told.out;
  EXPECT_NE(told.out.find("machine  none: the cells of a machine keep their size, and the box deforms\n"),
            std::string::npos)
      << told.out;
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"run", file, "--engine", "lattice"}, {"crosscheck", file}}) {
    const Answer answer = cuboct(words);
    EXPECT_EQ(answer.code, 2) << words[0];
    EXPECT_EQ(answer.out, "");
    const std::string who = words[0] == "run" ? "lattice" : "golden";
    EXPECT_EQ(without_excerpt(answer.err),
              file + ":9:10: a box that deforms is not for the " + who +
                  " engine\n  hint: --engine reference carries its particles along\n");
  }
}

}  // namespace
}  // namespace cuboct::test
