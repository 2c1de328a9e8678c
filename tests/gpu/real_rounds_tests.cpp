// SPDX-License-Identifier: MIT
// Rules of text in floats and doubles, with loops for kernels, beside the reference: every rule that ships.
// The text is compiled by the host's compiler, and by CUDA's where its library is here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "emu/gpu/rounds/nvrtc.h"
#include "emu/gpu/rounds/real_rounds_engine.h"
#include "emu/gpu/rounds/real_space.h"
#include "emu/gpu/rounds/scaled_graph.h"
#include "model/program/program_errors.h"
#include "model/real/real_engine.h"
#include "model/rules/rounds_rule.h"
#include "tests/gpu/host_compiler.h"
#include "tests/gpu/rule_scenes.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

constexpr const char* kNames[] = {"heat", "glass", "plastic", "copper", "langevin", "dpd"};

// The device and the reference from one start, and the bounds of what parts them.
struct Beside {
  Beside(const Scene& scene, bool doubles, const gpu::CompileRounds& compile)
      : scene(scene),
        body(begin_of(scene)),
        device(gpu::make_real_rounds(scene.rule, body, scene.periodic, doubles, {}, compile)),
        reference(make_real_engine(scene.rule, body, scene.periodic, {})),
        errors(scene.rule, body, scene.periodic, !doubles) {}

  void step() {
    reference->read(body);
    errors.step(body.x, body.v, steps);
    reference->step(steps++);
    device->advance(1);
  }
  // Of all errors the largest share of its bound.
  double worst() {
    reference->read(body);
    errors.look(body.x, body.v, steps);
    Body here = body;
    device->read(here);
    const gpu::RealLook look = device->look();
    const std::vector<Vec3> force = reference->forces();
    double worst = 0;
    const auto see = [&](double off, double bound) {
      const bool told = !std::isnan(off) && std::isfinite(bound);
      worst = told ? std::max(worst, off > 0 ? off / bound : 0) : 1e300;
    };
    for (size_t i = 0; i < body.size(); ++i) {
      see((here.x[i] - body.x[i]).norm(), errors.position());
      if (!look.force.empty()) see((look.force[i] - force[i]).norm(), errors.force()[i]);
    }
    const std::vector<std::vector<double>> shown = reference->terms()->shown();
    size_t at = 0;
    for (const ProgramField& field : scene.rule.rounds->text()->particle) {
      if (!field.shown) continue;
      for (uint32_t k = 0; k < field.numbers(); ++k)
        for (size_t i = 0; i < body.size(); ++i)
          see(std::abs(look.fields[field.first + k][i] - shown[at][field.numbers() * i + k]),
              errors.field(field.first + k, i));
      ++at;
    }
    return worst;
  }

  const Scene& scene;
  Body body;
  std::unique_ptr<gpu::RealRounds> device;
  std::unique_ptr<RealEngine> reference;
  ProgramErrors errors;
  uint64_t steps = 0;
};

class EveryRule : public testing::TestWithParam<const char*> {};

// The bounds double in a few steps, as errors of signs that differ add up in them: a few steps tell most.
TEST_P(EveryRule, StaysWithinItsBounds) {
  const Scene scene = rule_scene(GetParam());
  for (const bool doubles : {false, true}) {
    SCOPED_TRACE(doubles ? "double" : "float");
    Beside beside(scene, doubles, host_compiler(std::string("real_") + GetParam()));
    EXPECT_LT(beside.worst(), 1);
    for (int k = 0; k < 3; ++k) beside.step();
    EXPECT_LT(beside.worst(), 1);
    // Of the reach: what a wrong step would do is far more.
    EXPECT_LT(beside.errors.position(), scene.rule.cutoff() * (doubles ? 1e-10 : 1e-4));
  }
}

// A sum that is off by one part in 100 is beyond them; of bonds that have hardly stretched yet, ten times as
// large.
TEST_P(EveryRule, IsBeyondThemWithAWrongText) {
  const Scene scene = rule_scene(GetParam());
  const std::string factor = scene.rule.rounds->text()->bond_numbers > 0 ? "Real(10) * (" : "Real(1.01) * (";
  const auto wrong = [&](std::string& source) {
    const size_t at = source.find("sums[0] += "), end = source.find(';', at);
    ASSERT_NE(at, std::string::npos);
    source.insert(end, ")").insert(at + 11, factor);
  };
  Beside beside(scene, false, host_compiler(std::string("wrong_") + GetParam(), wrong));
  for (int k = 0; k < 3; ++k) beside.step();
  EXPECT_GT(beside.worst(), 1);
}

