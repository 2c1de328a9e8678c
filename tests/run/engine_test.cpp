// SPDX-License-Identifier: MIT
// What a run leaves is the same, whichever engine did it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fmt/format.h>

#include <cmath>
#include <csignal>
#include <filesystem>

#include "hw/engine/scene_engine.h"
#include "model/base/interrupt.h"
#include "model/base/steps.h"
#include "model/config/config.h"
#include "model/run/golden_engine.h"
#include "model/run/reference_engine.h"
#include "tests/run/kinds.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

const std::string kRoot = CUBOCT_SOURCE_DIR;

Bed bed_of(const std::string& scene, const std::string& arch = "scenes/archs/board.toml") {
  Bed bed;
  bed.scene = read_scene(kRoot + "/" + scene);
  bed.plan = plan_of(bed.scene, read_arch(arch.empty() ? arch : kRoot + "/" + arch));
  bed.one_thread.engine.threads = 1;
  bed.two_threads.engine.threads = 2;
  return bed;
}

RunRequest everything(uint64_t steps) {
  RunRequest request;
  request.steps = steps;
  request.frames = {0, 3, 7};
  request.probes = every_so_often(6, steps);
  request.energies = request.watch = request.totals = true;
  return request;
}

// The gpu engine sums energies in another order, and its probes' forces: equal but for the rounding of
// doubles.
void expect_equal(const std::vector<Curve>& a, const std::vector<Curve>& b, double share) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].name, b[k].name);
    EXPECT_EQ(a[k].unit, b[k].unit);
    EXPECT_EQ(a[k].step, b[k].step) << a[k].name;
    ASSERT_EQ(a[k].value.size(), b[k].value.size()) << a[k].name;
    double scale = 0;
    for (const double value : a[k].value) scale = std::max(scale, std::abs(value));
    for (size_t n = 0; n < a[k].value.size(); ++n)
      EXPECT_NEAR(a[k].value[n], b[k].value[n], share * scale) << a[k].name << " at sample " << n;
  }
}

// What was handed over while the run went: all but what the last state alone was read for.
void expect_beginning(const std::vector<Curve>& seen, const std::vector<Curve>& all) {
  ASSERT_EQ(seen.size(), all.size());
  for (size_t k = 0; k < all.size(); ++k) {
    EXPECT_EQ(seen[k].name + seen[k].unit, all[k].name + all[k].unit);
    ASSERT_EQ(seen[k].step.size(), seen[k].value.size());
    ASSERT_GT(seen[k].step.size(), 0U);
    EXPECT_GE(seen[k].step.size() + 1, all[k].step.size()) << all[k].name;
    for (size_t n = 0; n < seen[k].step.size(); ++n) {
      EXPECT_EQ(seen[k].step[n], all[k].step[n]) << all[k].name;
      EXPECT_EQ(seen[k].value[n], all[k].value[n]) << all[k].name << " at sample " << n;
    }
  }
}

void expect_equal(const Recorded& golden, const Recorded& run, double share) {
  const Trace &a = golden.trace, &b = run.trace;
  EXPECT_EQ(a.plan_hash, b.plan_hash);
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.state_hash, b.state_hash);
  EXPECT_EQ(a.hash_every, b.hash_every);
  EXPECT_EQ(a.steps(), b.steps());
  EXPECT_EQ(a.frames, b.frames);
  EXPECT_EQ(a.stop, b.stop);
  EXPECT_EQ(a.watched, b.watched);
  ASSERT_EQ(a.findings.size(), b.findings.size());
  for (size_t k = 0; k < a.findings.size(); ++k) EXPECT_EQ(a.findings[k].step, b.findings[k].step);
  EXPECT_EQ(golden.momentum_change, run.momentum_change);
  expect_equal(a.curves, b.curves, share);
}

