// SPDX-License-Identifier: MIT
// The host's end of a board: requests, one at a time, each repeated until its reply comes.
// docs/reference/board.md.
#pragma once

#include <cstdint>
#include <string>

#include "emu/board/serial_port.h"
#include "emu/machine/bits.h"
#include "model/base/error.h"

namespace cuboct::emu {

// What the board says of itself.
struct BoardInfo {
  int version = 0;  // of the protocol
  uint64_t plan_hash = 0, machine_hash = 0;
  int nodes = 0, particle_bits = 0;
  uint32_t clock_hz = 0;
  int moved_types = 0;
};

// After a request.
struct BoardState {
  bool busy = false;     // a run is under way
  bool fault = false;    // some node met one since RESET
  bool refused = false;  // the request could not be done
  uint16_t loaded = 0;   // particles since RESET
  uint32_t steps = 0;    // since RESET, once the run is over
  uint64_t cycles = 0;   // of runs since RESET; of status() alone
};

struct BoardFault {
  Fault fault = Fault::none;
  uint32_t particle = 0;
  int64_t number = 0;
};

struct LinkCount {
  uint64_t requests = 0;
  uint64_t retries = 0;  // requests sent again
  uint64_t damaged = 0;  // replies with a wrong check sum
  uint64_t silent = 0;   // times without a reply
  uint64_t bytes = 0;    // both ways
};

class Host {
 public:
  static constexpr int kVersion = 1;

  // `timeout`: seconds without a byte after which a request is sent again, the time on the line not counted.
  Host(const std::string& port, int baud, double timeout);

  // Throws InputError where nothing that speaks the protocol answers.
  BoardInfo info();
  BoardState status();
  // Empties the lattice, also in the midst of a run. Velocities become those of the board's plan.
  void reset();
  // The particle with number `index` since the reset.
  void load(uint16_t index, uint16_t node, const Word& word, int word_bits);
  // Starts a run; `from`: steps done since the reset.
  void run(uint32_t from, uint32_t steps);
  // All particles of a node, in the order of its slots.
  std::vector<Word> read(uint16_t node, int word_bits);
  // Of the k-th type of moved_types(), axis a.
  void set_velocity(uint8_t moved, uint8_t axis, int64_t value);
  BoardFault fault(uint16_t node);

  const LinkCount& count() const { return count_; }
  const std::string& port() const { return port_.path(); }

 private:
  // The reply's bytes after number and command, or nothing where none came in `attempts`. `longest`: bytes
  // that the reply may have.
  Bytes ask(uint8_t command, const Bytes& arguments, size_t longest, int attempts);
  Bytes answer(uint8_t command, const Bytes& arguments, size_t longest);
  BoardState short_answer(uint8_t command, const Bytes& arguments);
  // One attempt; empty: none came.
  Bytes attempt(const Bytes& line, uint8_t number, uint8_t command, size_t longest);

  SerialPort port_;
  double timeout_;
  uint8_t number_ = 0;
  int words_ = 16;  // to read at once; fewer after a damaged reply
  LinkCount count_;
};

}  // namespace cuboct::emu
