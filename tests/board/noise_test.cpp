// SPDX-License-Identifier: MIT
// Bits that flip, bytes that vanish and bytes that come from nowhere, both ways: slower, never wrong.
#include <gtest/gtest.h>

#include "emu/board/session.h"
#include "tests/board/simulated_board.h"

namespace cuboct::test {
namespace {

struct Line {
  const char* name;
  std::vector<std::string> options;
};

void PrintTo(const Line& line, std::ostream* out) { *out << line.name; }

class Noise : public testing::TestWithParam<Line> {};

TEST_P(Noise, CostsTimeAlone) {
  SimulatedBoard board(GetParam().options);
  uint64_t retries = 0;
  {
    emu::Host host(board.port(), SimulatedBoard::kBaud, 0.05);
    for (const char* scene : {"grips.toml", "thrown.toml"}) {
      const auto setup = board_setup(scene);
      const Trace run = run_on_board(host, setup, {.steps = 12, .frames = {0, 5, 11}});
      EXPECT_EQ(difference(setup.plan, golden_trace(setup, 12), run), "") << scene;
    }
    retries = host.count().retries;
  }
  EXPECT_GE(retries, 5u) << board.end();
}

INSTANTIATE_TEST_SUITE_P(Lines, Noise,
                         testing::Values(Line{"flips", {"--flip-rate", "0.0005", "--seed", "1"}},
                                         Line{"drops", {"--drop-rate", "0.004", "--seed", "2"}},
                                         Line{"inserts", {"--insert-rate", "0.004", "--seed", "3"}},
                                         Line{"all",
                                              {"--flip-rate", "0.0002", "--drop-rate", "0.002",
                                               "--insert-rate", "0.002", "--seed", "4"}}),
                         [](const auto& p) { return std::string(p.param.name); });

// A crystal and a USB adapter never agree exactly.
TEST(Skew, OfTwoPercentIsNoNoise) {
  const auto setup = board_setup("grips.toml");
  const Trace golden = golden_trace(setup, 6);
  for (const char* skew : {"-2", "2"}) {
    const SimulatedBoard board({"--skew", skew});
    emu::Host host(board.port(), SimulatedBoard::kBaud, 20);
    const Trace run = run_on_board(host, setup, {.steps = 6, .frames = {}});
    EXPECT_EQ(difference(setup.plan, golden, run), "") << skew;
    EXPECT_EQ(host.count().retries, 0u) << skew;
  }
}

}  // namespace
}  // namespace cuboct::test
