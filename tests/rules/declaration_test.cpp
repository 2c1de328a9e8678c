// SPDX-License-Identifier: MIT
#include "model/rules/declaration.h"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>

#include "tests/rules/lps_body.h"

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
  try {
    check(rule);
  } catch (const std::logic_error& error) {
    return error.what();
  }
  return "none";
}

TEST(Declaration, OneThatHoldsTogetherIsAccepted) {
  EXPECT_EQ(refusal([](RuleDeclaration&) {}), "none");
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
  EXPECT_EQ(numbers_of(plain.particle), 3 + 1 + 1 + 3);
  m.critical_stretch = 0.01, m.finite = false, m.corrected = true;
  const RuleDeclaration whole = LpsRule(m, full).declaration();
  EXPECT_EQ(numbers_of(whole.bond), 2);
  EXPECT_EQ(numbers_of(whole.particle), 3 + 1 + 1 + 3 + 6 + 3);
  EXPECT_EQ(whole.rounds[0].updated, (std::vector<std::string>{"largest_stretch", "whole"}));
}

}  // namespace
}  // namespace cuboct
