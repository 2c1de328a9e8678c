// SPDX-License-Identifier: MIT
// The scenes that `cuboct bench` runs: those of scenes/bench, built in, the block in other sizes.
#pragma once

#include <memory>
#include <string>

#include "hw/plan/setup.h"

namespace cuboct {

extern const char kBenchBlock[];       // block_32k.toml
extern const char kBenchImpact[];      // impact_1m.toml
extern const char kBenchImpactArch[];  // impact_arch.toml

struct BenchScene {
  int cells = 20;       // cubic cells of four particles along each side; of the impact: 63
  bool damped = false;  // ratio 0.1
  bool impact = false;  // the struck corner instead of the warm block

  uint64_t particles() const { return 4 * static_cast<uint64_t>(cells) * cells * cells; }
  std::string text() const;  // TOML
  std::string arch() const;  // TOML; empty: the defaults
  bool operator==(const BenchScene&) const = default;
};

struct BenchCase {
  Scene scene;
  Plan plan;
};
// The latest is kept, so that benchmarks that follow one another share it.
std::shared_ptr<const BenchCase> make_case(const BenchScene& scene);

// Whether a run of so many particles fits into the memory that is free now, at 300 bytes each (measured with
// ten million: 165, scene and engine together).
bool fits_in_memory(uint64_t particles);

}  // namespace cuboct
