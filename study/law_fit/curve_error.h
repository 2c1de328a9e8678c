// SPDX-License-Identifier: MIT
// How far one stress-strain curve is from another.
#pragma once

#include <cstddef>
#include <vector>

namespace cuboct::fit {

// `count` strains at equal distances from 0 to `last`.
std::vector<double> even_strains(double last, size_t count);

// Stress at each of the ascending strains, when the readings first come to it: a specimen that slips beside
// its gauge goes back there. Straight between two readings; 0 beyond the largest strain that was read, but
// for the last strain where it lies less than half a distance beyond.
std::vector<double> first_passage(const std::vector<double>& strain, const std::vector<double>& stress,
                                  const std::vector<double>& at);

// The L2 distance of two curves over the L2 norm of the second, both by the trapezoidal rule over even
// strains. 0: equal; 1: as far as no stress at all.
double curve_error(const std::vector<double>& stress, const std::vector<double>& target);

}  // namespace cuboct::fit
