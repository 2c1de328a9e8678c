// SPDX-License-Identifier: MIT
// A law's energy at many distances, in vectors.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "model/contract/rule.h"

namespace cuboct {

// J: law.energy() of each r (m), the same bits, without a call for each.
void energies_of(const PairLaw& law, std::span<const double> r, std::span<double> energy);

// Around the law proper: 0 from the cutoff on, and below the core the energy of a linear force.
struct EnergyEnds {
  double core, cutoff;             // m
  double core_energy, core_slope;  // J, N/m
};

// Of the law proper 4 epsilon s (s - 1) - end_energy - end_force (end - r), s = (sigma/r)^6.
struct LennardJonesEnergy {
  double sigma, epsilon4, end, end_energy, end_force;
};

// On piece k, with t = (r - start)/width: after + width (whole - t (c0 + t (c1 + t (c2 + t c3)))).
struct CubicEnergy {
  enum : uint8_t { start, width, after, whole, c0, c1, c2, c3, terms };
  std::array<std::vector<double>, terms> term;  // [term][piece]; pieces follow one another
};

void energies_of(const LennardJonesEnergy& law, const EnergyEnds& ends, std::span<const double> r,
                 std::span<double> energy);
void energies_of(const CubicEnergy& law, const EnergyEnds& ends, std::span<const double> r,
                 std::span<double> energy);

}  // namespace cuboct
