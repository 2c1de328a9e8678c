// SPDX-License-Identifier: MIT
// What a thread does for its particle in a round of a program: its partners' terms, then its finish. The
// operations are golden's (model/graph/interpret.h).
#pragma once

#include "gpu_ref/grid_view.h"
#include "gpu_ref/rounds_program.h"
#include "model/base/hash.h"
#include "model/graph/graph.h"
#include "model/graph/table_value.h"

namespace cuboct::gpu {

inline constexpr uint32_t kNoStep = 0xffffffffu;

// Particles as a step finds them, or leaves them.
struct RoundsView {
  int64_t *x[3], *v[3], *u[3];  // P+G fractional bits; x from the corner of cell (0, 0, 0), not wrapped since
                                // the last list; u: null where the rule has none
  int64_t* fields[kMostNumbers];
  const uint8_t* type;
  const uint32_t* id;
};

// The first step of a batch that was not possible here, or not certain to be; kNoStep: none.
struct RoundsControl {
  uint32_t doubt;
  uint32_t old;  // the step after which the list serves no longer
};

// Cells, dense over the lattice's box: which there are, and how many particles each may have held since the
// last list.
struct RoundsCells {
  int low[3], extent[3], period[3];
  const uint8_t* exists;
  uint32_t* occupancy;
  uint32_t* entered;       // by particle: of the 27 cells around that of the last list those that it was in
  const int32_t* home[3];  // by particle, the cell of the last list
  uint32_t capacity;

  // kNoStep: there is none.
  CUBOCT_DEVICE uint32_t find(const int (&cell)[3]) const {
    int64_t at = 0;
    for (int a = 2; a >= 0; --a) {
      int c = cell[a] - low[a];
      if (period[a] > 0) c = ((cell[a] % period[a]) + period[a]) % period[a] - low[a];
      if (c < 0 || c >= extent[a]) return kNoStep;
      at = at * extent[a] + c;
    }
    return exists[at] ? static_cast<uint32_t>(at) : kNoStep;
  }
};

struct RoundsList {
  const uint32_t *entries, *counts;  // [row * stride + particle]: index, and above it the image
  size_t stride;
  int64_t shift[27][3];      // of an image, in visible units
  const int64_t* listed[3];  // visible places when the list was made
  double allowed2;           // square of the displacement that it serves for, visible units
};
inline constexpr int kPartnerBits = 27;

// Of a bonded program: [row * stride + particle], as its list. Each end keeps its own numbers.
struct RoundsBonds {
  bool on;
  const int64_t* from[kMostBondNumbers];
  int64_t* to[kMostBondNumbers];
  const uint32_t* kind;
  const int64_t* constants;  // [kind][constant]
  int numbers, constant_count;
  int position_frac;
  int64_t period[3];  // visible units; 0: the box does not repeat