class EveryEngine : public testing::TestWithParam<Kind> {
 protected:
  double tolerance() const { return GetParam().name == "gpu" ? 1e-12 : 0; }
  // In this engine, and in golden.
  void compare(const Bed& bed, const RunRequest& request) {
    golden_ = record(bed.scene, fixed_kinds().front().make(bed, request), request);
    run_ = record(bed.scene, GetParam().make(bed, request), request);
    expect_equal(golden_, run_, tolerance());
  }
  void go_on(const Bed& bed, uint64_t steps, const std::vector<uint64_t>& energies);
  Recorded golden_, run_;
};

TEST_P(EveryEngine, LeavesGoldensTrace) {
  compare(bed_of("scenes/boards/grips.toml"), everything(20));
  EXPECT_EQ(run_.trace.frames.size(), 4u);  // the last one too
  EXPECT_EQ(run_.trace.state_hash.size(), 21u);
  EXPECT_GT(run_.momentum_change, 0);
  EXPECT_GT(run_.largest_speed, 0);
  ASSERT_FALSE(run_.trace.curves.empty());
  EXPECT_EQ(run_.trace.curves.front().step, (std::vector<uint64_t>{0, 6, 12, 18, 20}));
}

TEST_P(EveryEngine, HashesAsOftenAsItIsAsked) {
  RunRequest request = everything(18);
  request.hash_every = 4;
  compare(bed_of("scenes/boards/grips.toml"), request);
  EXPECT_EQ(run_.trace.state_hash.size(), 6u);  // 0, 4, ... 16 and 18
  request.hash_every = 0;
  compare(bed_of("scenes/boards/grips.toml"), request);
  EXPECT_TRUE(run_.trace.state_hash.empty());
}

// One probe of each kind over a warm block, a warm chain that hangs from a controller, and a warm flat sheet.
TEST_P(EveryEngine, ReadsEveryProbe) {
  struct Of {
    std::string name, radius, speed;
  };
  for (const auto& [name, radius, speed] : {Of{"boards/grips", "99", "0.02"},
                                            {"failures/stiff_hold_healthy", "99", "0.5"},
                                            {"sheet", "\"9 m\"", "\"1 m/s\""}}) {
    const std::string path = kRoot + "/scenes/" + name + ".toml";
    const std::string all = "region = { shape = \"sphere\", radius = " + radius + " }\n";
    std::string probes = "[[velocity]]\nseed = 3\nthermal_speed = " + speed + "\n";
    for (const std::string kind : {"force", "displacement", "velocity", "kinetic_energy", "temperature"})
      probes += "[[probe]]\nname = \"all_" + kind + "\"\nkind = \"" + kind + "\"\n" + all;
    Bed bed = bed_of("scenes/" + name + ".toml", "");
    bed.scene = parse_scene(read_config_text(path) + probes, path);
    bed.plan = plan_of(bed.scene, {});
    RunRequest request = everything(9);
    request.frames = {};
    compare(bed, request);
    size_t seen = 0;
    for (const Curve& curve : run_.trace.curves)
      if (curve.name == "all_temperature.temperature" || curve.name == "all_kinetic_energy.kinetic_energy") {
        EXPECT_GT(curve.value.back(), 0) << name;
        ++seen;
      }
    EXPECT_EQ(seen, 2u);
  }
}

// A bar whose halves fly apart. Their bonds are those of the packing that cross x = 0.
const std::string kTorn = R"(units = "reduced"
mass = 1
packing = { pitch = 1 }
geometry = { shape = "box", min = [-2.9, 0, 0], max = [2.9, 2.9, 2.9] }
law = { kind = "brittle", stiffness = 1 }
reach = { margin = 3 }
[[velocity]]
region = { shape = "half_space", normal = "-x" }
uniform = [1, 0, 0]
[[probe]]
name = "crack"
kind = "crack"
region = { shape = "sphere", radius = 9 }
axis = "y"
[run]
steps = 12
probe_every = 2
)";

