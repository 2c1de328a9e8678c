// SPDX-License-Identifier: MIT
// A run in two parts is the run in one: the second part begins with the last state of the first, read from
// its trace.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "hw/engine/scene_engine.h"
#include "model/base/error.h"
#include "model/base/output.h"
#include "model/base/steps.h"
#include "model/config/config.h"
#include "model/run/start.h"
#include "model/trace/trace_file.h"
#include "model/trace/trace_head.h"
#include "tests/run/kinds.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

const std::string kTree = CUBOCT_SOURCE_DIR;
const std::string kGrips = kTree + "/scenes/boards/grips.toml";

// A directory that is gone with the test.
class Directory {
 public:
  explicit Directory(const std::string& name)
      : path(fmt::format("{}start_test.{}.{}", testing::TempDir(), name, getpid())) {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  ~Directory() { fs::remove_all(path); }
  const std::string path;
};

Bed bed_of(Scene scene, const std::string& arch = "") {
  Bed bed;
  bed.scene = std::move(scene);
  bed.plan = plan_of(bed.scene, read_arch(arch.empty() ? arch : kTree + "/" + arch));
  bed.one_thread.engine.threads = 1;
  bed.two_threads.engine.threads = 2;
  return bed;
}

// What `cuboct run --out` leaves of it.
void leave(const Bed& bed, const Trace& trace, const std::string& directory) {
  TraceHead head{bed.scene, nullptr, nullptr, bed.plan.origin, ""};
  if (trace.bodies.empty()) head.rule = &bed.plan.rule, head.lattice = &bed.plan.lattice;
  TraceWriter out(directory + "/trace.h5", directory + "/trace.part.h5", true, &head);
  for (const State& frame : trace.frames) out.add(frame);
  for (const RealFrame& frame : trace.bodies) out.add(frame);
  Trace rest = trace;
  rest.frames.clear();
  rest.bodies.clear();
  out.finish(rest);
}

RunRequest of_steps(uint64_t steps) {
  RunRequest request;
  request.steps = steps;
  request.frames = {0, steps};
  request.probes = every_so_often(3, steps);
  return request;
}

class Starts : public testing::TestWithParam<Kind> {
 protected:
  Recorded run(const Bed& bed, uint64_t steps) {
    const RunRequest request = of_steps(steps);
    return record(bed.scene, GetParam().make(bed, request), request);
  }
};

// Ends imposed and damped; held by controllers; a warm box that repeats; a flat sheet.
TEST_P(Starts, InTwoPartsAsInOne) {
  for (const std::string name : {"boards/grips", "failures/stiff_hold_healthy", "two_types", "sheet"}) {
    const std::string path = kTree + "/scenes/" + name + ".toml";
    const Bed whole_bed = bed_of(read_scene(path));
    const Recorded whole = run(whole_bed, 21);
    const Directory first("first." + GetParam().name);
    leave(whole_bed, run(whole_bed, 9).trace, first.path);

    const Bed bed = bed_of(load_scene(path, {{}, first.path}));
    EXPECT_NE(start_text(bed.scene, &bed.plan.rule, bed.plan.origin).find("bit for bit"), std::string::npos)
        << name;
    const Recorded second = run(bed, 12);
    ASSERT_EQ(whole.trace.state_hash.size(), 22u);
    ASSERT_EQ(second.trace.state_hash.size(), 13u) << name;
    for (size_t k = 0; k < 13; ++k)
      EXPECT_EQ(second.trace.state_hash[k], whole.trace.state_hash[9 + k]) << name << k;
    // Displacements count from the packing: the curves go on where they were.
    ASSERT_EQ(second.trace.curves.size(), whole.trace.curves.size());
    for (size_t k = 0; k < whole.trace.curves.size(); ++k)
      for (size_t n = 0; n < 5; ++n)
        EXPECT_NEAR(second.trace.curves[k].value[n], whole.trace.curves[k].value[3 + n],
                    1e-12 * std::abs(whole.trace.curves[k].value[3 + n]))
            << name << " " << whole.trace.curves[k].name;
  }
}

TEST_P(Starts, CracksMayCountTheBondsOfTheStart) {
  const Directory first("crack." + GetParam().name);
  const std::string path = first.path + "/scene.toml";
  std::string text = read_config_text(kGrips);
  for (const std::string from : {"packing", "start"})
    text += "[[probe]]\nname = \"" + from + "\"\nkind = \"crack\"\naxis = \"x\"\nbonds = \"" + from +
            "\"\nregion = { shape = \"half_space\", point = [1.2, 0, 0], normal = [-1, 0, 0] }\n";
  write_text(path, text);
  const Bed bed = bed_of(read_scene(path));
  leave(bed, run(bed, 9).trace, first.path);
  const Scene scene = load_scene(path, {{}, first.path});
  const Probe &packed = scene.probes[scene.probes.size() - 2], &begun = scene.probes.back();
  EXPECT_TRUE(packed.begin.empty());
  ASSERT_EQ(begun.begin.size(), begun.set.ids.size());
  EXPECT_LT(begun.begin.size(), scene.body.size());
  size_t moved = 0;
  for (size_t at = 0; at < begun.begin.size(); ++at) {
    EXPECT_EQ(begun.begin[at], scene.body.x[begun.set.ids[at]]);
    moved += begun.begin[at] != scene.packing().x[begun.set.ids[at]] ? 1 : 0;
  }
  EXPECT_GT(moved, 0u);
}

std::string with_until(const std::string& until) {
  std::string text = read_config_text(kGrips);
  const size_t run = text.find("[run]\n") + 6;
  text.insert(run, "until = " + until + "\n");
  return text.insert(text.find("[run]"),
                     "[[probe]]\nname = \"right\"\nkind = \"displacement\"\naxis = \"x\"\n"
                     "region = { shape = \"half_space\", point = [2.4, 0, 0], normal = [-1, 0, 0] }\n\n");
}

// The right grip moves by 0.0042 per step: 0.03 is passed at step 8, and read at step 9.
TEST_P(Starts, EndsAtTheFirstReadingBeyondItsLimit) {
  struct Of {
    std::string until;
    uint64_t end;
  };
  for (const auto& [until, end] :
       {Of{"{ probe = \"right\", above = 0.03 }", 9},
        Of{"{ probe = \"right.along\", beyond = 0.03, after = 1.4 }", 12},
        Of{"{ probe = \"right\", below = 1 }", 3}, Of{"{ probe = \"right\", above = 1 }", 21}}) {
    Bed bed = bed_of(parse_scene(with_until(until), kGrips));
    RunRequest request = of_steps(21);
    request.until = true;
    request.totals = true;
    const Recorded run = record(bed.scene, GetParam().make(bed, request), request);
    EXPECT_EQ(run.trace.steps(), end) << until;
    EXPECT_EQ(run.trace.reached.has_value(), end < 21) << until;
    EXPECT_FALSE(run.interrupted);
    EXPECT_EQ(run.trace.frames.back().step, end);
    EXPECT_EQ(run.trace.state_hash.size(), end + 1);
    if (GetParam().name == "systemc") {
      // The cycles up to there, not those that the machine went on for.
      RunRequest until_there = of_steps(end);
      until_there.cycles = true;
      const Trace there = record(bed.scene, GetParam().make(bed, until_there), until_there).trace;
      uint64_t last = 0;
      for (const PhaseSpan& span : there.cycles) last = std::max(last, span.end);
      EXPECT_EQ(run.trace.counters.front().second,
                end < 21 ? static_cast<double>(last + 1) : there.counters.front().second);
    }
    if (!run.trace.reached) continue;
    EXPECT_EQ(run.trace.reached->step, end);
    EXPECT_NEAR(run.trace.reached->value, 0.0042 * static_cast<double>(end), 1e-6);
    // Who does not ask for it runs on.
    request.until = false;
    EXPECT_EQ(record(bed.scene, GetParam().make(bed, request), request).trace.steps(), 21u);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, Starts, testing::ValuesIn(fixed_kinds()),
                         [](const auto& p) { return p.param.name; });

// In doubles, and in floats: bit for bit too.
TEST(RealStarts, InTwoPartsAsInOne) {
  for (const std::string name : {"boards/grips", "failures/stiff_hold_healthy", "two_types"})
    for (const Precision precision : {Precision::float64, Precision::float32}) {
      const std::string path = kTree + "/scenes/" + name + ".toml";
      const RealOptions options{.precision = precision};
      const auto run = [&](const Bed& bed, uint64_t steps) {
        return record(bed.scene, scene_reference_kind(bed.scene, bed.plan, options), of_steps(steps));
      };
      const Bed whole_bed = bed_of(read_scene(path));
      const Recorded whole = run(whole_bed, 21);
      const Directory first("real");
      leave(whole_bed, run(whole_bed, 9).trace, first.path);
      const Bed bed = bed_of(load_scene(path, {{}, first.path}));
      const Recorded second = run(bed, 12);
      const RealFrame &a = whole.trace.bodies.back(), &b = second.trace.bodies.back();
      EXPECT_EQ(a.x, b.x) << name;
      EXPECT_EQ(a.v, b.v) << name;
      EXPECT_EQ(a.u, b.u) << name;
      EXPECT_EQ(a.u.empty(), name == "boards/grips");
    }
}

// The run in one, and the run that is killed behind the checkpoint of step `saved`, and goes on in `after`:
// bit for bit. Killed, as far as files can tell. `rounding`: of sums over all particles, as a share. Answers
// the run that went on.
Recorded expect_goes_on(const Bed& bed, const EngineKind& kind, const EngineKind& after, uint64_t saved,
                        uint64_t steps, double rounding = 0) {
  RunRequest request = of_steps(steps);
  request.frames = {0, 7, saved + 3, steps};
  request.energies = request.watch = request.totals = true;
  const Recorded whole = record(bed.scene, kind, request);

  const Directory directory("checkpoint");
  request.checkpoint.path = directory.path + "/checkpoint";
  request.checkpoint.every_steps = saved / 2;
  struct Killed {};
  request.keep = [&](const RunState& state) {
    if (std::get<RealFrame>(state).step == saved + 3) throw Killed();
  };
  EXPECT_THROW(record(bed.scene, kind, request), Killed);
  request.keep = {};
  request.checkpoint.resume = true;
  Recorded resumed = record(bed.scene, after, request);
  EXPECT_EQ(resumed.resumed_at, saved);
  EXPECT_EQ(resumed.trace.bodies.size(), whole.trace.bodies.size());
  for (size_t k = 0; k < std::min(whole.trace.bodies.size(), resumed.trace.bodies.size()); ++k) {
    EXPECT_EQ(resumed.trace.bodies[k].step, whole.trace.bodies[k].step);
    EXPECT_EQ(resumed.trace.bodies[k].x, whole.trace.bodies[k].x) << "frame " << k;
    EXPECT_EQ(resumed.trace.bodies[k].v, whole.trace.bodies[k].v) << "frame " << k;
    EXPECT_EQ(resumed.trace.bodies[k].u, whole.trace.bodies[k].u) << "frame " << k;
  }
  EXPECT_EQ(resumed.trace.curves.size(), whole.trace.curves.size());
  for (size_t k = 0; k < std::min(whole.trace.curves.size(), resumed.trace.curves.size()); ++k)
    for (size_t n = 0; n < whole.trace.curves[k].value.size(); ++n) {
      const double value = whole.trace.curves[k].value[n];
      EXPECT_NEAR(resumed.trace.curves[k].value.at(n), value, rounding * std::abs(value))
          << whole.trace.curves[k].name << " at sample " << n;
    }
  EXPECT_EQ(resumed.momentum_change, whole.momentum_change);
  EXPECT_EQ(resumed.largest_speed, whole.largest_speed);
  return resumed;
}

TEST(RealStarts, GoOnFromACheckpoint) {
  const Bed bed = bed_of(read_scene(kTree + "/scenes/failures/stiff_hold_healthy.toml"));
  const EngineKind kind = scene_reference_kind(bed.scene, bed.plan, {});
  expect_goes_on(bed, kind, kind, 10, 40);
}

// The next load step begins where the last two lead, and anchors are not to be had from positions to the last
// bit.
TEST(RealStarts, StaticLoadingGoesOnFromACheckpoint) {
  const std::string path = kTree + "/scenes/studies/fit_bar_scene.toml";
  for (const char* pull : {"\"moved\"", "\"moved_by_force\""}) {
    std::string text = read_text(path);
    text.replace(text.find("\"moved\""), 7, pull);
    const Bed bed = bed_of(parse_scene(text, path));
    const EngineKind kind = scene_reference_kind(bed.scene, bed.plan, {});
    const uint64_t every = bed.scene.loading->every;
    expect_goes_on(bed, kind, kind, 6 * every, 10 * every);
  }
}

// Lists are made many times before the checkpoint and behind it, at steps and with skins that depend on what
// came before: sums are then in another order.
TEST(RealStarts, OnDevicesGoOnFromACheckpoint) {
  struct Of {
    std::string scene;
    gpu::Arithmetic arithmetic;
    std::vector<int> before, after;
  };
  for (const auto& [scene, arithmetic, before, after] :
       {Of{"hot_cluster", gpu::Arithmetic::float32, {0}, {0}},
        Of{"hot_cluster", gpu::Arithmetic::float64, {0, 0}, {0}},
        Of{"two_types", gpu::Arithmetic::float32, {0}, {0, 0}},
        Of{"failures/stiff_hold_healthy", gpu::Arithmetic::float64, {0}, {0}}}) {
    const Bed bed = bed_of(read_scene(kTree + "/scenes/" + scene + ".toml"));
    const gpu::GpuChoice one{.arithmetic = arithmetic, .engine = {.devices = before}, .hooks = {}},
        other{.arithmetic = arithmetic, .engine = {.devices = after}, .hooks = {}};
    SCOPED_TRACE(scene);
    const Recorded resumed =
        expect_goes_on(bed, gpu::gpu_kind(bed.scene, bed.plan, one),
                       gpu::gpu_kind(bed.scene, bed.plan, other), 90, 240, before == after ? 0 : 1e-12);
    const auto& [name, builds] = resumed.trace.counters.front();
    EXPECT_EQ(name, "list_builds");
    EXPECT_GT(builds, scene == "hot_cluster" ? 10 : 0);
  }
}

// A checkpoint in the engine's own words may be a stranger's, who can make its hash right.
TEST(RealStarts, OnDevicesRefuseWhatIsNotTheirs) {
  const Bed bed = bed_of(read_scene(kTree + "/scenes/hot_cluster.toml"));
  const auto kind_of = [&](const gpu::GpuChoice& choice) {
    return gpu::gpu_kind(bed.scene, bed.plan, choice);
  };
  const gpu::GpuChoice floats{.arithmetic = gpu::Arithmetic::float32, .engine = {}, .hooks = {}},
      doubles{.arithmetic = gpu::Arithmetic::float64, .engine = {}, .hooks = {}};
  const auto engine = kind_of(floats).make(nullptr, false);
  engine->advance(20);
  const Directory directory("stranger");
  const std::string path = directory.path + "/checkpoint";
  const auto refusal = [&](const EngineKind& kind, const std::function<void(std::vector<uint64_t>&)>& edit) {
    class Edited : public Engine {
     public:
      explicit Edited(EngineMemory memory) : memory_(std::move(memory)) {}
      uint64_t step_count() const override { return 20; }
      void advance(uint64_t, std::vector<uint64_t>*) override {}
      uint64_t hash() override { return 0; }
      RunState frame(bool) override { return RealFrame{}; }
      Reading read(const Asked&) override { return {}; }
      Momentum momentum() override { return {}; }
      double largest_speed() override { return 0; }
      Counters counters() override { return {}; }
      EngineMemory memory() override { return memory_; }

     private:
      EngineMemory memory_;
    };
    CheckpointHead head;
    head.plan_hash = bed.plan.hash;
    head.step = 20;
    head.engine = engine->memory();
    edit(head.engine.own);
    Edited edited(head.engine);
    write_checkpoint(path, head, edited, false);
    CheckpointReader from(path, bed.plan.hash, false);
    try {
      kind.make(&from, false);
    } catch (const InputError& error) {
      return std::string(error.what()).substr(path.size());
    }
    return std::string("taken");
  };
  const EngineKind kind = kind_of(floats);
  const uint32_t n = static_cast<uint32_t>(bed.scene.body.size());
  EXPECT_EQ(refusal(kind, [](auto&) {}), "taken");
  EXPECT_EQ(refusal(kind_of(doubles), [](auto&) {}),
            " was made with another engine or --precision\n"
            "  hint: resume with the options of the run that wrote it");
  EXPECT_EQ(refusal(kind, [](auto& words) { words.pop_back(); }),
            " is damaged: its lists have other lengths");
  EXPECT_EQ(refusal(kind, [](auto& words) { words[0] = ~uint64_t{0}; }),
            " is damaged: its lists have other lengths");
  // Positions are of 16 bytes, as velocities; then none of u, cells of 12 bytes, ids of four.
  const size_t ids = 4 + 4 * n + (12 * n + 7) / 8 + 1;
  EXPECT_EQ(refusal(kind, [&](auto& words) { words[ids] |= 0xffffffff; }),
            " is damaged: a particle is missing");
  EXPECT_NE(refusal(kind, [&](auto& words) { words[1] = 0x7fc00000; }).find(" cannot be one of the scene's"),
            std::string::npos);
  EXPECT_EQ(refusal(kind, [&](auto& words) { words[words.size() - 3] = 99; }),
            " is damaged: no pair list has such a skin");
}

// From doubles into integers, and with another dt: rounded anew, by half a unit at most.
TEST(Start, RoundsAnewWhereFormatsDiffer) {
  const Bed first = bed_of(read_scene(kGrips));
  const Directory directory("anew");
  const RunRequest request = of_steps(9);
  const Recorded run = record(first.scene, golden_kind(first.scene, first.plan), request);
  leave(first, run.trace, directory.path);
  std::string text = read_config_text(kGrips);
  text.replace(text.find("dt = 0.14"), 9, "dt = 0.10");
  const std::string path = directory.path + "/other.toml";
  write_text(path, text);
  const Bed second = bed_of(load_scene(path, {{}, directory.path}));
  EXPECT_EQ(start_text(second.scene, &second.plan.rule, second.plan.origin),
            "step 9 of " + directory.path + ", rounded anew: dt 0.14 s there, 0.1 s here");
  const State left = run.trace.frames.back();
  const State begun = to_fixed(second.scene.body, second.plan.rule, second.plan.lattice, second.plan.origin);
  const double unit = std::ldexp(second.plan.rule.cell_edge, -second.plan.rule.widths.velocity_frac());
  double moved = 0;
  for (size_t id = 0; id < left.particles.size(); ++id) {
    const Vec3 there =
        position_of(first.plan.rule, first.plan.lattice, first.plan.origin, left.particles[id]);
    const Vec3 here =
        position_of(second.plan.rule, second.plan.lattice, second.plan.origin, begun.particles[id]);
    EXPECT_LE((there - here).cwiseAbs().maxCoeff(), 0.5001 * unit);
    moved = std::max(moved, (there - first.scene.body.x[id]).norm());
  }
  EXPECT_GT(moved, 0.03);  // the grip
}

TEST(Start, RefusesOtherParticles) {
  const Bed first = bed_of(read_scene(kGrips));
  const Directory directory("others");
  leave(first, record(first.scene, golden_kind(first.scene, first.plan), of_steps(3)).trace, directory.path);
  const auto refusal = [&](const std::string& from, const std::string& to) {
    std::string text = read_config_text(kGrips);
    text.replace(text.find(from), from.size(), to);
    write_text(directory.path + "/other.toml", text);
    try {
      load_scene(directory.path + "/other.toml", {{}, directory.path});
    } catch (const InputError& error) {
      const std::string what = error.what();
      return what.substr(directory.path.size() + 1, what.find('\n') - directory.path.size() - 1);
    }
    return std::string("taken");
  };
  const std::string left = directory.path + " was left by other particles: ";
  EXPECT_EQ(refusal("cells = [2, 1, 1]", "cells = [3, 1, 1]"),
            "other.toml:6:1: " + left + "8 there, 12 here");
  EXPECT_EQ(refusal("offset = [0.3, 0.3, 0.3]", "offset = [0.3, 0.31, 0.3]"),
            "other.toml:7:9: " + left + "their packing or its box is another one");
  EXPECT_EQ(refusal("[[constraint]]", "[[material]]\nname = \"rubber\"\n\n[[constraint]]"),
            "other.toml:20:1: " + left + "particle 0 is of 'matter' there, of 'rubber' here");
  EXPECT_EQ(refusal("velocity = [0.03", "velocity = [0.02"), "taken");
  EXPECT_EQ(refusal("[run]", "[start]\nfrom = \"none\"\n[run]"), "taken");  // --from wins
  fs::remove(directory.path + "/trace.h5");
  EXPECT_EQ(refusal("title", "title"), "holds no finished run: no file trace.h5");
}

}  // namespace
}  // namespace cuboct::test
