// SPDX-License-Identifier: MIT
// Names of enumerators.
#pragma once
#include <cstddef>

namespace cuboct {

// The name of an enumerator that counts from 0; "?" beyond the list, of values that come from a file.
template <typename Enum, size_t N>
constexpr const char* name_in(const char* const (&names)[N], Enum value) {
  const auto k = static_cast<size_t>(value);
  return k < N ? names[k] : "?";
}

}  // namespace cuboct
