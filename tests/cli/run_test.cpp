// SPDX-License-Identifier: MIT
// Runs: the summary, the files, the end by Ctrl-C.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <regex>

#include "model/trace/trace.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

// The value of a line "name   value ..." of a summary.
std::string value_of(const std::string& summary, const std::string& name) {
  std::smatch found;
  const std::regex line("(^|\n)" + name + "  +([^\n]*)");
  return std::regex_search(summary, found, line) ? found[2].str() : "no " + name;
}

TEST(Run, KeepsMomentumToTheLastBit) {
  const Answer answer = Bench(false).cuboct({"run", "scenes/undamped_block.toml", "--steps", "50"});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_EQ(value_of(answer.out, "momentum change"), "0 LSB");
  EXPECT_EQ(value_of(answer.out, "steps"), "50");
  EXPECT_EQ(value_of(answer.out, "engine"), "lattice");
}

TEST(Run, DriftsLittleWhereEnergyIsKept) {
  const Answer answer = Bench(false).cuboct({"run", "scenes/lj_block.toml", "--steps", "200"});
  ASSERT_EQ(answer.code, 0) << answer.err;
  // 256 particles with 0.2 epsilon of thermal energy each; leapfrog's error of the energy is of order dt^2.
  const double drift = std::stod(value_of(answer.out, "energy drift")),
               energy = std::stod(value_of(answer.out, "energy"));
  EXPECT_GT(drift, 0);
  EXPECT_LT(drift, 1e-3 * std::abs(energy));
}

TEST(Run, WritesItsDirectoryTheSameEachTime) {
  const Bench bench(false);
  for (const char* name : {"a", "b"})
    ASSERT_EQ(bench
                  .cuboct({"run", "scenes/coupon.toml", "--steps", "20", "--frame-every", "10", "--out",
                           bench.path(name)})
                  .code,
              0);
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(bench.path("a"))) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"frames.pvd", "frames.xyz", "frames_000000.vtp",
                                             "frames_000001.vtp", "frames_000002.vtp", "plan.txt",
                                             "rasters.h5", "run.toml", "summary.json", "trace.h5"}));
  for (const std::string& name : names)
    if (name != "trace.h5" && name != "summary.json") {  // these tell the host's time
      EXPECT_EQ(contents(bench.path("a/" + name)), contents(bench.path("b/" + name))) << name;
    }
  const Trace a = read_trace(bench.path("a/trace.h5")), b = read_trace(bench.path("b/trace.h5"));
  EXPECT_EQ(a.steps(), 20u);
  EXPECT_EQ(a.state_hash, b.state_hash);
  ASSERT_EQ(a.frames.size(), 3u);
  EXPECT_EQ(a.frames[1].step, 10u);
  ASSERT_FALSE(a.curves.empty());
  EXPECT_EQ(a.curves[0].name, "tension.strain");
  EXPECT_EQ(a.curves[0].value[0], 0);
}

TEST(Run, OfAnEngineBesideGivesGoldensCurves) {
  const Bench bench(true);
  const auto run = [&](const std::string& engine) {
    std::vector<std::string> arguments{"run",   "scenes/coupon.toml", "--steps", "60", "--engine", engine,
                                       "--out", bench.path(engine)};
    if (engine == "lattice") arguments.insert(arguments.end(), {"--hash-every", "1"});
    EXPECT_EQ(bench.cuboct(arguments).code, 0);
    return read_trace(bench.path(engine + "/trace.h5"));
  };
  const Trace golden = run("golden");
  for (const std::string engine : {"lattice", "systemc"}) {
    const Trace other = run(engine);
    EXPECT_EQ(other.engine, engine);
    EXPECT_EQ(golden.state_hash, other.state_hash);
    ASSERT_EQ(golden.curves.size(), other.curves.size());
    for (size_t i = 0; i < golden.curves.size(); ++i) {
      EXPECT_EQ(golden.curves[i].name, other.curves[i].name);
      EXPECT_EQ(golden.curves[i].step, other.curves[i].step);
      EXPECT_EQ(golden.curves[i].value, other.curves[i].value);
    }
    EXPECT_EQ(contents(bench.path("golden/frames.xyz")), contents(bench.path(engine + "/frames.xyz")));
  }
}

