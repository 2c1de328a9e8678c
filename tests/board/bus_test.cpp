// SPDX-License-Identifier: MIT
// The wrappers of the buses, Verilated, behind a bus master that stalls at random and holds them to the bus's
// rules: the host's driver gets golden's bits, faults and cycles through their registers.
#include <gtest/gtest.h>

#include "emu/board/session.h"
#include "tests/board/simulated_board.h"

namespace cuboct::test {
namespace {

constexpr double kBusTimeout = 20;  // s

class Bus : public testing::TestWithParam<std::string> {};

TEST_P(Bus, HoldsGoldensBitsAndFaults) {
  SimulatedBoard machine({}, "board.toml", behind(GetParam()));
  const auto grips = board_setup("grips.toml"), thrown = board_setup("thrown.toml");
  uint64_t bytes = 0;
  {
    emu::Host host(machine.port(), SimulatedBoard::kBaud, kBusTimeout);
    EXPECT_EQ(host.info().clock_hz, 100000000u);
    const Trace run = run_on_board(host, grips, {.steps = 24, .frames = {0, 7, 24}});
    EXPECT_EQ(difference(grips.plan, golden_trace(grips, 24), run), "");
    EXPECT_EQ(run.state_hash.size(), 25u);

    // Other velocities, set over the bus: a particle leaves the lattice.
    const Trace golden = golden_trace(thrown, 24), left = run_on_board(host, thrown, {.steps = 24});
    ASSERT_TRUE(golden.stop.has_value());
    ASSERT_TRUE(left.stop.has_value());
    EXPECT_EQ(left.stop->text, golden.stop->text);
    EXPECT_EQ(difference(thrown.plan, golden, left), "");

    // No byte was lost or changed.
    EXPECT_EQ(host.count().retries, 0u);
    EXPECT_EQ(host.count().damaged, 0u);
    bytes = host.count().bytes;
  }
  unsigned long long cycles = 0, written = 0, read = 0;
  ASSERT_EQ(std::sscanf(machine.end().c_str(), "over %llu cycles; %llu bytes written, %llu read", &cycles,
                        &written, &read),
            3);
  // The machine sends a mark after its reset, which the host may throw away as it opens the port.
  EXPECT_GE(written + read, bytes);
  EXPECT_LE(written + read, bytes + 1);
}

INSTANTIATE_TEST_SUITE_P(Wrappers, Bus, testing::ValuesIn(buses()), [](const auto& p) { return p.param; });

TEST(BusEmission, IsRefusedWithTheNearestName) {
  const std::string scene = board_file("grips.toml");
  const Answer unknown = command({"emit", scene, "--bus", "axi4lit", "--out", "never"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_NE(unknown.err.find("unknown bus 'axi4lit'"), std::string::npos) << unknown.err;
  EXPECT_NE(unknown.err.find("axi4lite"), std::string::npos) << unknown.err;
  const Answer both = command({"emit", scene, "--bus", "wishbone", "--board", "ulx3s", "--out", "never"});
  EXPECT_EQ(both.code, 2);
  EXPECT_NE(both.err.find("--bus and --board are two ways to one lattice"), std::string::npos) << both.err;
  const Answer neither = command({"emit", scene, "--fixed-velocities", "--out", "never"});
  EXPECT_EQ(neither.code, 2);
  EXPECT_NE(neither.err.find("give --board or --bus with it"), std::string::npos) << neither.err;
}

}  // namespace
}  // namespace cuboct::test
