// SPDX-License-Identifier: MIT
#include "model/trace/finding.h"

#include "model/base/enum_names.h"

namespace cuboct {

const char* to_string(Failure failure) {
  constexpr const char* kNames[] = {"time step",       "damping", "stiff hold", "force jump", "tunnelling",
                                    "constraint work", "heating", "creep",      "far origin", "resolution"};
  return name_in(kNames, failure);
}

}  // namespace cuboct
