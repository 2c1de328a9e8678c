// SPDX-License-Identifier: MIT
// A board that answers what it likes. The input is what comes over the line: in the first half of all inputs
// as it is, in the others as the frames of replies, with their numbers, check sums and escapes made right.
#include <algorithm>
#include <memory>
#include <stdexcept>

#include "emu/board/host.h"
#include "emu/board/serial_port.h"
#include "emu/board/session.h"
#include "hw/plan/setup.h"
#include "model/scene/scene.h"
#include "tests/fuzz/targets.h"

namespace cuboct {

namespace fuzz {
namespace {
Bytes line;           // that is still to come
bool framed = false;  // its first byte says how long the next reply is
emu::Bytes asked;     // bytes of the last request
int silent = 0;

emu::Bytes next_reply() {
  if (line.empty()) return {};
  size_t count = line.size();
  if (framed) {
    count = std::min<size_t>(line[0], line.size() - 1);
    line = line.subspan(1);
  }
  emu::Bytes bytes(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(count));
  line = line.subspan(count);
  if (!framed) return bytes;
  emu::FrameReader reader;
  for (const uint8_t byte : asked)
    if (reader.take(byte) == emu::FrameReader::Found::frame) break;
  emu::Bytes frame(reader.frame().begin(),
                   reader.frame().begin() +
                       std::min<std::ptrdiff_t>(2, static_cast<std::ptrdiff_t>(reader.frame().size())));
  frame.insert(frame.end(), bytes.begin(), bytes.end());
  return emu::to_line(frame);
}

}  // namespace
}  // namespace fuzz

// In the place of emu/board/serial_port.cpp.
namespace emu {

SerialPort::SerialPort(const std::string& path, int baud) : path_(path), baud_(baud) {}
SerialPort::~SerialPort() = default;
void SerialPort::write(const Bytes& bytes) { fuzz::asked = bytes; }
Bytes SerialPort::read(Clock::time_point) {
  // A line that has ended is a port that is gone: else 200 attempts of each request would follow.
  if (fuzz::line.empty() && ++fuzz::silent > 3) throw std::runtime_error("the port is gone");
  return fuzz::next_reply();
}

}  // namespace emu

namespace fuzz {
namespace {

void run_on_board(const Scene& scene, const Setup& setup) {
  emu::Host host("fuzzed", 1'000'000, 0.001);
  const EngineKind kind = emu::board_kind(host, scene, setup.plan);
  const std::unique_ptr<Engine> engine = kind.make(nullptr, false);
  engine->advance(2, nullptr);
  engine->hash();
}

}  // namespace

void take_board(Bytes input) {
  static const Scene scene = read_scene(in_tree("tests/board/thrown.toml"));
  static const Setup setup = make_setup(scene, read_arch(in_tree("tests/board/one_node.toml")));
  if (input.empty()) return;
  framed = (input[0] & 1) != 0;
  line = input.subspan(1);
  silent = 0;
  failing([&] { run_on_board(scene, setup); });
}

}  // namespace fuzz
}  // namespace cuboct
