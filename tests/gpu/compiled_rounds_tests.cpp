// SPDX-License-Identifier: MIT
// Programs as text that is compiled while the engine runs: by the host's compiler for an engine with loops
// for kernels, and by CUDA's where its library is here, for a device that need not be.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "emu/gpu/rounds/nvrtc.h"
#include "emu/gpu/rounds/rounds_engine.h"
#include "emu/gpu/rounds/rounds_kernel.h"
#include "emu/gpu/rounds/rounds_text.h"
#include "hw/engine/engine_kind.h"
#include "model/base/output.h"
#include "model/contract/pair_program.h"
#include "model/program/integer_program.h"
#include "tests/gpu/host_compiler.h"
#include "tests/gpu/rule_scenes.h"
#include "tests/support/cases.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

void run_beside_golden(const Scene& scene, const std::string& name, uint64_t steps) {
  SCOPED_TRACE(name);
  const Plan plan = program_plan_of(scene, Arch());
  const auto golden = integer_run(scene, plan, nullptr);
  const auto device = integer_run(scene, plan, nullptr, [&](const State& state) {
    return gpu::make_rounds_engine(plan, state, {}, host_compiler(name));
  });
  std::vector<uint64_t> expected{golden->hash()}, found{device->hash()};
  golden->advance(steps, &expected), device->advance(steps, &found);
  EXPECT_EQ(found, expected);
  EXPECT_EQ(note(device->notes(), "kernels"), "compiled for host");
  EXPECT_EQ(device->damage(), golden->damage());
}

// Glass and heat are in rounds_engine_tests.cpp.
TEST(CompiledRounds, RulesOfTextHaveGoldensBits) {
  run_beside_golden(rule_scene("plastic"), "plastic", 40);
  run_beside_golden(rule_scene("copper"), "copper", 5);
}

// The pair law as a program: types, damping, held particles, faults.
void run_case(Case c, const std::string& name, uint64_t& steps, uint64_t& faults) {
  SCOPED_TRACE(c.name);
  Plan& plan = c.setup.plan;
  auto made = std::make_shared<IntegerProgram>();
  FixedRule rule = plan.rule;
  rule.axes = 3;
  made->program = pair_program(rule, plan.arch.capacity);
  plan.program = made;
  Golden golden(plan.rule, plan.lattice, plan.arch.capacity, c.setup.initial);
  const auto engine = gpu::make_rounds_engine(plan, c.setup.initial, {}, host_compiler(name));
  for (uint64_t k = 0; k < c.steps; ++k, ++steps) {
    std::string expected, found;
    try {
      golden.step();
    } catch (const RunError& e) {
      expected = e.what();
    }
    try {
      engine->advance(1, nullptr);
    } catch (const RunError& e) {
      found = e.what();
    }
    ASSERT_EQ(found, expected);
    if (!expected.empty()) {
      ++faults;
      return;
    }
    ASSERT_EQ(engine->hash(), hash_of(plan.lattice, golden.state())) << "step " << k + 1;
  }
  EXPECT_EQ(note(engine->notes(), "kernels"), "compiled for host");
}

TEST(CompiledRounds, PairLawsHaveGoldensBits) {
  uint64_t steps = 0, faults = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) run_case(random_case(seed), "pair", steps, faults);
  for (const Fault fault : {Fault::velocity, Fault::strength})
    run_case(fault_case(fault), "pair", steps, faults);
  EXPECT_GT(steps, 20u);
  EXPECT_EQ(faults, 2u);
}

// The product of a slope and a fraction takes 32 by 32 bits where no entry of the table needs more.
TEST(CompiledRounds, SteepTablesAreTold) {
  const auto text_of_slope = [](int32_t slope) {
    graph::Builder b;
    FixedTable table;
    table.degree = 2, table.difference_frac = 8, table.index_bits = 3, table.fraction_bits = 10;
    table.c0.assign(8, 0), table.c1.assign(8, slope), table.c2.assign(8, 1024);
    graph::FixedProgram program;
    graph::Round round;
    const int x = b.input(graph::Source::apart, 0, 0, {0, 60000});
    const int y = b.lookup(b.table(table), x);
    round.when = b.constant(1);
    round.sums = {{"sum", {y}}};
    round.pair = b.take();
    program.rounds = {round};
    return gpu::text_of(program, sizeof(gpu::RoundsFrame)).source;
  };
  const auto holds = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  // At the end of a bin the slope is c1 + round(1024 1023/1024) = c1 + 1023.
  EXPECT_TRUE(holds(text_of_slope(2147483647 - 1023), "value<true>"));
  EXPECT_TRUE(holds(text_of_slope(2147483647 - 1022), "value<false>"));
}

