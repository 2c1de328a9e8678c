// SPDX-License-Identifier: MIT
#include "model/rules/declaration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>

#include "model/rules/lps_terms.h"
#include "tests/rules/lps_body.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

RuleDeclaration two_rounds() {
  RuleDeclaration rule;
  rule.name = "two";
  rule.particle = {{"density", 1, "1", "of neighbours"}, {"force", 3, "N", ""}};
  rule.bond = {{"age", 1, "s", ""}};
  rule.rounds = {{"density", {"position"}, {{"near", 1, "1", ""}}, {"age"}, {"density"}},
                 {"force", {"position", "density"}, {{"pull", 3, "N", ""}}, {}, {"force"}}};
  return rule;
}

std::string refusal(const std::function<void(RuleDeclaration&)>& spoil) {
  RuleDeclaration rule = two_rounds();
  spoil(rule);
  return refused_with<std::logic_error>([&] { check(rule); });
}

TEST(Declaration, OneThatHoldsTogetherIsAccepted) {
  EXPECT_EQ(refusal([](RuleDeclaration&) {}), "accepted");
}

TEST(Declaration, EachDefectIsNamed) {
  EXPECT_EQ(refusal([](auto& rule) { rule.rounds[0].exchanged.push_back("density"); }),
            "rule 'two': round 'density' exchanges 'density' before it is made");
  EXPECT_EQ(refusal([](auto& rule) { rule.rounds[0].made.clear(); }),
            "rule 'two': round 'force' exchanges 'density' before it is made");
  EXPECT_EQ(refusal([](auto& rule) { rule.rounds[1].updated.push_back("rust"); }),
            "rule 'two': round 'force' updates 'rust', which no bond holds");
  EXPECT_EQ(refusal([](auto& rule) { rule.rounds[1].made = {"density"}; }),
            "rule 'two': no round makes 'force'");
  EXPECT_EQ(refusal([](auto& rule) { rule.rounds[0].made = {"mass"}; }),
            "rule 'two': round 'density' makes 'mass', which no particle holds");
  EXPECT_EQ(refusal([](auto& rule) {
              rule.particle.push_back({"age", 1, "", ""});
            }),
            "rule 'two': two fields 'age'");
  EXPECT_EQ(refusal([](auto& rule) { rule.rounds.clear(); }), "rule 'two': it has no round");
  EXPECT_EQ(refusal([](auto& rule) { rule.bonds = BondRange::current; }),
            "rule 'two': its bonds are those of the moment, and hold nothing");
  EXPECT_EQ(refusal([](auto& rule) { rule.particle[0].numbers = 0; }),
            "rule 'two': field 'density' holds nothing");
  EXPECT_EQ(refusal([](auto& rule) { std::swap(rule.rounds[0].made, rule.rounds[1].made); }),
            "rule 'two': round 'force' exchanges 'density' before it is made");
}

// What the peridynamic solid declares: a bond that cannot break keeps nothing.
TEST(Declaration, OfPeridynamicsIsAsTheMaterialNeeds) {
  LpsMaterial m = test::cubic_material();
  const auto full = simple_cubic_bonds(1, 3);
  const RuleDeclaration plain = LpsRule(m, full).declaration();
  EXPECT_EQ(plain.rounds.size(), 2u);
  EXPECT_TRUE(plain.bond.empty());
  EXPECT_EQ(numbers_of(plain.particle), 3 + 1 + 1 + 1 + 3);
  m.critical_stretch = 0.01, m.finite = false, m.corrected = true;
  const RuleDeclaration whole = LpsRule(m, full).declaration();
  EXPECT_EQ(numbers_of(whole.bond), 2);
  EXPECT_EQ(numbers_of(whole.particle), 3 + 1 + 1 + 1 + 3 + 6 + 3);
  EXPECT_EQ(whole.rounds[0].updated, (std::vector<std::string>{"largest_stretch", "whole"}));
}

// The rounds of a stretched block that may break, against what the declaration says of them.
class DeclaredRounds : public testing::TestWithParam<bool> {
 protected:
  using Numbers = std::vector<std::vector<double>>;

