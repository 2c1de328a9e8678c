// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace cuboct {

// The material of a type, whose name is "material" or "material/constraint".
inline std::string material_of(const std::string& type) { return type.substr(0, type.find('/')); }

}  // namespace cuboct
