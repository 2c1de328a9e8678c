// SPDX-License-Identifier: MIT
// What an event costs in a technology, as technologies/*.toml say it: each constant a band from the lowest to
// the highest figure published or measured, with its source. A constant that no source gives is absent.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace cuboct {

// From low to high, low <= high.
struct Band {
  double low = 0, high = 0;
  double middle() const { return 0.5 * (low + high); }
  Band& operator+=(const Band& b) { return low += b.low, high += b.high, *this; }
  friend Band operator*(double a, const Band& b) { return {a * b.low, a * b.high}; }
  friend Band operator*(const Band& a, const Band& b) { return {a.low * b.low, a.high * b.high}; }
  bool operator==(const Band&) const = default;
};
inline bool overlap(const Band& a, const Band& b) { return a.low <= b.high && b.low <= a.high; }

inline constexpr double kMm2 = 1e-6;  // of a um^2

enum class Constant : uint8_t {
  add_bit,             // pJ/bit: an adder's or comparator's, linear in its width
  multiply_bit2,       // pJ/bit^2: a multiplier of a by b bits takes a b of them
  register_bit,        // pJ/bit: a register's bit written, beyond its clock
  clock_bit,           // pJ/bit: a register's bit in each cycle
  memory_read,         // pJ/bit, of a memory of `words`
  memory_write,        // the same
  memory_exponent,     // 1: these go with words^exponent
  leakage_transistor,  // pW
  leakage_memory_bit,  // pW
  wire_bit_mm,         // pJ/bit/mm
  link_bit,            // pJ/bit over one link; without it links are wires of a node's side
  clock_device,        // pJ: of an FPGA's clock network in each cycle
  static_device,       // mW: of an FPGA at rest
  transistor_area,     // um^2
  register_area,       // um^2 of a bit
  memory_bit_area,     // um^2
  wire_pitch           // um
};
inline constexpr size_t kConstants = static_cast<size_t>(Constant::wire_pitch) + 1;
const char* name_of(Constant constant);
const char* unit_of(Constant constant);

struct TechnologyFigure {
  Band band;         // >= 0
  double words = 0;  // memory_read, memory_write: of the memory that it is of
  std::string source;
};

struct Technology {
  std::string name, title;
  std::array<std::optional<TechnologyFigure>, kConstants> figures;

  const std::optional<TechnologyFigure>& at(Constant constant) const {
    return figures[static_cast<size_t>(constant)];
  }
  std::optional<TechnologyFigure>& at(Constant constant) { return figures[static_cast<size_t>(constant)]; }
};

// Throws InputError at the place of what is wrong: a figure without a source, low above high, another unit
// than the constant's, an unknown key.
Technology read_technology(const std::string& path);
Technology parse_technology(const std::string& text, const std::string& path);

// Kinds of link between chips, of a file of them.
struct LinkKind {
  std::string name;
  TechnologyFigure figure;  // pJ/bit
};
std::vector<LinkKind> parse_links(const std::string& text, const std::string& path);

}  // namespace cuboct
