// SPDX-License-Identifier: MIT
// The emitted board, Verilated, driven over its serial line: golden's bits, faults and cycles.
#include <gtest/gtest.h>

#include "emu/board/session.h"
#include "emu/machine/collector.h"
#include "emu/machine/words.h"
#include "hw/rtl/board.h"
#include "tests/board/simulated_board.h"

namespace cuboct::test {
namespace {

constexpr double kTimeout = 20;  // s; on a line without noise nothing is late but by the machine's load

std::vector<uint64_t> up_to(uint64_t steps) {
  std::vector<uint64_t> all;
  for (uint64_t k = 0; k <= steps; ++k) all.push_back(k);
  return all;
}

TEST(Board, HoldsGoldensBitsAndTheModelsCycles) {
  const SimulatedBoard board;
  const auto setup = board_setup("grips.toml");
  emu::Host host(board.port(), SimulatedBoard::kBaud, kTimeout);
  const Trace golden = golden_trace(setup, 24);

  // Step by step, then in one go.
  const Trace steps = run_on_board(host, setup, {.steps = 24, .frames = up_to(24)});
  EXPECT_EQ(difference(setup.plan, golden, steps), "");
  EXPECT_EQ(steps.frames.size(), 25u);
  EXPECT_EQ(steps.state_hash.size(), 25u);
  const Trace few = run_on_board(host, setup, {.steps = 24, .frames = {7, 24}, .hash_every = 0});
  ASSERT_EQ(few.frames.size(), 2u);
  EXPECT_EQ(few.frames[0], golden.frames[7]);
  EXPECT_EQ(few.frames[1], golden.frames[24]);
  EXPECT_EQ(few.steps(), 24u);
  EXPECT_EQ(host.count().retries, 0u);

  host.reset();
  const auto nodes = emu::by_node(setup.plan, setup.initial);
  uint16_t index = 0;
  for (uint16_t n = 0; n < nodes.size(); ++n)
    for (const emu::Loaded& p : nodes[n]) host.load(index++, n, p.word, setup.plan.words.particle_bits);
  host.run(0, 24);
  while (host.status().busy) continue;
  EXPECT_EQ(host.status().cycles, cycles_of(setup, 24));
}

// thrown.toml has other velocities of its grips: the machine is the same, the plan is not.
TEST(Board, TakesOtherVelocitiesAndFindsAFault) {
  const SimulatedBoard board;
  const auto grips = board_setup("grips.toml"), thrown = board_setup("thrown.toml");
  ASSERT_NE(grips.plan.hash, thrown.plan.hash);
  ASSERT_EQ(machine_hash(grips.plan), machine_hash(thrown.plan));
  emu::Host host(board.port(), SimulatedBoard::kBaud, kTimeout);
  const Trace golden = golden_trace(thrown, 24);
  ASSERT_TRUE(golden.stop);
  EXPECT_EQ(golden.stop->step, 6u);
  const Trace stepped = run_on_board(host, thrown, {.steps = 24, .frames = up_to(24)});
  EXPECT_EQ(difference(thrown.plan, golden, stepped), "");
  EXPECT_EQ(stepped.frames.size(), 7u);
  // The step is found where the board was not read after each.
  for (const uint64_t steps : {7, 9, 24}) {
    const Trace whole = run_on_board(host, thrown, {.steps = steps, .frames = {0, steps}, .hash_every = 0});
    ASSERT_TRUE(whole.stop);
    EXPECT_EQ(*whole.stop, *golden.stop);
    EXPECT_EQ(whole.steps(), 6u);
    ASSERT_EQ(whole.frames.size(), 2u);
    EXPECT_EQ(whole.frames[1], golden.frames[6]);
  }
  // Both nodes met one in that step; the second node's is the run's, by the particle's id.
  EXPECT_EQ(host.fault(0).particle, 4u);
  EXPECT_EQ(host.fault(1).particle, 1u);
  EXPECT_EQ(golden.stop->particle, 1u);
  // What was set does not outlive the reset.
  const Trace again = run_on_board(host, grips, {.steps = 24, .frames = {}});
  EXPECT_EQ(difference(grips.plan, golden_trace(grips, 24), again), "");
}

// One node serves both cells: what goes over the line names them.
TEST(Board, OfABrickHoldsGoldensBitsAndFindsTheFaultsCell) {
  const SimulatedBoard board({}, "one_node.toml");
  const auto grips = board_setup("grips.toml", "one_node.toml"),
             thrown = board_setup("thrown.toml", "one_node.toml");
  ASSERT_EQ(grips.plan.nodes(), 1u);
  emu::Host host(board.port(), SimulatedBoard::kBaud, kTimeout);
  const Trace held = run_on_board(host, grips, {.steps = 24, .frames = up_to(24)});
  EXPECT_EQ(difference(grips.plan, golden_trace(grips, 24), held), "");
  EXPECT_EQ(held.frames.size(), 25u);
  const Trace golden = golden_trace(thrown, 24);
  ASSERT_TRUE(golden.stop);
  EXPECT_EQ(golden.stop->cell, 1u);
  for (const uint64_t steps : {7, 24}) {
    const Trace whole = run_on_board(host, thrown, {.steps = steps, .frames = {0, steps}, .hash_every = 0});
    ASSERT_TRUE(whole.stop);
    EXPECT_EQ(*whole.stop, *golden.stop);
  }
}

// Unplugged between a checkpoint and the next, the run ends; on another board of the same project it goes on.
TEST(Board, GoesOnFromACheckpoint) {
  const auto setup = board_setup("grips.toml");
  const Scratch scratch;
  RunRequest request;
  request.steps = 24;
  request.frames = {0, 11, 24};
  request.hash_every = 1;
  request.checkpoint.path = scratch.path("checkpoint");
  request.checkpoint.every_steps = 5;
  const auto run = [&](const SimulatedBoard& board) {
    emu::Host host(board.port(), SimulatedBoard::kBaud, kTimeout);
    return record(setup.scene, emu::board_kind(host, setup.scene, setup.plan), request);
  };
  SimulatedBoard unplugged;
  request.keep = [&](const RunState& state) {
    if (std::get<State>(state).step == 11) unplugged.end();
  };
  try {
    run(unplugged);
    ADD_FAILURE() << "a board that is gone goes on";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), "port " + unplugged.port() + " is gone: is the board still plugged in?");
  }
  request.keep = {};
  request.checkpoint.resume = true;
  const Recorded resumed = run(SimulatedBoard());
  EXPECT_EQ(resumed.resumed_at, 10u);
  EXPECT_EQ(difference(setup.plan, golden_trace(setup, 24), resumed.trace), "");
  EXPECT_EQ(resumed.trace.state_hash.size(), 25u);
  EXPECT_EQ(resumed.trace.frames.size(), 3u);
  EXPECT_EQ(resumed.trace.counters.front().first, "cycles");
  EXPECT_GT(resumed.trace.counters.front().second, static_cast<double>(cycles_of(setup, 14)));
}

