// SPDX-License-Identifier: MIT
// What becomes of each value of a pair's graph when own and other are swapped: proven by numbering values.
#pragma once

#include <vector>

#include "model/graph/graph.h"

namespace cuboct::graph {

enum class Parity : uint8_t {
  none,
  even,  // the same at both ends
  odd,   // the negative: what one end adds the other subtracts, so that the total is kept to the last bit
  zero,  // both
};

constexpr bool is_even(Parity p) { return p == Parity::even || p == Parity::zero; }
constexpr bool is_odd(Parity p) { return p == Parity::odd || p == Parity::zero; }

// Of each node, for pairs that count in a step without a fault: there `within` and a check change nothing.
// Sound, not complete: `none` means that no proof was found.
std::vector<Parity> parities_of(const Graph& pair);

const char* to_string(Parity parity);

}  // namespace cuboct::graph
