// SPDX-License-Identifier: MIT
// The linear peridynamic solid at rest, and runs of it that begin where others ended.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "model/base/error.h"
#include "model/base/output.h"
#include "model/base/steps.h"
#include "model/run/reference_kind.h"
#include "model/run/rounds_run.h"
#include "model/run/start.h"
#include "model/run/static_engine.h"
#include "model/trace/trace_file.h"
#include "model/trace/trace_head.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

// A directory that is gone with the test, and a scene in it.
class Bench {
 public:
  Bench() : path_(fmt::format("{}lps_static.{}", testing::TempDir(), getpid())) {
    fs::remove_all(path_);
    fs::create_directories(path_ + "/left");
  }
  ~Bench() { fs::remove_all(path_); }

  std::string left() const { return path_ + "/left"; }
  std::string checkpoint() const { return path_ + "/checkpoint"; }
  std::string write(const std::string& text) const {
    write_text(path_ + "/scene.toml", text);
    return path_ + "/scene.toml";
  }
  Scene going_on(const std::string& text, const std::string& stage = "") const {
    return load_scene(write(text), {stage, left()});
  }
  // What `cuboct run --out` leaves of it.
  void leave(const Scene& scene, Trace trace) const {
    const TraceHead head{scene, nullptr, nullptr, Vec3::Zero(), ""};
    TraceWriter out(left() + "/trace.h5", left() + "/trace.part.h5", true, &head);
    for (const RealFrame& frame : trace.bodies) out.add(frame);
    trace.bodies.clear();
    out.finish(trace);
  }

 private:
  std::string path_;
};

EngineKind kind_of(const Scene& scene) { return scene_reference_kind(scene, scene.body, {}, 1e-3); }

RunRequest request_of(const Scene& scene) {
  RunRequest request;
  request.steps = scene.steps;
  request.probes = every_so_often(scene.probe_every, scene.steps);
  request.frames = {0, scene.steps};
  request.energies = request.totals = true;
  return request;
}

Recorded run(const Scene& scene) {
  Recorded recorded = record(scene, kind_of(scene), request_of(scene));
  EXPECT_FALSE(recorded.trace.stop) << recorded.trace.stop->text;
  return recorded;
}

const std::vector<double>& curve(const Recorded& run, const std::string& name) {
  for (const Curve& curve : run.trace.curves)
    if (curve.name == name) return curve.value;
  throw std::runtime_error("no curve " + name);
}

double counter(const Recorded& run, const std::string& name) {
  for (const auto& [key, value] : run.trace.counters)
    if (key == name) return value;
  throw std::runtime_error("no counter " + name);
}

const std::string kLeft = "region = { shape = \"half_space\", point = \"[-8, 0, 0] mm\", normal = \"x\" }\n",
                  kRight = "region = { shape = \"half_space\", point = \"[8, 0, 0] mm\", normal = \"-x\" }\n";

// A bar of 20 mm that is held at its left end. `width`: mm.
std::string bar(const std::string& more, const std::string& run, const std::string& rule = "",
                int width = 6) {
  return "density = \"2.44 g/cm^3\"\npacking = { pitch = \"1 mm\" }\n"
         "geometry = { shape = \"box\", size = \"[20, " +
         fmt::format("{0}, {0}", width) + "] mm\" }\n" +
         "[rule]\nkind = \"lps\"\nyoungs_modulus = \"10 GPa\"\npoissons_ratio = 0.25\n" + rule +
         "[[constraint]]\nname = \"left\"\nkind = \"held\"\n" + kLeft + more +
         "[[probe]]\nname = \"end\"\nkind = \"displacement\"\naxis = \"x\"\n" + kRight +
         "[[probe]]\nname = \"support\"\nkind = \"force\"\naxis = \"x\"\n" + kLeft + "[run]\n" + run;
}

constexpr double kPull = 360;  // N
std::string pulled(const std::string& run, const std::string& rule = "") {
  return bar("[[constraint]]\nname = \"right\"\nkind = \"pulled\"\nforce = \"[360, 0, 0] N\"\n" + kRight, run,
             rule);
}

// The right end goes by 20 um in all.
std::string moved(const std::string& run, const std::string& rule = "") {
  return bar("[[constraint]]\nname = \"right\"\nkind = \"moved\"\nvelocity = \"[1, 0, 0] m/s\"\n" + kRight,
             "duration = \"20 us\"\n" + run, rule);
}

