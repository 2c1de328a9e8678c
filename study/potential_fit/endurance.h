// SPDX-License-Identifier: MIT
// Whether a crystal outlives some time of molecular dynamics, with and without surfaces.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "model/atoms/bond_order/tersoff_parameters.h"

namespace cuboct::bond_fit {

struct Trial {
  int cells = 4;             // cubes of diamond along each edge
  double mass = 0;           // eV ps^2/angstrom^2, of an atom
  double temperature = 300;  // K, of the velocities at the start; half of it goes into the bonds
  double time = 10;          // ps
  double step = 0.001;       // ps
  uint64_t seed = 1;         // of the velocities
};

// The box repeats along x, y and z; x and y; x; not at all.
inline constexpr size_t kBoundaries = 4;
inline constexpr std::array<const char*, kBoundaries> kBoundaryNames = {"xyz", "xy", "x", "none"};

struct Endured {
  std::string fault;       // empty: it outlived the time
  double temperature = 0;  // K, at the end
  double drift = 0;        // of the energy of an atom, eV
};
struct Endurance {
  std::array<Endured, kBoundaries> runs;
  bool stable() const;
  double hottest() const;  // K, of all runs
};

// One run at constant energy from the perfect crystal of edge `edge` (angstrom). It fails where a number is
// not finite, where the energy drifts by a hundredth of k T, where the bonds' energy comes to lie below the
// perfect crystal's, which then is not what the parameters prefer, where the body comes apart, or where an
// atom that lies three bonds below each surface has other neighbours at the end than at the start. `stopped`
// is asked every hundred steps; study::Interrupted where it says so.
Endured endure(const Tersoff& tersoff, double edge, const Trial& trial, size_t boundary,
               const std::function<bool()>& stopped);

}  // namespace cuboct::bond_fit
