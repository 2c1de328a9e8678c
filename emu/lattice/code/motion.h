// SPDX-License-Identifier: MIT
// The end of a step, in compiled code: velocities, displacements and places of some lanes. FinishPass has the
// same for the interpreter.
#pragma once

#include "emu/lattice/code/lanes.h"

namespace cuboct::emu {
namespace {

inline V residues(const int32_t* from) {
  return __builtin_convertvector(*reinterpret_cast<const Half*>(from), V);
}
// In [0, 2^(P+G)), from the corner of its own cell.
inline V place_in_cell(const FinishJob& job, int axis, ptrdiff_t i) {
  const V x = load(job.x[axis] + i);
  const V inside = x - floor_of(x * splat(job.inverse_edge)) * splat(job.edge);
  return inside * splat(job.guard) + residues(job.residue[axis] + i);
}

inline W awake_lanes(const FinishJob& job, ptrdiff_t i) {
  const ptrdiff_t left = ptrdiff_t{job.end} - i;
  if (left <= 0) return W{};
  uint32_t lanes = left >= kLanes ? (1u << kLanes) - 1 : (1u << left) - 1;
  if (job.awake != nullptr)
    for (int l = 0; l < kLanes; ++l)
      if ((lanes >> l & 1) != 0 && job.awake[job.cell[i + l]] == 0) lanes &= ~(1u << l);
  return lanes_of(lanes);
}

// What some lanes did.
struct Moved {
  W changed = W{}, crossed = W{};
  V speed2 = V{}, away[3] = {V{}, V{}, V{}};  // cells
};

inline void keep(double* to, V value, W awake, Moved& moved) {
  const V before = load(to), after = select(awake, value, before);
  moved.changed |= before != after;
  store(to, after);
}

// The drift is exact: what the residue and the drift make together of visible units goes to x.
inline void move_axis(const FinishJob& job, int axis, ptrdiff_t i, W awake, V v, V drift, Moved& moved) {
  double* const to = job.x[axis] + i;
  int32_t* const residue = job.residue[axis] + i;
  const V old_x = load(to), old_residue = residues(residue);
  const V exact = old_residue + select(awake, drift, V{});
  const V whole = floor_of(exact * splat(job.inverse_guard));
  const V left = exact - whole * splat(job.guard), x = old_x + whole;
  const V inverse = splat(job.inverse_edge);
  moved.away[axis] = floor_of(x * inverse) - floor_of(old_x * inverse);
  moved.crossed |= moved.away[axis] != V{};
  moved.changed |= (whole != V{}) | (left != old_residue);
  keep(job.v[axis] + i, v, awake, moved);
  moved.speed2 = fused(v, v, moved.speed2);
  store(to, x);
  *reinterpret_cast<Half*>(residue) = __builtin_convertvector(left, Half);
}

inline void tell(const FinishJob& job, ptrdiff_t i, const Moved& moved) {
  if (__builtin_expect(any(moved.crossed), 0))
    for (int l = 0; l < kLanes; ++l) {
      if (moved.crossed[l] == 0) continue;
      int8_t away[3];
      for (int a = 0; a < 3; ++a) away[a] = static_cast<int8_t>(moved.away[a][l]);
      job.crossed(job.owner, static_cast<uint32_t>(i) + l, away);
    }
  if (job.changed != nullptr && any(moved.changed))
    for (int l = 0; l < kLanes; ++l)
      if (moved.changed[l] != 0) job.changed(job.owner, static_cast<uint32_t>(i) + l);
}

inline V faster(const Moved& moved, W awake, V fastest2) {
  return most(select(awake, moved.speed2, V{}), fastest2);
}
inline void tell_fastest(const FinishJob& job, V fastest2) {
  for (int l = 0; l < kLanes; ++l)
    if (fastest2[l] > *job.fastest2) *job.fastest2 = fastest2[l];
}

}  // namespace
}  // namespace cuboct::emu