  CUBOCT_DEVICE int64_t value(const Fetch& f, size_t slot) const {
    if (static_cast<graph::Source>(f.source) == graph::Source::bond_field) return from[f.index][slot];
    return constants[kind[slot] * static_cast<uint32_t>(constant_count) + f.index];
  }
  // `apart` becomes that of the partner's image beside `own`. Whether their cells are neighbours: in a ring
  // of three the image that is so may be farther away than another.
  CUBOCT_DEVICE bool meet(const int64_t (&own)[3], int64_t (&apart)[3]) const {
    bool met = true;
    for (int a = 0; a < 3; ++a) {
      if (period[a] > 0) {
        const int64_t half = apart[a] + period[a] / 2;
        apart[a] -= (half >= 0 ? half / period[a] : -((period[a] - 1 - half) / period[a])) * period[a];
      }
      int64_t cells = ((own[a] + apart[a]) >> position_frac) - (own[a] >> position_frac);
      if (period[a] > 0 && (cells < -1 || cells > 1)) {
        const int64_t ring = cells < 0 ? -period[a] : period[a];
        apart[a] -= ring;
        cells -= ring >> position_frac;
      }
      met = met && cells >= -1 && cells <= 1;
    }
    return met;
  }
};

struct RoundsRegisters {
  int64_t at[kMostRegisters];
};

CUBOCT_DEVICE inline int64_t odd_rounding(int64_t a, int s) {
  return s == 0 ? a : (a + (int64_t{1} << (s - 1)) - (a < 0)) >> s;
}

CUBOCT_DEVICE inline int leading_place(int64_t a) {
  return a <= 0 ? -1 : leading_bit(static_cast<uint64_t>(a));
}

// False where a check found what does not fit.
CUBOCT_DEVICE inline bool operate(const Span<Operation>& code, const CodeTable* tables, RoundsRegisters& r) {
  using graph::Op;
  bool fits = true;
  for (int n = 0; n < code.count; ++n) {
    const Operation& o = code.data[n];
    const int64_t a = r.at[o.in[0]], b = r.at[o.in[1]];
    int64_t value = 0;
    switch (static_cast<Op>(o.op)) {
      case Op::constant:
        value = o.low;
        break;
      case Op::input:
        continue;
      case Op::add:
        value = a + b;
        break;
      case Op::sub:
        value = a - b;
        break;
      case Op::neg:
        value = -a;
        break;
      case Op::shl:
        value = a << o.shift;
        break;
      case Op::round:
        value = odd_rounding(a, o.shift);
        break;
      case Op::floor:
        value = a >> o.shift;
        break;
      case Op::mul:
        value = odd_rounding(a * b, o.shift);
        break;
      case Op::mac:
        value = a + odd_rounding(b * r.at[o.in[2]], o.shift);
        break;
      case Op::dot:
        for (int k = 0; k < o.inputs / 2; ++k) value += r.at[o.in[k]] * r.at[o.in[o.inputs / 2 + k]];
        value = odd_rounding(value, o.shift);
        break;
      case Op::lookup: {
        const CodeTable& table = tables[o.table];
        value = table_value(table, static_cast<uint64_t>(a), static_cast<uint32_t>(b) << table.index_bits);
        break;
      }
      case Op::lt:
        value = a < b;
        break;
      case Op::le:
        value = a <= b;
        break;
      case Op::eq:
        value = a == b;
        break;
      case Op::both:
        value = a & b;
        break;
      case Op::either:
        value = a | b;
        break;
      case Op::negate:
        value = 1 - a;
        break;
      case Op::select:
        value = a ? b : r.at[o.in[2]];
        break;
      case Op::min:
        value = a < b ? a : b;
        break;
      case Op::max:
        value = a < b ? b : a;
        break;
      case Op::abs:
        value = a < 0 ? -a : a;
        break;
      case Op::clamp:
      case Op::within:
        value = a < o.low ? o.low : a > o.high ? o.high : a;
        break;
      case Op::msb:
        value = leading_place(a);
        break;
      case Op::align: {
        const int by = o.shift - leading_place(a) / o.width * o.width;
        value = a <= 0 ? 0 : by >= 0 ? a << by : a >> -by;
        break;
      }
      case Op::shift:
        value = b >= 0 ? a << b : odd_rounding(a, static_cast<int>(-b));
        break;
      case Op::check:
        value = wrap(a, o.width);
        fits = fits && (value == a || b == 0);
        break;
      case Op::noise: {
        const int64_t c = r.at[o.in[2]];
        const uint64_t mixed = Hash().add(o.low).add(a < b ? a : b).add(a < b ? b : a).add(c).value();
        value = static_cast<int64_t>(mixed) >> (64 - o.width);
        break;
      }
    }
    r.at[o.out] = value;
  }
  return fits;
}

// A round of one step, from one copy of the state; the last one makes the other copy.
struct RoundsStep {
  RoundCode code;
  RoundsView from, to;  // fields of `to`: those that the round writes
  RoundsList list;
  RoundsCells cells;
  RoundsBonds bonds;
  int guard, frac;  // G; P+G
  bool last;
  uint64_t step;
  uint32_t number;  // of the step in its batch, from 1
  RoundsControl* control;

  CUBOCT_DEVICE bool idle() const { return control->doubt <= number || control->old < number; }

