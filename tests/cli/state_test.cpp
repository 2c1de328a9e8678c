// SPDX-License-Identifier: MIT
// The end of a run as a file of particles, and a scene that begins with it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "model/base/output.h"
#include "model/trace/trace.h"
#include "tests/cli/refusal.h"

namespace cuboct::test {
namespace {

class StateFile : public testing::Test {
 protected:
  std::string scene(const std::string& name, const std::string& particles, int steps) const {
    const std::string path = bench_.path(name);
    std::ofstream(path)
        << "units = \"reduced\"\nmass = 1\n"
        << particles
        << "[law]\nkind = \"lj\"\nepsilon = 1\nsigma = 1\ncutoff = 1.6\n[[material]]\nname = \"a b\"\n"
           "[[material]]\nname = \"Cu\"\nregion = { shape = \"half_space\", point = [2.5, 0, 0], normal "
           "= \"-x\" }\nmass = 2\n[run]\ndt = 0.004\nframe_every = 100\nsteps = "
        << steps << "\n";
    return path;
  }
  std::string packed() const {
    return scene(
        "packed.toml",
        "packing = { pitch = 1.12 }\n[box]\ncells = [4, 4, 4]\nperiodic = \"xyz\"\norigin = [0.25, 0, 0]\n"
        "[[velocity]]\nthermal_energy = 1.2\nseed = 4\n",
        200);
  }
  void run(const std::string& path, const std::string& out, const std::string& engine) const {
    const Answer answer =
        bench_.cuboct({"run", path, "--engine", engine, "--out", bench_.path(out), "--frames", "none"});
    ASSERT_EQ(answer.code, 0) << answer.err;
  }
  // Behind the two lines of the head.
  static std::string rows(const std::string& path) {
    const std::string text = read_text(path);
    return text.substr(text.find('\n', text.find('\n') + 1) + 1);
  }
  const Bench bench_{false};
};

// 200 steps, a file, a scene that begins with it, no step, a file again: what stands in both is equal to the
// last bit. In integers positions are whole multiples of their unit, and 17 digits bring each back; in
// doubles those outside of the box come back as their images.
TEST_F(StateFile, OfTwoHundredStepsComesBack) {
  const std::string at_start = packed();
  for (const std::string engine : {"lattice", "reference"}) {
    run(at_start, engine, engine);
    const Answer saved = bench_.cuboct({"state", bench_.path(engine), "--out", bench_.path(engine + ".xyz")});
    EXPECT_EQ(saved.code, 0) << saved.err;
    EXPECT_EQ(saved.out, bench_.path(engine + ".xyz") + ": 256 particles at step 200\n");
    const std::string again =
        scene(engine + "_again.toml", "[particles]\nfile = \"" + engine + ".xyz\"\n", 0);
    run(again, engine + "_again", engine);
    const Answer twice =
        bench_.cuboct({"state", bench_.path(engine + "_again"), "--out", bench_.path("twice.xyz"), "--json"});
    EXPECT_EQ(twice.out, fmt::format("{{\"file\":\"{}\",\n\"particles\":256,\n\"step\":0}}\n",
                                     bench_.path("twice.xyz")));
    std::istringstream first(rows(bench_.path(engine + ".xyz"))), second(rows(bench_.path("twice.xyz")));
    std::string species, material, constraint;
    const double extent = 4 * 1.12 * std::sqrt(2);
    size_t count = 0, copper = 0, moved = 0;
    for (std::string line; std::getline(first, line); ++count) {
      std::array<double, 3> x{}, v{}, there{}, there_v{};
      double id = 0, type = 0;
      std::istringstream words(line);
      words >> species >> x[0] >> x[1] >> x[2] >> id >> type >> material >> constraint >> v[0] >> v[1] >>
          v[2];
      copper += species == "Cu";
      EXPECT_EQ(material, species == "Cu" ? "Cu" : "a_b");
      second >> species >> there[0] >> there[1] >> there[2] >> id >> type >> material >> constraint >>
          there_v[0] >> there_v[1] >> there_v[2];
      EXPECT_EQ(id, static_cast<double>(count));
      EXPECT_EQ(v, there_v) << line;
      for (int a = 0; a < 3; ++a) {
        const double low = a == 0 ? 0.25 : 0;
        const bool inside = x[a] >= low && x[a] < low + extent;
        moved += v[a] != 0;
        if (engine == "lattice" || inside)
          EXPECT_EQ(x[a], there[a]) << line;
        else
          EXPECT_NEAR(std::remainder(x[a] - there[a], extent), 0, 1e-14) << line;
      }
    }
    EXPECT_EQ(count, 256U);
    EXPECT_GT(copper, 50U);
    EXPECT_EQ(moved, 3 * count);
  }
}

TEST_F(StateFile, IsOfAFrameThatTheRunKept) {
  const std::string at_start = packed();
  run(at_start, "run", "lattice");
  const std::string file = bench_.path("first.xyz");
  EXPECT_EQ(bench_.cuboct({"state", bench_.path("run"), "--out", file, "--step", "100"}).out,
            file + ": 256 particles at step 100\n");
  EXPECT_NE(read_text(file).find(" Step=100 Time=0.4\n"), std::string::npos);
  const Answer none = bench_.cuboct({"state", bench_.path("run"), "--out", file, "--step", "50"});
  EXPECT_EQ(none.code, 2);
  EXPECT_EQ(none.err,
            "--step: no frame of step 50\n  hint: kept are 0, 100, 200; 'frame_every' of [run] keeps more\n");
  EXPECT_EQ(bench_.cuboct({"state", bench_.path("none"), "--out", file}).code, 2);
  const Answer nowhere = bench_.cuboct({"state", bench_.path("run"), "--out", bench_.path("none/a.xyz")});
  EXPECT_EQ(nowhere.code, 2);
  EXPECT_TRUE(nowhere.err.starts_with("cannot write " + bench_.path("none/a.xyz"))) << nowhere.err;
}

// Every engine begins with the same bits, from wherever it is started, and stages and runs that go on as
// well.
TEST_F(StateFile, BeginsRunsAndStages) {
  run(packed(), "run", "lattice");
  ASSERT_EQ(bench_.cuboct({"state", bench_.path("run"), "--out", bench_.path("at.xyz")}).code, 0);
  const std::string again = scene("again.toml", "[particles]\nfile = \"at.xyz\"\n", 20);
  const Answer same = bench_.cuboct({"crosscheck", again, "--engines", "golden,lattice"});
  EXPECT_EQ(same.code, 0) << same.err;
  EXPECT_NE(same.out.find("matched 5120 updates over 20 steps in 2 engines"), std::string::npos) << same.out;
  // In two stages.
  std::ofstream(again, std::ios::app)
      << "[[stage]]\nname = \"one\"\nsteps = 10\n[[stage]]\nname = \"two\"\nsteps = 10\n";
  const Answer staged = bench_.cuboct({"run", again, "--out", bench_.path("staged"), "--frames", "none"});
  ASSERT_EQ(staged.code, 0) << staged.err;
  const std::string whole = scene("whole.toml", "[particles]\nfile = \"at.xyz\"\n", 20);
  run(whole, "whole", "lattice");
  EXPECT_EQ(read_trace(bench_.path("staged/2-two/trace.h5")).state_hash.back(),
            read_trace(bench_.path("whole/trace.h5")).state_hash.back());
}

}  // namespace
}  // namespace cuboct::test
