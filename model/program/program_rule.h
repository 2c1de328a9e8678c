// SPDX-License-Identifier: MIT
// A rule that a user wrote, as the reference engine runs rules: in doubles, its graphs interpreted for the
// bonds of a particle at once.
#pragma once

#include <memory>
#include <vector>

#include "model/program/program_start.h"
#include "model/program/rule_program.h"
#include "model/rules/rounds_rule.h"

namespace cuboct {

class ProgramRule final : public RoundsRule {
 public:
  explicit ProgramRule(RuleProgram program) : program_(std::move(program)) {}

  const RuleProgram* text() const override { return &program_; }
  const RuleDeclaration& declaration() const override { return program_.declaration; }
  // Lasting bonds count from the body as packed, over a box of one size.
  bool lets_box_deform() const override { return program_.declaration.bonds == BondRange::current; }
  double bond_reach() const override;
  double stable_time_step(double mass, double pitch) const override;
  double stiffness() const override { return program_.stiffness; }
  double sound_speed(double) const override { return 0; }
  std::vector<DeclarationLine> settings() const override { return program_.settings; }
  std::unique_ptr<RoundsTerms> bind(const Rule& rule, const Body& body, const Periodic& periodic,
                                    int threads) const override;

 private:
  RuleProgram program_;
};

// What the fields of a rule's text begin with.
ProgramStart starts_of(const RuleProgram& program, const Rule& rule, const Body& body,
                       const Periodic& periodic);

}  // namespace cuboct