  DeclaredRounds() {
    LpsMaterial m = test::cubic_material();
    m.critical_stretch = 0.02;
    m.corrected = GetParam(), m.finite = !GetParam();
    rule_ = std::make_unique<LpsRule>(m, simple_cubic_bonds(1, 3));
    body_ = test::cubic_block(6, 5, 4);
    stretched_ = body_.x;
    for (size_t i = 0; i < stretched_.size(); ++i)
      stretched_[i] += Vec3(0.021 * body_.x[i][0], 0.004 * body_.x[i][2], -0.003 * body_.x[i][1]);
  }

  // The state before a round.
  void begin(size_t round) {
    bound_ = rule_->bind({}, body_, {}, 1);
    terms_ = dynamic_cast<LpsTerms*>(bound_.get());
    terms_->begin(stretched_);
    for (size_t k = 0; k < round; ++k) run(k);
  }
  void run(size_t round) {
    terms_->pair(round, 0, body_.size(), true);
    terms_->finish(round, 0, body_.size());
  }
  Numbers numbers() const {
    Numbers all;
    for (const LpsTerms::Field& field : terms_->fields())
      all.emplace_back(field.numbers.begin(), field.numbers.end());
    return all;
  }
  size_t each(const LpsTerms::Field& field) const { return field.numbers.size() / body_.size(); }

  static bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::count(names, name) > 0;
  }

  std::unique_ptr<LpsRule> rule_;
  Body body_;
  std::vector<Vec3> stretched_;
  std::unique_ptr<RoundsTerms> bound_;
  LpsTerms* terms_ = nullptr;
};

TEST_P(DeclaredRounds, ChangeWhatTheyDeclare) {
  const RuleDeclaration& rule = rule_->declaration();
  std::vector<std::string> changed;
  for (size_t round = 0; round < rule.rounds.size(); ++round) {
    begin(round);
    const Numbers before = numbers();
    run(round);
    const Numbers after = numbers();
    for (size_t f = 0; f < before.size(); ++f) {
      const LpsTerms::Field field = terms_->fields()[f];
      const std::vector<RuleField>& declared = field.of_bonds ? rule.bond : rule.particle;
      EXPECT_TRUE(std::ranges::count(declared, field.name, &RuleField::name) == 1) << field.name;
      if (before[f] == after[f]) continue;
      changed.push_back(field.name);
      EXPECT_TRUE(has(field.of_bonds ? rule.rounds[round].updated : rule.rounds[round].made, field.name))
          << "round " << round << " changes " << field.name;
    }
  }
  for (const char* name : {"dilatation", "pressure", "force", "largest_stretch", "whole"})
    EXPECT_TRUE(has(changed, name)) << name;
  EXPECT_EQ(has(changed, "missing"), GetParam());
}

TEST_P(DeclaredRounds, ReadOfOthersWhatIsExchanged) {
  const RuleDeclaration& rule = rule_->declaration();
  const size_t own = body_.size() / 2;
  for (size_t round = 0; round < rule.rounds.size(); ++round) {
    begin(round);
    run(round);
    const Numbers whole = numbers();
    size_t kept_apart = 0;
    for (size_t f = 0; f < whole.size(); ++f) {
      begin(round);
      const LpsTerms::Field field = terms_->fields()[f];
      if (field.of_bonds) continue;
      for (size_t n = 0; n < field.numbers.size(); ++n)
        if (n / each(field) != own) field.numbers[n] = std::nan("");
      terms_->pair(round, own, own + 1, true);
      terms_->finish(round, own, own + 1);
      bool same = true;
      for (const std::string& made : rule.rounds[round].made)
        for (size_t g = 0; g < whole.size(); ++g) {
          const LpsTerms::Field of = terms_->fields()[g];
          for (size_t n = 0; of.name == made && n < each(of); ++n)
            same = same && of.numbers[own * each(of) + n] == whole[g][own * each(of) + n];
        }
      EXPECT_TRUE(same || has(rule.rounds[round].exchanged, field.name))
          << "round " << round << " reads " << field.name << " of others";
      kept_apart += same ? 0 : 1;
    }
    EXPECT_EQ(kept_apart, rule.rounds[round].exchanged.size()) << "round " << round;
  }
}

INSTANTIATE_TEST_SUITE_P(OfPeridynamics, DeclaredRounds, testing::Bool(),
                         [](const auto& test) { return test.param ? "Corrected" : "Finite"; });

}  // namespace
}  // namespace cuboct