TEST(Board, IsResetInTheMidstOfARun) {
  const SimulatedBoard board;
  const auto setup = board_setup("grips.toml");
  const Trace golden = golden_trace(setup, 5);
  emu::Host host(board.port(), SimulatedBoard::kBaud, kTimeout);
  for (const uint32_t steps : {1000000u, 2000000u, 3000000u}) {
    run_on_board(host, setup, {.steps = 2, .frames = {}, .hash_every = 0});
    host.run(2, steps);
    EXPECT_TRUE(host.status().busy);
    const Trace after = run_on_board(host, setup, {.steps = 5, .frames = {5}});
    EXPECT_EQ(difference(setup.plan, golden, after), "");
  }
}

// What a host that lost a reply does, and what only a confused one does.
TEST(Board, RequestsMayBeRepeated) {
  const SimulatedBoard board;
  const auto setup = board_setup("grips.toml");
  const Trace golden = golden_trace(setup, 7);
  emu::Host host(board.port(), SimulatedBoard::kBaud, kTimeout);
  const int bits = setup.plan.words.particle_bits;
  host.reset();
  const auto nodes = emu::by_node(setup.plan, setup.initial);
  uint16_t index = 0;
  for (uint16_t n = 0; n < nodes.size(); ++n)
    for (const emu::Loaded& p : nodes[n]) {
      for (int k = 0; k < 2; ++k) host.load(index, n, p.word, bits);
      ++index;
    }
  for (int k = 0; k < 2; ++k) host.run(0, 7);
  while (host.status().busy) continue;
  const uint64_t cycles = host.status().cycles;
  EXPECT_EQ(cycles, cycles_of(setup, 7));
  uint64_t hash = 0;
  for (uint16_t n = 0; n < nodes.size(); ++n)
    for (const emu::Word& word : host.read(n, bits)) {
      const emu::Slot slot = emu::unpack_particle(setup.plan, word);
      const Int3 x = emu::position_of(setup.plan.rule.widths, slot);
      const Particle p{slot.body.id, slot.body.type, n, x, slot.body.v, slot.u};
      hash += hash_of(setup.plan.lattice, p);
    }
  EXPECT_EQ(hash, golden.state_hash[7]);
  EXPECT_THROW(host.run(3, 1), std::runtime_error);
  EXPECT_THROW(host.load(index + 1, 0, {}, bits), std::runtime_error);
  EXPECT_THROW(host.load(index, 2, {}, bits), std::runtime_error);
  EXPECT_THROW(host.set_velocity(2, 0, 0), std::runtime_error);
  EXPECT_THROW(host.set_velocity(0, 3, 0), std::runtime_error);
  EXPECT_THROW(host.fault(2), std::runtime_error);
  EXPECT_EQ(host.status().cycles, cycles);
}

TEST(Board, TheCommandDrivesIt) {
  const SimulatedBoard board;
  const std::string baud = std::to_string(SimulatedBoard::kBaud);
  const std::vector<std::string> end{"--arch", board_file("board.toml"), "--port", board.port(), "--baud",
                                     baud,     "--port-timeout",         "20"};
  const auto with = [&](std::vector<std::string> words) {
    words.insert(words.end(), end.begin(), end.end());
    return command(words);
  };
  const Answer matched = with({"crosscheck", board_file("grips.toml"), "--engines", "golden,fpga"});
  EXPECT_EQ(matched.out, "matched 192 updates over 24 steps in 2 engines\n");
  EXPECT_EQ(matched.code, 0);
  const Answer stopped = with({"crosscheck", board_file("thrown.toml"), "--engines", "fpga,lattice"});
  EXPECT_EQ(stopped.out,
            "matched 48 updates over 6 steps in 2 engines\nall stopped: step 6, cell 1 at (1, 0, 0), "
            "particle 1: "
            "left the lattice along y (0)\n");
  EXPECT_EQ(stopped.code, 1);
  const Answer run = with({"run", board_file("grips.toml"), "--engine", "fpga"});
  EXPECT_EQ(run.code, 0);
  EXPECT_NE(run.out.find("\nretries            0\n"), std::string::npos) << run.out;
  const Answer wrong = with({"run", board_file("other.toml"), "--engine", "fpga"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_EQ(
      wrong.err,
      "port " + board.port() +
          ": the board holds plan 0b68a86656dcd33f, the scene is plan c84fbfe54025609e\n"
          "  hint: emit the scene with --board, build and flash it; or run the scene that the board was made "
          "from\n");
}

}  // namespace
}  // namespace cuboct::test
