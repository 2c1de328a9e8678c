// SPDX-License-Identifier: MIT
// A tensile test that takes microseconds: the perfect packing, evenly deformed, with free sides.
#pragma once

#include <vector>

#include "model/base/mat3.h"
#include "model/contract/rule.h"

namespace cuboct::fit {

// Pull over the area at rest, Pa, at each of the ascending strains. `axes`: columns are the pull and the two
// directions across it, in cubic axes of the packing; it may narrow along both, but not shear. Behind the
// largest stress a specimen draws out in one place, which this does not.
std::vector<double> packing_stress(const PairLaw& law, double pitch, const Mat3& axes,
                                   const std::vector<double>& strains);

}  // namespace cuboct::fit
