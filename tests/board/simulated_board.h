// SPDX-License-Identifier: MIT
// cuboct-board-sim on the project of a scene, scenes/boards/grips.toml unless said, and what tests ask of it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "emu/board/session.h"
#include "hw/plan/setup.h"
#include "hw/rtl/board.h"
#include "model/base/process.h"
#include "model/trace/trace.h"

namespace cuboct::test {

std::string board_file(const std::string& name);  // of scenes/boards, scenes/archs or tests/board
// A scene with its machine.
struct BoardSetup : Setup {
  Scene scene;
};
BoardSetup board_setup(const std::string& scene, const std::string& arch = "board.toml");  // likewise

struct Answer {
  int code;  // exit code
  std::string out, err;
};
// Runs to its end.
Answer command(const std::vector<std::string>& arguments);

// Behind the wrapper of a bus instead of a board.
inline BoardChoice behind(const std::string& bus) {
  BoardChoice choice;
  choice.bus = bus;
  return choice;
}

class SimulatedBoard {
 public:
  static constexpr int kBaud = 3000000;  // four clocks per bit
  // `options`: further ones of cuboct-board-sim.
  explicit SimulatedBoard(const std::vector<std::string>& options = {},
                          const std::string& arch = "board.toml",
                          const BoardChoice& board = {.name = "icebreaker", .baud = kBaud})
      : SimulatedBoard(board_setup("grips.toml", arch), board, options) {}
  // Of another scene than grips.toml.
  SimulatedBoard(const Setup& setup, const BoardChoice& board, const std::vector<std::string>& options = {});

  const std::string& port() const { return port_; }
  // Ends it; what it told: "... cycles; to the board N bytes, ...".
  std::string end();

 private:
  Scratch scratch_;
  std::unique_ptr<Process> process_;
  std::string port_;
};

// A run on a board, as golden's trace.
struct BoardRun {
  uint64_t steps = 0;
  std::vector<uint64_t> frames = {};
  uint64_t hash_every = 1;
};
Trace run_on_board(emu::Host& host, const BoardSetup& setup, const BoardRun& run);
// From the first cycle of EXCHANGE_X to the last of DUMP, as docs/reference/board.md says, by the native
// nodes.
uint64_t cycles_of(const Setup& setup, uint64_t steps);
// Golden's trace with every state.
Trace golden_trace(const Setup& setup, uint64_t steps);
// The first difference in hashes, stops, and each state that `run` kept; empty where there is none.
std::string difference(const Plan& plan, const Trace& golden, const Trace& run);

}  // namespace cuboct::test
