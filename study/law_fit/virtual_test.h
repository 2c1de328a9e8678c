// SPDX-License-Identifier: MIT
// One tensile test of a scene with some law in place of its own.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "study/law_fit/drawn_law.h"
#include "study/sweep/settings.h"

namespace cuboct::fit {

struct Test {
  study::Base base;
  std::string engine;          // "lattice" or "reference"
  std::string curve, against;  // of stress and strain
  double last_strain = 0;      // the run ends where this is read
};

struct Tested {
  std::vector<double> strain, stress;  // -, Pa: readings; of a run in motion the stress is its running mean
  uint64_t particle_steps = 0;         // of a static run: force evaluations times particles
  std::string stop;                    // why the run ended early, or there was none
  bool refused = false;                // there was none
};

// The scene's text with the law.
std::string scene_with(const study::Base& base, const LawPoints& law);

// On one thread. Throws study::Interrupted; a law that no run can have is an answer, no exception.
Tested run_test(const Test& test, const LawPoints& law);

}  // namespace cuboct::fit
