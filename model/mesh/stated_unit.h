// SPDX-License-Identifier: MIT
// Units that XML formats state of themselves.
#pragma once

#include <string>

namespace cuboct {

// Metres of 3MF's and AMF's names of units; 0 of another name.
double metres_of(const std::string& unit);

// The attribute `key` of the first element `name`; `otherwise` where it has none.
std::string attribute(const std::string& xml, const std::string& name, const std::string& key,
                      const std::string& otherwise);

}  // namespace cuboct
