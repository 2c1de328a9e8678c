// SPDX-License-Identifier: MIT
#include "model/rules/reference_bonds.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "model/base/error.h"
#include "model/base/mat3.h"
#include "model/contract/neighbours.h"

namespace cuboct {
namespace {

constexpr double kTolerance = 1e-6;  // of the reach

struct Half {
  uint32_t i, j;
  Vec3 d;  // from i to j
};

std::vector<Half> halves_of(std::span<const Vec3> x, const Periodic& periodic, double reach,
                            const std::vector<Slit>& slits) {
  std::vector<Half> halves;
  CellList cells(reach * (1 + kTolerance), periodic);
  cells.build(x);
  cells.for_each_pair(x, [&](uint32_t i, uint32_t j, const Vec3& d, double) {
    const bool cut = std::ranges::any_of(slits, [&](const Slit& slit) { return slit.cuts(x[i], d); });
    if (!cut) halves.push_back({i, j, d});
  });
  return halves;
}

}  // namespace

// from + q d = corner + s along + t across.
bool Slit::cuts(const Vec3& from, const Vec3& d) const {
  Mat3 m;
  m << eigen(along), eigen(across), -eigen(d);
  const double volume = m.determinant();
  if (std::abs(volume) < 1e-12 * along.norm() * across.norm() * d.norm()) return false;
  const Vec3 at = m.inverse() * (from - corner);
  return at[0] >= 0 && at[0] <= 1 && at[1] >= 0 && at[1] <= 1 && at[2] >= 0 && at[2] <= 1;
}

std::string Slit::told() const {
  const auto text = [](const Vec3& r) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", r[0], r[1], r[2]); };
  return fmt::format("from {} m along {} and {} m", text(corner), text(along), text(across));
}

ReferenceBonds reference_bonds(std::span<const Vec3> x, const Periodic& periodic, double reach,
                               const std::vector<Slit>& slits) {
  const std::vector<Half> halves = halves_of(x, periodic, reach, slits);
  ReferenceBonds bonds;
  bonds.first.assign(x.size() + 1, 0);
  for (const Half& half : halves) ++bonds.first[half.i + 1], ++bonds.first[half.j + 1];
  std::partial_sum(bonds.first.begin(), bonds.first.end(), bonds.first.begin());
  struct End {
    uint32_t other;
    Vec3 d;
  };
  std::vector<End> ends(2 * halves.size());
  std::vector<uint64_t> next(bonds.first.begin(), bonds.first.end() - 1);
  for (const Half& half : halves) {
    ends[next[half.i]++] = {half.j, half.d};
    ends[next[half.j]++] = {half.i, -half.d};
  }
  for (size_t i = 0; i < x.size(); ++i)
    std::sort(ends.begin() + static_cast<int64_t>(bonds.first[i]),
              ends.begin() + static_cast<int64_t>(bonds.first[i + 1]),
              [](const End& a, const End& b) { return a.other < b.other; });
  bonds.other.reserve(ends.size());
  bonds.vector.reserve(ends.size());
  for (const End& end : ends) bonds.other.push_back(end.other), bonds.vector.push_back(end.d);
  return bonds;
}

}  // namespace cuboct
