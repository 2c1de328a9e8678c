// SPDX-License-Identifier: MIT
// What `cuboct energy` found, as text and as JSON.
#pragma once

#include <string>
#include <vector>

#include "hw/cost/energy.h"

namespace cuboct {

// In one technology.
struct EnergyFinding {
  std::string technology, title;
  Energy energy;
  Area area;
  std::vector<Sensitivity> bars;
};

// One machine of a scene.
struct EnergyMachine {
  std::string arch;  // its name
  uint64_t nodes = 0, steps = 0, cycles = 0, updates = 0;
  MachineEvents events;
  std::vector<MemoryTraffic> traffic;
  std::vector<EnergyFinding> findings;

  // Of a particle's step, J; of the run at the clock, W.
  Band joules_per_update(const Energy& energy) const;
  Band watts(const Energy& energy, double clock) const;
};

struct EnergyFindings {
  std::string scene, link;  // link: empty, wires on chip
  double clock = 0;         // Hz
  std::vector<EnergyMachine> machines;
};

// "1.2 to 3.4 nJ".
std::string band_text(const Band& band, const std::string& unit);
// Of two bands: "the first takes less", "the second takes less", or "within the band".
std::string order_of(const Band& first, const Band& second);

std::string text_of(const EnergyFindings& found);
std::string json_of(const EnergyFindings& found);

}  // namespace cuboct
