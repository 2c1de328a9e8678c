// SPDX-License-Identifier: MIT
// cuboct-board-sim: the top of an emitted board, or the wrapper of a bus, Verilated, behind a
// pseudo-terminal: hardware for whoever has none.
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <fstream>

#include "emu/verilated/library.h"
#include "emu/verilated/serial_line.h"
#include "hw/program/command_line.h"
#include "hw/program/options.h"
#include "hw/rtl/rtl_prefix.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/base/standard_streams.h"

namespace cuboct::emu {
namespace {

struct Request {
  std::string project, build_directory;
  Noise noise;
  double skew = 0;  // per cent
};

// The value of a constant of the project's cuboct_board_pkg.
double constant_of(const std::string& project, const std::string& name) {
  const std::string path =
      fmt::format("{}/board/{}cuboct_board_pkg.sv", project, prefix_of(board_files(project)));
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    const size_t equals = line.find('=');
    if (equals == std::string::npos || line.find(" " + name + " ") == std::string::npos) continue;
    return std::stod(line.substr(equals + 1));
  }
  throw InputError(fmt::format("{} does not tell {}", path, name), "emit the project again");
}

struct Terminal {
  int master = -1, slave = -1;
  std::string name;
  Terminal() {
    std::array<char, 256> text{};
    termios raw{};
    cfmakeraw(&raw);
    if (openpty(&master, &slave, text.data(), &raw, nullptr) != 0)
      throw std::runtime_error(fmt::format("no pseudo-terminal: {}", std::strerror(errno)));
    // The slave stays open here, so that hosts may come and go.
    fcntl(master, F_SETFL, fcntl(master, F_GETFL) | O_NONBLOCK);
    name = text.data();
  }
  ~Terminal() {
    close(master);
    close(slave);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
};

constexpr int kChunk = 64;  // cycles

// What comes from the host, or nothing; waits for it where the machine sleeps.
size_t hear(const Terminal& terminal, bool sleeps, std::array<uint8_t, 4096>& buffer) {
  pollfd waiting{terminal.master, POLLIN, 0};
  if (poll(&waiting, 1, sleeps ? 200 : 0) <= 0) return 0;
  return static_cast<size_t>(std::max<ssize_t>(0, read(terminal.master, buffer.data(), buffer.size())));
}

void tell(const Terminal& terminal, const std::vector<uint8_t>& bytes) {
  for (size_t at = 0; at < bytes.size();) {
    const ssize_t done = write(terminal.master, bytes.data() + at, bytes.size() - at);
    if (done <= 0) break;  // nobody reads: a serial line does not wait
    at += static_cast<size_t>(done);
  }
}

int failed(uint64_t cycles, const char* at) {
  const bool rule = std::strncmp(at, "the bus", 7) == 0;
  fmt::print(stderr, "cuboct-board-sim: cycle {}: {}\n", cycles,
             rule ? fmt::format("{}: broken", at) : fmt::format("the assertion of the RTL at {} failed", at));
  return 1;
}

// A serial line, level by level.
int simulate_line(const Request& request, const Library& library, void* model, const Terminal& terminal) {
  const double clocks = constant_of(request.project, "BitClocks16") / 16 * (1 + request.skew / 100);
  Noise back = request.noise;
  back.seed ^= 0x9e3779b97f4a7c15u;
  LineOut to_board(clocks, request.noise);
  LineIn from_board(clocks, back);
  std::array<uint8_t, kChunk> rx{}, tx{};
  std::array<uint8_t, 4096> buffer{};
  std::vector<uint8_t> bytes;
  const int settle = static_cast<int>(40 * clocks);  // cycles after which a quiet board has nothing to say
  int quiet = 0;
  uint64_t cycles = 0;
  while (!interrupted()) {
    const bool sleeps = to_board.empty() && quiet > settle;
    const size_t got = hear(terminal, sleeps, buffer);
    for (size_t k = 0; k < got; ++k) to_board.send(buffer[k]);
    if (got == 0 && sleeps) continue;
    for (uint8_t& level : rx) level = to_board.level();
    uint8_t idle = 1;
    if (const char* at = library.clock_board(model, rx.data(), tx.data(), kChunk, &idle); at != nullptr)
      return failed(cycles, at);
    cycles += kChunk;
    bytes.clear();
    for (const uint8_t level : tx) from_board.take(level, bytes);
    quiet = to_board.empty() && from_board.idle() && bytes.empty() && idle ? quiet + kChunk : 0;
    tell(terminal, bytes);
  }
  const NoiseCount &a = to_board.count(), &b = from_board.count();
  fmt::print(stderr,
             "{} cycles; to the board {} bytes, {} flips, {} drops, {} inserts; from it {}, {}, {}, {}\n",
             cycles, a.bytes, a.flips, a.drops, a.inserts, b.bytes, b.flips, b.drops, b.inserts);
  return 0;
}

// A bus's registers, byte by byte.
int simulate_bus(const Library& library, void* model, const Terminal& terminal) {
  constexpr int kSettle = 1024;  // cycles after which a quiet machine has nothing to say
  std::array<uint8_t, 4096> buffer{}, tx{};
  std::vector<uint8_t> to_bus, bytes;
  int quiet = 0;
  uint64_t cycles = 0, written = 0, read = 0;
  while (!interrupted()) {
    const bool sleeps = to_bus.empty() && quiet > kSettle;
    const size_t got = hear(terminal, sleeps, buffer);
    to_bus.insert(to_bus.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(got));
    if (got == 0 && sleeps) continue;
    int taken = 0, count = 0;
    uint8_t idle = 1;
    const char* at = library.clock_bus(model, to_bus.data(), static_cast<int>(to_bus.size()), &taken,
                                       tx.data(), static_cast<int>(tx.size()), &count, kChunk, &idle);
    if (at != nullptr) return failed(cycles, at);
    cycles += kChunk;
    to_bus.erase(to_bus.begin(), to_bus.begin() + taken);
    bytes.assign(tx.begin(), tx.begin() + count);
    written += static_cast<uint64_t>(taken);
    read += static_cast<uint64_t>(count);
    quiet = to_bus.empty() && taken == 0 && bytes.empty() && idle ? quiet + kChunk : 0;
    tell(terminal, bytes);
  }
  fmt::print(stderr, "over {} cycles; {} bytes written, {} read\n", cycles, written, read);
  return 0;
}

int simulate(const Request& request) {
  const Library library(compile_board(request.project, request.build_directory.empty()
                                                           ? default_build_directory()
                                                           : request.build_directory));
  const bool line = library.clock_board != nullptr;
  if (!line && library.clock_bus == nullptr) throw InputError("the compiled library is not that of a board");
  const Noise& noise = request.noise;
  if (!line && (noise.flip > 0 || noise.drop > 0 || noise.insert > 0 || request.skew != 0))
    throw InputError(fmt::format("{} has a bus, not a serial line: nothing disturbs it", request.project));
  void* model = library.create(1);
  Terminal terminal;
  fmt::print("{}\n", terminal.name);
  std::fflush(stdout);
  catch_interrupts();
  const int code =
      line ? simulate_line(request, library, model, terminal) : simulate_bus(library, model, terminal);
  library.destroy(model);
  return code;
}

int main_of(int argc, char** argv) {
  Request request;
  Command app("cuboct-board-sim", "Simulates an emitted board behind a pseudo-terminal and prints its name");
  app.option("project", request.project, "Directory of 'cuboct emit SCENE --board B --out DIR', or --bus",
             "DIR")
      .required();
  app.option("--flip-rate", request.noise.flip, "Chance that a bit on the line is wrong").range(0.0, 1.0);
  app.option("--drop-rate", request.noise.drop, "Chance that a byte is lost").range(0.0, 1.0);
  app.option("--insert-rate", request.noise.insert, "Chance that a byte comes after a byte").range(0.0, 1.0);
  app.option("--seed", request.noise.seed, "Of the noise").show_default();
  app.option("--skew", request.skew, "Per cent by which the host's bits are longer than the board's")
      .range(-10.0, 10.0);
  app.option("--build-dir", request.build_directory,
             "Where compiled boards are kept; $XDG_CACHE_HOME/cuboct or ~/.cache/cuboct without it");
  return run_command_line(app, argc, argv, [&] { return simulate(request); });
}

}  // namespace
}  // namespace cuboct::emu

int main(int argc, char** argv) {
  return cuboct::with_standard_streams([&] { return cuboct::emu::main_of(argc, argv); });
}
