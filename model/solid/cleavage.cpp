// SPDX-License-Identifier: MIT
#include "model/solid/cleavage.h"

#include <cmath>
#include <limits>

namespace cuboct {
namespace {

struct CutBond {
  Vec3 d;         // m
  double energy;  // J/m^3, that parts it, over the cell's volume; half, as each bond comes from both ends
};

std::vector<CutBond> cut_bonds(const Rule& rule, const CrystalCell& cell) {
  std::vector<CutBond> bonds;
  for (const CellBond& bond : bonds_of(rule, cell)) {
    const double energy = -rule.pair_energy(cell.type[bond.from], cell.type[bond.to], bond.d.norm());
    if (energy != 0) bonds.push_back({bond.d, energy / (2 * cell.volume())});
  }
  return bonds;
}

double energy_of(const std::vector<CutBond>& bonds, const Vec3& n) {
  double sum = 0;
  for (const CutBond& bond : bonds) sum += std::abs(n.dot(bond.d)) * bond.energy;
  return sum;
}

// Uphill until no bond changes its side.
Vec3 strongest_near(const std::vector<CutBond>& bonds, Vec3 n) {
  Vec3 last = Vec3::Zero();
  for (size_t turn = 0; turn < bonds.size() && (n - last).norm() > 1e-12; ++turn) {
    last = n;
    Vec3 gradient = Vec3::Zero();
    for (const CutBond& bond : bonds) gradient += std::copysign(bond.energy, n.dot(bond.d)) * bond.d;
    n = gradient.normalized();
  }
  return n;
}

}  // namespace

double cleavage_energy(const Rule& rule, const CrystalCell& cell, const Vec3& normal) {
  return energy_of(cut_bonds(rule, cell), normal.normalized());
}

CleavagePlanes cleavage_planes(const Rule& rule, const CrystalCell& cell) {
  const std::vector<CutBond> bonds = cut_bonds(rule, cell);
  CleavagePlanes planes{Vec3::UnitX(), Vec3::UnitX()};
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const CutBond& a : bonds)
    for (const CutBond& b : bonds) {
      const Vec3 across = a.d.cross(b.d);
      if (across.norm() <= 1e-9 * a.d.norm() * b.d.norm()) continue;
      const Vec3 weak = across.normalized(), strong = strongest_near(bonds, weak + a.d.normalized());
      const double low = energy_of(bonds, weak), high = energy_of(bonds, strong);
      // The first of equals.
      if (low < least * (1 - 1e-9)) least = low, planes.weakest = weak;
      if (high > most * (1 + 1e-9)) most = high, planes.strongest = strong;
    }
  return planes;
}

}  // namespace cuboct