Bed torn() {
  Bed bed;
  bed.scene = parse_scene(kTorn, "torn");
  bed.plan = plan_of(bed.scene, {});
  bed.one_thread.engine.threads = 1;
  bed.two_threads.engine.threads = 2;
  return bed;
}

size_t bonds_across(const std::vector<Vec3>& x) {
  size_t count = 0;
  for (const Vec3& a : x)
    for (const Vec3& b : x) count += a.x() < 0 && b.x() > -1e-9 && (a - b).norm() < 1.1;
  return count;
}

void expect_torn(const Bed& bed, const std::vector<Curve>& curves) {
  ASSERT_GE(curves.size(), 4u);
  const double bonds = static_cast<double>(bonds_across(bed.scene.body.x));
  EXPECT_GT(bonds, 30);
  EXPECT_EQ(curves[0].name, "crack.broken");
  EXPECT_EQ(curves[0].value.front(), 0);
  EXPECT_EQ(curves[0].value.back(), bonds);
  EXPECT_NEAR(curves[3].value.back(), -bonds * bed.scene.rule.law->energy(1), 1e-4 * curves[3].value.back());
}

TEST_P(EveryEngine, CountsTheSameBrokenBonds) {
  const Bed bed = torn();
  RunRequest request = everything(12);
  request.probes = every_so_often(2, 12);
  compare(bed, request);
  expect_torn(bed, run_.trace.curves);
}

// The state before the step that cannot be done is kept, measured and looked at.
TEST_P(EveryEngine, EndsAtAFaultWithTheStateBefore) {
  compare(bed_of("tests/board/thrown.toml"), everything(24));
  ASSERT_TRUE(run_.trace.stop);
  EXPECT_EQ(run_.trace.steps(), 6u);
  EXPECT_EQ(run_.trace.frames.back().step, 6u);
  EXPECT_EQ(run_.trace.curves.back().step.back(), 6u);
  EXPECT_EQ(run_.trace.watched, 6u);
  EXPECT_FALSE(run_.interrupted);
}

TEST_P(EveryEngine, OfWarmParticlesInABox) {
  RunRequest request = everything(12);
  request.frames = {};
  compare(bed_of("scenes/two_types.toml", ""), request);
  EXPECT_TRUE(run_.trace.frames.empty());
}

// Energies are dear, probes are not: their values are those of a run that reads both everywhere.
TEST_P(EveryEngine, ReadsEnergiesLessOftenThanProbes) {
  const Bed bed = bed_of("scenes/boards/grips.toml");
  RunRequest request = everything(20);
  compare(bed, request);
  const std::vector<Curve> all = run_.trace.curves;
  const double speed = run_.largest_speed;
  request.energy_steps = {0, 12, 20};
  compare(bed, request);
  const std::vector<Curve>& some = run_.trace.curves;
  ASSERT_EQ(some.size(), all.size());
  size_t energies = 0;
  for (size_t k = 0; k < some.size(); ++k) {
    EXPECT_EQ(some[k].name, all[k].name);
    const bool energy = some[k].name.starts_with("energy.") || some[k].name == "temperature";
    energies += energy ? 1 : 0;
    if (!energy) {
      EXPECT_EQ(some[k].step, all[k].step) << some[k].name;
      EXPECT_EQ(some[k].value, all[k].value) << some[k].name;
      continue;
    }
    EXPECT_EQ(some[k].step, request.energy_steps);
    // 0, 6, 12, 18, 20
    EXPECT_EQ(some[k].value, (std::vector{all[k].value[0], all[k].value[2], all[k].value[4]}));
  }
  EXPECT_GE(energies, 4u);
  EXPECT_LT(energies, some.size());
  EXPECT_EQ(run_.trace.watched, 20u);
  // The gpu engine looks for it with the energies alone.
  if (GetParam().name != "gpu") {
    EXPECT_EQ(run_.largest_speed, speed);
  }
}

