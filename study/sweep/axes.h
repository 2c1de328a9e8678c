// SPDX-License-Identifier: MIT
// The keys of [[sweep]] and [search]: what each sets.
#pragma once

#include <vector>

#include "model/config/config.h"
#include "study/sweep/study.h"

namespace cuboct::study {

// Which keys a table has: those that errors depend on, or those of a machine in fixed arithmetic, which are
// the same less the engine's own, and the rest of the arch file's.
enum class KeysOf : uint8_t { errors, machines };

// The axes of a table, in the order of docs/user/study.md: those of the table's keys that are there, then its
// `presets`, then what stands in its `set`. Every value is tried on the base by itself: InputError at the
// value where it makes no scene or arch, but for those that may turn out impossible only together with others
// (pitch, cutoff, dt, cell_edge). Keys that the caller asked for before stay its own.
std::vector<Axis> read_axes(const ConfigTable& table, const Base& base, KeysOf keys = KeysOf::errors);

// All that stands in a table of changes, [change] or `set`: {"run.duration", "\"0.3 ms\""}, ... as TOML text,
// in the order of the file. Keys of the arch begin with "arch.".
struct Leaf {
  std::string key;
  ConfigValue value;
};
std::vector<Leaf> leaves(const ConfigTable& table);
std::string toml_text(const ConfigValue& value);

}  // namespace cuboct::study
