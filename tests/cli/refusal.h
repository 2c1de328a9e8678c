// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/cli/shell.h"

namespace cuboct::test {

// cuboct ends with exit code 2 and says this on stderr alone.
inline void expect_refusal(const std::vector<std::string>& arguments, const std::string& text) {
  const Answer answer = Bench(false).cuboct(arguments);
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(answer.out, "");
  EXPECT_EQ(answer.err, text);
}

}  // namespace cuboct::test
