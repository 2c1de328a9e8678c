// SPDX-License-Identifier: MIT
// From atoms to a continuum on points: mass density, body force density and displacement as weighted sums
// over the atoms around each point, which do not average across a crack. Equations 1 to 12 of H. Q. You, X.
// Xu, Y. Yu, S. Silling, M. D'Elia and J. Foster, Appl. Math. Mech. 44 (2023) 1125. Lengths are in any one
// unit.
//
//   CoarseGrain grain(points, x, mass);     // cone weights, equation 4
//   grain.look(u, {noise, tube});           // weights that avoid jumps of u, equations 5 to 9
//   grain.density(), grain.density_of(force), grain.mean(u)   // equations 10 to 12
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "model/base/vec.h"

namespace cuboct {

struct CoarsePoints {
  int dimensions = 3;  // 2: a sheet along x and y, where z is not looked at
  std::vector<Vec3> x;
  double radius = 0;           // R: atoms farther away do not count
  double volume = 0;           // of a point; of a sheet its area times a thickness
  Vec3 period = Vec3::Zero();  // extent along an axis that repeats, above 2 R; 0: it does not repeat
};

// What counts as a crack between a point and an atom.
struct CrackSight {
  // Deviations of displacements from a straight line that are none, root mean square. With 0 it is equation 9
  // to the letter, where each smooth field that is curved counts as cracked.
  double noise = 0;
  // Atoms farther than this from the line between the two are not looked at. The paper looks at all within R.
  double tube = std::numeric_limits<double>::infinity();
};

class CoarseGrain {
 public:
  // With the weights of equation 4: sum over points of weight times volume is 1 for each atom, so that the
  // points have the atoms' mass, force and momentum together. `x`: of the atoms, before they move.
  // InputError where an atom is in no point's radius, or a point has no atom. Time goes as points times
  // atoms.
  CoarseGrain(CoarsePoints points, std::span<const Vec3> x, std::vector<double> mass);

  // Weights for displacements `u` of the atoms.
  void look(std::span<const Vec3> u, const CrackSight& sight);

  // Equation 10, mass per volume, and equation 11, per volume.
  std::vector<double> density() const;
  std::vector<Vec3> density_of(std::span<const Vec3> force) const;
  // Equation 12. A linear field u = A X comes out as A times mean(X), not as A times the point.
  std::vector<Vec3> mean(std::span<const Vec3> u) const;
  // The same with weights times a + b.(X - x), where a and b make linear fields exact at the points
  // themselves: what differences between points need. It is equation 12 where atoms lie evenly around a
  // point. It keeps no momentum.
  std::vector<Vec3> linear_mean(std::span<const Vec3> u) const;

  const CoarsePoints& points() const { return points_; }
  size_t atoms() const { return mass_.size(); }
  // alpha(x, X) of equation 9 for each atom of a point, with the atom. Of displacements it takes the
  // component along what the atom has moved against the one nearest to the point, so that a crack that slides
  // counts as one that opens; the paper's is along the line.
  std::vector<std::pair<uint32_t, double>> smoothness(size_t point, std::span<const Vec3> u,
                                                      const CrackSight& sight) const;

 private:
  uint64_t begin(size_t point) const { return first_[point]; }
  uint64_t end(size_t point) const { return first_[point + 1]; }
  void find();
  void share(std::vector<double>& weight) const;

  CoarsePoints points_;
  std::vector<double> mass_;
  std::vector<Vec3> x_;
  std::vector<uint64_t> first_;        // [point]
  std::vector<uint32_t> atom_;         // [entry]
  std::vector<Vec3> away_;             // [entry]: from the point to the atom
  std::vector<double> cone_, weight_;  // [entry]: 1/volume
};

// alpha of equation 9 for pairs of a place along a line and a displacement: the least squared error of two
// straight lines, of those before some place and of those behind it, over that of one line. 1: no jump. A
// line that crosses a crack at a slant has places at which some atoms are on either side, so that no place
// parts them. So the pairs are also parted by displacement, anywhere between `here` and `there`, those of the
// line's ends, where there > here. Sorts the pairs.
double smoothness_of(std::span<std::pair<double, double>> pairs, double noise, double here = 0,
                     double there = 0);

}  // namespace cuboct
