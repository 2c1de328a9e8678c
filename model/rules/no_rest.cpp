// SPDX-License-Identifier: MIT
#include "model/rules/no_rest.h"

#include <fmt/format.h>

namespace cuboct {

std::optional<NoRest> why_no_rest(const RoundsRule& rule) {
  const RuleDeclaration& declaration = rule.declaration();
  if (!declaration.moves) return NoRest{"the rule moves no particle", ""};
  if (!declaration.kept.empty())
    return NoRest{fmt::format("the rule's field '{}' goes on with it", declaration.kept.front()), ""};
  if (declaration.noise) return NoRest{"the rule draws noise in each step", ""};
  if (!(rule.stiffness() > 0))
    return NoRest{"the rule does not say its stiffness", "stiffness = \"...\" in N/m, among its keys"};
  return std::nullopt;
}

}  // namespace cuboct
