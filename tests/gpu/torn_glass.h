// SPDX-License-Identifier: MIT
// Glass that is torn apart so fast that halves of it lose sight of one another.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "model/scene/scene.h"

namespace cuboct::test {

// `rules`: the directory of the rules' scenes.
inline Scene torn_glass(const std::string& rules) {
  std::ifstream in(rules + "glass.toml");
  std::string torn((std::istreambuf_iterator<char>(in)), {});
  for (const char* speed : {"0, 0.5, 0", "0, -0.5, 0"}) {
    const size_t at = torn.find(speed);
    EXPECT_NE(at, std::string::npos);
    torn.replace(at, std::string(speed).size(), speed[3] == '-' ? "0, -400, 0" : "0, 400, 0");
  }
  // No bond lasts: those of the grips would leave their tables.
  const size_t lasting = torn.find("start.hard");
  EXPECT_NE(lasting, std::string::npos);
  torn.erase(lasting, torn.find('\n', lasting) - lasting);
  return parse_scene(torn, rules + "torn.toml");
}

}  // namespace cuboct::test
