// SPDX-License-Identifier: MIT
// Frames on a board's serial line: 7e, bytes with 7e and 7d escaped, their CRC-32, 7e.
// docs/reference/board.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cuboct::emu {

using Bytes = std::vector<uint8_t>;

// The line's bytes for a frame of these.
Bytes to_line(const Bytes& frame);

// Takes what comes over a line apart.
class FrameReader {
 public:
  enum class Found : uint8_t { nothing, frame, damaged };
  // One byte. `frame`: frame() holds the bytes of a frame whose check sum is right, without it. `damaged`:
  // one ended whose check sum is wrong, or that is longer than any of ours.
  Found take(uint8_t byte);
  const Bytes& frame() const { return frame_; }

 private:
  static constexpr size_t kLongest = 1 << 16;
  Bytes frame_;
  bool escaped_ = false, too_long_ = false, ended_ = false;
};

}  // namespace cuboct::emu
