// SPDX-License-Identifier: MIT
// What `cuboct-gpu bench` measures: the scenes of scenes/bench, built in, in three sizes and arithmetics.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cuboct::gpu {

extern const char kBenchBlock[];   // block_32k.toml
extern const char kBenchMelt[];    // lj_melt.toml
extern const char kBenchSolid[];   // lj_solid.toml
extern const char kBenchLjArch[];  // lj_arch.toml, of melt and solid

struct BenchScene {
  enum class Kind : uint8_t { block, melt, solid };
  Kind kind = Kind::block;
  int cells =
      40;  // cubic cells of four particles along each side; at least 3, so that a ring holds two cutoffs
  bool damped = false;  // ratio 0.1, block alone

  uint64_t particles() const { return 4 * static_cast<uint64_t>(cells) * cells * cells; }
  // Before the timing: a melt must have melted, and lists have taken the skin that then lasts.
  uint64_t settle_steps() const { return kind == Kind::melt ? 1000 : 100; }
  std::string text() const;  // TOML
  std::string arch() const;  // TOML; empty: the defaults
  bool operator==(const BenchScene&) const = default;
};

struct BenchRow {
  BenchScene scene;
  const char* arithmetic = "";  // "float", "double", "fixed"
  std::string name;             // "damped_2m.float"
  std::string what;             // for a list
};

// Those of one scene in a row.
std::vector<BenchRow> bench_rows();
// The row `name`, or those that begin with it and '_' or '.'; all where it is empty. InputError where there
// is none.
std::vector<BenchRow> choose_rows(const std::vector<BenchRow>& rows, const std::string& name);

}  // namespace cuboct::gpu