TEST(Run, OfTheReferenceFollowsGolden) {
  const Bench bench(false);
  std::vector<double> stress;
  for (const char* engine : {"golden", "reference"}) {
    ASSERT_EQ(bench
                  .cuboct({"run", "scenes/coupon.toml", "--steps", "500", "--engine", engine, "--out",
                           bench.path(engine)})
                  .code,
              0);
    const Trace trace = read_trace(bench.path(std::string(engine) + "/trace.h5"));
    ASSERT_EQ(trace.curves[1].name, "tension.stress");
    stress.push_back(*std::max_element(trace.curves[1].value.begin(), trace.curves[1].value.end()));
  }
  // The table's worst force error is below 1e-3 of the largest force.
  EXPECT_GT(stress[1], 0);
  EXPECT_NEAR(stress[0], stress[1], 1e-2 * stress[1]);
}

// Frames hold the state to six digits or more: threads leave no mark in them, floats and the other integrator
// do.
TEST(Run, OfTheReferenceTakesItsOptions) {
  const Bench bench(false);
  const auto run = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> arguments{
        "run", "scenes/coupon.toml", "--engine", "reference", "--steps", "100", "--out", bench.path(name)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Answer answer = bench.cuboct(arguments);
    EXPECT_EQ(answer.code, 0) << answer.err;
    return answer.out;
  };
  const auto stress = [&](const std::string& name) {
    const Trace trace = read_trace(bench.path(name + "/trace.h5"));
    EXPECT_EQ(trace.curves[1].name, "tension.stress");
    return trace.curves[1].value.back();
  };
  std::string out = run("one", {"--threads", "1"});
  EXPECT_EQ(value_of(out, "precision"), "double");
  EXPECT_EQ(value_of(out, "integrator"), "semi-implicit Euler");
  EXPECT_EQ(value_of(out, "threads"), "1");
  out = run("two", {"--threads", "2"});
  EXPECT_EQ(value_of(out, "threads"), "2");
  EXPECT_EQ(contents(bench.path("one/frames.xyz")), contents(bench.path("two/frames.xyz")));
  EXPECT_EQ(read_trace(bench.path("one/trace.h5")).curves.back().name, "energy.total");
  EXPECT_EQ(stress("one"), stress("two"));
  out = run("float", {"--precision", "float"});
  EXPECT_EQ(value_of(out, "precision"), "float");
  // 2^-24 of coordinates of 20 pitches, over a strain of 1e-3 or so.
  EXPECT_NE(stress("one"), stress("float"));
  EXPECT_NEAR(stress("one"), stress("float"), 0.05 * std::abs(stress("one")));
  out = run("verlet", {"--integrator", "verlet"});
  EXPECT_EQ(value_of(out, "integrator"), "velocity Verlet");
  EXPECT_NE(stress("one"), stress("verlet"));
  EXPECT_NEAR(stress("one"), stress("verlet"), 0.05 * std::abs(stress("one")));
}

// Summary and trace of three processes are those of one.
TEST(Run, SharesASceneAmongRanks) {
  const Bench bench(false);
  fs::copy(CUBOCT_LATTICE, bench.path("bin/cuboct-lattice"));
  const auto run = [&](const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"run",           "scenes/undamped_block.toml",
                                       "--steps",       "120",
                                       "--frame-every", "40",
                                       "--hash-every",  "1",
                                       "--out",         bench.path(out)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return bench.cuboct(arguments);
  };
  const Answer one = run("one", {}), three = run("three", {"--ranks", "3"});
  ASSERT_EQ(one.code, 0) << one.err;
  if (three.code == 2 && three.err.find("MPI") != std::string::npos) GTEST_SKIP() << three.err;
  ASSERT_EQ(three.code, 0) << three.err;
  const Trace alone = read_trace(bench.path("one/trace.h5")),
              shared = read_trace(bench.path("three/trace.h5"));
  ASSERT_EQ(shared.state_hash.size(), 121u);
  EXPECT_EQ(alone.state_hash, shared.state_hash);
  EXPECT_EQ(alone.frames, shared.frames);
  for (const char* line : {"momentum change", "largest speed", "energy", "state hash"})
    EXPECT_EQ(value_of(one.out, line), value_of(three.out, line));
}

