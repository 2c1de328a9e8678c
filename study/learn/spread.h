// SPDX-License-Identifier: MIT
// Mean and standard deviation.
#pragma once

#include <algorithm>
#include <cmath>

namespace cuboct::learn {

struct Spread {
  double mean = 0, deviation = 0;  // of a single one; 0 where there is no other
};

// Of what `of` says of each item.
template <typename Items, typename Of>
Spread spread_of(const Items& items, const Of& of) {
  double sum = 0, squares = 0;
  const auto n = static_cast<double>(items.size());
  for (const auto& item : items) sum += of(item), squares += of(item) * of(item);
  const double mean = sum / n;
  return {mean, n > 1 ? std::sqrt(std::max(0.0, (squares - n * mean * mean) / (n - 1))) : 0};
}

}  // namespace cuboct::learn