  CUBOCT_DEVICE void operator()(uint32_t i) const {
    if (idle()) return;
    int64_t sums[kMostNumbers];
    bool fits = meet(i, sums);
    RoundsRegisters r;
    operate(code.finish_constants, code.finish_tables, r);
    for (int k = 0; k < code.finish_fetch.count; ++k) {
      const Fetch& f = code.finish_fetch.data[k];
      r.at[f.to] = static_cast<graph::Source>(f.source) == graph::Source::sum ? sums[f.index] : own(f, i);
    }
    fits = operate(code.finish, code.finish_tables, r) && fits;
    for (int k = 0; k < code.writes.count; ++k)
      to.fields[code.writes.data[k].to][i] = r.at[code.writes.data[k].from];
    if (last) fits = move(i, r) && fits;
    if (!fits) atomic_min(&control->doubt, number);
  }

 private:
  CUBOCT_DEVICE int64_t own(const Fetch& f, uint32_t i) const {
    switch (static_cast<graph::Source>(f.source)) {
      case graph::Source::own_x:
        return from.x[f.axis][i] & ((int64_t{1} << frac) - 1);
      case graph::Source::own_v:
        return from.v[f.axis][i];
      case graph::Source::own_u:
        return from.u[0] != nullptr ? from.u[f.axis][i] : 0;
      case graph::Source::own_constant:
        return code.type_constants[f.index * code.types + from.type[i]];
      case graph::Source::own_field:
        return from.fields[f.index][i];
      case graph::Source::own_id:
        return from.id[i];
      default:  // step
        return static_cast<int64_t>(step);
    }
  }
  CUBOCT_DEVICE int64_t of_pair(const Fetch& f, uint32_t i, uint32_t j, const int64_t (&apart)[3],
                                size_t slot) const {
    switch (static_cast<graph::Source>(f.source)) {
      case graph::Source::apart:
        return apart[f.axis];
      case graph::Source::other_v:
        return from.v[f.axis][j];
      case graph::Source::other_constant:
        return code.type_constants[f.index * code.types + from.type[j]];
      case graph::Source::pair_constant:
        return code.pair_constants[(f.index * code.types + from.type[i]) * code.types + from.type[j]];
      case graph::Source::other_field:
        return from.fields[f.index][j];
      case graph::Source::other_id:
        return from.id[j];
      default:  // of the bond
        return bonds.value(f, slot);
    }
  }

  // A bond that is not met.
  CUBOCT_DEVICE bool broken(size_t slot) const {
    if (code.broken < 0) return false;
    RoundsRegisters r;
    operate(code.broken_constants, code.broken_tables, r);
    for (int k = 0; k < code.broken_fetch.count; ++k)
      r.at[code.broken_fetch.data[k].to] = bonds.value(code.broken_fetch.data[k], slot);
    operate(code.broken_code, code.broken_tables, r);
    return r.at[code.broken] != 0;
  }
  CUBOCT_DEVICE void keep_bond(size_t slot) const {
    for (int k = 0; k < code.bond_writes.count; ++k) {
      const int number = code.bond_writes.data[k].to;
      bonds.to[number][slot] = bonds.from[number][slot];
    }
  }

  CUBOCT_DEVICE bool meet(uint32_t i, int64_t (&sums)[kMostNumbers]) const {
    for (int k = 0; k < code.terms.count; ++k) sums[k] = 0;
    RoundsRegisters r;
    operate(code.constants, code.tables, r);
    for (int k = 0; k < code.own.count; ++k) r.at[code.own.data[k].to] = own(code.own.data[k], i);
    const int64_t x[3] = {from.x[0][i] >> guard, from.x[1][i] >> guard, from.x[2][i] >> guard};
    const uint32_t count = list.counts[i];
    bool fits = true;
    for (uint32_t row = 0; row < count; ++row) {
      const size_t slot = row * list.stride + i;
      const uint32_t entry = list.entries[slot];
      const uint32_t j = entry & ((1u << kPartnerBits) - 1);
      const int64_t(&shift)[3] = list.shift[entry >> kPartnerBits];
      int64_t apart[3];
      for (int a = 0; a < 3; ++a) apart[a] = (from.x[a][j] >> guard) + shift[a] - x[a];
      if (bonds.on && !bonds.meet(x, apart)) {
        fits = fits && broken(slot);
        keep_bond(slot);
        continue;
      }
      for (int k = 0; k < code.early_fetch.count; ++k)
        r.at[code.early_fetch.data[k].to] = of_pair(code.early_fetch.data[k], i, j, apart, slot);
      operate(code.early, code.tables, r);
      if (r.at[code.when] == 0) {
        keep_bond(slot);
        continue;
      }
      for (int k = 0; k < code.late_fetch.count; ++k)
        r.at[code.late_fetch.data[k].to] = of_pair(code.late_fetch.data[k], i, j, apart, slot);
      fits = operate(code.late, code.tables, r) && fits;
      for (int k = 0; k < code.terms.count; ++k) sums[k] += r.at[code.terms.data[k].from];
      for (int k = 0; k < code.bond_writes.count; ++k)
        bonds.to[code.bond_writes.data[k].to][slot] = r.at[code.bond_writes.data[k].from];
    }
    return fits;
  }

