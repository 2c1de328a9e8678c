// SPDX-License-Identifier: MIT
#include "python/catch_interrupt.h"

namespace cuboct {

CatchForHost::CatchForHost() = default;

}  // namespace cuboct