// Lists are made anew, near lists too, and every batch ends somewhere else: the bits are those of single
// steps. What goes on from a memory has them, too.
TEST_P(EveryRule, HasTheSameBitsHoweverItIsStepped) {
  const Scene scene = rule_scene(GetParam());
  const Body body = begin_of(scene);
  const auto compile = host_compiler(std::string("real_") + GetParam());
  const auto make = [&](const Body& from, const gpu::Memory& memory) {
    return gpu::make_real_rounds(scene.rule, from, scene.periodic, false, {}, compile, memory);
  };
  const auto whole = make(body, {}), parts = make(body, {});
  whole->advance(60);
  parts->advance(23);
  for (int k = 0; k < 10; ++k) parts->advance(1);
  Body half = body;
  parts->read(half);
  const auto holder = make_real_engine(scene.rule, body, scene.periodic, {});
  holder->recall(parts->kept());
  keep_bonds(half, *holder->kept_terms());
  const std::vector<uint64_t> words = parts->memory();
  const auto resumed = make(half, {33, words});
  parts->advance(27), resumed->advance(27);
  for (const auto* other : {&parts, &resumed}) {
    Body expected = body, found = body;
    whole->read(expected), (*other)->read(found);
    EXPECT_EQ(found.x, expected.x);
    EXPECT_EQ(found.v, expected.v);
    EXPECT_EQ((*other)->kept(), whole->kept());
    EXPECT_EQ((*other)->step_count(), 60u);
  }
}

TEST_P(EveryRule, IsTakenByCuda) {
  std::unique_ptr<gpu::Nvrtc> nvrtc;
  try {
    nvrtc = std::make_unique<gpu::Nvrtc>();
  } catch (const gpu::NvrtcError& e) {
    GTEST_SKIP() << e.what();
  }
  const Scene scene = rule_scene(GetParam());
  std::string text;
  const auto keep =
      host_compiler(std::string("real_") + GetParam(), [&](std::string& source) { text = source; });
  const bool doubles = GetParam() == std::string("copper");
  gpu::make_real_rounds(scene.rule, begin_of(scene), scene.periodic, doubles, {}, keep);
  EXPECT_GT(nvrtc->compiled(text, gpu::round_headers(), "sm_90").size(), 1000u);
}

INSTANTIATE_TEST_SUITE_P(Rules, EveryRule, testing::ValuesIn(kNames),
                         [](const auto& rule) { return std::string(rule.param); });

// A density beyond the table of embedding: the state before that step stands.
TEST(RealRounds, TellsWhereATableEnds) {
  Scene scene = rule_scene("copper");
  for (Vec3& x : scene.body.x) x *= 0.6;
  scene.periodic = {};
  const Body body = begin_of(scene);
  const auto device =
      gpu::make_real_rounds(scene.rule, body, scene.periodic, false, {}, host_compiler("real_copper"));
  EXPECT_EQ(refused_with<gpu::TableEnds>([&] { device->advance(5); }),
            "step 1: a table is asked for more than it has; is dt too long?");
  EXPECT_EQ(device->step_count(), 0u);
}

TEST(RealRounds, TellsWhereAPositionIsLost) {
  Scene scene = rule_scene("langevin");
  scene.body.v[7] = Vec3(1e9, 0, 0);
  const auto device = gpu::make_real_rounds(scene.rule, begin_of(scene), scene.periodic, true, {},
                                            host_compiler("real_langevin"));
  EXPECT_EQ(refused_with<gpu::LostPosition>([&] { device->advance(5); }),
            "step 1: a position leaves all bounds; before it particle 7 was the fastest, at 1e+09 m/s");
}

