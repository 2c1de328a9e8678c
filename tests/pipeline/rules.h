// SPDX-License-Identifier: MIT
// The rules of scenes/rules in integers.
#pragma once

#include <string>

#include "model/base/output.h"
#include "tests/rules/in_integers.h"

namespace cuboct::test {

inline constexpr const char* kShippedRules[] = {"copper", "dpd", "glass", "heat", "langevin", "plastic"};

// Of a scene its stages are left out: they are of a run.
inline InIntegers shipped_rule(const std::string& name) {
  const std::string text = read_text(kIntegerTexts + name + ".toml");
  return InIntegers(text.substr(0, text.find("[[stage]]")));
}

}  // namespace cuboct::test
