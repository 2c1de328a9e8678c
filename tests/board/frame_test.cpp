// SPDX-License-Identifier: MIT
#include "emu/board/frame.h"

#include <gtest/gtest.h>

#include <random>

namespace cuboct::test {
namespace {

using emu::Bytes;
using emu::FrameReader;
using emu::to_line;

// The frames that a line's bytes hold, and how many were damaged.
struct Heard {
  std::vector<Bytes> frames;
  int damaged = 0;
};
Heard hear(const Bytes& line) {
  Heard heard;
  FrameReader reader;
  for (const uint8_t byte : line) {
    const FrameReader::Found found = reader.take(byte);
    if (found == FrameReader::Found::frame) heard.frames.push_back(reader.frame());
    if (found == FrameReader::Found::damaged) ++heard.damaged;
  }
  return heard;
}

// The check value of CRC-32 for "123456789" is cbf43926; ~ and } are escaped.
TEST(Frame, IsWhatThePageSays) {
  EXPECT_EQ(to_line({'1', '2', '3', '4', '5', '6', '7', '8', '9'}),
            (Bytes{0x7e, '1', '2', '3', '4', '5', '6', '7', '8', '9', 0x26, 0x39, 0xf4, 0xcb, 0x7e}));
  const Bytes escaped = to_line({0x7e, 0x7d, 0x20});
  EXPECT_EQ(Bytes(escaped.begin(), escaped.begin() + 6), (Bytes{0x7e, 0x7d, 0x5e, 0x7d, 0x5d, 0x20}));
}

TEST(Frame, ReturnsWhatWasSent) {
  std::mt19937 random(1);
  Bytes line;
  std::vector<Bytes> frames;
  for (int k = 0; k < 200; ++k) {
    Bytes frame(1 + random() % 40);
    // A third of all bytes are marks.
    for (uint8_t& byte : frame)
      byte = static_cast<uint8_t>(random() % 3 == 0 ? 0x7d + random() % 2 : random());
    const Bytes sent = to_line(frame);
    line.insert(line.end(), sent.begin(), sent.end());
    frames.push_back(frame);
  }
  const Heard heard = hear(line);
  EXPECT_EQ(heard.frames, frames);
  EXPECT_EQ(heard.damaged, 0);
}

// Every single bit, every lost byte, every byte too many: no frame, or another number of frames, never a
// wrong one.
TEST(Frame, IsNeverTakenForAnother) {
  const Bytes frame{3, 4, 0x7e, 0x7d, 0, 0xff, 0x11, 0x22, 0x33};
  const Bytes line = to_line(frame);
  int harmed = 0;
  const auto look = [&](const Bytes& changed) {
    for (const Bytes& found : hear(changed).frames) EXPECT_EQ(found, frame);
    harmed += hear(changed).frames.empty();
  };
  for (size_t at = 0; at < line.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes changed = line;
      changed[at] = static_cast<uint8_t>(changed[at] ^ 1 << bit);
      look(changed);
    }
    Bytes lost = line, more = line;
    lost.erase(lost.begin() + static_cast<long>(at));
    look(lost);
    for (const uint8_t extra : {0x00, 0x55, 0x7d, 0x7e}) {
      more.insert(more.begin() + static_cast<long>(at), extra);
      look(more);
    }
  }
  EXPECT_GT(harmed, static_cast<int>(10 * frame.size()));
}

}  // namespace
}  // namespace cuboct::test
