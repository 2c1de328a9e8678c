// SPDX-License-Identifier: MIT
// Strain of each particle from how its initial neighbourhood moved.
//
// Source: M. L. Falk, J. S. Langer, "Dynamics of viscoplastic deformation in amorphous solids", Phys. Rev. E
// 57, 7192 (1998): the affine map F that best carries the initial neighbour vectors into the present ones,
// and what it leaves (D2min). F. Shimizu, S. Ogata, J. Li, "Theory of shear banding in metallic glasses and
// molecular dynamics calculations", Mater. Trans. 48, 2923 (2007): the Lagrangian strain (F^T F - 1)/2 of
// that map.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "model/base/mat3.h"
#include "model/contract/nearest_image.h"
#include "model/contract/rule.h"

namespace cuboct {

struct LocalStrain {
  Mat3 gradient = Mat3::Identity();  // F: present neighbour vector = F * initial neighbour vector
  double residual = 0;               // m^2, D2min: sum over the neighbours of what F leaves, squared
  int neighbours = 0;

  // Green-Lagrange strain.
  Mat3 lagrangian() const { return 0.5 * (gradient.transpose() * gradient - Mat3::Identity()); }
  // Elongation of a fibre that lay along `axis`: |F e| - 1 = sqrt(1 + 2 lagrangian(axis, axis)) - 1.
  double axial(int axis) const { return gradient.col(axis).norm() - 1; }
};

// What the viewers' frames say of a particle.
struct Deformation {
  double axial = 0;               // LocalStrain::axial
  std::array<float, 6> strain{};  // Green-Lagrange: xx, yy, zz, xy, xz, yz
  uint32_t broken = 0;            // initial neighbours that are now beyond the law's reach
};

class StrainMeter {
 public:
  // Neighbours are the pairs of `initial` closer than `radius` in metres (between the first and second shell
  // of the packing). Axes with a period take the nearest image; such a period is at least two radii
  // (InputError).
  StrainMeter(const std::vector<Vec3>& initial, const Periodic& periodic, double radius);

  // The box of the present positions from now on: of the same axes. At first that of the initial ones.
  void set_box(const Periodic& present) { present_box_ = present; }

  // `present` has the order of `initial`. Where the neighbours span less than space (a chain, a sheet, a lone
  // particle), the directions that they do not see count as unstrained.
  std::vector<LocalStrain> measure(const std::vector<Vec3>& present) const;
  // The elongation along one axis alone, LocalStrain::axial: 8 bytes per particle instead of 96, in threads.
  std::vector<double> axial(const std::vector<Vec3>& present, int axis) const;
  // m, of the bond between two particles: a neighbour that was beyond it from the start never counts.
  using Reach = std::function<double(uint32_t i, uint32_t j)>;
  std::vector<Deformation> deformations(const std::vector<Vec3>& present, int axis, const Reach& reach) const;
  // Deformation::broken alone.
  std::vector<uint32_t> broken(const std::vector<Vec3>& present, const Reach& reach) const;

 private:
  Mat3 gradient(size_t i, const std::vector<Vec3>& present) const;
  uint32_t broken(size_t i, const std::vector<Vec3>& present, const Reach& reach) const;

  std::vector<Vec3> initial_;
  Periodic periodic_, present_box_;
  std::vector<size_t> first_;         // [particle]: begin of its neighbours; one more at the end
  std::vector<uint32_t> neighbours_;  // by particle
};

}  // namespace cuboct
