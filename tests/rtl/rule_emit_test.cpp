// SPDX-License-Identifier: MIT
// The project of a rule of text: its files, and vectors that hold golden's fields.
#include <gtest/gtest.h>

#include <bit>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "hw/cost/cycles.h"
#include "hw/rtl/rtl_emit.h"
#include "model/base/output.h"
#include "model/contract/golden.h"
#include "tests/backend/rule_cases.h"
#include "tests/support/folder.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

// A word of hexadecimal digits, the least significant last.
class HexWord {
 public:
  explicit HexWord(std::string digits) : digits_(std::move(digits)) {}
  int64_t value(const WordField& f) const {
    uint64_t value = 0;
    for (int b = 0; b < f.bits; ++b) value |= uint64_t{bit(f.lsb + b)} << b;
    if (f.is_signed && bit(f.lsb + f.bits - 1)) value |= f.bits < 64 ? ~uint64_t{0} << f.bits : 0;
    return static_cast<int64_t>(value);
  }
  bool bit(int at) const {
    const char digit = digits_[digits_.size() - 1 - static_cast<size_t>(at / 4)];
    return ((digit <= '9' ? digit - '0' : digit - 'a' + 10) >> at % 4 & 1) != 0;
  }

 private:
  std::string digits_;
};

class RuleEmit : public testing::Test {
 protected:
  std::string text(const std::string& path) const { return read_text((root_ / path).string()); }
  const test::Folder folder_;
  const fs::path root_ = folder_.path("project");
};

// Fields of vectors and of signed numbers; each word of the bench is looked at, each field of it.
TEST_F(RuleEmit, VectorsHoldGoldensFields) {
  const Case c = case_of("four", hot(kFourRounds), {}, 2);
  const Plan& plan = c.setup.plan;
  emit_rtl(plan, c.setup.initial, root_.string(), {.vector_steps = c.steps});
  const WordLayout& word = plan.words.particle;
  const auto id = std::ranges::find(word, FieldKind::id, &WordField::kind);
  // As they come: all of node 0 in the order of steps, then of node 1.
  std::istringstream first(text("bench/first.hex")), words(text("bench/expected.hex"));
  std::vector<size_t> begins;
  for (std::string line; std::getline(first, line);) begins.push_back(std::stoul(line, nullptr, 16));
  std::vector<std::vector<int64_t>> fields;
  std::vector<std::vector<std::vector<Particle>>> cells;
  Golden golden(plan.program->program, plan.lattice, plan.arch.capacity, c.setup.initial);
  for (uint64_t step = 0;; ++step) {
    fields.push_back(golden.state().fields);
    cells.push_back(golden.cells());
    if (step == c.steps) break;
    golden.step();
  }
  EXPECT_NE(fields[0], fields[1]);
  EXPECT_NE(fields[1], fields[2]);
  const auto numbers = static_cast<size_t>(plan.program->program.numbers());
  size_t line_number = 0, compared = 0;
  for (uint32_t n = 0; n < plan.nodes(); ++n) {
    EXPECT_EQ(begins.at(n), line_number);
    for (uint64_t step = 0; step <= c.steps; ++step)
      for (const Particle& particle : cells[step][n]) {
        std::string line;
        ASSERT_TRUE(std::getline(words, line));
        ++line_number;
        const HexWord got(line);
        ASSERT_EQ(got.value(*id), particle.id);
        for (const WordField& f : word)
          if (f.kind == FieldKind::field) {
            EXPECT_EQ(got.value(f), fields[step][particle.id * numbers + static_cast<size_t>(f.number)])
                << name_of(f) << " of " << particle.id << " in step " << step;
            ++compared;
          }
      }
  }
  EXPECT_EQ(begins.back(), line_number);
  EXPECT_EQ(compared, (c.steps + 1) * plan.particles * numbers);
}

// What a project names is there, and what tells people and programs of the rounds.
TEST_F(RuleEmit, TheProjectTellsOfItsRounds) {
  const Case c = case_of("four", hot(kFourRounds), {}, 1);
  const Plan& plan = c.setup.plan;
  emit_rtl(plan, c.setup.initial, root_.string(), {.vector_steps = 1});
  const auto json = nlohmann::json::parse(text("project.json"));
  EXPECT_EQ(json.at("rule").at("rounds"), 4);
  EXPECT_EQ(json.at("rule").at("fields").size(), plan.program->program.fields.size());
  EXPECT_EQ(json.at("rule").at("fields").at(0).at("name"), plan.program->program.fields[0].name);
  for (size_t k = 0; k < 4; ++k) {
    const auto& round = json.at("latency").at("rounds").at(k);
    EXPECT_EQ(round.at("pipe"), plan.rounds[k].pipe);
    EXPECT_EQ(round.at("finish"), plan.rounds[k].finish);
    EXPECT_EQ(round.at("beats"), plan.rounds[k].beats);
    EXPECT_TRUE(fs::exists(root_ / ("rtl/cuboct_pair_" + std::to_string(k + 1) + ".sv")));
    EXPECT_TRUE(fs::exists(root_ / ("rtl/cuboct_finish_" + std::to_string(k + 1) + ".sv")));
  }
  EXPECT_EQ(json.at("cycles_per_step").at("expected"), expected_cycles(plan, c.setup.initial).step);
  for (const auto& file : json.at("files")) EXPECT_TRUE(fs::exists(root_ / file.get<std::string>())) << file;
  for (const char* page : {"node.md", "pipeline.md"})
    EXPECT_TRUE(fs::exists(root_ / "docs/reference" / page));
  // Phase 22 of 23 ends a step of four rounds.
  EXPECT_NE(text("bench/cuboct_bench.sv").find("probe_phase_end[23*k+22]"), std::string::npos);
  const std::string readme = text("README.md");
  for (const char* line : {"`crowd` of the rule, times ", "`way.z` of the rule, times ", "  round 4 "})
    EXPECT_NE(readme.find(line), std::string::npos) << line;
  EXPECT_EQ(readme.find("_rom.sv"), std::string::npos);
}

// A host's link loads the state of any step, and nodes count steps from their reset.
TEST_F(RuleEmit, RefusesAHostsLinkOfARuleThatReadsTheStep) {
  const Case c = case_of("one", hot(kFourRounds), {}, 1);
  for (const auto& [board, said] :
       {std::pair{BoardChoice{.name = "ulx3s"}, "--board ulx3s: "},
        std::pair{BoardChoice{.name = "", .bus = "wishbone"}, "--bus wishbone: "}}) {
    const BoardChoice& choice = board;
    EXPECT_TRUE(refused_with<InputError>([&] {
                  with_places(c.scene, {}, [&] { check_emission(c.setup.plan, {.board = choice}); });
                }).starts_with(std::string("rule.toml:10:1: ") + said + "the rule '"))
        << said;
  }
  for (const char* bus : {"axi4lite", "wishbone"})
    check_emission(case_of("one", hot(kOneRound), {}, 1).setup.plan, {.board = {.name = "", .bus = bus}});
}

}  // namespace
}  // namespace cuboct::test
