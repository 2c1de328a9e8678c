// SPDX-License-Identifier: MIT
// Machines of others, and what was measured of CPUs and GPUs: marks on the charts, from a file with sources
// (technologies/machines.toml).
#pragma once

#include <string>
#include <vector>

#include "hw/cost/technology.h"

namespace cuboct::study {

struct Peer {
  std::string name;
  std::string what;      // scene and rule
  std::string known;     // "measured", "published", "power assumed"
  double particles = 0;  // of its scene
  double rate = 0;       // particle-steps/s
  Band joules;           // of a particle-step
  std::string source;
};

// Throws InputError at the place of what is wrong: no source, low above high, a power without a rate.
std::vector<Peer> parse_peers(const std::string& text, const std::string& path);

}  // namespace cuboct::study
