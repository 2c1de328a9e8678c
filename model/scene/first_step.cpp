// SPDX-License-Identifier: MIT
#include "model/scene/first_step.h"

#include <memory>
#include <utility>

#include "model/program/program_rule.h"

namespace cuboct {
namespace {

const RuleProgram* text_of(const Rule& rule) {
  const RoundsRule* rounds = rule.rounds.get();
  return rounds == nullptr ? nullptr : rounds->text();
}

}  // namespace

uint64_t first_step_of(const Rule& rule) {
  const RuleProgram* text = text_of(rule);
  return text == nullptr ? 0 : text->first_step;
}

void begin_at_step(Rule& rule, uint64_t step) {
  const RuleProgram* text = text_of(rule);
  if (text == nullptr) return;
  RuleProgram program = *text;
  program.first_step = step;
  rule.rounds = std::make_shared<const ProgramRule>(std::move(program));
}

}  // namespace cuboct
