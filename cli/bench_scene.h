// SPDX-License-Identifier: MIT
// The scenes that `cuboct bench` runs: scenes/bench/block_32k.toml, which is built in, in other sizes and moods.
#pragma once

#include <memory>
#include <string>

#include "cli/command.h"

namespace cuboct {

extern const char kBenchBlock[];

struct BenchScene {
  int cells = 20;       // cubic cells of four particles along each side
  bool damped = false;  // ratio 0.1
  bool impact = false;  // at rest but for one corner, which is hit, instead of warm

  uint64_t particles() const { return 4 * static_cast<uint64_t>(cells) * cells * cells; }
  std::string text() const;  // TOML
  bool operator==(const BenchScene&) const = default;
};

// Scene and plan, without a State. The latest is kept, so that benchmarks that follow one another share it.
std::shared_ptr<const Loaded> load_bench(const BenchScene& scene);

// Whether a run of so many particles fits into the memory that is free now, at 600 bytes each (measured: 500, scene
// and engine together).
bool fits_in_memory(uint64_t particles);

}  // namespace cuboct
