// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace cuboct {

// As docs/user/scene.md lists them: g, m, s, N and so on.
std::vector<std::string> named_units();

}  // namespace cuboct