// Code that computes something else is found out before it is used.
TEST(CompiledRounds, WrongCodeIsNotUsed) {
  const Scene scene = rule_scene("heat");
  const Plan plan = program_plan_of(scene, Arch());
  const auto kernels_of = [&](const gpu::CompileRounds& compile) {
    const auto golden = integer_run(scene, plan, nullptr);
    const auto device = integer_run(scene, plan, nullptr, [&](const State& state) {
      return gpu::make_rounds_engine(plan, state, {}, compile);
    });
    golden->advance(10, nullptr), device->advance(10, nullptr);
    EXPECT_EQ(device->hash(), golden->hash());
    return note(device->notes(), "kernels");
  };
  const auto wrong = [](std::string& source) {
    const size_t at = source.find("sums[0] += ");
    ASSERT_NE(at, std::string::npos);
    source.insert(at + 11, "1 + ");
  };
  EXPECT_EQ(kernels_of(host_compiler("wrong", wrong)), "interpreted: compiled ones take step 1 otherwise");
  const auto none = [](const std::string&, const std::string&) -> std::string {
    throw gpu::NvrtcError("no library libnvrtc.so.0");
  };
  EXPECT_EQ(kernels_of(none), "interpreted: no library libnvrtc.so.0");
}

TEST(CompiledRounds, CudaTakesTheText) {
  std::unique_ptr<gpu::Nvrtc> nvrtc;
  try {
    nvrtc = std::make_unique<gpu::Nvrtc>();
  } catch (const gpu::NvrtcError& e) {
    GTEST_SKIP() << e.what();
  }
  for (const char* rule : {"heat", "glass", "plastic", "copper"}) {
    SCOPED_TRACE(rule);
    const Scene scene = rule_scene(rule);
    const Plan plan = program_plan_of(scene, Arch());
    const gpu::RoundsText text = gpu::text_of(plan.program->program, sizeof(gpu::RoundsFrame));
    EXPECT_GT(nvrtc->compiled(text.source, gpu::round_headers(), "sm_90").size(), 1000u);
  }
  EXPECT_EQ(refused_with<gpu::NvrtcError>(
                [&] { nvrtc->compiled("__device__ int wrong = nothing;\n", {}, "sm_90"); }),
            "CUDA's compiler " + nvrtc->version() +
                ": NVRTC_ERROR_COMPILATION: rounds.cu(1): error: identifier "
                "\"nothing\" is undefined");
}

// What was compiled is kept, by all that it is made of.
TEST(CompiledRounds, CodeIsKept) {
  try {
    gpu::Nvrtc();
  } catch (const gpu::NvrtcError& e) {
    GTEST_SKIP() << e.what();
  }
  const auto dir = std::filesystem::path(testing::TempDir()) / "compiled_kept";
  std::filesystem::remove_all(dir);
  const std::string source = "extern \"C\" __global__ void one() {}\n";
  const std::string path = gpu::compiled_file(source, "sm_90", dir.string());
  write_text(path, "kept");
  EXPECT_EQ(gpu::compiled_file(source, "sm_90", dir.string()), path);
  EXPECT_EQ(read_text(path), "kept");
  EXPECT_NE(gpu::compiled_file(source + "\n", "sm_90", dir.string()), path);
  EXPECT_THROW(gpu::compiled_file(source, "sm_90", ""), gpu::NvrtcError);
  EXPECT_THROW(gpu::compiled_file(source, "host", dir.string()), gpu::NvrtcError);
  EXPECT_THROW(gpu::Nvrtc({"libno_such_compiler.so"}), gpu::NvrtcError);
}

}  // namespace
}  // namespace cuboct::test
