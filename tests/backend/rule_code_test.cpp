// SPDX-License-Identifier: MIT
// Compiled code of a rule: what it is kept by, and what happens where the compiler is not to be had or not to
// be trusted.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "emu/lattice/code/proof.h"
#include "emu/lattice/engine.h"
#include "emu/lattice/run.h"
#include "hw/plan/setup.h"
#include "model/base/error.h"
#include "model/base/process.h"
#include "model/contract/pair_program.h"
#include "model/program/integer_program.h"
#include "model/scene/scene.h"
#include "tests/support/cases.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

class RuleCodeTest : public testing::Test {
 protected:
  void SetUp() override {
    const char* before = std::getenv("CXX");
    before_ = before != nullptr ? before : "";
    auto program = std::make_shared<IntegerProgram>();
    program->program = pair_program(case_.setup.plan.rule, case_.setup.plan.arch.capacity);
    case_.setup.plan.program = std::move(program);
  }
  void TearDown() override { before_.empty() ? unsetenv("CXX") : setenv("CXX", before_.c_str(), 1); }

  // A compiler that does this first.
  void use_compiler_after(const std::string& line) {
    const std::string path = scratch_.path("compiler");
    std::ofstream(path) << "#!/bin/sh\n" << line << "\nexec c++ \"$@\"\n";
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    setenv("CXX", path.c_str(), 1);
  }
  std::string refusal() {
    return refused_with([this] { engine(); });
  }
  void engine() {
    emu::LatticeEngine engine(
        case_.setup.plan, 0, static_cast<uint32_t>(case_.setup.initial.particles.size()),
        [&](uint32_t k) { return case_.setup.initial.particles[k]; },
        {.threads = 1, .simd = {}, .rule_code = emu::RuleCode::compiled, .code_directory = code_directory_});
    engine.step();
  }
  size_t files() const {
    size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(code_directory_))
      count += entry.path().extension() == ".so";
    return count;
  }

  Scratch scratch_;
  std::string code_directory_ = scratch_.path("code");
  Case case_ = make_case("two_materials");
  std::string before_;
};

TEST_F(RuleCodeTest, IsCompiledOnce) {
  use_compiler_after("test \"$1\" = --version || echo once >> " + scratch_.path("calls"));
  engine();
  engine();
  std::ifstream calls(scratch_.path("calls"));
  std::string line;
  size_t count = 0;
  while (std::getline(calls, line)) ++count;
  EXPECT_EQ(count, 1u);
  EXPECT_EQ(files(), 1u);
}

TEST_F(RuleCodeTest, ACompilerThatMakesOtherNumbersIsNotTrusted) {
  struct Mistake {
    const char *line, *told;
  };
  const Mistake mistakes[] = {
      {"s/sum1 = fused(product1, /sum1 = fused(product1, -/", "makes other numbers of round"},
      {"s/store(to, x)/store(to, old_x)/", "makes other numbers of the finish of round"},
      {"s/bad |= misfit & counts/bad |= W{}/", "makes other numbers of "},
      {"s/keep(job.v\\[axis\\] + i, v, awake/keep(job.v[axis] + i, v, ~W{}/",
       "makes other numbers of the finish"},
      {"s/drift, V{}/drift + 1.0, V{}/", "makes other numbers of the finish"},
      {"/cuboct_round_0_own/,/^}/s/sum0 = fused(product0, /sum0 = fused(product0, -/",
       "makes other numbers of round"},
      {"s/+ splat(job.shift/- splat(job.shift/", "makes other numbers of round"},
      {"s/job.wanted.group. == 0/job.wanted[group] != 0/", "makes other numbers of round"},
      {"s/: job.first + n;/: job.first;/", "makes other numbers of "},
  };
  for (const Mistake& mistake : mistakes) {
    code_directory_ += "_";  // a library that is loaded stays so under its name
    use_compiler_after(std::string("test \"$1\" = --version || find . -type f | xargs sed -i '") +
                       mistake.line + "'");
    EXPECT_NE(refusal().find(mistake.told), std::string::npos) << mistake.line << ": " << refusal();
  }
}

