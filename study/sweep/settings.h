// SPDX-License-Identifier: MIT
// How a scene is computed: everything that a study may vary.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hw/arch/arch.h"
#include "model/config/changes.h"
#include "model/real/reference.h"
#include "model/scene/scene.h"

namespace cuboct::study {

// What a study starts from: the texts of a scene and of an arch, and where they came from.
struct Base {
  std::string scene_path, scene_text;
  std::string arch_path, arch_text;  // empty: the defaults
};
// Reads both files; throws InputError where one cannot be read or holds no scene (arch).
Base read_base(const std::string& scene_path, const std::string& arch_path);
// Whether the scene is in reduced units: its lengths and times are plain numbers.
bool is_reduced(const Base& base);

enum class Arithmetic : uint8_t { float64, float32, fixed };

// By Arithmetic, as studies, keys and results call it: "float64", "float32", "fixed".
const std::vector<std::string>& arithmetic_names();
inline const std::string& name_of(Arithmetic arithmetic) {
  return arithmetic_names()[static_cast<size_t>(arithmetic)];
}

struct Settings {
  std::string engine = "lattice";  // "reference" (float64, float32), "lattice" (fixed) or "gpu" (all three);
                                   // points of other engines come from elsewhere (store.h)
  Arithmetic arithmetic = Arithmetic::fixed;
  Integrator integrator = Integrator::semi_implicit_euler;  // fixed knows this one only
  int threads = 1;                                          // of the host; the gpu engine knows none
  std::vector<Change> scene, arch;  // from the base, e.g. {"run.dt_safety", "0.1"}, {"widths.guard", "6"}

  // What the numbers depend on: all of it, but for the threads of a fixed engine. One line, the same for the
  // same settings; the key of results.
  std::string numbers_key() const;
  // All of it. The key of speeds.
  std::string key() const;
  bool operator==(const Settings&) const = default;
};
// Of an arithmetic where no engine is named.
inline const char* default_engine(Arithmetic arithmetic) {
  return arithmetic == Arithmetic::fixed ? "lattice" : "reference";
}
bool on_gpu(const Settings& settings);

// The resolved scene and arch of some settings. Throws InputError: the scene or arch that results is wrong
// (its text says which key), or engine and arithmetic do not go together.
struct Case {
  Settings settings;
  Scene scene;
  Arch arch;
  std::string scene_text, arch_text;  // as changed
};
Case resolve(const Base& base, const Settings& settings);

}  // namespace cuboct::study
