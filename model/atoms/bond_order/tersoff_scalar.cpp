// SPDX-License-Identifier: MIT
// The first sweep for several elements: the formulas of tersoff_terms.h, an atom after another.
#include <algorithm>

#include "model/atoms/bond_order/tersoff_kernel.h"

namespace cuboct {
namespace {

using Term = TersoffTerm<double>;

struct Bond {
  Vec3 unit, partial;
  double r = 0;
  size_t element = 0, slot = 0;
};

// An atom's neighbours within its cutoff.
std::vector<Bond> bonds_of(const Tersoff& tersoff, const TersoffSweep& sweep, size_t atom) {
  const BondList& list = *sweep.list;
  const size_t lanes = list.lanes(), group = atom / lanes;
  const Vec3 home(sweep.x + 4 * atom);
  std::vector<Bond> bonds;
  for (size_t row = list.first_row()[group]; row < list.first_row()[group + 1]; ++row) {
    const size_t slot = row * lanes + atom % lanes;
    std::fill_n(sweep.partial + 4 * slot, 4, 0.0);
    const double* const other = sweep.x + list.entry()[slot];
    const Vec3 d = Vec3(other) - home;
    const double r = d.norm();
    if (r > 0 && r < tersoff.cutoff())
      bonds.push_back({d / r, Vec3::Zero(), r, static_cast<size_t>(other[3]), slot});
  }
  return bonds;
}

// Calls on(term, other bond) for those that count in the zeta of bonds[j].
template <class On>
void for_each_other(const Tersoff& tersoff, std::vector<Bond>& bonds, size_t element, size_t j,
                    const On& on) {
  for (size_t k = 0; k < bonds.size(); ++k) {
    if (k == j) continue;
    const Term& t = tersoff.term(element, bonds[j].element, bonds[k].element);
    if (bonds[k].r < t.R + t.D) on(t, bonds[k]);
  }
}

double bond_energy(const Tersoff& tersoff, std::vector<Bond>& bonds, size_t element, size_t j) {
  Bond& bond = bonds[j];
  const Term& t = tersoff.term(element, bond.element, bond.element);
  const auto fc = tersoff_cutoff(t, bond.r);
  if (fc.value == 0) return 0;
  double zeta = 0;
  for_each_other(tersoff, bonds, element, j, [&](const Term& triple, Bond& other) {
    zeta += tersoff_cutoff(triple, other.r).value * tersoff_angle(triple, bond.unit.dot(other.unit)).value *
            tersoff_stretch(triple, bond.r - other.r).value;
  });
  const auto repulsion = tersoff_repulsion(t, bond.r), attraction = tersoff_attraction(t, bond.r);
  const auto b = tersoff_order(t, zeta);
  const double depth = repulsion.value - b.value * attraction.value;
  bond.partial +=
      (fc.slope * depth + fc.value * (repulsion.slope - b.value * attraction.slope)) / 2 * bond.unit;
  const double p = -fc.value * attraction.value * b.slope / 2;
  for_each_other(tersoff, bonds, element, j, [&](const Term& triple, Bond& other) {
    const double cosine = bond.unit.dot(other.unit);
    const auto cut = tersoff_cutoff(triple, other.r);
    const auto g = tersoff_angle(triple, cosine);
    const auto stretch = tersoff_stretch(triple, bond.r - other.r);
    const double turning = p * cut.value * g.slope * stretch.value;
    const double pull = p * cut.value * g.value * stretch.slope;
    bond.partial += pull * bond.unit + turning / bond.r * (other.unit - cosine * bond.unit);
    other.partial += (p * cut.slope * g.value * stretch.value - pull) * other.unit +
                     turning / other.r * (bond.unit - cosine * other.unit);
  });
  return fc.value * depth / 2;
}

}  // namespace

void tersoff_scalar_partials(const Tersoff& tersoff, const TersoffSweep& sweep, size_t first, size_t last) {
  const size_t lanes = sweep.list->lanes();
  for (size_t atom = first * lanes; atom < last * lanes; ++atom) {
    const auto element = static_cast<size_t>(sweep.x[4 * atom + 3]);
    std::vector<Bond> bonds = bonds_of(tersoff, sweep, atom);
    double energy = 0;
    for (size_t j = 0; j < bonds.size(); ++j) energy += bond_energy(tersoff, bonds, element, j);
    Vec3 force = Vec3::Zero();
    Mat3 virial = Mat3::Zero();
    for (const Bond& bond : bonds) {
      std::ranges::copy(bond.partial, sweep.partial + 4 * bond.slot);
      force += bond.partial;
      virial += bond.r * bond.unit * bond.partial.transpose();
    }
    std::ranges::copy(force, sweep.force + 4 * atom);
    sweep.force[4 * atom + 3] = 0;
    if (sweep.energy == nullptr) continue;
    sweep.energy[atom] = energy;
    const Mat3 even = (virial + virial.transpose()) / 2;
    const double voigt[6] = {even(0, 0), even(1, 1), even(2, 2), even(1, 2), even(0, 2), even(0, 1)};
    for (size_t k = 0; k < 6; ++k) sweep.virial[(atom / lanes * 6 + k) * lanes + atom % lanes] = voigt[k];
  }
}

}  // namespace cuboct
