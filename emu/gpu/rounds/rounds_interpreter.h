// SPDX-License-Identifier: MIT
// A program's graphs, run operation by operation over a thread's registers. The operations are golden's
// (model/graph/interpret.h).
#pragma once

#include "emu/gpu/rounds/rounds_kernel.h"
#include "emu/gpu/rounds/rounds_program.h"
#include "model/graph/graph.h"
#include "model/graph/integer_ops.h"

namespace cuboct::gpu {

// Of a thread, in memory that its block shares: on a device local memory would be that of all threads, more
// than a cache has room for.
struct RoundsRegisters {
  int64_t* first;
  uint32_t stride;
  CUBOCT_DEVICE int64_t& operator[](int k) const { return first[static_cast<uint32_t>(k) * stride]; }
  CUBOCT_DEVICE RoundsRegisters from(int k) const { return {&(*this)[k], stride}; }
};

// False where a check found what does not fit.
CUBOCT_DEVICE inline bool operate(const Span<Operation>& code, const CodeTable* tables,
                                  const RoundsRegisters& r) {
  using graph::Op;
  bool fits = true;
  for (int n = 0; n < code.count; ++n) {
    const Operation o = load(code.data + n);
    const int64_t a = r[o.in[0]], b = r[o.in[1]];
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
        value = round_odd(a, o.shift);
        break;
      case Op::floor:
        value = a >> o.shift;
        break;
      case Op::mul:
        value = round_odd(a * b, o.shift);
        break;
      case Op::mac:
        value = a + round_odd(b * r[o.in[2]], o.shift);
        break;
      case Op::dot:
        for (int k = 0; k < o.inputs / 2; ++k) value += r[o.in[k]] * r[o.in[o.inputs / 2 + k]];
        value = round_odd(value, o.shift);
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
        value = a ? b : r[o.in[2]];
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
        value = graph::leading_of(a);
        break;
      case Op::align:
        value = graph::aligned_of(a, o.shift, o.width);
        break;
      case Op::shift:
        value = graph::shifted_of(a, b);
        break;
      case Op::check:
        value = wrap(a, o.width);
        fits = fits && (value == a || b == 0);
        break;
      case Op::noise:
        value = graph::mixed_of(o.low, a, b, r[o.in[2]], o.width);
        break;
    }
    r[o.out] = value;
  }
  return fits;
}

// RoundsStep's Graphs. A thread's registers, then its sums, then the registers of a bond that is not met.
template <bool Bonded>
struct Interpreted {
  static constexpr bool kBonded = Bonded;
  static constexpr int kSums = 1;  // not used
  using Own = RoundsRegisters;

  RoundCode code;

  CUBOCT_DEVICE void begin(const RoundsFrame& at, uint32_t i, const RoundsRegisters& r) const {
    const RoundsRegisters sums = r.from(code.registers);
    for (int k = 0; k < code.terms.count; ++k) sums[k] = 0;
    operate(code.constants, code.tables, r);
    for (int k = 0; k < code.own.count; ++k) r[code.own.data[k].to] = own(at, code.own.data[k], i);
  }

  CUBOCT_DEVICE bool pair(const RoundsFrame& at, const RoundsRegisters& r, const RoundsPair& pair,
                          int64_t (&)[kSums], bool& fits) const {
    for (int k = 0; k < code.early_fetch.count; ++k)
      r[code.early_fetch.data[k].to] = of_pair(at, code.early_fetch.data[k], pair);
    operate(code.early, code.tables, r);
    if (r[code.when] == 0) return false;
    for (int k = 0; k < code.late_fetch.count; ++k)
      r[code.late_fetch.data[k].to] = of_pair(at, code.late_fetch.data[k], pair);
    fits = operate(code.late, code.tables, r) && fits;
    const RoundsRegisters sums = r.from(code.registers);
    for (int k = 0; k < code.terms.count; ++k) sums[k] += r[code.terms.data[k].from];
    for (int k = 0; k < code.bond_writes.count; ++k)
      at.bonds.to[code.bond_writes.data[k].to][pair.slot] = r[code.bond_writes.data[k].from];
    return true;
  }

