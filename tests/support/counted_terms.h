// SPDX-License-Identifier: MIT
// A rule of text that counts how often its terms in doubles are made.
#pragma once

#include <memory>
#include <utility>

#include "model/rules/rounds_rule.h"
#include "model/scene/scene.h"

namespace cuboct::test {

class CountedTerms final : public RoundsRule {
 public:
  explicit CountedTerms(std::shared_ptr<const RoundsRule> rule) : rule_(std::move(rule)) {}

  const RuleProgram* text() const override { return rule_->text(); }
  const RuleDeclaration& declaration() const override { return rule_->declaration(); }
  double bond_reach() const override { return rule_->bond_reach(); }
  double stable_time_step(double mass, double pitch) const override {
    return rule_->stable_time_step(mass, pitch);
  }
  double stiffness() const override { return rule_->stiffness(); }
  double sound_speed(double mass) const override { return rule_->sound_speed(mass); }
  std::vector<DeclarationLine> settings() const override { return rule_->settings(); }
  std::unique_ptr<RoundsTerms> bind(const Rule& rule, const Body& body, const Periodic& periodic,
                                    int threads) const override {
    ++made_;
    return rule_->bind(rule, body, periodic, threads);
  }
  int made() const { return made_; }

 private:
  std::shared_ptr<const RoundsRule> rule_;
  mutable int made_ = 0;
};

// The scene's rule counts from now on.
inline std::shared_ptr<const CountedTerms> count_terms(Scene& scene) {
  auto counted = std::make_shared<const CountedTerms>(scene.rule.rounds);
  scene.rule.rounds = counted;
  return counted;
}

}  // namespace cuboct::test
