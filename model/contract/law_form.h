// SPDX-License-Identifier: MIT
// What a pair law is made of, for engines that evaluate it in vectors. Forces in N (positive repels), lengths
// in m.
#pragma once

#include <variant>
#include <vector>

namespace cuboct {

// f(r) = 24 epsilon (2 (sigma/r)^12 - (sigma/r)^6)/r + offset
struct LennardJonesForm {
  double epsilon = 0, sigma = 0;  // J, m
  double offset = 0;              // N; not 0: the force is shifted
  bool operator==(const LennardJonesForm&) const = default;
};

// From r on, up to the r of the next piece: f = c0 + t (c1 + t (c2 + t c3)), t = distance - r.
struct CubicPiece {
  double r = 0, c0 = 0, c1 = 0, c2 = 0, c3 = 0;
  bool operator==(const CubicPiece&) const = default;
};

// A quadratic arc (r(t), f(t)), t in [0, 1], from r on: distance = r + t (r1 + t r2), f = f0 + t (f1 + t f2);
// r rises with t.
struct ArcPiece {
  double r = 0, r1 = 0, r2 = 0, f0 = 0, f1 = 0, f2 = 0;
  bool operator==(const ArcPiece&) const = default;
};

// A law between its core and its cutoff; the first and the last piece take what lies outside of all. A law of
// no form (monostate) is asked pair by pair.
using LawForm =
    std::variant<std::monostate, LennardJonesForm, std::vector<CubicPiece>, std::vector<ArcPiece>>;

}  // namespace cuboct
