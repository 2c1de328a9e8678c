// SPDX-License-Identifier: MIT
// How long each kind of step takes: the figures that schedules are made with. They are part of the contract
// on cycles, so another set of them is another version.
#pragma once

#include <array>

#include "hw/pipeline/steps.h"

namespace cuboct::pipeline {

// All in ps: fixed + per_bit w + per_level n, of w bits and n levels. What they are by kind of step:
//   kind                   w                     n
//   add, sub, less,        bits of the wider     0
//     less_equal             input or the result
//   equal                  0                     ceil(log2 bits of the wider input)
//   choose                 0                     ceil(log2 bits), at most 3: sinks of the choice
//   leading                0                     ceil(log2 bits of the input) - 1, at least 1
//   shift_left             0                     bits of the number of places
//   carry                  0                     ceil(log2 low)
//   unfit                  0                     ceil(log2 (bits of the input - low + 1))
//   both, either, negate,  0                     0
//     exclusive
//   product, rom           blocks: `fixed` is what the input needs before the clock
struct StepDelay {
  int fixed = 0, per_bit = 0, per_level = 0;
};

struct Delays {
  int version;
  int period;      // of the clock
  int margin;      // of the period: what placement may add
  int clock_to_q;  // of a register
  int setup;       // of a register, with the wire before it
  std::array<StepDelay, kKinds> of;

  // What steps between two registers may take together.
  int room() const { return period - margin - clock_to_q - setup; }
};

// 100 MHz on an ECP5 of speed grade 6.
extern const Delays kDelays;

}  // namespace cuboct::pipeline
