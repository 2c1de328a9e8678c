// SPDX-License-Identifier: MIT
// Rules of text: every engine of integers has golden's bits, whatever becomes of bonds, cells and sleep.
#include <gtest/gtest.h>

#include <algorithm>

#include "hw/engine/scene_engine.h"
#include "model/base/output.h"
#include "model/config/changes.h"
#include "tests/run/kinds.h"

namespace cuboct::test {
namespace {

// The engines of kinds.h that run programs, but for golden.
std::vector<Kind> program_kinds() {
  std::vector<Kind> kinds = fixed_kinds();
  std::erase_if(kinds, [](const Kind& kind) { return kind.name == "golden" || kind.name == "systemc"; });
  return kinds;
}

Bed text_bed(const std::string& text, int capacity = kAutomatic) {
  Bed bed;
  bed.scene = parse_scene(text, "rule.toml");
  Arch arch;
  arch.capacity = capacity;
  bed.plan = program_plan_of(bed.scene, arch);
  bed.one_thread.engine.threads = 1;
  bed.two_threads.engine.threads = 2;
  return bed;
}

State state_of(Engine& engine) { return std::get<State>(engine.integers()); }

// The hash after each step, and the fault that ends them.
struct Ran {
  std::vector<uint64_t> hashes;
  std::string fault;
};
Ran run(Engine& engine, uint64_t steps) {
  Ran ran;
  try {
    engine.advance(steps, &ran.hashes);
  } catch (const RunError& error) {
    ran.fault = error.what();
  }
  return ran;
}

class TextPrograms : public testing::TestWithParam<Kind> {
 protected:
  std::unique_ptr<Engine> golden(const Bed& bed) {
    kind_ = golden_kind(bed.scene, bed.plan);
    return kind_.make(nullptr, false);
  }
  std::unique_ptr<Engine> engine(const Bed& bed) {
    other_ = GetParam().make(bed, {});
    return other_.make(nullptr, false);
  }

