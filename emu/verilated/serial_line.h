// SPDX-License-Identifier: MIT
// A serial line to and from a simulated board, as levels per clock cycle, and the noise on it. Shares no code
// with the board's receiver or with the host's driver.
#pragma once

#include <cstdint>
#include <deque>
#include <random>
#include <vector>

namespace cuboct::emu {

// What may happen to a line, each at random and independent of the rest.
struct Noise {
  double flip = 0;    // chance of each bit, start and stop bits included
  double drop = 0;    // of each byte
  double insert = 0;  // of a random byte after each byte
  uint64_t seed = 1;
};

// What happened.
struct NoiseCount {
  uint64_t bytes = 0, flips = 0, drops = 0, inserts = 0;
};

class Dice {
 public:
  explicit Dice(const Noise& noise) : noise_(noise), random_(noise.seed) {}
  // The bytes that stand for one, each as its ten bits, the start bit lowest.
  std::vector<uint16_t> disturb(uint8_t byte);
  const NoiseCount& count() const { return count_; }

 private:
  bool happens(double chance) { return chance > 0 && std::generate_canonical<double, 53>(random_) < chance; }

  Noise noise_;
  std::mt19937_64 random_;
  NoiseCount count_;
};

// Bytes into levels.
class LineOut {
 public:
  LineOut(double bit_clocks, const Noise& noise) : bit_clocks_(bit_clocks), dice_(noise) {}
  void send(uint8_t byte);
  bool empty() const { return bits_.empty(); }
  uint8_t level();  // of the next cycle
  const NoiseCount& count() const { return dice_.count(); }

 private:
  double bit_clocks_, left_ = 0;  // clocks
  bool now_ = true;
  std::deque<bool> bits_;
  Dice dice_;
};

// Levels into bytes; a byte without a stop bit is dropped.
class LineIn {
 public:
  LineIn(double bit_clocks, const Noise& noise) : bit_clocks_(bit_clocks), dice_(noise) {}
  void take(uint8_t level, std::vector<uint8_t>& bytes);
  bool idle() const { return bit_ < 0; }
  const NoiseCount& count() const { return dice_.count(); }

 private:
  double bit_clocks_, left_ = 0;
  int bit_ = -1;  // the bit whose middle comes next; -1: none under way
  uint16_t held_ = 0;
  Dice dice_;
};

}  // namespace cuboct::emu
