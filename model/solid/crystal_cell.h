// SPDX-License-Identifier: MIT
// Matter that repeats: some particles and up to three vectors, of any angles and lengths, also below the
// cutoff.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "model/base/mat3.h"
#include "model/contract/bond.h"

namespace cuboct {

struct CrystalCell {
  Mat3 vectors = Mat3::Identity();  // columns, m; the cell's extent where it does not repeat
  std::array<bool, 3> repeats{true, true, true};
  std::vector<Vec3> x;        // m
  std::vector<uint8_t> type;  // index into Rule::types
  // In which bonds that last were made; null: as it stands.
  std::shared_ptr<const CrystalCell> packed = nullptr;

  double volume() const;  // m^3
  // The same particles and vectors under x -> deformation * x.
  CrystalCell deformed(const Mat3& deformation) const;
};

// One image of a particle: at x[owner] + vectors * shift.
struct CellImage {
  uint32_t owner;
  Vec3 shift;  // whole numbers
};
// All that stand within `range` (m) of the box around the cell's own particles, without those themselves.
std::vector<CellImage> images_of(const CrystalCell& cell, double range);

// A bond of a particle of the cell; each bond within the cell comes once from each end.
struct CellBond {
  uint32_t from, to;  // `to` owns the image at which the bond ends
  Vec3 d;             // m, from `from` to the image
  BondConstants constants;
};
std::vector<CellBond> bonds_of(const Rule& rule, const CrystalCell& cell);

}  // namespace cuboct
