// SPDX-License-Identifier: MIT
#include "model/rules/rounds_rule.h"

#include <fmt/format.h>

#include <utility>

#include "model/base/error.h"

namespace cuboct {
namespace {

[[noreturn]] void refuse(const RoundsRule& rule, const std::string& who) {
  const size_t rounds = rule.declaration().rounds.size();
  throw InputError(fmt::format("the rule '{}' has {} round{} of its own, and {} knows the pair law alone",
                               rule.declaration().name, rounds, rounds == 1 ? "" : "s", who),
                   rule.text() != nullptr ? "engines reference, golden, lattice and gpu run it; a force of r "
                                            "along d, with 'core', is a pair law"
                                          : "the reference engine runs it")
      .about({"rule.kind", "rule.file", "rule"});
}

class RoundsLaw final : public PairLaw {
 public:
  RoundsLaw(double reach, std::shared_ptr<const RoundsRule> rule) : reach_(reach), rule_(std::move(rule)) {}
  double force(double) const override { return none(); }
  double energy(double) const override { return none(); }
  double slope(double) const override { return none(); }
  double cutoff() const override { return reach_; }
  double core() const override { return reach_ / 1000; }
  const RoundsRule* rule() const { return rule_.get(); }

 private:
  // Who asks for a pair force would take the body for one without any.
  double none() const {
    if (rule_ != nullptr) refuse(*rule_, "what is asked for");
    return 0;
  }

  double reach_;
  std::shared_ptr<const RoundsRule> rule_;
};

}  // namespace

std::shared_ptr<const PairLaw> rounds_law(double reach, std::shared_ptr<const RoundsRule> rule) {
  return std::make_shared<RoundsLaw>(reach, std::move(rule));
}

const RoundsRule* rounds_of(const Rule& rule) {
  const auto* law = dynamic_cast<const RoundsLaw*>(rule.law.get());
  return law == nullptr ? nullptr : law->rule();
}

bool has_reference_bonds(const Rule& rule) {
  const RoundsRule* rounds = rounds_of(rule);
  return rounds != nullptr && rounds->declaration().bonds == BondRange::reference;
}

bool has_bond_memory(const Rule& rule) {
  const RoundsRule* rounds = rounds_of(rule);
  return rounds != nullptr && !rounds->declaration().bond.empty();
}

bool has_memory(const Rule& rule) {
  const RoundsRule* rounds = rounds_of(rule);
  return has_bond_memory(rule) || (rounds != nullptr && !rounds->declaration().kept.empty());
}

Body with_bonds(const Rule& rule, Body body, const Body& start) {
  if (!has_reference_bonds(rule) && !has_memory(rule)) return body;
  body.bonds = start.bonds ? start.bonds : std::make_shared<BondState>(BondState{start.x, {}});
  return body;
}

void keep_bonds(Body& body, const RoundsTerms& terms) {
  if (!body.bonds) return;
  std::vector<uint64_t> kept = terms.memory();
  if (!kept.empty()) kept.insert(kept.begin(), terms.memory_hash());
  body.bonds = std::make_shared<BondState>(BondState{body.bonds->packed, std::move(kept)});
}

void recall_bonds(RoundsTerms& terms, const Body& body) {
  if (!body.bonds || body.bonds->kept.empty()) return;
  const std::vector<uint64_t>& kept = body.bonds->kept;
  if (kept.front() != terms.memory_hash())
    throw InputError(
        "the state was left by other bonds: its horizon, slits, unbreakable regions, critical "
        "stretch and damage width are not those of the rule here",
        "go on with the rule that left it")
        .about({"start.from", "rule"});
  terms.recall({kept.begin() + 1, kept.end()});
}

void refuse_rounds(const Rule& rule, const std::string& who) {
  if (const RoundsRule* rounds = rounds_of(rule)) refuse(*rounds, who);
}

}  // namespace cuboct
