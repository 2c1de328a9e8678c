// SPDX-License-Identifier: MIT
#include "cli/study/bond_fit.h"

namespace cuboct {

int fit_bonds(const std::string&, const std::string&, int, const Answer&) {
  throw InputError("fit: this cuboct was built without fits of Tersoff's potential",
                   "install NLopt (libnlopt-dev) and configure anew");
}

}  // namespace cuboct
