// SPDX-License-Identifier: MIT
// Scenes of stages, and runs that begin where others ended, as users meet them.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "model/base/output.h"
#include "model/config/config.h"
#include "model/trace/trace.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

const std::string kRelease = CUBOCT_SOURCE_DIR "/scenes/templates/release.toml";
const std::string kGrips = CUBOCT_SOURCE_DIR "/scenes/boards/grips.toml";

const std::vector<double>& curve(const Trace& trace, const std::string& name) {
  for (const Curve& one : trace.curves)
    if (one.name == name) return one.value;
  throw std::runtime_error("no curve " + name);
}

// A bar of density rho and modulus E under its weight, and set free: rho g L^2/(2 E), and the period 4
// L/sqrt(E/rho). L ends half a pitch beyond the lowest particles, whose mass is whole. The clamp holds its
// surroundings too, which takes some 2 %.
TEST(Stages, ABarHangsThenSwingsWithItsPeriod) {
  const Bench bench(false);
  const Answer ran = bench.cuboct({"run", kRelease, "--out", bench.path("run")});
  ASSERT_EQ(ran.code, 0) << ran.out << ran.err;
  const Trace relax = read_trace(bench.path("run/1-relax/trace.h5")),
              free = read_trace(bench.path("run/2-free/trace.h5"));
  const double length = 0.0205, gravity = 9.81, density = 1000, modulus = 1e5;
  const double rest = density * gravity * length * length / (2 * modulus);
  EXPECT_NEAR(curve(relax, "tip.along").back(), rest, 0.04 * rest);
  ASSERT_TRUE(relax.reached);
  EXPECT_LT(relax.steps(), *relax.asked);
  EXPECT_STREQ(relax.ended(), "finished");

  // It begins where the first stage ended, and swings about 0 without loss.
  const std::vector<double>& tip = curve(free, "tip.along");
  EXPECT_NEAR(tip.front(), curve(relax, "tip.along").back(), 1e-3 * rest);
  std::vector<double> zeros;  // readings at which the tip passes 0
  for (size_t k = 1; k < tip.size(); ++k)
    if ((tip[k - 1] > 0) != (tip[k] > 0))
      zeros.push_back(static_cast<double>(k) - tip[k] / (tip[k] - tip[k - 1]));
  ASSERT_GE(zeros.size(), 4u);
  const double steps = static_cast<double>(free.steps()) / static_cast<double>(tip.size() - 1);
  const double dt = 30e-3 / static_cast<double>(free.steps());
  const double period =
      2 * (zeros.back() - zeros.front()) / static_cast<double>(zeros.size() - 1) * steps * dt;
  EXPECT_NEAR(period, 4 * length / std::sqrt(modulus / density), 0.02 * period);
  const std::vector<double>& energy = curve(free, "energy.total");
  EXPECT_NEAR(energy.back(), energy.front(), 0.01 * std::abs(energy.front()));

  EXPECT_NE(ran.out.find("stage 1-relax"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("finished (at step"), std::string::npos) << ran.out;
  EXPECT_NE(contents(bench.path("run/summary.json")).find("\"name\": \"free\""), std::string::npos);
  EXPECT_EQ(bench.cuboct({"report", bench.path("run/2-free")}).code, 0);
}

// The grips of a small scene, with a stage that moves them and one that lets them be.
std::string staged(const Bench& bench) {
  const std::string path = bench.path("grips.toml");
  write_text(path, read_config_text(kGrips) +
                       "\n[[stage]]\nname = \"pull\"\nsteps = 600\n"
                       "\n[[stage]]\nname = \"hold\"\nsteps = 500\n"
                       "constraint = [{ name = \"right\", velocity = [0, 0, 0] }]\n");
  return path;
}

// The right grip's way over a ramp is that of the straight line; where `until` holds, later parts do not run.
TEST(Stages, ARampIsRunInParts) {
  const Bench bench(false);
  const std::string scene = bench.path("ramp.toml");
  const auto write = [&](const std::string& more) {
    write_text(scene,
               read_config_text(kGrips) +
                   "\n[[probe]]\nname = \"end\"\nkind = \"displacement\"\naxis = \"x\"\n"
                   "region = { shape = \"half_space\", point = [2.4, 0, 0], normal = [-1, 0, 0] }\n"
                   "\n[[stage]]\nname = \"up\"\nsteps = 24\nparts = 4\n" +
                   more +
                   "constraint = [{ name = \"right\", velocity = { from = [0, 0, 0], to = [0.04, 0, 0] } }]\n"
                   "\n[[stage]]\nname = \"hold\"\nsteps = 6\n");
  };
  write("");
  const Answer ran = bench.cuboct({"run", scene, "--out", bench.path("a")});
  ASSERT_EQ(ran.code, 0) << ran.out << ran.err;
  const double whole = 0.04 / 2 * 24 * 0.14;
  double way = 0;
  for (int part = 1; part <= 4; ++part) {
    const Trace trace = read_trace(bench.path(fmt::format("a/{0}-up-{0}/trace.h5", part)));
    EXPECT_EQ(trace.steps(), 6u);
    const std::vector<double>& end = curve(trace, "end.along");
    EXPECT_NEAR(end.front(), way, 1e-5 * whole);  // where the part before it ended
    way = whole * part * part / 16;
    EXPECT_NEAR(end.back(), way, 1e-3 * whole);
  }
  EXPECT_EQ(contents(bench.path("a/5-hold/run.toml")).find("../4-up-4") == std::string::npos, false);
  EXPECT_EQ(bench.cuboct({"run", scene, "--stage", "up", "--out", bench.path("b")}).code, 0);
  // In JSON too: of the stages that it runs, and DIR's summary of all stays as it was.
  const Answer json = bench.cuboct({"run", scene, "--stage", "up-2", "--out", bench.path("b"), "--json"});
  ASSERT_EQ(json.code, 0) << json.err;
  const auto stages = nlohmann::json::parse(json.out)["stages"];
  ASSERT_EQ(stages.size(), 1u);
  EXPECT_EQ(stages[0]["name"], "up-2");
  EXPECT_EQ(stages[0]["summary"]["steps"]["value"], 6);
  EXPECT_FALSE(fs::exists(bench.path("b/summary.json")));
  EXPECT_EQ(bench.cuboct({"run", scene, "--stage", "up", "--out", bench.path("b")}).code, 0);
  EXPECT_TRUE(fs::exists(bench.path("b/4-up-4/trace.h5")));
  EXPECT_FALSE(fs::exists(bench.path("b/5-hold")));
  const Answer checked = bench.cuboct({"check", scene});
  EXPECT_NE(checked.out.find("stages 1-up-1 to 4-up-4"), std::string::npos) << checked.out << checked.err;
  EXPECT_NE(checked.out.find("4 parts, each 6 steps"), std::string::npos) << checked.out;

  // A quarter of the way is behind the second part: its last reading.
  write(fmt::format("until = {{ probe = \"end.along\", above = {} }}\n", 0.24 * whole));
  const Answer early = bench.cuboct({"run", scene, "--out", bench.path("c")});
  ASSERT_EQ(early.code, 0) << early.out << early.err;
  EXPECT_FALSE(fs::exists(bench.path("c/3-up-3")));
  EXPECT_NE(contents(bench.path("c/5-hold/run.toml")).find("../2-up-2"), std::string::npos);
  EXPECT_NE(early.out.find("not needed ('until' held in up-2)"), std::string::npos) << early.out;
  const Answer again = bench.cuboct({"run", scene, "--resume", "--out", bench.path("c")});
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_FALSE(fs::exists(bench.path("c/3-up-3")));
}

std::map<std::string, uint64_t> hashes(const Bench& bench, const std::string& out) {
  std::map<std::string, uint64_t> last;
  for (const char* stage : {"1-pull", "2-hold"})
    last[stage] = read_trace(bench.path(out + "/" + stage + "/trace.h5")).state_hash.back();
  return last;
}

TEST(Stages, RunAloneAndOnOtherEngines) {
  const Bench bench(false);
  std::string text = read_config_text(staged(bench));
  const std::string scene = bench.path("short.toml");
  for (const char* steps : {"steps = 600", "steps = 500"}) text.replace(text.find(steps), 11, "steps = 12 ");
  // Particles must be able to go so far.
  write_text(scene, text);
  ASSERT_EQ(bench.cuboct({"run", scene, "--out", bench.path("a"), "--hash-every", "1"}).code, 0);
  // One by one, on another engine.
  EXPECT_EQ(bench.cuboct({"run", scene, "--stage", "hold", "--out", bench.path("b")}).err,
            "stage 'hold' begins where 'pull' ended, and " + bench.path("b/1-pull") +
                " holds no run that is finished\n  hint: --from DIR begins elsewhere\n");
  for (const char* stage : {"pull", "hold"})
    ASSERT_EQ(
        bench.cuboct({"run", scene, "--stage", stage, "--engine", "golden", "--out", bench.path("b")}).code,
        0);
  EXPECT_EQ(hashes(bench, "a"), hashes(bench, "b"));
  const Answer crossed = bench.cuboct({"crosscheck", scene, "--stage", "hold", "--from",
                                       bench.path("a/1-pull"), "--engines", "golden,lattice"});
  EXPECT_EQ(crossed.code, 0) << crossed.out << crossed.err;
  EXPECT_EQ(crossed.out.substr(0, 8), "matched ");
  EXPECT_EQ(bench
                .cuboct({"emit", scene, "--stage", "hold", "--from", bench.path("a/1-pull"), "--out",
                         bench.path("rtl")})
                .code,
            0);
  const Answer checked = bench.cuboct({"check", scene});
  EXPECT_EQ(checked.code, 0) << checked.err;
  EXPECT_NE(checked.out.find("stage 2-hold"), std::string::npos) << checked.out;
  EXPECT_NE(bench.cuboct({"run", scene}).err.find("needs --out DIR"), std::string::npos);
  EXPECT_NE(bench.cuboct({"run", scene, "--out", bench.path("c"), "--steps", "3"}).err.find("--stage NAME"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(bench.path("c")));
}

// A stage that cannot be read is told before the first one begins.
TEST(Stages, AreReadBeforeAnyBegins) {
  const Bench bench(false);
  const std::string scene = bench.path("wrong.toml");
  write_text(scene,
             read_config_text(kGrips) + "\n[[stage]]\nname = \"a\"\n[[stage]]\nname = \"b\"\nstpes = 3\n");
  const Answer answer = bench.cuboct({"run", scene, "--out", bench.path("run")});
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.err.find(scene + ":52:1: unknown key 'stpes'"), std::string::npos) << answer.err;
  EXPECT_FALSE(fs::exists(bench.path("run")));
}

// As a killed run leaves it: the first stage finished, the second with a checkpoint or without one.
TEST(Stages, ResumeInTheStageThatWasCut) {
  const Bench bench(false);
  std::string text = read_config_text(staged(bench));
  const std::string scene = bench.path("short.toml");
  for (const char* steps : {"steps = 600", "steps = 500"}) text.replace(text.find(steps), 11, "steps = 12 ");
  write_text(scene, text);
  const std::vector<std::string> run{"run",     scene,  "--engine", "golden", "--checkpoint-every",
                                     "5 steps", "--out"};
  const auto with = [&](std::vector<std::string> more) {
    std::vector<std::string> all = run;
    all.insert(all.end(), more.begin(), more.end());
    return bench.cuboct(all);
  };
  ASSERT_EQ(with({bench.path("a")}).code, 0);
  ASSERT_EQ(with({bench.path("b")}).code, 0);
  const auto first = fs::last_write_time(bench.path("b/1-pull/trace.h5"));
  const std::string record = bench.path("b/2-hold/run.toml");
  std::string state = contents(record);
  state.replace(state.find("finished"), 8, "running");
  write_text(record, state);
  fs::remove(bench.path("b/2-hold/trace.h5"));
  const Answer refused = with({bench.path("b")});
  EXPECT_EQ(refused.err,
            bench.path("b/2-hold") +
                " holds a run that did not end\n  hint: --resume goes on with it; --force begins anew in "
                "its place\n");
  const Answer resumed = with({bench.path("b"), "--resume"});
  EXPECT_EQ(resumed.code, 0) << resumed.out << resumed.err;
  EXPECT_EQ(fs::last_write_time(bench.path("b/1-pull/trace.h5")), first);
  EXPECT_EQ(hashes(bench, "a"), hashes(bench, "b"));
}

// By Ctrl-C as soon as the second stage has begun: it is cut, leaves a checkpoint, and goes on from it. Where
// it ends before the signal comes, a longer stage is tried.
TEST(Stages, GoOnFromTheCheckpointOfTheStageThatWasCut) {
  const Bench bench(false);
  const std::string scene = bench.path("long.toml");
  for (uint64_t steps = 20'000; steps < 20'000'000; steps *= 4) {
    write_text(scene, read_config_text(CUBOCT_SOURCE_DIR "/scenes/lj_block.toml") +
                          "\n[[stage]]\nname = \"pull\"\nsteps = 12\n[[stage]]\nname = \"hold\"\nsteps = " +
                          std::to_string(steps) + "\nprobe_every = 1000\n");
    const std::vector<std::string> run{"run",
                                       scene,
                                       "--hash-every",
                                       "1000",
                                       "--force",
                                       "--no-watch",
                                       "--out",
                                       bench.path("cut"),
                                       "--checkpoint-every",
                                       "1 h"};
    const Answer cut = bench.cuboct(run, there(bench.path("cut/2-hold/trace.part.h5")));
    if (cut.code == 0) continue;
    EXPECT_EQ(cut.code, 1);
    EXPECT_TRUE(fs::exists(bench.path("cut/2-hold/checkpoint")));
    EXPECT_NE(cut.out.find("stage 2-hold  interrupted"), std::string::npos) << cut.out;
    std::vector<std::string> again = run;
    again[4] = "--resume";
    const Answer resumed = bench.cuboct(again);
    EXPECT_EQ(resumed.code, 0) << resumed.out << resumed.err;
    EXPECT_EQ(resumed.out.find("stage 1-pull\n"), std::string::npos) << resumed.out;  // not run again
    again[4] = "--force";
    again[7] = bench.path("whole");
    ASSERT_EQ(bench.cuboct(again).code, 0);
    const Trace a = read_trace(bench.path("cut/2-hold/trace.h5")),
                b = read_trace(bench.path("whole/2-hold/trace.h5"));
    EXPECT_EQ(a.state_hash, b.state_hash);
    EXPECT_EQ(a.steps(), steps);
    return;
  }
  FAIL() << "no run was cut";
}

TEST(Stages, ARunBeginsWhereAnotherEnded) {
  const Bench bench(false);
  const auto hash = [&](const std::string& out) {
    return read_trace(bench.path(out + "/trace.h5")).state_hash.back();
  };
  ASSERT_EQ(bench.cuboct({"run", kGrips, "--out", bench.path("whole")}).code, 0);
  ASSERT_EQ(bench.cuboct({"run", kGrips, "--steps", "10", "--out", bench.path("first")}).code, 0);
  const std::string scene = bench.path("second.toml");
  write_text(scene, read_config_text(kGrips) + "[start]\nfrom = \"first\"\n");
  for (const std::string engine : {"lattice", "golden"}) {
    const Answer second =
        bench.cuboct({"run", scene, "--steps", "14", "--engine", engine, "--out", bench.path(engine)});
    EXPECT_EQ(second.code, 0) << second.err;
    EXPECT_NE(second.out.find("step 10 of " + bench.path("first") + ", bit for bit"), std::string::npos)
        << second.out;
    EXPECT_EQ(hash(engine), hash("whole")) << engine;
  }
  EXPECT_EQ(bench.cuboct({"report", bench.path("golden")}).code, 0);
  const Answer none = bench.cuboct({"run", kGrips, "--from", bench.path("nowhere")});
  EXPECT_EQ(none.code, 2);
  EXPECT_NE(none.err.find("holds no finished run: no file trace.h5"), std::string::npos) << none.err;
  ASSERT_EQ(bench.cuboct({"run", kGrips, "--no-states", "--out", bench.path("bare")}).code, 0);
  EXPECT_EQ(bench.cuboct({"run", kGrips, "--from", bench.path("bare")}).err,
            bench.path("bare/trace.h5") +
                " holds no state to begin with\n  hint: a run with --no-states keeps none\n");
}

}  // namespace
}  // namespace cuboct::test
