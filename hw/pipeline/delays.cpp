// SPDX-License-Identifier: MIT
#include "hw/pipeline/delays.h"

namespace cuboct::pipeline {
namespace {

// From synth/delays.cpp, which has what each figure was measured on: a LUT 236 ps, a wire to one sink 742 and
// 328 more for each doubling of its sinks, two bits of carry 71, into a chain 447 and 923, out of it 474.
constexpr int kLut = 236, kWire = 742, kDoubling = 328, kIntoChain = 447 + 923, kTwoBits = 71, kOut = 474;
// With two sinks. A tree of LUTs, whose wires have one sink, takes two levels in one.
constexpr int kLevel = kLut + kWire + kDoubling, kTree = kLut + kWire;
constexpr StepDelay kChain{kWire + kDoubling + kIntoChain + kOut, (kTwoBits + 1) / 2, 0};
constexpr StepDelay kGate{kLevel, 0, 0};
// A choice of four is two LUTs and a multiplexer beside them, 256 ps: two places of a shift.
constexpr StepDelay kShift{kTree, 0, (kLevel + 256 + 1) / 2};

constexpr std::array<StepDelay, kKinds> by_kind() {
  std::array<StepDelay, kKinds> of{};
  const auto set = [&](Kind kind, StepDelay delay) { of[static_cast<size_t>(kind)] = delay; };
  for (const Kind kind : {Kind::add, Kind::sub, Kind::less, Kind::less_equal}) set(kind, kChain);
  for (const Kind kind : {Kind::both, Kind::either, Kind::negate, Kind::exclusive}) set(kind, kGate);
  for (const Kind kind : {Kind::equal, Kind::carry, Kind::unfit}) set(kind, {kTree, 0, kTree / 2});
  set(Kind::choose, {kTree, 0, kDoubling});
  set(Kind::leading, {0, 0, kLevel});
  set(Kind::shift_left, kShift);
  set(Kind::rom, {251, 0, 0});
  return of;
}

}  // namespace

const Delays kDelays = {
    .version = 1, .period = 10'000, .margin = 1'000, .clock_to_q = 525, .setup = 130, .of = by_kind()};

}  // namespace cuboct::pipeline
