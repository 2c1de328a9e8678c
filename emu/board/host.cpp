// SPDX-License-Identifier: MIT
#include "emu/board/host.h"

#include <fmt/format.h>

#include <algorithm>

namespace cuboct::emu {
namespace {

enum Command : uint8_t {
  kInfo = 1,
  kStatus = 2,
  kReset = 3,
  kLoad = 4,
  kRun = 5,
  kRead = 6,
  kVelocity = 7,
  kFault = 8
};
enum StatusBit : uint8_t { kBusy = 1, kFaulty = 2, kRefused = 4 };

constexpr int kAttempts = 200;      // until the line counts as broken
constexpr int kFirstAttempts = 10;  // until a port counts as none of a board
constexpr size_t kFrameBytes = 12;  // flags, check sum and escapes of it

void put(Bytes& to, uint64_t value, int bytes) {
  for (int k = 0; k < bytes; ++k) to.push_back(static_cast<uint8_t>(value >> 8 * k));
}

uint64_t get(const Bytes& from, size_t at, size_t bytes) {
  uint64_t value = 0;
  for (size_t k = 0; k < bytes; ++k) value |= static_cast<uint64_t>(from[at + k]) << 8 * k;
  return value;
}

BoardState state_of(const Bytes& reply) {
  BoardState state;
  state.busy = reply[0] & kBusy;
  state.fault = reply[0] & kFaulty;
  state.refused = reply[0] & kRefused;
  state.loaded = static_cast<uint16_t>(get(reply, 1, 2));
  state.steps = static_cast<uint32_t>(get(reply, 3, 4));
  if (reply.size() >= 13) state.cycles = get(reply, 7, 6);
  return state;
}

}  // namespace

Host::Host(const std::string& port, int baud, double timeout) : port_(port, baud), timeout_(timeout) {}

Bytes Host::attempt(const Bytes& line, uint8_t number, uint8_t command, size_t longest) {
  using Clock = SerialPort::Clock;
  const auto seconds = [](double s) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
  };
  port_.write(line);
  count_.bytes += line.size();
  // Each byte may need an escape. A port that never falls silent must not hold us longer than a slow board
  // may.
  const double on_line = 10.0 * static_cast<double>(line.size() + 2 * (longest + kFrameBytes)) / port_.baud();
  const auto start = Clock::now(), end = start + seconds(10 * (timeout_ + on_line));
  auto deadline = start + seconds(timeout_ + 10.0 * static_cast<double>(line.size()) / port_.baud());
  FrameReader reader;
  for (;;) {
    const Bytes bytes = port_.read(std::min(deadline, end));
    if (bytes.empty() || Clock::now() >= end) {
      ++count_.silent;
      return {};
    }
    count_.bytes += bytes.size();
    deadline = Clock::now() + seconds(timeout_);
    for (const uint8_t byte : bytes) {
      const FrameReader::Found found = reader.take(byte);
      if (found == FrameReader::Found::damaged) {
        ++count_.damaged;
        return {};
      }
      if (found != FrameReader::Found::frame) continue;
      const Bytes& frame = reader.frame();
      // A reply to an earlier attempt at something else is passed over.
      if (frame.size() >= 3 && frame[0] == number && frame[1] == command)
        return {frame.begin() + 2, frame.end()};
    }
  }
}

Bytes Host::ask(uint8_t command, const Bytes& arguments, size_t longest, int attempts) {
  const uint8_t number = ++number_;
  Bytes frame(2 + arguments.size());
  frame[0] = number;
  frame[1] = command;
  std::copy(arguments.begin(), arguments.end(), frame.begin() + 2);
  const Bytes line = to_line(frame);
  ++count_.requests;
  for (int k = 0; k < attempts; ++k) {
    if (k > 0) ++count_.retries;
    Bytes reply = attempt(line, number, command, longest);
    if (!reply.empty()) return reply;
  }
  return {};
}

Bytes Host::answer(uint8_t command, const Bytes& arguments, size_t longest) {
  Bytes reply = ask(command, arguments, longest, kAttempts);
  if (reply.empty())
    throw std::runtime_error(fmt::format("port {}: no answer to {} attempts ({} damaged, {} silent in all)",
                                         port(), kAttempts, count_.damaged, count_.silent));
  return reply;
}

BoardState Host::short_answer(uint8_t command, const Bytes& arguments) {
  const Bytes reply = answer(command, arguments, 7);
  if (reply.size() < 7)
    throw std::runtime_error(fmt::format("port {}: a reply of {} bytes", port(), reply.size()));
  return state_of(reply);
}

