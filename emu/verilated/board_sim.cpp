// SPDX-License-Identifier: MIT
// cuboct-board-sim: the top of an emitted board, Verilated, behind a pseudo-terminal: a board for whoever has
// none.
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>

#include "emu/verilated/library.h"
#include "emu/verilated/serial_line.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/base/text.h"

namespace cuboct::emu {
namespace {

struct Request {
  std::string project, build_directory;
  Noise noise;
  double skew = 0;  // per cent
};

// The value of a constant of the project's cuboct_board_pkg.
double constant_of(const std::string& project, const std::string& name) {
  const std::string path = project + "/board/cuboct_board_pkg.sv";
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

int simulate(const Request& request) {
  const double clocks = constant_of(request.project, "BitClocks16") / 16 * (1 + request.skew / 100);
  const Library library(compile_board(request.project, request.build_directory.empty()
                                                           ? default_build_directory()
                                                           : request.build_directory));
  if (library.clock_board == nullptr) throw InputError("the compiled library is not that of a board");
  void* model = library.create(1);
  Terminal terminal;
  fmt::print("{}\n", terminal.name);
  std::fflush(stdout);
  catch_interrupts();

  Noise back = request.noise;
  back.seed ^= 0x9e3779b97f4a7c15u;
  LineOut to_board(clocks, request.noise);
  LineIn from_board(clocks, back);
  constexpr int kChunk = 64;  // cycles
  std::array<uint8_t, kChunk> rx{}, tx{};
  std::array<uint8_t, 4096> buffer{};
  std::vector<uint8_t> bytes;
  const int settle = static_cast<int>(40 * clocks);  // cycles after which a quiet board has nothing to say
  int quiet = 0;
  uint64_t cycles = 0;
  while (!interrupted()) {
    const bool sleeps = to_board.empty() && quiet > settle;
    pollfd waiting{terminal.master, POLLIN, 0};
    if (poll(&waiting, 1, sleeps ? 200 : 0) > 0) {
      const ssize_t got = read(terminal.master, buffer.data(), buffer.size());
      for (ssize_t k = 0; k < got; ++k) to_board.send(buffer[static_cast<size_t>(k)]);
    } else if (sleeps) {
      continue;
    }
    for (uint8_t& level : rx) level = to_board.level();
    uint8_t idle = 1;
    if (const char* at = library.clock_board(model, rx.data(), tx.data(), kChunk, &idle); at != nullptr) {
      fmt::print(stderr, "cuboct-board-sim: cycle {}: the assertion of the RTL at {} failed\n", cycles, at);
      return 1;
    }
    cycles += kChunk;
    bytes.clear();
    for (const uint8_t level : tx) from_board.take(level, bytes);
    quiet = to_board.empty() && from_board.idle() && bytes.empty() && idle ? quiet + kChunk : 0;
    for (size_t at = 0; at < bytes.size();) {
      const ssize_t done = write(terminal.master, bytes.data() + at, bytes.size() - at);
      if (done <= 0) break;  // nobody reads: a serial line does not wait
      at += static_cast<size_t>(done);
    }
  }
  const NoiseCount &a = to_board.count(), &b = from_board.count();
  fmt::print(stderr,
             "{} cycles; to the board {} bytes, {} flips, {} drops, {} inserts; from it {}, {}, {}, {}\n",
             cycles, a.bytes, a.flips, a.drops, a.inserts, b.bytes, b.flips, b.drops, b.inserts);
  library.destroy(model);
  return 0;
}

int main_of(int argc, char** argv) {
  Request request;
  CLI::App app{"Simulates an emitted board behind a pseudo-terminal and prints its name", "cuboct-board-sim"};
  app.add_option("project", request.project, "Directory of 'cuboct emit SCENE --board B --out DIR'")
      ->required()
      ->type_name("DIR");
  app.add_option("--flip-rate", request.noise.flip, "Chance that a bit on the line is wrong")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--drop-rate", request.noise.drop, "Chance that a byte is lost")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--insert-rate", request.noise.insert, "Chance that a byte comes after a byte")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--seed", request.noise.seed, "Of the noise")->capture_default_str();
  app.add_option("--skew", request.skew, "Per cent by which the host's bits are longer than the board's")
      ->check(CLI::Range(-10.0, 10.0));
  app.add_option("--build-dir", request.build_directory,
                 "Where compiled boards are kept; $XDG_CACHE_HOME/cuboct or ~/.cache/cuboct without it");
  try {
    app.parse(argc, argv);
    return simulate(request);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const InputError& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 2;
  } catch (const std::exception& e) {
    fmt::print(stderr, "cuboct-board-sim: {}\n", block_text(e.what()));
    return 1;
  }
}

}  // namespace
}  // namespace cuboct::emu

int main(int argc, char** argv) { return cuboct::emu::main_of(argc, argv); }
