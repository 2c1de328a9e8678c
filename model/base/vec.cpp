// SPDX-License-Identifier: MIT
#include "model/base/vec.h"

#include <ostream>

namespace cuboct {

std::ostream& operator<<(std::ostream& out, const Vec3& a) {
  return out << a.x() << ' ' << a.y() << ' ' << a.z();
}

}  // namespace cuboct
