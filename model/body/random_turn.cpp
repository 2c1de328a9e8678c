// SPDX-License-Identifier: MIT
#include "model/body/random_turn.h"

#include <array>
#include <cmath>

#include "model/body/packing_parts.h"

namespace cuboct {

// Rotation by a unit quaternion that is uniform on its sphere (G. Marsaglia, "Choosing a point from the
// surface of a sphere", Ann. Math. Stat. 43, 645 (1972)).
Mat3 random_turn(std::mt19937_64& generator) {
  const auto disc = [&] {
    for (;;) {
      const double x = 2 * uniform(generator) - 1, y = 2 * uniform(generator) - 1, square = x * x + y * y;
      if (square < 1 && square > 0) return std::array{x, y, square};
    }
  };
  const auto [a, b, first] = disc();
  const auto [u, v, second] = disc();
  const double rest = std::sqrt((1 - first) / second), c = u * rest, d = v * rest;
  Mat3 turn;
  turn << a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c),  //
      2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b),      //
      2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d;
  return turn;
}

}  // namespace cuboct
