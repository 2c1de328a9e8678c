// SPDX-License-Identifier: MIT
// Meshfree quadrature by local optimisation: of the weights that integrate a space of functions over a ball
// exactly, those of the least sum of squares. N. Trask, H. You, Y. Yu and M. L. Parks, Comput. Methods Appl.
// Mech. Eng. 343 (2019) 151; equation 19 of the paper in model/rules/lps.h. The functions are
//   p(r)/|r|^3, p a polynomial of degree `order` at most, as far as their integral is finite.
// Weights depend on the points alone, not on the influence.
#pragma once

#include <optional>
#include <vector>

#include "model/base/vec.h"
#include "model/rules/lps.h"

namespace cuboct {

// What the weights integrate: r^a/|r|^3 over the ball of radius `horizon`, and its integral.
struct Monomial {
  std::array<int, 3> power;
  double at(const Vec3& r) const;
  double integral(int dimensions, double horizon) const;
};
std::vector<Monomial> integrated_functions(int dimensions, int order);

// m^3 (of two dimensions m^2), one for each of `points`, which lie around the ball's middle. None where no
// weights integrate all functions to 1e-10 of the largest integral: there are too few points.
std::optional<std::vector<double>> ball_weights(const std::vector<Vec3>& points, double horizon,
                                                int dimensions, int order);

// [bond]: the weight of its far end. A particle near a surface has no neighbours on one side: where the
// mirror image of a neighbour through the particle lacks one within half a spacing, the image stands in while
// the weights are made, and is then dropped. InputError, with the particle, where there are too few.
std::vector<double> fitted_weights(const LpsMaterial& material, const ReferenceBonds& bonds, int threads);

}  // namespace cuboct
