// SPDX-License-Identifier: MIT
// Energies of pairs and of particles in joules, from a RealRule's units; in doubles whatever the steps are
// in.
#pragma once

#include <cstdint>
#include <vector>

#include "emu/gpu/real/real_rule.h"

namespace cuboct {
class PairLaw;
struct Rule;  // model/contract/rule.h, which no GPU compiler needs
}  // namespace cuboct
namespace cuboct::gpu {

// Of one law. U over s = (r/cutoff)^2 by cubics through values and slopes at the nodes: the core,
// and beyond it the ends of kEnergyBins ranges of equal length in each octave of s, up to 1. Error inside a
// bin [a, a + h], by Peano's kernel of the cubic Hermite interpolation:
//   |U - table| <= h^4/384 max|U''''| + h^3/192 |J|      derivatives by s,
// with a joint of the law in the bin, where U''' jumps by J; laws here have a continuous f', so U'' does not.
struct EnergyLaw {
  int first = 0;  // of its nodes
  int first_bin = 0;
  double core2 = 0, core_energy = 0, core_slope = 0;  // below: U = core_energy + core_slope (s - core2)
  double cutoff2 = 1;         // of the law, in that of the rule, squared; the end of the bin that holds it
  double contact_energy = 0;  // J, at contact2
};

// A view, as RealRule.
struct EnergyRule {
  EnergyLaw law[kLaws];
  bool several = false;          // laws
  const double* node = nullptr;  // U (J), dU/ds (J); law by law from the bin of the core to its cutoff
  // type_count x type_count; negative: the two only touch. With several laws as many again: the number of
  // each pair's law.
  const double* strength = nullptr;
  double contact2 = 0;  // where those that only touch part, cutoff^2
  int type_count = 1;
  const double* weight = nullptr;  // three per type, J per cutoff: mass * gravity * cutoff
  const double* free = nullptr;    // three per type: 1 along axes that nothing imposes or steers, else 0
  const double* mass = nullptr;    // per type, over the lightest
  double kinetic = 0;              // J: mass/2 (cutoff/dt)^2 of the lightest
};

inline constexpr int kEnergyBits = 12, kEnergyBins = 1 << kEnergyBits;
inline constexpr int kEnergyShift = 20 - kEnergyBits;  // of an upper word: see bin_bits

// Of one pair (count it once), J; 0 from the cutoff on. s = |x_j - x_i|^2 in cutoff^2. Strength included.
CUBOCT_HD inline double pair_energy(const EnergyRule& rule, double s, int type_i, int type_j) {
  const int pair = type_i * rule.type_count + type_j;
  const EnergyLaw& law =
      rule.law[rule.several ? static_cast<int>(rule.strength[rule.type_count * rule.type_count + pair]) : 0];
  if (!(s < law.cutoff2)) return 0;
  double energy;
  if (s < law.core2) {
    energy = law.core_energy + law.core_slope * (s - law.core2);
  } else {
    const int bits = bin_bits(s, kEnergyShift);
    const auto begin_of = [](int bin) {
      return std::bit_cast<double>(static_cast<uint64_t>(static_cast<uint32_t>(bin)) << (32 + kEnergyShift));
    };
    const double a = detail::larger(begin_of(bits), law.core2);
    const double h = detail::smaller(begin_of(bits + 1), law.cutoff2) - a;
    const double* const n = rule.node + law.first + 2 * (bits - law.first_bin);
    const double t = (s - a) / h, left = h * n[1], right = h * n[3], rise = n[2] - n[0];
    energy = n[0] + t * (left + t * (3 * rise - 2 * left - right + t * (left + right - 2 * rise)));
  }
  const double strength = rule.strength[pair];
  if (strength > 0) return energy * strength;
  return s < rule.contact2 ? (law.contact_energy - energy) * strength : 0;
}

// Adds one particle's kinetic energy at the time of its positions, half a step after that of v: v + half of
// what the coming step adds, 0 along imposed axes; and its energy by gravity, -m g.x. `sum`: of its pair
// kicks at x; x in cutoffs in the scene's coordinates; u may be null unless rule.pd.
template <class Real>
CUBOCT_HD void add_particle_energy(const RealRule<Real>& rule, const EnergyRule& energy, const Real sum[3],
                                   const double x[3], const Real v[3], const Real u[3], int type,
                                   double& kinetic, double& gravity) {
  const RealType<Real>& of = rule.types[type];
  for (int a = 0; a < 3; ++a) {
    double now = static_cast<double>(v[a]);
    if (!of.imposed[a]) now += static_cast<double>(velocity_gain(of, sum[a], v[a], u, a)) / 2;
    kinetic += energy.kinetic * energy.mass[type] * now * now;
    gravity -= energy.weight[3 * type + a] * x[a];
  }
}

// Makes an EnergyRule and owns its arrays on the host.
struct EnergyTables {
  explicit EnergyTables(const Rule& rule);

  std::vector<double> node, strength, weight, free, mass;

  EnergyRule rule() const {
    return rule(node.data(), strength.data(), weight.data(), free.data(), mass.data());
  }
  EnergyRule rule(const double* node_copy, const double* strength_copy, const double* weight_copy,
                  const double* free_copy, const double* mass_copy) const {
    EnergyRule view = rule_;
    view.node = node_copy;
    view.strength = strength_copy;
    view.weight = weight_copy;
    view.free = free_copy;
    view.mass = mass_copy;
    return view;
  }

 private:
  EnergyLaw take_law(const PairLaw& law, double cutoff);

  EnergyRule rule_;
};

}  // namespace cuboct::gpu
