// SPDX-License-Identifier: MIT
#include "emu/verilated/serial_line.h"

namespace cuboct::emu {

std::vector<uint16_t> Dice::disturb(uint8_t byte) {
  const auto framed = [](unsigned b) { return static_cast<uint16_t>(b << 1 | 0x200u); };
  std::vector<uint16_t> out;
  ++count_.bytes;
  if (happens(noise_.drop))
    ++count_.drops;
  else
    out.push_back(framed(byte));
  if (happens(noise_.insert)) {
    ++count_.inserts;
    out.push_back(framed(static_cast<unsigned>(random_() & 0xff)));
  }
  if (noise_.flip > 0)
    for (uint16_t& bits : out)
      for (int k = 0; k < 10; ++k)
        if (happens(noise_.flip)) {
          ++count_.flips;
          bits = static_cast<uint16_t>(bits ^ 1u << k);
        }
  return out;
}

void LineOut::send(uint8_t byte) {
  for (const uint16_t bits : dice_.disturb(byte))
    for (int k = 0; k < 10; ++k) bits_.push_back(bits >> k & 1);
}

uint8_t LineOut::level() {
  if (left_ < 0.5) {
    now_ = true;
    if (bits_.empty()) {
      left_ = 0;
      return 1;
    }
    now_ = bits_.front();
    bits_.pop_front();
    left_ += bit_clocks_;
  }
  left_ -= 1;
  return now_;
}

void LineIn::take(uint8_t level, std::vector<uint8_t>& bytes) {
  if (bit_ < 0) {
    if (level) return;
    bit_ = 0;
    held_ = 0;
    left_ = bit_clocks_ / 2;
  }
  left_ -= 1;
  if (left_ >= 0) return;
  left_ += bit_clocks_;
  held_ = static_cast<uint16_t>(held_ | (level ? 1u : 0u) << bit_);
  if (bit_ == 0 && level) {
    bit_ = -1;
  } else if (++bit_ == 10) {
    bit_ = -1;
    // The noise of the way back: a byte whose start or stop bit is hit is lost.
    if (held_ & 0x200)
      for (const uint16_t bits : dice_.disturb(static_cast<uint8_t>(held_ >> 1)))
        if ((bits & 0x201) == 0x200) bytes.push_back(static_cast<uint8_t>(bits >> 1));
  }
}

}  // namespace cuboct::emu
