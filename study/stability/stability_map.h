// SPDX-License-Identifier: MIT
// Maps of where runs are stable: the time step against something else that decides.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "study/stability/stability.h"

namespace cuboct::study {

struct StabilityMap {
  enum class Cell : uint8_t { stable, unstable, refused, body_unstable };
  std::string name;   // of its file: "damping", ...
  std::string title;  // of the picture
  std::string x_label;
  std::vector<double> x;       // ascending, evenly spaced
  std::vector<double> y;       // dt over 2/omega_max of the body: undamped, unstretched, free
  std::vector<Cell> cells;     // [y * x.size() + x]
  std::vector<double> theory;  // [x]: the limit, in the unit of y; nan where there is none
};

// Throws InputError where the scene is too large for hundreds of runs.
void check_maps(const Scene& scene);

// dt against damping and PD stiffness (in doubles), PD stiffness, position_frac and strength_bits (in the
// fixed engine), and strain along `axis` (in doubles). Everything else of the scene but its packing, law and
// boundaries is taken off. Held by force are the scene's PD-held particles, else its lowest layer along
// `axis`. `fineness`: cells along each side; 26 for pictures. `progress` is called with each map's name and
// the part that is done. Columns are run by as many threads as there are cores.
std::vector<StabilityMap> stability_maps(const Scene& scene, const Arch& arch, int axis, int fineness,
                                         const std::function<void(const std::string&, double)>& progress);

}  // namespace cuboct::study
