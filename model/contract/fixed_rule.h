// SPDX-License-Identifier: MIT
// The update rule in integers. Lengths count cell edges, times count steps; a `_bits` is a width, a `_frac` a
// number of fractional bits. docs/reference/numeric.md derives each format.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "model/base/error.h"
#include "model/contract/fixed_step.h"
#include "model/contract/rule.h"
#include "model/graph/fixed_table.h"

namespace cuboct {

// Formats of the datapath; an arch file may set each of them.
struct Widths {
  int position_frac = 20;           // P: what forces and neighbours see of a position, in [0, 2^P)
  int guard = 8;                    // G: x, which its owner keeps, and v have P+G fractional bits
  int difference_frac = 16;         // D: d
  int velocity_bits = 29;           // v, signed; at most P+G+1, which is one cell edge per step
  int relative_velocity_frac = 20;  // W: w
  int relative_velocity_bits = 18;  // w, signed
  int filter_frac = 10;        // B: leading bits of a position that the planar test sees, all if it has fewer
  int strength_bits = 0;       // s and the entries of the tables, signed; 0: chosen, see quantise.h
  int sum_bits = 29;           // a particle's summed kick, signed, P+G fractional bits
  int displacement_bits = 29;  // u, signed, P+G fractional bits
  int scale_frac = 16;         // pair scale factors, 18 bits signed, in (0, 1]
  int gain_frac = 16;          // kp, kd, 18 bits signed

  int velocity_frac() const { return position_frac + guard; }
};

struct FixedType {
  // The lightest material's mass over this one's, kWeightFrac fractional bits, in (0, 1].
  int64_t weight = int64_t{1} << kWeightFrac;
  std::array<bool, 3> imposed{};
  Int3 velocity{};  // P+G fractional bits
  Int3 gravity{};   // cell edges per step^2, P+G fractional bits
  bool pd = false;
  int64_t kp = 0;  // per step^2, gain_frac fractional bits
  int64_t kd = 0;  // per step, gain_frac fractional bits
};

// A cell's edges along x, y and z: shares of the longest, in (0, 1]. Others than 1 where a periodic box has
// no cubic cells.
using CellShape = std::array<double, 3>;
inline constexpr CellShape kCube = {1, 1, 1};

struct CellEdges {
  double longest = 0;  // m
  CellShape shape = kCube;

  CellEdges(double edge) : longest(edge) {}  // of a cube, where an edge is all that is said
  CellEdges(double edge, const CellShape& of) : longest(edge), shape(of) {}
  double operator[](int axis) const { return longest * shape[static_cast<size_t>(axis)]; }
  double shortest() const { return longest * *std::ranges::min_element(shape); }
};

struct FixedRule {
  Widths widths;
  double cell_edge = 0;     // m, the longest
  CellShape shape = kCube;  // of a cell; positions, velocities and kicks count edges of their own axis
  double dt = 0;            // s
  double mass = 0;          // kg, the lightest material's: kicks and tables count in it

  uint64_t cutoff2 = 0;  // 2D fractional bits; r2 >= cutoff2: no interaction
  // Adder-only test that no interacting pair fails, on the leading bits of the positions: with e_a the
  // difference of floor(x_a / 2^(P-B)) and size_a = e_a, or -e_a - 1 where e_a < 0, each size <= [0], each
  // sum of two <= [1], the sum of all <= [2]. B fractional bits. See set_planar. Of cubes alone.
  std::array<int64_t, 3> planar{};

  FixedTable force;  // of each law f(r)/r * dt^2/m, times the largest pair scale
  bool damped = false;
  FixedTable damp;      // c(r)/(r/cell_edge)^2 * dt/m, times the largest pair scale; only if damped
  bool scaled = false;  // pairs of types differ, by scale or law
  // Types x types, scale_frac fractional bits; only if scaled. Negative: the two only touch. Their factor is
  // its size, and from contact2 on they do not interact.
  std::vector<std::vector<int32_t>> scale;
  uint64_t contact2 = 0;                  // as cutoff2, at most that; 0: no two types only touch
  int law_bits = 0;                       // of a law's number; 0: all pairs have one law
  std::vector<std::vector<uint8_t>> law;  // types x types, which law of `force`; only with law_bits
  std::vector<FixedType> types;
  bool weighted = false;  // masses differ: some weight is below 1
  bool pd = false;        // some type is held or moved by force
  // 2: every particle has z = 0, v_z = 0 and u_z = 0 for ever (hw/plan/setup.h), and no record holds them.
  int axes = 3;

