// SPDX-License-Identifier: MIT
#include "model/solid/crystal_cell.h"

#include <Eigen/Geometry>
#include <cmath>

#include "model/contract/neighbours.h"

namespace cuboct {

double CrystalCell::volume() const { return std::abs(vectors.determinant()); }

CrystalCell CrystalCell::deformed(const Mat3& deformation) const {
  CrystalCell out = *this;
  out.vectors = deformation * vectors;
  for (Vec3& at : out.x) at = deformation * at;
  return out;
}

std::vector<CellImage> images_of(const CrystalCell& cell, double range) {
  Vec3 low = cell.x[0], high = cell.x[0];
  for (const Vec3& x : cell.x) low = low.cwiseMin(x), high = high.cwiseMax(x);
  const double reach = range + (high - low).norm();
  std::array<int, 3> most{};
  for (int k = 0; k < 3; ++k) {
    const Vec3 normal = cell.vectors.col((k + 1) % 3).cross(cell.vectors.col((k + 2) % 3));
    if (cell.repeats[k]) most[k] = static_cast<int>(std::ceil(reach * normal.norm() / cell.volume()));
  }
  low -= Vec3::Constant(range), high += Vec3::Constant(range);
  std::vector<CellImage> images;
  for (int a = -most[0]; a <= most[0]; ++a)
    for (int b = -most[1]; b <= most[1]; ++b)
      for (int c = -most[2]; c <= most[2]; ++c) {
        if (a == 0 && b == 0 && c == 0) continue;
        const Vec3 shift(a, b, c), by = cell.vectors * shift;
        for (uint32_t i = 0; i < cell.x.size(); ++i) {
          const Vec3 at = cell.x[i] + by;
          if (at.within(low, high)) images.push_back({i, shift});
        }
      }
  return images;
}

std::vector<CellBond> bonds_of(const Rule& rule, const CrystalCell& cell) {
  const auto n = static_cast<uint32_t>(cell.x.size());
  std::vector<Vec3> x = cell.x;
  std::vector<uint32_t> owner(n);
  for (uint32_t i = 0; i < n; ++i) owner[i] = i;
  for (const CellImage& image : images_of(cell, rule.cutoff())) {
    x.push_back(cell.x[image.owner] + cell.vectors * image.shift);
    owner.push_back(image.owner);
  }
  CellList list(rule.cutoff(), {});
  list.build(x);
  std::vector<CellBond> bonds;
  list.for_each_pair(x, [&](uint32_t i, uint32_t j, const Vec3& d, double r) {
    if (i >= n && j >= n) return;
    const uint32_t a = owner[i], b = owner[j];
    const BondConstants constants = bond_constants(rule, cell.type[a], cell.type[b], r);
    if (i < n) bonds.push_back({a, b, d, constants});
    if (j < n) bonds.push_back({b, a, -d, constants});
  });
  return bonds;
}

}  // namespace cuboct
