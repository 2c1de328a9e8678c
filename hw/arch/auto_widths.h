// SPDX-License-Identifier: MIT
// The formats of the datapath that a scene needs, where the arch leaves them to us: a function of scene and
// arch alone. docs/reference/numeric.md, "Widths by themselves", derives the rules.
#pragma once

#include <string>
#include <vector>

#include "hw/arch/arch.h"
#include "model/scene/scene.h"

namespace cuboct {

// Why a format is as wide as it is.
struct WidthReason {
  std::string key;  // of the arch file, "difference_frac"
  int bits = 0;     // as taken
  // What the scene's accuracy asks for: more than `bits` where no format is as wide, or where the arch file
  // says less.
  int wanted = 0;
  bool asked = false;  // the arch file says so
  std::string why;
};

struct AutoWidths {
  Widths widths;  // strength_bits 0: quantise chooses, with `half_unit`
  // N: half a unit of the force table, at the cutoff, may be worth so much. Infinite where the scene does not
  // tell.
  double half_unit = 0;
  std::vector<WidthReason> reasons;
};

// `edge`: of a cell, m. Keys that `asked` sets (not kAutomatic) are kept. `accuracy`: 0 is the scene's.
AutoWidths auto_widths(const Scene& scene, double edge, const Widths& asked, double accuracy = 0);

// What the widths taken cannot do to the scene's accuracy, one line each.
std::vector<std::string> width_warnings(const Scene& scene, double edge, const AutoWidths& taken,
                                        const FixedRule& rule);

}  // namespace cuboct
