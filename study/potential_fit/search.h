// SPDX-License-Identifier: MIT
// Ways downhill from a point of the search.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "study/potential_fit/loss.h"

namespace cuboct::bond_fit {

// lbfgs: J. Nocedal, Math. Comp. 35 (1980) 773, within bounds; nelder_mead: Computer Journal 7 (1965) 308.
// Both are NLopt's. granular: see granular_search.h.
enum class Method : uint8_t { lbfgs, nelder_mead, granular };
std::string name_of(Method method);

struct Found {
  Point point;
  double loss = 0;      // L
  int evaluations = 0;  // of the loss; with its gradient counts as one
};
// The least loss so far, each time that it fell.
struct Descent {
  std::vector<int> evaluation;
  std::vector<double> loss;
};

// Ends where the loss stands or after `evaluations`. `seed`: of granular alone. Same input, same bits.
Found descend(const Problem& problem, Method method, const Point& start, int evaluations, uint64_t seed = 0,
              Descent* descent = nullptr);

// Evenly drawn within the bounds until the lattice holds together; the same for one seed and index.
// std::runtime_error where no point of a thousand holds.
Point random_start(const Problem& problem, uint64_t seed, uint64_t index);

}  // namespace cuboct::bond_fit
