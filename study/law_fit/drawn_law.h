// SPDX-License-Identifier: MIT
// The force law that a fit looks for: two plane B-splines of degree 3, (r(t), f(t)), drawn by the control
// points P0 ... P4 of the push, from 0 to the pitch, and Q0 ... Q5 of the pull, from there to the reach.
//
//   11 control points of two numbers each                          22
//   P0.r = 0, P4.r = Q0.r = the pitch, Q5.r = the reach            -4
//   P4.f = Q0.f = 0: no force at the pitch                         -2
//   P1.f = P0.f: the push is level where it begins                 -1
//   Q5.f = 0: the pull vanishes at the reach                       -1
//   P3, the pitch and Q1 on one line: a continuous tangent there   -1
//                                                                  13 free
#pragma once

#include <array>
#include <string>
#include <vector>

namespace cuboct::fit {

// Without units, so that one set of bounds serves all materials. A place that is a share counts from the
// control point before it: any shares in (0, 1) give points in ascending order, and so a force that is a
// function of r.
enum Parameter : size_t {
  stiffness,     // -df/dr at the pitch, over LawScale::stiffness
  push_top,      // force of P0 and P1, over stiffness times pitch
  push_1,        // place of P1: share of the way from 0 to P3
  push_2,        // place of P2: share of the way from P1 to P3
  push_2_force,  // of P2: over that of a straight bond there
  push_3,        // distance of P3 from the pitch, in pitches
  pull_1,        // force of Q1, over LawScale::height; forces of pulls are positive here
  pull_2,        // place of Q2: share of the way from Q1 to the reach
  pull_3,        // place of Q3: share of the way from Q2 to the reach
  pull_4,        // place of Q4: share of the way from Q3 to the reach
  pull_2_force,  // over LawScale::height
  pull_3_force,
  pull_4_force,
  kParameters
};
using Parameters = std::array<double, kParameters>;

// "push_2_force"
const std::array<std::string, kParameters>& parameter_names();

// What parameters are measured by.
struct LawScale {
  double pitch = 0;      // m
  double reach = 3;      // pitches, above 1
  double stiffness = 0;  // N/m
  double height = 0;     // N: the pull of a bond that makes the target's strength
};

struct ControlPoint {
  double r, f;  // m, N; positive repels
};
struct DrawnLaw {
  std::array<ControlPoint, 5> push;
  std::array<ControlPoint, 6> pull;
};
DrawnLaw draw(const Parameters& parameters, const LawScale& scale);

// Points of both splines, ascending in r from 0 to the reach, for a scene's law of kind "spline". The pitch
// is one of them, to the last bit, with the force 0.
struct LawPoints {
  std::vector<double> r, f;  // m, N
};
LawPoints points_of(const DrawnLaw& law);

}  // namespace cuboct::fit
