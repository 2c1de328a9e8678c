// SPDX-License-Identifier: MIT
#include "model/analysis/near_within.h"

#include <fmt/format.h>

#include "model/base/error.h"

namespace cuboct {

void check_range(double range, const Periodic& periodic, const char* what) {
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = periodic.extent[axis];
    if (extent > 0 && range > extent / 2)
      throw InputError(fmt::format("the {} is {:g} m, more than half of the box along {}, {:g} m", what,
                                   range, "xyz"[axis], extent),
                       fmt::format("at most {:.6g} m", extent / 2));
  }
}

}  // namespace cuboct
