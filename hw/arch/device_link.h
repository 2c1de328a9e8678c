// SPDX-License-Identifier: MIT
// Kinds of link between devices, as technologies/boards.toml says them: what they carry and how late, each
// figure with its source. docs/reference/boards.md.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace cuboct {

enum class LinkFigure : uint8_t {
  lanes,       // 1: of a device, each one way
  pins,        // 1: of a lane
  rate,        // Mbit/s of a lane
  efficiency,  // 1: share of the bits on the line that are data
  delay,       // ns: from the last bit that goes in to its coming out
  registers    // cycles of the device's clock, of both ends together
};
inline constexpr size_t kLinkFigures = static_cast<size_t>(LinkFigure::registers) + 1;
const char* name_of(LinkFigure figure);
const char* unit_of(LinkFigure figure);

struct DeviceLinkKind {
  struct Figure {
    double value = 0;
    std::string source;
    bool assumed() const { return source.starts_with("assumed"); }
  };
  std::string name;
  std::array<Figure, kLinkFigures> figures;

  double of(LinkFigure figure) const { return figures[static_cast<size_t>(figure)].value; }
  uint64_t lanes() const { return static_cast<uint64_t>(of(LinkFigure::lanes)); }
  // Data bits that a lane carries in a cycle; `clock` in Hz.
  double bits_per_cycle(double clock) const;
  // Cycles from the one in which a beat is taken to the one in which it is shown, where its bits go in over
  // `interval` cycles: those, the delay and the registers; at least 1.
  int latency(double clock, int interval) const;
};

// Throws InputError at the place of what is wrong: a figure without a source, of another unit, absent.
std::vector<DeviceLinkKind> parse_board_links(const std::string& text, const std::string& path);

}  // namespace cuboct