// Where a run ends early at a step of the probes alone, energies are read there too.
TEST_P(EveryEngine, ReadsTheEnergiesOfAnEarlyEnd) {
  Bed bed = bed_of("scenes/boards/grips.toml");
  const Probe& probe = bed.scene.probes.front();
  RunRequest request = everything(24);
  request.energy_steps = {0, 24};
  request.until = true;
  const std::string curve = record(bed.scene, GetParam().make(bed, request), request).trace.curves[0].name;
  bed.scene.until = Until{.curve = curve, .limit = -1e300, .after = 6};
  compare(bed, request);
  EXPECT_TRUE(curve.starts_with(probe.name));
  ASSERT_TRUE(run_.trace.reached);
  EXPECT_EQ(run_.trace.curves.front().step, (std::vector<uint64_t>{0, 6, 12}));
  EXPECT_EQ(run_.trace.curves.back().step, (std::vector<uint64_t>{0, 12}));
}

// An engine whose states are dear has the watch look at some of the probes' steps, and at the last state.
TEST_P(EveryEngine, IsLookedAtWhereItAllowsAndAtItsEnd) {
  const Bed bed = bed_of("scenes/boards/grips.toml");
  const RunRequest request = everything(18);
  EngineKind kind = GetParam().make(bed, request);
  kind.looks = [](const std::vector<uint64_t>&) { return std::vector<uint64_t>{0}; };
  const Recorded run = record(bed.scene, kind, request);
  EXPECT_EQ(run.trace.watched, 18u);
  EXPECT_EQ(run.trace.curves.front().step, (std::vector<uint64_t>{0, 6, 12, 18}));
}

TEST_P(EveryEngine, GoesOnFromItsCheckpointOrSaysThatItLeavesNone) {
  Bed unprobed = bed_of("scenes/boards/grips.toml");
  unprobed.scene.probes.clear();
  for (const auto& [bed, steps] :
       {std::pair{bed_of("scenes/boards/grips.toml"), 20}, {torn(), 12}, {unprobed, 20}})
    for (const std::vector<uint64_t>& energies : {{}, std::vector<uint64_t>{0, 12}})
      go_on(bed, static_cast<uint64_t>(steps), energies);
}

// Killed, as far as files can tell, between a checkpoint and the next.
void EveryEngine::go_on(const Bed& bed, uint64_t steps, const std::vector<uint64_t>& energies) {
  RunRequest request = everything(steps);
  request.probes = every_so_often(3, steps);
  request.energy_steps = energies;
  const std::string path = fmt::format("{}run_tests.{}.{}", testing::TempDir(), GetParam().name, getpid());
  remove_checkpoint(path);
  request.checkpoint.path = path;
  request.checkpoint.every_steps = 5;
  struct Killed {};
  request.keep = [](const RunState& state) {
    if (std::get<State>(state).step == 7) throw Killed();
  };
  const EngineKind kind = GetParam().make(bed, request);
  if (!kind.saves) {
    EXPECT_EQ(refused_with([&] { record(bed.scene, kind, request); }),
              "the " + kind.name + " engine leaves no checkpoints");
    return;
  }
  EXPECT_THROW(record(bed.scene, kind, request), Killed);
  ASSERT_TRUE(std::filesystem::exists(path));
  request.keep = {};
  request.checkpoint.resume = true;
  std::vector<Curve> seen;
  request.read = [&](const std::vector<Curve>& of, uint64_t step, Values values) {
    if (seen.empty()) seen = of;
    add_reading(seen, step, values);
  };
  const Recorded run = record(bed.scene, kind, request);
  remove_checkpoint(path);
  expect_beginning(seen, run.trace.curves);
  EXPECT_EQ(run.resumed_at, 5u);
  request.checkpoint = {};
  expect_equal(record(bed.scene, golden_kind(bed.scene, bed.plan), request), run, tolerance());
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryEngine, testing::ValuesIn(fixed_kinds()),
                         [](const auto& p) { return p.param.name; });

