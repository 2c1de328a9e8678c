// SPDX-License-Identifier: MIT
// Mean of a time series and its standard error, by blocks: H. Flyvbjerg and H. G. Petersen, J. Chem. Phys. 91
// (1989) 461. Neighbouring samples are averaged in pairs again and again; the error estimated as if samples
// were independent rises until blocks are longer than the correlation time, then stays. Taken is the first
// level that is within its own uncertainty, 1/sqrt(2 (n - 1)) of it, of the largest estimate at any later
// level with 16 blocks or more.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace cuboct::test {

struct Mean {
  double value = 0, error = 0;
};

inline Mean blocked(std::vector<double> x) {
  const auto mean_of = [](const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v;
    return sum / static_cast<double>(values.size());
  };
  Mean mean{mean_of(x), 0};
  std::vector<double> errors, doubts;
  while (x.size() >= 16) {
    const double middle = mean_of(x), n = static_cast<double>(x.size());
    double squares = 0;
    for (const double v : x) squares += (v - middle) * (v - middle);
    errors.push_back(std::sqrt(squares / n / (n - 1)));
    doubts.push_back(errors.back() / std::sqrt(2 * (n - 1)));
    std::vector<double> halved(x.size() / 2);
    for (size_t k = 0; k < halved.size(); ++k) halved[k] = (x[2 * k] + x[2 * k + 1]) / 2;
    x = std::move(halved);
  }
  for (size_t k = 0; k < errors.size(); ++k) {
    mean.error = errors[k];
    if (*std::max_element(errors.begin() + static_cast<ptrdiff_t>(k), errors.end()) <= errors[k] + doubts[k])
      break;
  }
  return mean;
}

}  // namespace cuboct::test
