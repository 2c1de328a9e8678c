// SPDX-License-Identifier: MIT
// What a plan carries although its scene does not use it. The bits of a run stay the same; words, latencies
// and the paths that engines choose become those of a plan that needs it. For measuring what leaving it out
// saves.
#pragma once

#include <array>

#include "model/contract/fixed_rule.h"

namespace cuboct {

struct Carry {
  bool damping = false;      // a table of zeros, and velocities in the halo record
  bool scales = false;       // pair scales, all 1
  bool types = false;        // a bit for the type, where one type would do
  bool pd = false;           // displacements, of no type
  bool masses = false;       // a weight of each type, all 1
  bool third_axis = false;   // in a flat scene
  bool empty_nodes = false;  // the lattice has every cell of its bounding box

  static constexpr int kCount = 7;
  // In the order of the fields: the names that an arch file uses.
  static constexpr std::array<const char*, kCount> kNames{"damping", "scales",     "types",      "pd",
                                                          "masses",  "third_axis", "empty_nodes"};
  bool& operator[](size_t k);
  static Carry everything();
};

// All but the empty cells, which are no part of a rule. Two more things can stop a run then: a relative
// velocity inside the cutoff that does not fit `relative_velocity_bits`, as in any damped plan, and a
// strength that does not fit.
FixedRule carrying(FixedRule rule, const Carry& carry);

}  // namespace cuboct