 private:
  EngineKind kind_, other_;
};

// Two halves of a metal's packing slide past one another, 0.16 mm a step, in a box of so many cubic cells of
// 1.41 mm. `met` counts the steps in which a bond met its partner.
std::string sliding(int cells, const std::string& rule) {
  const std::string half = "region = { shape = \"half_space\", point = \"[0, 0, 2.1] mm\", normal = ";
  return "density = \"7.8 g/cm^3\"\npacking = { pitch = \"1 mm\" }\n"
         "run = { dt = \"0.2 us\", steps = 9 }\n"
         "[box]\nperiodic = \"xyz\"\ncells = [" +
         std::to_string(cells) + ", 3, 3]\n[[velocity]]\n" + half +
         "\"z\" }\nuniform = \"[400, 30, 0] m/s\"\n[[velocity]]\n" + half +
         "\"-z\" }\nuniform = \"[-400, 0, 0] m/s\"\n[rule]\nbonds = \"reference\"\nreach = \"1.05 * "
         "pitch\"\n" +
         rule;
}
const std::string kCut =
    "broken = \"cut\"\n[rule.bond.cut]\nkind = \"truth\"\n[rule.bond.met]\nrange = [0, 4096]\n"
    "[[rule.round]]\nbond.cut = \"cut or r > 1.08 * r0 or r < 0.93 * r0\"\n"
    "bond.met = \"min(met + 1, 4000)\"\n"
    "sum.force = { is = \"1 kN/m * (r - r0) * d / r\", when = \"not cut\" }\n";

// The places of a bond's numbers: cut, met.
constexpr size_t kNumbers = 2, kMet = 1;

// In a ring of three cells all are neighbours, and a bond meets its partner at whatever distance.
TEST_P(TextPrograms, BondsMeetAroundARingOfThreeCells) {
  const Bed bed = text_bed(sliding(3, kCut));
  ASSERT_EQ(bed.plan.lattice.period(), (Cell{3, 3, 3}));
  const auto golden = this->golden(bed), other = engine(bed);
  constexpr int64_t kSteps = 60;
  const Ran expected = run(*golden, kSteps), found = run(*other, kSteps);
  EXPECT_EQ(expected.fault, "");
  EXPECT_EQ(found.hashes, expected.hashes);
  const State state = state_of(*golden);
  size_t cut = 0;
  for (size_t b = 0; b < state.bonds.size(); b += kNumbers) {
    cut += state.bonds[b] != 0;
    ASSERT_EQ(state.bonds[b + kMet] >> bed.plan.program->bond_scales[kMet].frac, kSteps) << b;
  }
  EXPECT_GT(cut, 100u);
}

// Around a ring of seven cells they lose sight of one another, and meet again.
TEST_P(TextPrograms, BrokenBondsPartAndMeetAgain) {
  const Bed bed = text_bed(sliding(6, kCut));
  const auto golden = this->golden(bed), other = engine(bed);
  std::vector<int64_t> met;
  std::vector<bool> parted;
  size_t again = 0;
  for (int part = 0; part < 8; ++part) {
    const Ran expected = run(*golden, 10), found = run(*other, 10);
    EXPECT_EQ(expected.fault, "");
    ASSERT_EQ(found.hashes, expected.hashes);
    const State state = state_of(*golden);
    met.resize(state.bonds.size() / kNumbers), parted.resize(met.size());
    for (size_t b = 0; b < met.size(); ++b) {
      const int64_t now = state.bonds[kNumbers * b + kMet];
      again += parted[b] && now > met[b];
      parted[b] = now == met[b];
      met[b] = now;
    }
  }
  EXPECT_GT(again, 100u);
}

// Nothing says that these bonds break for ever, though they do not count while they are long.
TEST_P(TextPrograms, ALostBondIsGoldensFault) {
  const Bed bed = text_bed(sliding(
      6,
      "[rule.bond.met]\nrange = [0, 4096]\n[[rule.round]]\nbond.met = \"min(met + 1, 4000)\"\n"
      "sum.force = { is = \"1 kN/m * (r - r0) * d / r\", when = \"r < 1.05 * r0 and r > 0.95 * r0\" }\n"));
  const auto golden = this->golden(bed), other = engine(bed);
  const Ran expected = run(*golden, 40), found = run(*other, 40);
  EXPECT_NE(expected.fault.find("partner of a bond out of reach"), std::string::npos) << expected.fault;
  EXPECT_EQ(found.fault, expected.fault);
  EXPECT_EQ(found.hashes, expected.hashes);
  EXPECT_GT(found.hashes.size(), 5u);
}

// A bond that is pressed leaves its table in a step in which others break.
TEST_P(TextPrograms, AFaultLeavesTheStateBefore) {
  const Bed bed = text_bed(sliding(
      3,
      "broken = \"cut\"\nbond.cut.kind = \"truth\"\n[[rule.round]]\nbond.cut = \"cut or r > 1.03 * r0\"\n"
      "sum.force = { is = \"1 kN/m * (r - r0) * d / r\", when = \"not cut\" }\n"));
  RunRequest request;
  request.steps = 40;
  request.frames = {0};
  request.energies = request.totals = true;
  const Recorded golden = record(bed.scene, golden_kind(bed.scene, bed.plan), request);
  ASSERT_TRUE(golden.trace.stop);
  EXPECT_EQ(golden.trace.stop->fault, Fault::strength);
  const Recorded found = record(bed.scene, GetParam().make(bed, request), request);
  EXPECT_EQ(found.trace.stop, golden.trace.stop);
  request.steps = golden.trace.steps();
  EXPECT_GT(request.steps, 0u);
  const Recorded before = record(bed.scene, GetParam().make(bed, request), request);
  EXPECT_FALSE(before.trace.stop);
  const auto damage = [](const Recorded& run) {
    const auto at = std::ranges::find(run.trace.counters, "mean_damage", &Counters::value_type::first);
    return at == run.trace.counters.end() ? -1 : at->second;
  };
  EXPECT_GT(damage(before), 0);
  for (const Recorded* run : {&golden, &found}) {
    EXPECT_EQ(run->trace.state_hash, before.trace.state_hash);
    EXPECT_EQ(run->trace.bonds, before.trace.bonds);
    EXPECT_EQ(run->momentum_change, before.momentum_change);
    EXPECT_EQ(damage(*run), damage(before));
    ASSERT_EQ(run->trace.bodies.size(), 2u);
    EXPECT_EQ(run->trace.bodies[1].x, before.trace.bodies[1].x);
    for (size_t k = 0; k < before.trace.curves.size(); ++k)
      EXPECT_EQ(run->trace.curves[k].value, before.trace.curves[k].value);
  }
}

// The last frame is of integers as the others are, wherever a run ends.
TEST_P(TextPrograms, KeepTheLastStateInIntegersToo) {
  const Bed bed = text_bed(sliding(3, kCut));
  RunRequest request;
  request.steps = 5;
  request.frames = {0, 3};
  request.integers = true;
  const Recorded run = record(bed.scene, GetParam().make(bed, request), request);
  EXPECT_TRUE(run.trace.bodies.empty());
  ASSERT_EQ(run.trace.frames.size(), 3u);
  EXPECT_EQ(run.trace.frames[2].step, 5u);
  EXPECT_EQ(hash_of(bed.plan.lattice, run.trace.frames[2]), run.trace.state_hash.back());
}

std::string counter_text(Engine& engine) {
  std::string text;
  for (const auto& [name, value] : engine.counters()) text += name + " " + std::to_string(value) + "\n";
  return text;
}
double counter(Engine& engine, const std::string& name) {
  for (const auto& [key, value] : engine.counters())
    if (key == name) return value;
  return -1;
}

// Every cell is full. Where a layer crosses into the next one, a step is possible though cells may be beyond
// their capacity on the way: the gpu engine leaves it to golden, and takes fields back.
TEST_P(TextPrograms, FullCellsPassFieldsOn) {
  const Bed bed = text_bed(
      "density = \"7.8 g/cm^3\"\npacking = { pitch = \"1 mm\" }\nrun = { dt = \"0.2 us\", steps = 9 }\n"
      "box = { periodic = \"xyz\", cells = [4, 3, 3] }\nvelocity = [ { uniform = \"[400, 0, 0] m/s\" } ]\n"
      "[rule]\nreach = \"1.2 * pitch\"\nparticle.T = { range = [0, 2000], start = \"select(x.x > 2 mm, 400, "
      "300)\" }\n"
      "[[rule.round]]\nsum.q = \"0.01 * (T_j - T_i)\"\nfinish.T = \"T + q\"\n"
      "sum.force = \"1 N/m * (1 mm - r) * d / r\"\n",
      4);
  const auto golden = this->golden(bed), other = engine(bed);
  const Ran expected = run(*golden, 30), found = run(*other, 30);
  EXPECT_EQ(expected.fault, "");
  EXPECT_EQ(found.hashes, expected.hashes);
  if (GetParam().name == "gpu") {
    EXPECT_GT(counter(*other, "golden_steps"), 1) << counter_text(*other);
  }
}

// What passes from neighbour to neighbour goes two of them further in a step of two rounds, into cells that
// had slept. Of who sleeps the sums are not made: `full` of no neighbours would be far out of its range.
TEST_P(TextPrograms, OfTwoRoundsRestAndNoCheckFailsAsleep) {
  const Bed bed = text_bed(
      "density = \"7.8 g/cm^3\"\npacking = { pitch = \"1 mm\" }\nrun = { dt = \"0.2 us\", steps = 9 }\n"
      "box = { periodic = \"x\", cells = [30, 2, 2] }\n[rule]\nreach = \"1.2 * pitch\"\nstill = true\n"
      "particle.full = { range = [-1, 1] }\nparticle.most = {}\nparticle.heard.kind = \"truth\"\n"
      "particle.told = { kind = \"truth\", start = \"x.x < 1 mm\" }\n"
      "[[rule.setup]]\nsum.all = \"1\"\nfinish.most = \"all\"\n"
      "[[rule.round]]\nsum.tellers = { is = \"1\", when = \"told_j\" }\nsum.n = \"1\"\n"
      "finish.heard = \"tellers > 0\"\nfinish.full = \"1000 * (n - most)\"\n"
      "[[rule.round]]\nsum.hearers = { is = \"1\", when = \"heard_j\" }\nfinish.told = \"told or hearers > "
      "0\"\n");
  const auto golden = this->golden(bed), other = engine(bed);
  const Ran expected = run(*golden, 12), found = run(*other, 12);
  EXPECT_EQ(expected.fault, "");
  EXPECT_EQ(found.hashes, expected.hashes);
  if (GetParam().name != "gpu") {
    EXPECT_GT(counter(*other, "quiet_node_steps"), 100) << counter_text(*other);
  }
}

// A scene of scenes/rules in another box.
Bed uneven_bed(const std::string& name, const std::vector<Change>& changes) {
  Bed bed;
  const std::string path = CUBOCT_SOURCE_DIR "/scenes/rules/" + name;
  bed.scene = parse_scene(with_changes(read_text(path), path, changes), path);
  bed.plan = program_plan_of(bed.scene, {});
  bed.one_thread.engine.threads = 1;
  bed.two_threads.engine.threads = 2;
  return bed;
}
const std::vector<std::pair<std::string, std::vector<Change>>> kUneven = {
    {"copper.toml", {{"box.cells", "[5, 7, 6]"}}},
    {"dpd.toml", {{"box.cells", "[7, 5, 8]"}, {"packing.pitch", "0.5"}}},
    {"langevin.toml", {{"box.cells", "[6, 5, 7]"}}}};

TEST_P(TextPrograms, CellsThatAreNoCubes) {
  for (const auto& [name, changes] : kUneven) {
    SCOPED_TRACE(name);
    const Bed bed = uneven_bed(name, changes);
    ASSERT_FALSE(bed.plan.rule.cubic());
    const auto golden = this->golden(bed), other = engine(bed);
    const Ran expected = run(*golden, 12), found = run(*other, 12);
    EXPECT_EQ(expected.fault, "");
    EXPECT_EQ(found.hashes, expected.hashes);
  }
  const Bed bed = text_bed(
      "density = \"7.8 g/cm^3\"\npacking = { pitch = \"1 mm\" }\nrun = { dt = \"0.2 us\", steps = 9 }\n"
      "[box]\nperiodic = \"xyz\"\ncells = [5, 4, 6]\n[[velocity]]\nuniform = \"[300, 30, 100] m/s\"\nregion "
      "= "
      "{ shape = \"half_space\", point = \"[0, 0, 4.3] mm\", normal = \"z\" }\n"
      "[rule]\nbonds = \"reference\"\nreach = \"1.5 * pitch\"\n" +
          kCut,
      40);
  ASSERT_FALSE(bed.plan.rule.cubic());
  const auto golden = this->golden(bed), other = engine(bed);
  const Ran expected = run(*golden, 40), found = run(*other, 40);
  EXPECT_EQ(expected.fault, "");
  EXPECT_EQ(found.hashes, expected.hashes);
}

// A pair law is a program there.
TEST_P(TextPrograms, PairLawsInCellsThatAreNoCubes) {
  Bed bed;
  bed.scene = parse_scene(
      "units = \"reduced\"\nmass = 1\npacking = { pitch = 1.1 }\nlaw = { kind = \"lj\", epsilon = 1, sigma = "
      "1, "
      "cutoff = 2.5 }\ndamping = { ratio = 0.02 }\nbox = { cells = [6, 5, 8], periodic = \"xyz\" }\n"
      "velocity = [ { thermal_energy = 1.5, seed = 2 } ]\nrun = { dt = 0.004, steps = 20, energy_every = 10 "
      "}\n",
      "lj.toml");
  bed.plan = plan_of(bed.scene, {}, CellForm::any);
  bed.one_thread.engine.threads = 1, bed.two_threads.engine.threads = 2;
  ASSERT_FALSE(bed.plan.rule.cubic());
  RunRequest request;
  request.steps = 20, request.energy_steps = {0, 10, 20}, request.energies = true, request.hash_every = 1;
  const Trace golden = record(bed.scene, golden_kind(bed.scene, bed.plan), request).trace,
              other = record(bed.scene, GetParam().make(bed, request), request).trace;
  EXPECT_EQ(golden.state_hash.size(), 21u);
  EXPECT_EQ(other.state_hash, golden.state_hash);
  ASSERT_EQ(other.curves.size(), golden.curves.size());
  for (size_t k = 0; k < golden.curves.size(); ++k) EXPECT_EQ(other.curves[k].value, golden.curves[k].value);
}

// As in the cubes of embedded_atoms_integer_test.cpp, by the same third derivative.
TEST(UnevenTexts, MoveAsInDoublesAndKeepMomentum) {
  const Bed bed = uneven_bed("copper.toml", {{"box.cells", "[5, 4, 6]"}});
  ASSERT_FALSE(bed.plan.rule.cubic());
  const auto golden = golden_kind(bed.scene, bed.plan).make(nullptr, false);
  const auto doubles = scene_reference(bed.scene, bed.scene.body, {}, bed.scene.rule.cutoff(), 0, {});
  const Momentum before = golden->momentum();
  golden->advance(50, nullptr), doubles->advance(50, nullptr);
  EXPECT_EQ(golden->momentum().fixed, before.fixed);
  const auto here = std::get<RealFrame>(golden->frame(false)).x,
             there = std::get<RealFrame>(doubles->frame(false)).x;
  double moved = 0, off = 0;
  for (size_t i = 0; i < here.size(); ++i) {
    moved = std::max(moved, nearest_image(here[i] - bed.scene.body.x[i], bed.scene.periodic).norm());
    off = std::max(off, nearest_image(here[i] - there[i], bed.scene.periodic).norm());
  }
  EXPECT_GT(moved, 0.2e-10);
  EXPECT_LT(off, 2e-14);
}

INSTANTIATE_TEST_SUITE_P(Kinds, TextPrograms, testing::ValuesIn(program_kinds()),
                         [](const auto& p) { return p.param.name; });

// Who measures a run of the gpu engine measures a rule of text as well.
TEST(GpuOfText, TellsWhoMeasures) {
  Bed bed = text_bed(sliding(3, kCut));
  uint64_t ready = 0, steps = 0;
  bed.gpu.hooks.ready = [&] { ++ready; };
  bed.gpu.hooks.did = [&](uint64_t done) { steps += done; };
  bed.gpu.hooks.finish = [&](Counters& counters, Notes& notes) {
    counters.emplace_back("joules", steps);
    notes.emplace_back("energy by", "a test");
  };
  RunRequest request;
  request.steps = 20;
  const Trace trace = record(bed.scene, gpu::gpu_kind(bed.scene, bed.plan, bed.gpu), request).trace;
  EXPECT_EQ(ready, 1u);
  EXPECT_EQ(steps, 20u);
  EXPECT_TRUE(std::ranges::count(trace.counters, Counters::value_type("joules", 20)));
  EXPECT_TRUE(std::ranges::count(trace.notes, Notes::value_type("energy by", "a test")));
}

}  // namespace
}  // namespace cuboct::test