// In real numbers: the same steps, names and ends.
TEST(RealEngines, AreRecordedAlike) {
  Bed bed = bed_of("scenes/boards/grips.toml");
  const RunRequest request = everything(20);
  const Recorded reference = record(bed.scene, scene_reference_kind(bed.scene, bed.plan, {}), request);
  bed.gpu.arithmetic = gpu::Arithmetic::float64;
  const Recorded device = record(bed.scene, gpu::gpu_kind(bed.scene, bed.plan, bed.gpu), request);
  for (const Recorded* run : {&reference, &device}) {
    EXPECT_TRUE(run->trace.state_hash.empty());
    EXPECT_EQ(run->trace.steps(), 20u);
    ASSERT_EQ(run->trace.bodies.size(), 4u);
    EXPECT_EQ(run->trace.bodies.back().step, 20u);
    EXPECT_EQ(run->trace.watched, 20u);
  }
  // Sums in another order, over 20 steps of a warm bar.
  expect_equal(reference.trace.curves, device.trace.curves, 1e-9);
  EXPECT_NEAR(reference.momentum_change, device.momentum_change, 1e-9 * reference.momentum_change);
}

TEST(RealEngines, CountTheSameBrokenBonds) {
  const Bed bed = torn();
  RunRequest request = everything(12);
  request.probes = every_so_often(2, 12);
  const Recorded run = record(bed.scene, scene_reference_kind(bed.scene, bed.plan, {}), request);
  expect_torn(bed, run.trace.curves);
}

// A position that stops being finite takes the state with it: the run ends with the state before.
TEST(RealEngines, EndWhereAPositionIsLost) {
  Scene scene = read_scene(kRoot + "/scenes/boards/grips.toml");
  const Plan plan = plan_of(scene, read_arch(kRoot + "/scenes/archs/board.toml"));
  scene.rule.dt *= 1e160;
  const Recorded run = record(scene, scene_reference_kind(scene, plan, {}), everything(20));
  ASSERT_TRUE(run.trace.stop);
  EXPECT_EQ(run.trace.stop->fault, Fault::none);
  EXPECT_LT(run.trace.steps(), 20u);
  ASSERT_FALSE(run.trace.bodies.empty());
  EXPECT_EQ(run.trace.bodies.back().step, run.trace.steps());
  for (const Vec3& x : run.trace.bodies.back().x) EXPECT_TRUE(x.allFinite());
}

// Ctrl-C comes when the run has decided to go on after step 6: the next batch ends before its first step.
class InterruptedBetweenBatches : public GoldenEngine {
 public:
  using GoldenEngine::GoldenEngine;
  std::pair<bool, bool> agreed(bool stop, bool save) override {
    if (step_count() == 6 && !interrupted()) std::raise(SIGINT);
    return {stop, save};
  }
  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override {
    if (!interrupted()) GoldenEngine::advance(steps, hashes);
  }
};

TEST(Interrupts, BetweenBatchesRecordNoStepTwice) {
  const Bed bed = bed_of("scenes/boards/grips.toml");
  EngineKind kind = golden_kind(bed.scene, bed.plan);
  kind.batches = true;
  kind.make = [&](CheckpointReader* from, bool) {
    return std::make_unique<InterruptedBetweenBatches>(
        setting_of(bed.scene, bed.plan), bed.plan.arch.capacity, begin_of(bed.scene, bed.plan, from));
  };
  RunRequest request = everything(20);
  request.hash_every = 2;
  const CatchInterrupt catching;
  const Recorded run = record(bed.scene, kind, request);
  EXPECT_TRUE(run.interrupted);
  EXPECT_EQ(run.trace.steps(), 6u);
  EXPECT_EQ(run.trace.state_hash.size(), 4u);
  for (size_t k = 1; k < run.trace.frames.size(); ++k)
    EXPECT_LT(run.trace.frames[k - 1].step, run.trace.frames[k].step);
}

}  // namespace
}  // namespace cuboct::test
