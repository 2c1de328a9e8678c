// SPDX-License-Identifier: MIT
// Ports behind which there is no board: one clear error each.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <random>
#include <thread>

#include "emu/board/host.h"
#include "tests/board/simulated_board.h"

namespace cuboct::test {
namespace {

struct Pty {
  int master = -1, slave = -1;
  std::string name;
  Pty() {
    char text[256] = {};
    termios raw{};
    cfmakeraw(&raw);
    if (openpty(&master, &slave, text, &raw, nullptr) != 0) throw std::runtime_error("openpty");
    name = text;
  }
  ~Pty() {
    close(master);
    close(slave);
  }
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;
};

Answer run_at(const std::string& port, const std::string& timeout = "0.05") {
  return command({"run", "--quiet", board_file("grips.toml"), "--arch", board_file("board.toml"), "--engine",
                  "fpga", "--port", port, "--port-timeout", timeout});
}

void expect_refusal(const Answer& answer, const std::string& text) {
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(answer.err, text);
  EXPECT_EQ(answer.out, "");
}

const std::string kIsItFlashed =
    "  hint: is it flashed with a project of 'cuboct emit --board', and is --baud that of the project?\n";

TEST(Port, ThatIsSilent) {
  const Pty pty;
  expect_refusal(run_at(pty.name),
                 "port " + pty.name + ": no board answers (10 attempts at 1000000 baud)\n" + kIsItFlashed);
}

// A device that never stops talking must not hold the command.
TEST(Port, ThatSpeaksSomethingElse) {
  const Pty pty;
  fcntl(pty.master, F_SETFL, O_NONBLOCK);
  std::atomic<bool> stop = false;
  std::thread babble([&] {
    std::mt19937 random(1);
    while (!stop) {
      uint8_t bytes[64];
      for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random());
      if (write(pty.master, bytes, sizeof bytes) < 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  const Answer answer = run_at(pty.name, "0.5");
  stop = true;
  babble.join();
  expect_refusal(answer, "port " + pty.name +
                             ": what comes is not what a board says (10 attempts at 1000000 baud)\n" +
                             kIsItFlashed);
}

// What a terminal echoes is no answer.
TEST(Port, ThatEchoes) {
  const Pty pty;
  std::atomic<bool> stop = false;
  fcntl(pty.master, F_SETFL, O_NONBLOCK);
  std::thread echo([&] {
    uint8_t bytes[64];
    while (!stop) {
      const ssize_t got = read(pty.master, bytes, sizeof bytes);
      if (got <= 0 || write(pty.master, bytes, static_cast<size_t>(got)) != got)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  const Answer answer = run_at(pty.name);
  stop = true;
  echo.join();
  expect_refusal(answer,
                 "port " + pty.name + ": no board answers (10 attempts at 1000000 baud)\n" + kIsItFlashed);
}

TEST(Port, ThatIsNone) {
  expect_refusal(run_at("/dev/null"), "/dev/null is no serial port\n");
  expect_refusal(run_at("/dev/ttyNONE"),
                 "there is no port /dev/ttyNONE\n"
                 "  hint: is the board plugged in? 'ls /dev/ttyUSB* /dev/ttyACM*' lists serial ports\n");
}

TEST(Port, ThatIsInUse) {
  const Pty pty;
  const emu::Host other(pty.name, 1000000, 1);
  expect_refusal(run_at(pty.name),
                 "port " + pty.name + " is in use by another program\n  hint: end that one first\n");
}

TEST(Port, ThatMayNotBeOpened) {
  if (geteuid() == 0) GTEST_SKIP() << "root may open every port";
  const Pty pty;
  chmod(pty.name.c_str(), 0);
  expect_refusal(run_at(pty.name), "no permission for port " + pty.name +
                                       "\n  hint: 'ls -l' shows whose it is: often group dialout ('sudo "
                                       "usermod -aG dialout $USER', log in "
                                       "again)\n");
}

TEST(Port, HasKnownRates) {
  const Pty pty;
  expect_refusal(
      command({"run", board_file("grips.toml"), "--engine", "fpga", "--port", pty.name, "--baud", "1234"}),
      "1234 baud is no rate of serial ports\n"
      "  hint: one of 9600, 19200, 38400, 57600, 115200, 230400, 460800, 500000, 576000, 921600, 1000000, "
      "1500000, "
      "2000000, 3000000, 4000000\n");
}

TEST(Command, SaysWhatAnEngineNeeds) {
  const std::string scene = board_file("grips.toml");
  expect_refusal(command({"run", scene, "--engine", "fpga"}),
                 "the fpga engine needs --port, where the board is\n"
                 "  hint: --port /dev/ttyUSB0, or what cuboct-board-sim prints\n");
  expect_refusal(command({"run", scene, "--engine", "golden", "--port", "/dev/ttyUSB0"}),
                 "--port is an option of the fpga engine, not of golden\n");
  expect_refusal(command({"crosscheck", scene, "--engines", "golden,lattice", "--baud", "115200"}),
                 "--baud is an option of the fpga engine, not of golden,lattice\n");
}

TEST(Emit, RefusesBoardsThatThereAreNot) {
  const Scratch scratch;
  const std::string scene = board_file("grips.toml"), out = scratch.path("p");
  expect_refusal(command({"emit", scene, "--out", out, "--board", "icebraker"}),
                 "unknown board 'icebraker'\n  hint: did you mean 'icebreaker'?\n");
  expect_refusal(command({"emit", scene, "--out", out, "--board", "arty"}),
                 "unknown board 'arty'\n  hint: one of icebreaker or ulx3s\n");
  expect_refusal(command({"emit", scene, "--out", out, "--board", "icebreaker", "--baud", "4000000"}),
                 "4000000 baud is out of range: 300 to 3000000 on the icebreaker\n");
}

}  // namespace
}  // namespace cuboct::test
