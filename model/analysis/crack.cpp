// SPDX-License-Identifier: MIT
#include "model/analysis/crack.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/analysis/clusters.h"
#include "model/contract/neighbours.h"
#include "model/rules/rounds_rule.h"

namespace cuboct {
namespace {

// Of all pairs of types, squared, m^2.
class Reach {
 public:
  explicit Reach(const Rule& rule) : types_(static_cast<int>(rule.types.size())) {
    for (int i = 0; i < types_; ++i)
      for (int j = 0; j < types_; ++j) squared_.push_back(std::pow(bond_reach(rule, i, j), 2));
    least_ = *std::ranges::min_element(squared_);
  }
  double squared(int i, int j) const { return squared_[static_cast<size_t>(i * types_ + j)]; }
  double least() const { return least_; }

 private:
  int types_;
  std::vector<double> squared_;
  double least_;
};

}  // namespace

double bond_reach(const Rule& rule, int type_i, int type_j) {
  if (const RoundsRule* rounds = rule.rounds.get()) return rounds->bond_reach();
  return rule.only_touch(type_i, type_j) ? 0 : rule.law_of(type_i, type_j).cutoff();
}

CrackMeter::CrackMeter(const Probe& probe, const Periodic& periodic, const std::vector<Vec3>& initial)
    : probe_(probe), periodic_(periodic), repeats_(!periodic.extent.isZero(0)) {
  x_.reserve(probe.set.ids.size());
  for (const uint32_t id : probe.set.ids) x_.push_back(initial[id]);
  for (size_t at = 0; at < probe.begin.size(); ++at) {
    ahead_.push_back(nearest_image(probe.begin[at] - x_[at], periodic));
    x_[at] += ahead_[at];
  }
  CellList cells(probe.bond_length, periodic);
  cells.build(x_);
  cells.for_each_pair(x_, [&](uint32_t i, uint32_t j, const Vec3&, double r) {
    if (r <= bond_reach(*probe_.rule, type(i), type(j))) bonds_.push_back({std::min(i, j), std::max(i, j)});
  });
  std::sort(bonds_.begin(), bonds_.end());
}

std::vector<CrackMeter::Bond> CrackMeter::broken(const std::vector<Vec3>& moved) const {
  std::vector<Vec3> u;
  u.reserve(x_.size());
  for (const uint32_t id : probe_.set.ids) u.push_back(moved[id]);
  for (size_t at = 0; at < ahead_.size(); ++at) u[at] -= ahead_[at];
  const Reach reach(*probe_.rule);
  std::vector<Bond> gone;
  for (const Bond& bond : bonds_) {
    const double r2 = (initial(bond) + u[bond.j] - u[bond.i]).squaredNorm();
    if (r2 > reach.least() && r2 > reach.squared(type(bond.i), type(bond.j))) gone.push_back(bond);
  }
  return gone;
}

// Broken bonds belong to one cluster where they share a particle, or where a bond, broken or not, joins their
// particles. The crack is the cluster of most broken bonds, the first of equals; one by itself is none.
double CrackMeter::length(const std::vector<Bond>& broken) const {
  if (broken.size() < 2) return 0;
  std::vector<char> torn(x_.size(), 0);
  for (const Bond& bond : broken) torn[bond.i] = torn[bond.j] = 1;
  Clusters clusters(x_.size());
  for (const Bond& bond : bonds_)
    if (torn[bond.i] && torn[bond.j]) clusters.join(bond.i, bond.j);
  std::vector<uint32_t> count(x_.size(), 0);
  uint32_t most = 1, crack = 0;
  for (const Bond& bond : broken) ++count[clusters.find(bond.i)];
  for (uint32_t at = 0; at < count.size(); ++at)
    if (count[at] > most) most = count[at], crack = at;
  if (most < 2) return 0;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Bond& bond : broken) {
    if (clusters.find(bond.i) != crack) continue;
    const double middle = (x_[bond.i] + initial(bond) / 2).dot(probe_.axis);
    low = std::min(low, middle), high = std::max(high, middle);
  }
  return std::max(0.0, high - probe_.start.value_or(low));
}

CrackMeter::Found CrackMeter::look(const std::vector<Vec3>& moved) const {
  const std::vector<Bond> gone = broken(moved);
  Found found{gone.size(), length(gone), 0};
  for (const Bond& bond : gone)
    found.energy -= probe_.rule->pair_energy(type(bond.i), type(bond.j), initial(bond).norm());
  return found;
}

}  // namespace cuboct