  CUBOCT_DEVICE bool move(uint32_t i, const RoundsRegisters& r) const {
    int64_t x[3];
    bool crosses = false;
    double moved2 = 0;
    for (int a = 0; a < 3; ++a) {
      const int64_t before = from.x[a][i];
      x[a] = before;
      int64_t v = from.v[a][i], u = 0;
      if (a < code.v.count) {
        v = r.at[code.v.data[a].from];
        x[a] += r.at[code.drift.data[a].from];
      }
      if (a < code.u.count) u = r.at[code.u.data[a].from];
      to.x[a][i] = x[a];
      to.v[a][i] = v;
      if (to.u[0] != nullptr) to.u[a][i] = u;
      crosses = crosses || (x[a] >> frac) != (before >> frac);
      const auto apart = static_cast<double>((x[a] >> guard) - list.listed[a][i]);
      moved2 += apart * apart;
    }
    if (moved2 > list.allowed2) atomic_min(&control->old, number);
    return !crosses || enter(i, x);
  }

  // Golden moves a particle along x, then y, then z. False: one of the cells on its way is not there, or may
  // be full.
  CUBOCT_DEVICE bool enter(uint32_t i, const int64_t (&x)[3]) const {
    int cell[3];
    for (int a = 0; a < 3; ++a) cell[a] = static_cast<int>(from.x[a][i] >> frac);
    bool fits = true;
    for (int a = 0; a < 3; ++a) {
      const int next = static_cast<int>(x[a] >> frac);
      if (next == cell[a]) continue;
      cell[a] = next;
      const uint32_t at = cells.find(cell);
      if (at == kNoStep) return false;
      int bit = 13;
      for (int b = 0, scale = 1; b < 3; ++b, scale *= 3) {
        const int off = cell[b] - cells.home[b][i];
        if (off < -1 || off > 1) return false;
        bit += off * scale;
      }
      const uint32_t entered = cells.entered[i];
      if (entered >> bit & 1u) continue;
      cells.entered[i] = entered | 1u << bit;
      fits = atomic_add(cells.occupancy + at, 1u) + 1 <= cells.capacity && fits;
    }
    return fits;
  }
};

// The hash of each particle (model/contract/state.h) after step `number`, where it came so far.
struct RoundsHash {
  RoundsView at;
  int period[3];
  int frac, numbers;
  RoundsBonds bonds;
  const uint32_t* counts;
  size_t stride;
  uint32_t number;
  const RoundsControl* control;
  CUBOCT_DEVICE bool idle() const { return control->doubt <= number || control->old < number; }
  CUBOCT_DEVICE uint64_t operator()(uint32_t i) const {
    Hash hash;
    hash.add(at.id[i]).add(at.type[i]);
    for (int a = 0; a < 3; ++a) {
      int64_t cell = at.x[a][i] >> frac;
      if (period[a] > 0) cell = (cell % period[a] + period[a]) % period[a];
      hash.add(cell);
    }
    for (int a = 0; a < 3; ++a)
      hash.add(at.x[a][i] & ((int64_t{1} << frac) - 1))
          .add(at.v[a][i])
          .add(at.u[0] != nullptr ? at.u[a][i] : 0);
    for (int f = 0; f < numbers; ++f) hash.add(at.fields[f][i]);
    for (uint32_t row = 0; bonds.on && row < counts[i]; ++row)
      for (int k = 0; k < bonds.numbers; ++k) hash.add(bonds.from[k][row * stride + i]);
    return hash.value();
  }
};

}  // namespace cuboct::gpu