  CUBOCT_DEVICE bool broken(const RoundsFrame& at, const RoundsRegisters& own, size_t slot) const {
    if (code.broken < 0) return false;
    const RoundsRegisters r = own.from(code.registers + code.terms.count);
    operate(code.broken_constants, code.broken_tables, r);
    for (int k = 0; k < code.broken_fetch.count; ++k)
      r[code.broken_fetch.data[k].to] = of_bond(at, code.broken_fetch.data[k], slot);
    operate(code.broken_code, code.broken_tables, r);
    return r[code.broken] != 0;
  }
  CUBOCT_DEVICE void keep(const RoundsFrame& at, size_t slot) const {
    for (int k = 0; k < code.bond_writes.count; ++k) at.bonds.keep(code.bond_writes.data[k].to, slot);
  }

  CUBOCT_DEVICE void finish(const RoundsFrame& at, uint32_t i, const RoundsRegisters& r,
                            const int64_t (&)[kSums], RoundsMotion& motion, bool& fits) const {
    const RoundsRegisters sums = r.from(code.registers);
    operate(code.finish_constants, code.finish_tables, r);
    for (int k = 0; k < code.finish_fetch.count; ++k) {
      const Fetch& f = code.finish_fetch.data[k];
      r[f.to] = static_cast<graph::Source>(f.source) == graph::Source::sum ? sums[f.index] : own(at, f, i);
    }
    fits = operate(code.finish, code.finish_tables, r) && fits;
    for (int k = 0; k < code.writes.count; ++k)
      at.to.fields[code.writes.data[k].to][i] = r[code.writes.data[k].from];
    CUBOCT_UNROLL
    for (int a = 0; a < 3; ++a) {
      if (a < code.v.count)
        motion.v[a] = r[code.v.data[a].from], motion.drift[a] = r[code.drift.data[a].from];
      if (a < code.u.count) motion.u[a] = r[code.u.data[a].from];
    }
  }

 private:
  CUBOCT_DEVICE int64_t own(const RoundsFrame& at, const Fetch& f, uint32_t i) const {
    switch (static_cast<graph::Source>(f.source)) {
      case graph::Source::own_x:
        return at.own_x(f.axis, i);
      case graph::Source::own_v:
        return at.from.v[f.axis][i];
      case graph::Source::own_u:
        return at.own_u(f.axis, i);
      case graph::Source::own_constant:
        return at.type_constants[f.index * code.types + at.from.type[i]];
      case graph::Source::own_field:
        return at.from.fields[f.index][i];
      case graph::Source::own_id:
        return at.from.id[i];
      default:  // step
        return static_cast<int64_t>(at.step);
    }
  }
  CUBOCT_DEVICE int64_t of_pair(const RoundsFrame& at, const Fetch& f, const RoundsPair& pair) const {
    const auto own_type = static_cast<int>(pair.own_type), other_type = static_cast<int>(pair.other_type);
    switch (static_cast<graph::Source>(f.source)) {
      case graph::Source::apart:
        // Not by a number that is known late: then it would stand in memory.
        return f.axis == 0 ? pair.apart[0] : f.axis == 1 ? pair.apart[1] : pair.apart[2];
      case graph::Source::other_v:
        return at.from.v[f.axis][pair.j];
      case graph::Source::other_constant:
        return at.type_constants[f.index * code.types + other_type];
      case graph::Source::pair_constant:
        return at.pair_constants[(f.index * code.types + own_type) * code.types + other_type];
      case graph::Source::other_field:
        return at.from.fields[f.index][pair.j];
      case graph::Source::other_id:
        return at.from.id[pair.j];
      default:
        return of_bond(at, f, pair.slot);
    }
  }
  CUBOCT_DEVICE int64_t of_bond(const RoundsFrame& at, const Fetch& f, size_t slot) const {
    if (static_cast<graph::Source>(f.source) == graph::Source::bond_field)
      return at.bonds.from[f.index][slot];
    return at.bonds.constant(f.index, slot);
  }
};

// A block of threads.
template <bool Bonded>
struct InterpretedBlock {
  RoundsStep<Interpreted<Bonded>> step;
  uint32_t count, threads;
  CUBOCT_DEVICE void operator()(uint32_t index, const Block& block, void* memory) const {
    block.each(threads, [&](uint32_t k) {
      if (const uint32_t i = index * threads + k; i < count)
        step(i, RoundsRegisters{static_cast<int64_t*>(memory) + k, threads});
    });
  }
};

}  // namespace cuboct::gpu