TEST_F(RuleCodeTest, ACompilerThatFailsIsToldWithItsLog) {
  use_compiler_after("test \"$1\" = --version || { echo no such luck >&2; exit 1; }");
  const std::string told = refusal();
  ASSERT_NE(told.find("the C++ compiler failed: see "), std::string::npos) << told;
  std::ifstream log(told.substr(told.find("see ") + 4));
  std::string line;
  std::getline(log, line);
  EXPECT_EQ(line, "no such luck");
  EXPECT_EQ(files(), 0u);
}

// A rule that ships, in its scene's first stage.
struct Shipped {
  explicit Shipped(const std::string& name) : Shipped(name, [](const std::string& text) { return text; }) {}
  template <class Edit>
  Shipped(const std::string& name, const Edit& edit) {
    const std::string file = CUBOCT_SOURCE_DIR "/scenes/rules/" + name + ".toml";
    const std::vector<StageName> stages = stages_of(file);
    std::ifstream in(file);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    scene = parse_scene(edit(text), file, {.stage = stages.empty() ? "" : stages.front().name});
    plan = program_plan_of(scene, Arch());
  }
  const graph::FixedProgram& program() const { return plan.program->program; }
  Scene scene;
  Plan plan;
};
constexpr const char* kShipped[] = {"../cracked_glass", "copper", "dpd", "glass", "heat",
                                    "langevin",         "plastic"};

bool has_avx2() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2");
#else
  return true;
#endif
}

TEST_F(RuleCodeTest, OfRulesThatShipIsThereWithoutACompiler) {
  if (!has_avx2()) GTEST_SKIP() << "kept code is for AVX2";
  setenv("CXX", "no-such-compiler", 1);
  for (const char* name : kShipped) {
    const Shipped shipped(name);
    const auto engine = emu::lattice_kind(shipped.scene, shipped.plan, {.engine = {.threads = 1, .simd = {}}})
                            .make(nullptr, false);
    engine->advance(1, nullptr);
    const Counters counters = engine->counters();
    const auto steps = std::ranges::find(counters, "compiled_steps", [](const auto& c) { return c.first; });
    ASSERT_NE(steps, counters.end());
    EXPECT_EQ(steps->second, 1) << name;
  }
}

// A rule that differs in numbers alone, not in how its formats are aligned, has the same code.
TEST_F(RuleCodeTest, OfRulesThatShipServesOtherNumbers) {
  if (!has_avx2()) GTEST_SKIP() << "kept code is for AVX2";
  const auto is_kept = [](const std::string& name, const std::string& from, const std::string& to) {
    const Shipped other(name, [&](std::string text) {
      EXPECT_NE(text.find(from), std::string::npos) << name;
      return text.replace(text.find(from), from.size(), to);
    });
    return emu::is_kept(other.program(), emu::is_mutual(other.program()), "");
  };
  EXPECT_TRUE(is_kept("dpd", "seed = 1", "seed = 2"));
  EXPECT_TRUE(is_kept("glass", "dt = \"0.04 us\"", "dt = \"0.03 us\""));
}

TEST_F(RuleCodeTest, OfRulesThatShipIsProvenInTheirFinishes) {
  if (!has_avx2()) GTEST_SKIP() << "kept code is for AVX2";
  for (const char* name : kShipped) {
    const Shipped shipped(name);
    const graph::FixedProgram& program = shipped.program();
    const emu::KernelRule rule = emu::kernel_rule(shipped.plan.rule, shipped.plan.arch.capacity);
    const bool once = emu::is_mutual(program);
    const emu::CodeLibrary library(program, once, "", code_directory_);
    emu::BondSpace space;
    std::vector<double> constants;
    if (program.bonded) {
      space = {shipped.plan.program->rows.get(), rule.cell, {}};
      constants.assign(space.rows->constants.begin(), space.rows->constants.end());
    }
    for (size_t k = 0; k < program.rounds.size(); ++k)
      EXPECT_GE(emu::prove({program, rule, space, once, constants, &library}, k), 100) << name << k;
  }
}

TEST_F(RuleCodeTest, WithoutACompilerARuleIsInterpreted) {
  setenv("CXX", "no-such-compiler", 1);
  EXPECT_EQ(refusal(), "no-such-compiler is missing: a rule's code is compiled with it (Debian package g++)");
}

}  // namespace
}  // namespace cuboct::test
