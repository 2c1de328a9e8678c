// SPDX-License-Identifier: MIT
// Formulas of a rule's text: "g(r2) * (T_j - T_i)".
//
//   or, and, not, then one of < <= > >= ==, then + -, then * /, then a sign, then ^ with its exponent to the
//   right; `.x .y .z` take a component, `[a, b, c]` makes a vector, `f(a, b)` calls a function. A number may
//   have a unit behind it: "5 mm", "3 N/m^2", whose parts stand without blanks.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "model/base/units.h"

namespace cuboct {

struct Expression {
  enum class Kind : unsigned char { number, name, call, unary, binary, component, vector };
  Kind kind = Kind::number;
  std::string text;  // the name, the function, the operator, or the component
  double value = 0;  // of a number, in SI units
  Dimension dimension;
  std::vector<Expression> of;
  size_t at = 0;  // where it begins in the text
};

// What is wrong with a formula, and where: the byte counts from its beginning.
struct FormulaError {
  size_t at;
  std::string message, hint;
};

// Throws FormulaError.
Expression parse_expression(std::string_view text);

}  // namespace cuboct