TEST(Run, EndsCleanlyOnCtrlC) {
  const Bench bench(false);
  const Answer answer = bench.cuboct({"run", "scenes/lj_block.toml", "--quiet", "--steps", "10000000",
                                      "--frame-every", "10000", "--anyway", "--out", bench.path("out_dir")},
                                     there(bench.path("out_dir/frames_000001.vtp")));
  EXPECT_EQ(answer.code, 1);
  EXPECT_EQ(answer.err, "interrupted\n");
  const Trace trace = read_trace(bench.path("out_dir/trace.h5"));
  EXPECT_GT(trace.steps(), 0u);
  EXPECT_EQ(std::to_string(trace.steps()), value_of(answer.out, "steps"));
  EXPECT_EQ(trace.frames.back().step, trace.steps());
}

TEST(Run, GoesOnWhereCtrlCLeftIt) {
  const Bench bench(false);
  const auto run = [&](const std::string& out, uint64_t steps, const std::vector<std::string>& more,
                       const Condition& interrupts = {}) {
    std::vector<std::string> arguments{
        "run",     "scenes/coupon.toml",  "--quiet", "--anyway",     "--frame-every", "200", "--threads", "1",
        "--steps", std::to_string(steps), "--out",   bench.path(out)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return bench.cuboct(arguments, interrupts);
  };
  // Each goes on until it has left another frame than those before; none would ever end.
  uint64_t steps = 0;
  for (const bool first : {true, false, false}) {
    std::vector<std::string> more{"--checkpoint-every", "1 h"};
    if (!first) more.emplace_back("--resume");
    const Answer cut = run("parts", 10'000'000, more,
                           there(bench.path(fmt::format("parts/frames_{:06}.vtp", steps / 200 + 2))));
    ASSERT_EQ(cut.code, 1) << cut.err;
    const uint64_t before = steps;
    steps = read_trace(bench.path("parts/trace.h5")).steps();
    EXPECT_GT(steps, before);
    EXPECT_EQ(cut.err,
              fmt::format("interrupted; the same command with --resume goes on at step {}\n", steps));
  }
  steps += 250;
  const Answer answer = run("parts", steps, {"--checkpoint-every", "1 h", "--resume"});
  ASSERT_EQ(answer.code, 0) << answer.err;
  ASSERT_EQ(run("whole", steps, {}).code, 0);
  const Trace whole = read_trace(bench.path("whole/trace.h5")),
              parts = read_trace(bench.path("parts/trace.h5"));
  EXPECT_EQ(whole.state_hash, parts.state_hash);
  EXPECT_EQ(whole.frames, parts.frames);
  ASSERT_EQ(whole.curves.size(), parts.curves.size());
  for (size_t i = 0; i < whole.curves.size(); ++i) EXPECT_EQ(whole.curves[i].value, parts.curves[i].value);
  EXPECT_FALSE(fs::exists(bench.path("parts/checkpoint")));
}

TEST(Run, PrintsJson) {
  const Bench bench(false);
  const Answer answer = bench.cuboct({"run", "scenes/lj_block.toml", "--steps", "3", "--json"});
  EXPECT_EQ(answer.code, 0);
  EXPECT_EQ(answer.out.front(), '{');
  EXPECT_NE(answer.out.find("\n  \"steps\": {\"value\": 3},\n"), std::string::npos) << answer.out;
}

TEST(Run, TellsEveryCurveAndHowItEnded) {
  const Bench bench(false);
  const Answer answer = bench.cuboct({"run", "scenes/coupon.toml", "--steps", "50"});
  ASSERT_EQ(answer.code, 0) << answer.err;
  EXPECT_TRUE(std::regex_match(value_of(answer.out, "tension.stress"),
                               std::regex("[-0-9.e+]+ Pa \\([-0-9.e+]+ to [-0-9.e+]+\\)")))
      << answer.out;
  EXPECT_TRUE(std::regex_match(value_of(answer.out, "tension.strain"),
                               std::regex("[-0-9.e+]+ \\([-0-9.e+]+ to [-0-9.e+]+\\)")))
      << answer.out;
  EXPECT_EQ(value_of(answer.out, "ended"), "finished");
}

TEST(Run, SaysInItsDirectoryThatItWasInterrupted) {
  const Bench bench(false);
  const Answer answer =
      bench.cuboct({"run", "scenes/lj_block.toml", "--steps", "100000000", "--out", bench.path("out_dir")},
                   bench.table_begins());
  EXPECT_EQ(answer.code, 1);
  const Trace trace = read_trace(bench.path("out_dir/trace.h5"));
  EXPECT_STREQ(trace.ended(), "interrupted");
  EXPECT_EQ(trace.asked, 100000000u);
  const std::string after = "after " + std::to_string(trace.steps()) + " of 100000000 steps";
  EXPECT_EQ(value_of(answer.out, "ended"), "interrupted (" + after + ")");
  EXPECT_NE(contents(bench.path("out_dir/summary.json"))
                .find("\n  \"ended\": {\"value\": \"interrupted\", \"note\": \"" + after + "\"}"),
            std::string::npos);
  ASSERT_EQ(bench.cuboct({"report", bench.path("out_dir")}).code, 0);
  EXPECT_NE(
      contents(bench.path("out_dir/report.html")).find("<b class=\"bad\">interrupted " + after + "</b>"),
      std::string::npos);
}

// A key of JSON is words joined by '_'.
TEST(Run, GivesKeysThatScriptsCanName) {
  const Bench bench(true);
  for (std::vector<std::string> more :
       {std::vector<std::string>{"scenes/lj_block.toml", "--cycles"}, {"scenes/coupon.toml"}}) {
    more.insert(more.end(), {"--steps", "3", "--json"});
    more.insert(more.begin(), "run");
    const std::string json = bench.cuboct(more).out;
    const std::regex key("\n  \"([^\"]*)\": ");
    int keys = 0;
    for (std::sregex_iterator at(json.begin(), json.end(), key), end; at != end; ++at, ++keys)
      EXPECT_TRUE(std::regex_match((*at)[1].str(), std::regex("[A-Za-z0-9_.]+"))) << (*at)[1];
    EXPECT_GT(keys, 10);
  }
}

TEST(Run, LeavesTheFramesThatAreAskedFor) {
  const Bench bench(false);
  const auto files = [&](const std::string& formats) {
    const std::string out = bench.path(formats);
    const Answer answer =
        bench.cuboct({"run", "--frames", formats, "scenes/coupon.toml", "--steps", "20", "--out", out});
    EXPECT_EQ(answer.code, 0) << answer.err;
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(out))
      if (entry.path().filename().string().starts_with("frames")) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(files("none"), Names{});
  EXPECT_EQ(files("lammps"), Names{"frames.dump.gz"});
  EXPECT_EQ(files("ase"), Names{"frames.ase.xyz"});
  EXPECT_EQ(files("xyz.gz,vtp"),
            (Names{"frames.pvd", "frames.xyz.gz", "frames_000000.vtp", "frames_000001.vtp"}));
  // A run with other formats replaces those of the run before.
  EXPECT_EQ(bench
                .cuboct({"run", "--frames", "none", "scenes/coupon.toml", "--steps", "1", "--out",
                         bench.path("lammps")})
                .code,
            0);
  EXPECT_FALSE(fs::exists(bench.path("lammps/frames.dump.gz")));
  for (const auto& [formats, text] :
       {std::pair{"pdb", "--frames: pdb not in {xyz,xyz.gz,ase,vtp,lammps,none}\n"},
        {"none,xyz", "--frames: none goes with no other format\n"}}) {
    const Answer answer =
        bench.cuboct({"run", "scenes/coupon.toml", "--frames", formats, "--out", bench.path("out_dir")});
    EXPECT_EQ(answer.code, 2);
    EXPECT_EQ(answer.err, text);
  }
  const Answer reduced = bench.cuboct(
      {"run", "scenes/lj_block.toml", "--frames", "xyz,ase", "--steps", "1", "--out", bench.path("reduced")});
  EXPECT_EQ(reduced.code, 2);
  EXPECT_EQ(reduced.err,
            "--frames ase is in angstrom, and the scene's units are reduced\n  hint: --frames xyz\n");
  EXPECT_FALSE(fs::exists(bench.path("reduced/trace.part.h5")));
  EXPECT_EQ(bench.cuboct({"run", "scenes/coupon.toml", "--frames", "vtp"}).err,
            "--frames needs --out DIR: without it nothing of the run is kept\n");
}

// The trace's positions in metres are asked for, and mean nothing without a trace.
TEST(Run, RefusesSiWithoutADirectory) {
  const Answer answer = Bench(false).cuboct({"run", "scenes/lj_block.toml", "--steps", "1", "--si"});
  EXPECT_EQ(answer.code, 2) << answer.out;
  EXPECT_EQ(answer.err, "--si needs --out DIR: without it nothing of the run is kept\n");
}

}  // namespace
}  // namespace cuboct::test