// Places of 32 bits have equal ones 8 to 16 reaches apart. An atom that flies off as far meets nobody again.
// The 14th power of a length is no float in SI units.
TEST(RealRounds, FloatsKnowWhoIsFar) {
  Scene scene = parse_scene(
      "mass = \"40 u\"\npacking = { pitch = \"4 angstrom\" }\nrun = { dt = \"1 fs\", steps = 20 }\n"
      "geometry = { shape = \"box\", min = \"[0, 0, 0] angstrom\", max = \"[9, 9, 9] angstrom\" }\n"
      "[[particle]]\nposition = \"[0, 0, 20] angstrom\"\n[rule]\nname = \"argon\"\nreach = \"5 angstrom\"\n"
      "parameters = { depth = \"10 meV\", size = \"3.4 angstrom\" }\n[[rule.round]]\nsum.force = "
      "\"-48 * depth * (size^12 / r^14 - size^6 / r^8 / 2) * d\"\n",
      "far.toml");
  const size_t flyer = scene.body.size() - 1;
  double top = 0;  // of those below
  for (size_t i = 0; i < flyer; ++i)
    if (std::hypot(scene.body.x[i].x(), scene.body.x[i].y()) < 1e-11)
      top = std::max(top, scene.body.x[i].z());
  const double reach = scene.rule.cutoff();
  const gpu::RealSpace space(scene.body, scene.periodic, reach, false);
  const double again = std::ldexp(space.place_unit(2), 32);
  constexpr int kSteps = 12;
  scene.body.v[flyer].z() = (top + again + 0.8 * reach - scene.body.x[flyer].z()) / (kSteps * scene.rule.dt);
  Beside beside(scene, false, host_compiler("real_far"));
  EXPECT_LT(beside.worst(), 1);
  EXPECT_GT(beside.device->look().force[0].norm(), 1e-14);
  for (int k = 0; k < kSteps; ++k) {
    beside.step();
    EXPECT_EQ(beside.device->look().force[flyer].norm(), 0) << k;
  }
  Body body = beside.body;
  beside.device->read(body);
  EXPECT_NEAR(body.x[flyer].z(), top + again + 0.8 * reach, 0.1 * reach);
}

TEST(RealRounds, RefusesWhatItCannotDo) {
  const Scene scene = rule_scene("heat");
  const auto none = [](const std::string&, const std::string&) -> std::string {
    throw gpu::NvrtcError("no library libnvrtc.so.0");
  };
  const auto made = [&](const gpu::Options& options) {
    gpu::make_real_rounds(scene.rule, begin_of(scene), scene.periodic, false, options, none);
  };
  EXPECT_EQ(refused_with<InputError>([&] { made({}); }),
            "a rule of text in floats is compiled for the device: no library libnvrtc.so.0\n"
            "  hint: the package nvidia-cuda-nvrtc has CUDA's compiler; --precision fixed needs none");
}

// (a + b c)/d of sizes that no float holds: 1e-30, 1e-50, 1e20 and 1e-40.
TEST(RealRounds, ExponentsAreThoseOfSizes) {
  RealGraph graph;
  const NodeId a = graph.input(RealSource::own_field, 0), b = graph.input(RealSource::own_field, 1),
               c = graph.input(RealSource::own_field, 2), d = graph.input(RealSource::own_field, 3);
  const NodeId sum = graph.add(RealOp::add, a, graph.add(RealOp::multiply, b, c));
  const NodeId quotient = graph.add(RealOp::divide, sum, d);
  const int sizes[] = {gpu::exponent_of(1e-30), gpu::exponent_of(1e-50), gpu::exponent_of(1e20),
                       gpu::exponent_of(1e-40)};
  const gpu::ScaledGraph scaled = gpu::scaled(
      graph, {quotient, sum},
      {[](const RealInput&) { return std::nullopt; }, [](const RealInput&) { return gpu::RealScope::own; },
       [&](const RealInput& input) { return sizes[input.index]; }, [](NodeId) { return 0; }});
  EXPECT_EQ(sizes[0], -100);
  EXPECT_EQ(scaled.at(scaled.outputs[1]).exponent, sizes[0]);
  EXPECT_EQ(scaled.at(scaled.outputs[0]).exponent, sizes[0] - sizes[3]);
}

}  // namespace
}  // namespace cuboct::test
