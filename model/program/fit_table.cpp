// SPDX-License-Identifier: MIT
#include "model/program/fit_table.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

namespace cuboct {
namespace {

constexpr int kBinBits = 6;     // 64 parabolas an octave: for x^-n off by n^3/2^25 of a value at most
constexpr double kGood = 1e-6;  // of the largest value: a larger error takes bins of half the width
constexpr int kMostIndex = 11;
constexpr int kCoefficient = 25;
constexpr int kFraction = 17;
constexpr double kFar = 0.3;

struct Parabola {
  std::array<double, 3> c{};
};

constexpr int kWindowBits = 10;  // bins of a window

Parabola through(double y0, double ym, double y1) {
  return {{y0, -3 * y0 + 4 * ym - y1, 2 * y0 - 4 * ym + 2 * y1}};
}

// As finely as the largest coefficient lets them be.
void keep(const std::vector<Parabola>& bins, FixedTable& table) {
  double largest = 0;
  for (const Parabola& bin : bins)
    for (const double c : bin.c) largest = std::max(largest, std::abs(c));
  int exponent = 0;
  if (largest > 0) std::frexp(largest, &exponent);
  table.value_frac = kCoefficient - exponent;
  for (const Parabola& bin : bins) {
    table.c0.push_back(static_cast<int32_t>(std::lround(std::ldexp(bin.c[0], table.value_frac))));
    table.c1.push_back(static_cast<int32_t>(std::lround(std::ldexp(bin.c[1], table.value_frac))));
    table.c2.push_back(static_cast<int32_t>(std::lround(std::ldexp(bin.c[2], table.value_frac))));
  }
}

int octave_of(double argument) {
  return argument < 1 ? 0 : static_cast<int>(std::floor(std::log2(argument)));
}

FittedTable fitted_with(int bin_bits, const TableRoom& room, const std::function<double(double)>& f) {
  FittedTable out;
  FixedTable& table = out.table;
  table.shape = TableShape::octaves;
  table.degree = 2;
  table.difference_frac = std::max((room.bits + 1) / 2, (bin_bits + 1) / 2 + 1);
  table.bin_bits = bin_bits;
  table.fraction_bits = kFraction;
  const int octaves = 2 * table.difference_frac, most = 1 << (kMostIndex - bin_bits);
  table.first_octave = std::clamp(octave_of(room.from / room.step), std::max(0, octaves - most), octaves - 1);
  table.index_bits =
      bin_bits + static_cast<int>(std::bit_width(static_cast<unsigned>(octaves - table.first_octave - 1)));

  const auto at = [&](double argument) { return f(std::min(argument * room.step, room.to)) / room.unit; };
  std::vector<Parabola> bins;
  const size_t entries = size_t{1} << table.index_bits;
  for (size_t k = 0; k < entries; ++k) {
    const int octave = table.first_octave + static_cast<int>(k >> bin_bits);
    const double width = std::ldexp(1.0, octave - bin_bits);
    const double begin = std::ldexp(1.0, octave) + width * static_cast<double>(k % (1u << bin_bits));
    const double y0 = at(begin), ym = at(begin + width / 2), y1 = at(begin + width);
    bins.push_back(through(y0, ym, y1));
  }
  keep(bins, table);
  const uint64_t last = static_cast<uint64_t>(std::min(room.to / room.step, std::ldexp(1.0, octaves) - 1));
  for (size_t k = 0; k < 4 * entries; ++k) {
    const int octave = table.first_octave + static_cast<int>(k >> (bin_bits + 2));
    const auto argument = static_cast<uint64_t>(
        std::ldexp(1.0 + (static_cast<double>(k % (4u << bin_bits)) + 0.5) / (4 << bin_bits), octave));
    if (argument > last) break;
    if (static_cast<double>(argument) < kFar * static_cast<double>(last)) continue;
    const double value = std::ldexp(static_cast<double>(table.at(argument)), -table.value_frac);
    out.worst = std::max(out.worst, std::abs(value - at(static_cast<double>(argument))));
    out.largest = std::max(out.largest, std::abs(value));
  }
  return out;
}

}  // namespace

FittedTable fit_table(const TableRoom& room, const std::function<double(double)>& f) {
  FittedTable best = fitted_with(kBinBits, room, f);
  const int octaves = best.table.index_bits - kBinBits;  // as a power of two
  for (int bits = kBinBits + 1; bits + octaves <= kMostIndex && best.worst > kGood * best.largest; ++bits)
    best = fitted_with(bits, room, f);
  return best;
}

FittedTable fit_window(const WindowRoom& room, const std::function<double(double, size_t)>& f) {
  FittedTable out;
  FixedTable& table = out.table;
  table.shape = TableShape::uniform;
  table.degree = 2;
  table.difference_frac = room.bits / 2;
  table.fraction_bits = kFraction;
  table.index_bits = std::min(kWindowBits, room.bits - kFraction);
  const double bin = std::ldexp(1.0, room.bits - table.index_bits);
  // What is below the last bit of t is cut off: half of that bit is added to what the bins mean.
  const double half = std::ldexp(bin, -kFraction - 1);
  const auto at = [&](double argument, size_t law) {
    // The bin that holds the window's end goes on behind it.
    return f(room.from[law] + std::min(argument, room.width[law] / room.step + bin) * room.step, law) /
           room.unit;
  };
  std::vector<Parabola> bins;
  const size_t entries = size_t{1} << table.index_bits;
  for (size_t law = 0; law < room.from.size(); ++law)
    for (size_t k = 0; k < entries; ++k) {
      const double begin = static_cast<double>(k) * bin + half;
      bins.push_back(through(at(begin, law), at(begin + bin / 2, law), at(begin + bin, law)));
    }
  keep(bins, table);
  for (size_t law = 0; law < room.from.size(); ++law)
    for (size_t k = 0; k < 4 * entries; ++k) {
      const double argument = std::floor((static_cast<double>(k) + 0.5) * bin / 4);
      if (argument * room.step > room.width[law]) break;
      const double value = std::ldexp(
          static_cast<double>(table.at(static_cast<uint64_t>(argument), static_cast<uint32_t>(law))),
          -table.value_frac);
      out.worst = std::max(out.worst, std::abs(value - at(argument, law)));
      out.largest = std::max(out.largest, std::abs(value));
    }
  return out;
}

}  // namespace cuboct
