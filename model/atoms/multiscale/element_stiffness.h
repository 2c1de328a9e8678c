// SPDX-License-Identifier: MIT
// The undeformed body as linear elasticity sees it: what steps of dynamics and of a search for rest need to
// know of its stiffness.
#pragma once

#include <Eigen/SparseCore>

#include "model/atoms/multiscale/element_body.h"

namespace cuboct {

// N/m, rows 3 v + axis of vertex v; force = -stiffness * displacement. O. C. Zienkiewicz and R. L. Taylor,
// The Finite Element Method 1 (2000), chapter 6: constant strain, constants of each grain's undeformed
// sample.
Eigen::SparseMatrix<double> element_stiffness(const ElementBody& body);

// rad/s, of the fastest vibration; from below, by power iterations: some percent too low. Leapfrog is stable
// up to dt = 2/that.
double fastest_vibration(const ElementBody& body, const Eigen::SparseMatrix<double>& stiffness);

}  // namespace cuboct