// Bonds count from the packing at each load step: the end goes where the force puts it, the support carries
// it, and, as the body is linear, it holds half of the force's work.
TEST(LpsStatic, ABarRestsWhereItsForcePutsItHoweverItIsLoaded) {
  double first = 0;
  for (const int load_steps : {1, 2, 5}) {
    SCOPED_TRACE(load_steps);
    const Recorded at_rest = run(parse_scene(
        pulled(fmt::format("duration = \"20 us\"\nstatic = {{ load_steps = {} }}\n", load_steps)), "bar"));
    const std::vector<double>& end = curve(at_rest, "end.along");
    ASSERT_EQ(end.size(), load_steps + 1u);
    EXPECT_EQ(end.front(), 0);  // before the load
    EXPECT_EQ(curve(at_rest, "support.force").front(), 0);
    EXPECT_EQ(at_rest.trace.bodies.front().x, parse_scene(pulled("steps = 1\n"), "bar").body.x);
    EXPECT_NEAR(end.back(), 1.41e-5, 0.01e-5);
    if (first == 0) first = end.back();
    EXPECT_NEAR(end.back(), first, 1e-3 * first);
    EXPECT_NEAR(curve(at_rest, "support.force").back(), kPull, 2e-3 * kPull);
    EXPECT_NEAR(curve(at_rest, "energy.potential").back(), kPull * first / 2, 5e-3 * kPull * first / 2);
    EXPECT_EQ(counter(at_rest, "mean_damage"), 0);
  }
}

// The second run begins strained: it counts strains from the packing too, and is where the first one was.
TEST(LpsStatic, ARunThatBeginsStrainedKeepsItsStrain) {
  const Bench bench;
  const std::string text = pulled("duration = \"20 us\"\nstatic = { load_steps = 2, tolerance = 1e-5 }\n");
  const Scene scene = parse_scene(text, "bar");
  const Recorded first = run(scene);
  bench.leave(scene, first.trace);
  const Recorded second = run(bench.going_on(text));
  for (const std::string name : {"end.along", "support.force", "energy.potential"}) {
    const double there = curve(first, name).back();
    EXPECT_EQ(curve(second, name).front(), there) << name;
    EXPECT_NEAR(curve(second, name).back(), there, 1e-4 * there) << name;
  }
}

// The run in one, and the run that is cut behind the checkpoint of step `saved`.
void expect_resumes(const Bench& bench, const Scene& scene, uint64_t saved) {
  RunRequest request = request_of(scene);
  const Recorded whole = record(scene, kind_of(scene), request);
  request.frames = {0, saved + 1, scene.steps};
  request.checkpoint.path = bench.checkpoint();
  request.checkpoint.every_steps = saved;
  struct Killed {};
  request.keep = [&](const RunState& state) {
    if (std::get<RealFrame>(state).step == saved + 1) throw Killed();
  };
  EXPECT_THROW(record(scene, kind_of(scene), request), Killed);
  request.keep = {};
  request.checkpoint.resume = true;
  const Recorded resumed = record(scene, kind_of(scene), request);
  EXPECT_EQ(resumed.resumed_at, saved);
  const RealFrame &a = whole.trace.bodies.back(), &b = resumed.trace.bodies.back();
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.v, b.v);
  EXPECT_EQ(whole.trace.bonds, resumed.trace.bonds);
  EXPECT_EQ(curve(whole, "energy.potential"), curve(resumed, "energy.potential"));
  fs::remove(bench.checkpoint());
}

const std::string kBrittle = "critical_stretch = 2e-3\ndamage_width = 5e-4\n";
// Ends pulled apart so fast that bonds give way between them.
std::string torn(const std::string& run, const std::string& rule = kBrittle) {
  return bar("[[constraint]]\nname = \"right\"\nkind = \"moved\"\nvelocity = \"[40, 0, 0] m/s\"\n" + kRight,
             "dt = \"auto\"\nprobe_every = 5\n" + run, rule, 4);
}

TEST(LpsStatic, GoesOnFromACheckpoint) {
  const Bench bench;
  expect_resumes(bench, parse_scene(moved("static = { load_steps = 4 }\n"), "bar"), 200);
  const Scene breaks = parse_scene(torn("steps = 60\n"), "bar");
  EXPECT_GT(counter(run(breaks), "mean_damage"), 1e-3);
  expect_resumes(bench, breaks, 40);
}

// At rest a bond gives way when the body stretches it too far: the bar that is moved by 20 um over 16 mm
// stays whole where bonds bear that. Where they do not it carries less, and at rest no bond is left that is
// stretched too far: a step of motion from there breaks none.
TEST(LpsStatic, BondsGiveWayAtRest) {
  const auto scene_of = [](const std::string& rule) {
    return parse_scene(moved("static = { load_steps = 4 }\n", rule), "bar");
  };
  const Scene weak = scene_of("critical_stretch = 1e-3\n");
  const Recorded sound = run(scene_of("")), bears = run(scene_of("critical_stretch = 4e-3\n")),
                 tears = run(weak);
  EXPECT_EQ(counter(bears, "largest_damage"), 0);
  EXPECT_EQ(curve(bears, "support.force"), curve(sound, "support.force"));
  const std::vector<double>& force = curve(tears, "support.force");
  EXPECT_EQ(force[1], curve(sound, "support.force")[1]);
  EXPECT_LT(force.back(), 0.6 * curve(sound, "support.force").back());

  Body body = weak.body;
  body.x = tears.trace.bodies.back().x;
  body.bonds = std::make_shared<BondState>(BondState{weak.body.x, *tears.trace.bonds});
  RoundsRun motion(weak, body, {}, 1e-3);
  motion.advance(1, nullptr);
  EXPECT_GT(counter(tears, "mean_damage"), 0);
  for (const auto& [name, value] : motion.counters_of_state())
    if (name == "mean_damage") {
      EXPECT_EQ(value, counter(tears, "mean_damage"));
    }
}

