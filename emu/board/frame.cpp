// SPDX-License-Identifier: MIT
#include "emu/board/frame.h"

#include <zlib.h>

namespace cuboct::emu {
namespace {

constexpr uint8_t kFlag = 0x7e, kEscape = 0x7d, kInverted = 0x20;
constexpr size_t kSumBytes = 4;

uint32_t sum_of(const uint8_t* bytes, size_t count) {
  return static_cast<uint32_t>(crc32(0, bytes, static_cast<unsigned>(count)));
}

}  // namespace

Bytes to_line(const Bytes& frame) {
  Bytes line{kFlag};
  const auto put = [&line](uint8_t byte) {
    const bool special = byte == kFlag || byte == kEscape;
    if (special) line.push_back(kEscape);
    line.push_back(special ? byte ^ kInverted : byte);
  };
  for (const uint8_t byte : frame) put(byte);
  const uint32_t sum = sum_of(frame.data(), frame.size());
  for (size_t k = 0; k < kSumBytes; ++k) put(static_cast<uint8_t>(sum >> 8 * k));
  line.push_back(kFlag);
  return line;
}

FrameReader::Found FrameReader::take(uint8_t byte) {
  if (ended_) {
    frame_.clear();
    ended_ = too_long_ = false;
  }
  if (byte == kFlag) {
    escaped_ = false;
    if (frame_.empty()) return Found::nothing;
    ended_ = true;
    if (too_long_ || frame_.size() < kSumBytes) return Found::damaged;
    const size_t size = frame_.size() - kSumBytes;
    const uint32_t sum = sum_of(frame_.data(), size);
    for (size_t k = 0; k < kSumBytes; ++k)
      if (frame_[size + k] != static_cast<uint8_t>(sum >> 8 * k)) return Found::damaged;
    frame_.resize(size);
    return Found::frame;
  }
  if (byte == kEscape) {
    escaped_ = true;
    return Found::nothing;
  }
  if (frame_.size() < kLongest)
    frame_.push_back(escaped_ ? byte ^ kInverted : byte);
  else
    too_long_ = true;
  escaped_ = false;
  return Found::nothing;
}

}  // namespace cuboct::emu