  // Derived shifts, all >= 0.
  int difference_shift = 0;  // P - D
  int w_shift = 0;           // P+G - W
  int q_shift = 0;     // W+D - (W-1): w.d is kept with W-1 fractional bits, `relative_velocity_bits` wide
  int damp_shift = 0;  // damp.value_frac + (W-1) - force.value_frac
  int kick_shift = 0;  // force.value_frac + D - (P+G)

  int type_bits = 0;  // 0 where there is one type

  // What quantisation cost, against the rule in doubles (quantise.h).
  struct Error {
    double worst_force = 0;  // N, largest |f_fixed - f| over the distances outside the core
    double at = 0;           // m, where
    double relative = 0;     // worst_force over the law's largest |f| outside the core
  };
  std::vector<Error> errors{1};  // by law
  // Of the law that errs most.
  const Error& error() const { return *std::ranges::max_element(errors, {}, &Error::worst_force); }

  bool cubic() const { return shape == kCube; }
  CellEdges edges() const { return {cell_edge, shape}; }
  // What brings a difference along an axis, or a relative velocity, to edges of the longest: kShapeFrac
  // fractional bits.
  int32_t shape_of(int axis) const {
    return static_cast<int32_t>(std::lround(std::ldexp(shape[static_cast<size_t>(axis)], kShapeFrac)));
  }
};

// kg: what the weight of a type means, and by that the masses that a run has.
inline double mass_of(const FixedRule& rule, int type) {
  return std::ldexp(rule.mass, kWeightFrac) / static_cast<double>(rule.types[type].weight);
}

// One pair's part of the kick: what j does to i, P+G fractional bits, and the tests on its way. Exactly the
// contract: pair(i, j) == -pair(j, i).
struct PairResult {
  bool inside = false;  // r2 < cutoff2, or contact2
  Fault fault = Fault::none;
  int64_t number = 0;  // the value that did not fit
  Int3 kick{};
};

// What forces and neighbours see of a position of P+G fractional bits: its leading P, rounded down.
inline Int3 visible(const FixedRule& rule, const Int3& x) {
  const int guard = rule.widths.guard;
  return {x[0] >> guard, x[1] >> guard, x[2] >> guard};
}

// x_i, x_j: visible positions in the frame of i's cell (x_j may lie in [-2^P, 2^(P+1))); v with P+G.
PairResult pair_kick(const FixedRule& rule, const Int3& x_i, const Int3& v_i, int type_i, const Int3& x_j,
                     const Int3& v_j, int type_j);

// d of the contract, D fractional bits, of visible positions.
Int3 difference(const FixedRule& rule, const Int3& x_i, const Int3& x_j);
// The bounds of the planar test, from cutoff2 and the widths. Inside the cutoff the sum over m axes of |d| is
// at most f = floor(sqrt(m (cutoff2 - 1))); d is rounded by at most half of its unit, and e differs from the
// exact difference by less than one of its own; size <= |e|. So the sum of sizes is below (f + m/2) 2^(B-D) +
// m.
void set_planar(FixedRule& rule);
// The planar test; x_i, x_j as for pair_kick.
bool may_interact(const FixedRule& rule, const Int3& x_i, const Int3& x_j);

// Kick, constraints and drift of one particle. `x`, P+G fractional bits, may leave [0, 2^(P+G)) by less than
// one cell.
struct FinishResult {
  Fault fault = Fault::none;
  int64_t number = 0;
  Int3 x{}, v{}, u{};
};
FinishResult finish(const FixedRule& rule, const Int3& sum, const Int3& x, const Int3& v, const Int3& u,
                    int type);

}  // namespace cuboct