// By way of the trace: 60 steps are 25 and 35, bit by bit; and no stage heals.
TEST(LpsStart, ARunInTwoPartsIsTheRunInOne) {
  const Bench bench;
  const Scene scene = parse_scene(torn("steps = 60\n"), "bar");
  const Recorded whole = run(scene);
  Scene part = scene;
  part.steps = 25;
  const Recorded first = run(part);
  ASSERT_TRUE(first.trace.bonds);
  bench.leave(part, first.trace);
  const Scene rest = bench.going_on(torn("steps = 35\n"));
  const Recorded second = run(rest);
  EXPECT_EQ(whole.trace.bodies.back().x, second.trace.bodies.back().x);
  EXPECT_EQ(whole.trace.bodies.back().v, second.trace.bodies.back().v);
  EXPECT_EQ(whole.trace.bonds, second.trace.bonds);
  EXPECT_EQ(curve(whole, "energy.potential")[5], curve(second, "energy.potential")[0]);
  EXPECT_GT(counter(first, "mean_damage"), 0);
  EXPECT_EQ(counter(whole, "mean_damage"), counter(second, "mean_damage"));
  // And at rest.
  bench.leave(rest, second.trace);
  const Recorded still =
      run(bench.going_on(torn("steps = 5\nstatic = { load_steps = 1, tolerance = 0.01 }\n")));
  EXPECT_GE(counter(still, "mean_damage"), counter(whole, "mean_damage"));
}

TEST(LpsStart, DamageNeverFallsFromStageToStage) {
  const Bench bench;
  const std::string text = torn("steps = 40\n") +
                           "[[stage]]\nname = \"open\"\n[[stage]]\nname = \"close\"\nconstraint = [{ name = "
                           "\"right\", velocity = \"[-40, 0, 0] m/s\" }]\n[[stage]]\nname = \"rest\"\n"
                           "constraint = [{ name = \"right\", velocity = \"[0, 0, 0] m/s\" }]\n";
  Scene scene = parse_scene(text, "bar", {.begins = true, .stage = "open"});
  double damage = 0;
  for (const std::string next : {"close", "rest", ""}) {
    const Recorded stage = run(scene);
    EXPECT_GE(counter(stage, "mean_damage"), damage) << scene.stage;
    EXPECT_GT(counter(stage, "mean_damage"), 1e-3) << scene.stage;
    damage = counter(stage, "mean_damage");
    if (next.empty()) break;
    bench.leave(scene, stage.trace);
    scene = bench.going_on(text, next);
  }
}

TEST(LpsStart, BondsThatDoNotFitAreRefused) {
  const Bench bench;
  const Scene scene = parse_scene(torn("steps = 25\n"), "bar");
  const Trace trace = run(scene).trace;
  bench.leave(scene, trace);
  const auto expect = [&](const std::string& text, const std::string& what) {
    const std::string said = refused_with([&] {
      const Scene next = bench.going_on(text);
      static_cast<void>(kind_of(next).make(nullptr, false));
    });
    EXPECT_NE(said.find(what), std::string::npos) << said;
  };
  expect(torn("steps = 1\n"), "accepted");
  const std::string others = "the state was left by other bonds";
  expect(torn("steps = 1\n", "critical_stretch = 3e-3\ndamage_width = 5e-4\n"), others);
  expect(torn("steps = 1\n", "critical_stretch = 2e-3\n"), others);
  expect(torn("steps = 1\n", kBrittle + "horizon_pitches = 1.8\n"), others);
  expect(torn("steps = 1\n", kBrittle + "slit = [{ corner = \"[0.3, -9, 0] mm\", along = \"[0, 18, 0] mm\", "
                                        "across = \"[0, 0, 9] mm\" }]\n"),
         others);
  expect(torn("steps = 1\n", kBrittle + "unbreakable = [" + kLeft.substr(9, kLeft.size() - 10) + "]\n"),
         others);
  expect(torn("steps = 1\n", ""), "holds bonds that can break, and here none can: they would heal");
  // A stranger's words.
  for (const double stretch : {-std::numeric_limits<double>::infinity(), std::nan("")}) {
    Trace other = trace;
    other.bonds->back() = std::bit_cast<uint64_t>(stretch);
    bench.leave(scene, other);
    expect(torn("steps = 1\n"), "has no stretch that it could have");
  }
  Trace other = trace;
  other.bonds->pop_back();
  bench.leave(scene, other);
  expect(torn("steps = 1\n"), "bonds, the body has");
  // Of an older program, or of a pair law.
  other.bonds.reset();
  bench.leave(scene, other);
  expect(torn("steps = 1\n"), "does not say which bonds are broken");
  expect(torn("steps = 1\n", ""), "accepted");  // none can break
}

}  // namespace
}  // namespace cuboct
