// SPDX-License-Identifier: MIT
// What a plan leaves out, as its scene does not use it, and what that saves.
#pragma once

#include <optional>
#include <vector>

#include "hw/plan/plan.h"
#include "model/scene/scene.h"

namespace cuboct {

struct Spared {
  struct Part {
    size_t index;                  // into Carry::kNames
    int halo_bits, particle_bits;  // that the records would be longer by
  };
  std::vector<Part> parts;        // but the empty cells; pair scales with the types that they need
  uint64_t box = 0, missing = 0;  // cells of the bounding box, and those that the lattice lacks
  Words all;                      // with every part
};
Spared spared(const Plan& plan);

// The formats and records that a tenth of the accuracy would take. Nothing where the arch sets a format, or
// where they are those of the plan.
struct LooserFormats {
  double accuracy;
  Widths widths;
  Words words;
};
std::optional<LooserFormats> looser_formats(const Scene& scene, const Plan& plan);

}  // namespace cuboct
