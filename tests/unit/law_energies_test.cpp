// SPDX-License-Identifier: MIT
// Energies of many distances are those of the law, bit for bit.
#include "model/contract/law_energies.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/contract/law.h"

namespace cuboct {
namespace {

TEST(LawEnergies, AreThoseOfTheLawBitForBit) {
  std::vector<double> at{0.5, 0.6, 0.75, 0.8, 1, 1.2, 1.25, 1.5, 1.75, 2},
      force{4, 3, 1.5, 1, 0, -1, -1, -0.5, -0.1, 0};
  const std::vector<std::shared_ptr<const PairLaw>> laws{
      lennard_jones(1.7, 0.9, 2.25, 0.8, Smoothing::none),
      lennard_jones(1.7, 0.9, 2.25, 0.8, Smoothing::linear),
      preset_law("elastic", 1.1, 3, 1),
      preset_law("ductile", 1.1, 3, 1),
      preset_law("viscous", 1.1, 3, 0.7),
      spline_law(at, force, Interpolation::monotone_cubic, 0.55),
      spline_law(at, force, Interpolation::b_spline, 0.55)};
  for (size_t n = 0; n < laws.size(); ++n) {
    const PairLaw& law = *laws[n];
    // Below the core, at each joint and beside it, and beyond the cutoff; 1999 are no whole vectors.
    std::vector<double> r{law.core(), law.cutoff(), std::nextafter(law.core(), 0),
                          std::nextafter(law.cutoff(), 0)};
    r.insert(r.end(), at.begin(), at.end());
    for (int k = 1; r.size() < 1999; ++k) r.push_back(1.05 * law.cutoff() * k / 1999);
    std::vector<double> energy(r.size(), -1);
    energies_of(law, r, energy);
    for (size_t k = 0; k < r.size(); ++k)
      ASSERT_EQ(energy[k], law.energy(r[k])) << "law " << n << " at " << r[k];
  }
}

}  // namespace
}  // namespace cuboct
