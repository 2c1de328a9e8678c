// SPDX-License-Identifier: MIT
#include "model/program/formula_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/base/error.h"
#include "model/base/error_parts.h"
#include "model/contract/law_function.h"
#include "model/program/along.h"
#include "model/program/radial.h"
#include "model/program/tape.h"

namespace cuboct {
namespace {

constexpr const char* kHint = "without 'core' the rule is one of any force: engines of software run it";

class FormulaForce final : public LawFunction {
 public:
  FormulaForce(std::shared_ptr<const RuleProgram> program)
      : program_(std::move(program)), along_x_(program_->rounds[0].pair, program_->rounds[0].terms[0]) {}

  void forces(std::span<const double> r, std::span<double> f) const override {
    along_x_.run(r, f);
    for (double& force : f) force = -force;
  }
  double slope(double r) const override { return -along_x_.slope(r); }

 private:
  std::shared_ptr<const RuleProgram> program_;
  Tape along_x_;
};

// The table, where the force is its value at r, and nothing else.
const PointTable* table_of(const RuleProgram& program) {
  const RealGraph& graph = program.rounds[0].pair;
  const Radial radial(graph);
  const auto is_r = [&](NodeId id) {
    const RealNode& node = graph.at(id);
    return node.op == RealOp::square_root && radial.is_r2(node.of[0]);
  };
  const RealNode& product = graph.at(program.rounds[0].terms[0]);
  if (product.op != RealOp::multiply) return nullptr;
  for (size_t side = 0; side < 2; ++side) {
    const RealNode& minus = graph.at(product.of[side]);
    const RealNode& unit = graph.at(product.of[1 - side]);
    if (minus.op != RealOp::negate || unit.op != RealOp::divide || !is_r(unit.of[1])) continue;
    const RealNode& along = graph.at(unit.of[0]);
    const RealNode& curve = graph.at(minus.of[0]);
    if (along.op == RealOp::input && curve.op == RealOp::curve && curve.of[0] == unit.of[1])
      return dynamic_cast<const PointTable*>(curve.table);
  }
  return nullptr;
}

void check_rule(const RuleText& text, const RuleProgram& program) {
  const Formula& core = *text.core;
  const auto refuse = [&](const std::string& what) { core.fail({0, what, kHint}); };
  if (!text.particle.empty() || !text.bond.empty())
    refuse("a rule with 'core' is a pair law, and has no fields");
  if (text.range != BondRange::current)
    refuse("a rule with 'core' is a pair law: its bonds are those of the moment");
  if (text.still) refuse("a rule with 'core' is a pair law, which moves particles");
  if (text.rounds.size() != 1 || !text.setup.empty())
    refuse("a rule with 'core' is a pair law, of one round");
  const RuleText::Round& round = text.rounds[0];
  if (round.sums.size() != 1 || !round.finishes.empty())
    round.fail("a rule with 'core' is a pair law: its round has the sum 'force' alone", kHint);
  if (text.particle_energy)
    refuse("a rule with 'core' is a pair law: its particles have no energy but that of pairs");
  if (round.sums[0].when)
    round.sums[0].when->fail({0, "a pair law acts wherever r is below 'reach'", "select(truth, a, b)"});
  if (!is_along(program.rounds[0].pair,
                {program.rounds[0].terms[0], program.rounds[0].terms[1], program.rounds[0].terms[2]}))
    round.sums[0].is.fail({0, "the force of a pair law is d times a function of r", kHint});
  if (!(program.core < program.reach))
    core.fail(
        {0, fmt::format("'core' is {:.6g}, not below 'reach', {:.6g}", program.core, program.reach), {}});
}

// dU/dr = -f, to what a formula loses by cancellation.
void check_energy(const RuleText& text, const RuleProgram& program, const PairLaw& law) {
  if (!program.pair_energy_at) return;
  constexpr int kSamples = 64;
  constexpr double kMost = 1e-6;
  const Tape energy(program.pair_energy, *program.pair_energy_at);
  if (!is_radial(program.pair_energy, *program.pair_energy_at))
    text.pair_energy->fail({0, "the energy of a pair law is a function of r", {}});
  const double width = law.cutoff() - law.core();
  double largest = 0;
  for (int k = 0; k < kSamples; ++k)
    largest = std::max(largest, std::abs(law.force(law.core() + width * k / kSamples)));
  for (int k = 0; k < kSamples; ++k) {
    const double r = law.core() + width * (k + 0.5) / kSamples, slope = energy.slope(r), force = law.force(r);
    if (!(std::abs(slope + force) <= kMost * (largest + std::abs(force))))
      text.pair_energy->fail(
          {0,
           fmt::format("at r = {:.6g} the energy falls by {:.6g} a length, and the force is {:.6g}", r,
                       -slope, force),
           "the force is minus the slope of the energy"});
  }
}

}  // namespace

std::shared_ptr<const PairLaw> formula_law(const RuleText& text, std::shared_ptr<const RuleProgram> program) {
  check_rule(text, *program);
  std::shared_ptr<const PairLaw> law;
  const PointTable* table = table_of(*program);
  const Formula& force = text.rounds[0].sums[0].is;
  if (table != nullptr && table->begin() <= program->core && table->end() == program->reach)
    law = hermite_law("rule", table->cubics(), program->core);
  else
    try {
      law = function_law(std::make_shared<FormulaForce>(program), program->reach, program->core);
    } catch (const InputError& error) {
      const ErrorParts parts = parts_of(error);
      force.fail({0, parts.message, parts.hint});
    }
  check_energy(text, *program, *law);
  return law;
}

}  // namespace cuboct