BoardInfo Host::info() {
  const Bytes reply = ask(kInfo, {}, 27, kFirstAttempts);
  if (reply.empty()) {
    const std::string what = count_.damaged > 0 ? "what comes is not what a board says" : "no board answers";
    throw InputError(
        fmt::format("port {}: {} ({} attempts at {} baud)", port(), what, kFirstAttempts, port_.baud()),
        "is it flashed with a project of 'cuboct emit --board', and is --baud that of the project?");
  }
  BoardInfo info;
  info.version = reply.size() > 1 ? reply[1] : 0;
  if (info.version != kVersion || reply.size() != 27)
    throw InputError(
        fmt::format("port {}: the board speaks version {} of the protocol, this program version {}", port(),
                    info.version, int{kVersion}),
        "emit the project again and flash the board");
  info.plan_hash = get(reply, 2, 8);
  info.machine_hash = get(reply, 10, 8);
  info.nodes = static_cast<int>(get(reply, 18, 2));
  info.particle_bits = static_cast<int>(get(reply, 20, 2));
  info.clock_hz = static_cast<uint32_t>(get(reply, 22, 4));
  info.moved_types = reply[26];
  return info;
}

BoardState Host::status() {
  const Bytes reply = answer(kStatus, {}, 13);
  if (reply.size() != 13)
    throw std::runtime_error(fmt::format("port {}: a reply of {} bytes", port(), reply.size()));
  return state_of(reply);
}

void Host::reset() {
  const BoardState state = short_answer(kReset, {});
  if (state.loaded != 0 || state.steps != 0)
    throw std::runtime_error(fmt::format("port {}: the reset had no effect", port()));
}

void Host::load(uint16_t index, uint16_t node, const Word& word, int word_bits) {
  Bytes arguments;
  put(arguments, index, 2);
  for (int at = 0; at < word_bits; at += 8) put(arguments, word.get(at, std::min(8, word_bits - at)), 1);
  put(arguments, node, 2);
  const BoardState state = short_answer(kLoad, arguments);
  // Refused, but loaded: the reply to an earlier attempt was lost.
  if (state.loaded != index + 1)
    throw std::runtime_error(
        fmt::format("port {}: the board did not take particle {}: it holds {}", port(), index, state.loaded));
}

void Host::run(uint32_t from, uint32_t steps) {
  Bytes arguments;
  put(arguments, from, 4);
  put(arguments, steps, 4);
  const BoardState state = short_answer(kRun, arguments);
  if (state.steps != from + steps)
    throw std::runtime_error(
        fmt::format("port {}: the board did not start step {}: it is at {}", port(), from, state.steps));
}

std::vector<Word> Host::read(uint16_t node, int word_bits) {
  const size_t word_bytes = (static_cast<size_t>(word_bits) + 7) / 8;
  std::vector<Word> words;
  for (int tries = 0;; ++tries) {
    if (tries > kAttempts)
      throw std::runtime_error(fmt::format("port {}: node {} cannot be read", port(), node));
    Bytes arguments;
    put(arguments, words.size(), 2);
    put(arguments, static_cast<uint64_t>(words_), 1);
    put(arguments, node, 2);
    // Long replies are hit more often: fewer words at once after one that was lost.
    const Bytes reply = ask(kRead, arguments, 3 + static_cast<size_t>(words_) * word_bytes, 2);
    if (reply.empty()) {
      words_ = std::max(1, words_ / 2);
      continue;
    }
    const size_t count = reply.size() >= 3 ? get(reply, 1, 2) : 0;
    const size_t expected = std::min(count - std::min(count, words.size()), static_cast<size_t>(words_));
    if ((reply[0] & (kBusy | kRefused)) != 0 || reply.size() != 3 + expected * word_bytes)
      throw std::runtime_error(fmt::format("port {}: node {}: a reply of {} bytes, status {}", port(), node,
                                           reply.size(), reply[0]));
    for (size_t k = 0; k < expected; ++k) {
      Word word;
      for (int at = 0; at < word_bits; at += 8)
        word.put(at, std::min(8, word_bits - at), reply[3 + k * word_bytes + static_cast<size_t>(at / 8)]);
      words.push_back(word);
    }
    if (words.size() >= count) return words;
    tries = 0;
  }
}

void Host::set_velocity(uint8_t moved, uint8_t axis, int64_t value) {
  Bytes arguments{moved, axis};
  put(arguments, static_cast<uint64_t>(value), 8);
  if (short_answer(kVelocity, arguments).refused)
    throw std::runtime_error(fmt::format("port {}: the board did not take a velocity", port()));
}

BoardFault Host::fault(uint16_t node) {
  Bytes arguments;
  put(arguments, node, 2);
  const Bytes reply = answer(kFault, arguments, 14);
  if (reply.size() != 14 || (reply[0] & kRefused) != 0)
    throw std::runtime_error(fmt::format("port {}: the fault of node {} cannot be read", port(), node));
  return {static_cast<Fault>(reply[1]), static_cast<uint32_t>(get(reply, 2, 4)),
          static_cast<int64_t>(get(reply, 6, 8))};
}

}  // namespace cuboct::emu
