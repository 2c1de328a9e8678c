// SPDX-License-Identifier: MIT
// Why nothing can be said of a body of the rule at rest, where the motion to it is left out.
#pragma once

#include <optional>
#include <string>

#include "model/rules/rounds_rule.h"

namespace cuboct {

struct NoRest {
  std::string what, hint;
};
// None: it can.
std::optional<NoRest> why_no_rest(const RoundsRule& rule);

}  // namespace cuboct
