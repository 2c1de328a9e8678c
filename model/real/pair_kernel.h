// SPDX-License-Identifier: MIT
// Pair forces of the real-number engine, in vectors: each lane is a particle that sums its own pairs, one
// after another. So a particle's sum has the order of its list and nothing else: vectors and threads leave no
// mark.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "model/contract/rule.h"

namespace cuboct {

// Rows of `lanes` entries; entry l of a group's row is one more neighbour of its particle l, and where that
// has no more the particle itself. An entry is 4 times a slot: where its four numbers begin.
struct PairRows {
  size_t first_group = 0;
  std::vector<size_t> begin{0};  // [group - first_group]: its first row; one more at the end
  std::vector<uint32_t> entry;
};

// A law as the kernels read it. Real: double or float.
template <class Real>
struct LawTerms {
  explicit LawTerms(const PairLaw& of);

  enum class Kind : uint8_t { lennard_jones, cubic, arc, asked } kind = Kind::asked;
  Real sigma2 = 0, epsilon24 = 0, offset = 0;  // m^2, J, N
  // [coefficient][piece]: r and what follows it in CubicPiece or ArcPiece; filled up with copies of the last
  // piece.
  static constexpr size_t kLeastPieces = 16;  // as many as a vector has lanes
  std::array<std::vector<Real>, 6> coefficient;
  size_t pieces = 0;
  std::vector<Real> joint2;  // m^2, where one piece ends and the next begins
  const PairLaw* law = nullptr;
  Real cutoff2 = 0, core2 = 0;  // m^2
};

// The pair part of a rule.
template <class Real>
struct PairForce {
  PairForce(const Rule& rule, const Periodic& periodic);
  void set_box(const Periodic& periodic);

  std::vector<LawTerms<Real>> laws;
  std::vector<Real> law_index;  // materials x materials; empty where there is one law

  Real cutoff2 = 0, core2 = 0;  // m^2, of the rule
  Real damping = 0, inverse_cutoff2 = 0;
  size_t materials = 1;
  // Materials x materials; empty where all are 1, none only touch, and there is one law. Negative: the two
  // only touch.
  std::vector<Real> strength;
  Real contact2 = 0;  // m^2
  bool ring = false;
  std::array<Real, 3> extent{}, inverse_extent{};  // 0 in open axes
};

// Forces on the particles of `rows`, N. x, v and f hold four numbers a slot: three coordinates, and in x the
// material, in f nothing. All three reach to the end of the last group.
void pair_forces(const PairForce<double>& force, const PairRows& rows, const double* x, const double* v,
                 double* f);
void pair_forces(const PairForce<float>& force, const PairRows& rows, const float* x, const float* v,
                 float* f);
// Of the candidates of `ranges`, at `at` (axis, candidate), those whose nearest image in `box` (0: an open
// axis) is nearer to `home` than the root of range2 (m^2): their `names`, ascending, begin `found`. Answers
// how many. `at` has kNearerSpill more places than names, and `found` than candidates.
inline constexpr size_t kNearerSpill = 64;
struct NearRange {
  size_t begin, end;
};
size_t nearer(const std::vector<double> (&at)[3], const std::vector<uint64_t>& names,
              std::span<const NearRange> ranges, const Vec3& home, const std::array<double, 3>& box,
              double range2, std::vector<uint64_t>& found);
// f/r of a law, N/m, at the roots of r2 (m^2).
void pair_over_r(const LawTerms<double>& law, const std::vector<double>& r2, std::vector<double>& over_r);
// Lanes of a vector on this machine.
template <class Real>
size_t pair_lanes();
// The instruction set, e.g. "AVX3".
const char* pair_simd();

}  // namespace cuboct
