// SPDX-License-Identifier: MIT
// What a program's graphs do for a thread's particle, run operation by operation. Each operation takes
// kTogether of its partners at once.
#pragma once

#include "emu/gpu/rounds/rounds_kernel.h"
#include "emu/gpu/rounds/rounds_operations.h"

namespace cuboct::gpu {

// RoundsStep's Graphs. A thread's registers, then those of a bond that is not met.
template <bool Bonded>
struct Interpreted {
  static constexpr bool kBonded = Bonded;
  static constexpr int kSums = 1;  // not used: sums stand behind the registers
  static constexpr int kTogether = gpu::kTogether;
  struct Own {
    RoundsRegisters registers;
    int64_t* sums;
    uint32_t stride;
    const Line* image;
    CUBOCT_DEVICE int64_t& sum(uint32_t k) const { return sums[k * stride]; }
    template <typename T>
    CUBOCT_DEVICE const T* in(const Part<T>& part) const {
      return reinterpret_cast<const T*>(image + part.line);
    }
  };

  RoundCode code;

  CUBOCT_DEVICE void begin(const RoundsFrame& at, uint32_t i, const Own& own) const {
    for (uint32_t k = 0; k < code.terms.count; ++k) own.sum(k) = 0;
    put_constants(code.constants, own.registers);
    for (uint32_t k = 0; k < code.own.count; ++k) put_own(at, own, load(own.in(code.own) + k), i);
    for (uint32_t k = 0; k < code.prepare.count; ++k)
      for (int l = 0; l < kTogether; ++l)
        operate(load(own.in(code.prepare) + k), own.registers, l, code.tables);
  }

  CUBOCT_DEVICE void meet(const RoundsFrame& at, uint32_t i, const Own& own, bool& fits) const {
    if constexpr (Bonded)
      meet_bonds(at, i, own, fits);
    else
      meet_near(at, i, own, fits);
  }

  // In the first lane.
  CUBOCT_DEVICE void finish(const RoundsFrame& at, uint32_t i, const Own& own, const int64_t (&)[kSums],
                            RoundsMotion& motion, bool& fits) const {
    const RoundsRegisters& r = own.registers;
    put_constants(code.finish_constants, r);
    for (uint32_t k = 0; k < code.finish_fetch.count; ++k)
      put_own(at, own, load(own.in(code.finish_fetch) + k), i);
    for (uint32_t k = 0; k < code.finish.count; ++k)
      fits = operate(load(own.in(code.finish) + k), r, 0, code.finish_tables) && fits;
    const auto value = [&](const Part<Store>& part, uint32_t k) {
      const Store s = load(own.in(part) + k);
      return r.lane(s.from, s.wide, 0);
    };
    for (uint32_t k = 0; k < code.writes.count; ++k)
      at.to.fields[load(own.in(code.writes) + k).to][i] = value(code.writes, k);
    CUBOCT_UNROLL
    for (uint32_t a = 0; a < 3; ++a) {
      if (a < code.v.count) motion.v[a] = value(code.v, a), motion.drift[a] = value(code.drift, a);
      if (a < code.u.count) motion.u[a] = value(code.u, a);
    }
  }

 private:
  // Partners that a thread meets at once. `live`: which lanes hold one; others repeat a partner, or stand
  // where their particle does.
  struct Together {
    uint32_t j[kTogether], own_type, other_type[kTogether];
    int64_t apart[3][kTogether];  // visible units
    size_t slot[kTogether];       // of bonds
    const int64_t* constants[kTogether];
    uint32_t live;
  };

  CUBOCT_DEVICE void meet_near(const RoundsFrame& at, uint32_t i, const Own& own, bool& fits) const {
    const RoundsPlace here = load(at.from.place + i);
    if (at.first && at.control->near_stale[at.number] != 0) make_near(at, i, here);
    const uint32_t* entries = at.near.entries + i;
    const uint32_t count = at.near.counts[i];
    Together pairs{};
    pairs.own_type = here.type;
    for (uint32_t row = 0; row < count; row += kTogether) {
      pairs.live = 0;
      CUBOCT_UNROLL
      for (uint32_t l = 0; l < kTogether; ++l) {
        const bool one = row + l < count;
        pairs.live |= static_cast<uint32_t>(one) << l;
        const uint32_t entry = entries[(one ? row + l : row) * at.list.stride];
        const RoundsPlace there = place_of(at, entry);
        pairs.j[l] = entry & ((1u << kPartnerBits) - 1);
        CUBOCT_UNROLL
        for (int a = 0; a < 3; ++a) pairs.apart[a][l] = apart_of(here, there, a);
        pairs.other_type[l] = there.type;
      }
      run_pairs(at, own, pairs, fits);
    }
  }
  CUBOCT_DEVICE static RoundsPlace place_of(const RoundsFrame& at, uint32_t entry) {
    RoundsPlace there = load(at.from.place + (entry & ((1u << kPartnerBits) - 1)));
    if (const uint32_t image = entry >> kPartnerBits; image != kNoImage)
      for (int a = 0; a < 3; ++a) there.x[a] += at.list.shift[image][a];
    return there;
  }
  CUBOCT_DEVICE static void make_near(const RoundsFrame& at, uint32_t i, const RoundsPlace& here) {
    uint32_t kept = 0;
    for (uint32_t row = 0; row < at.list.counts[i]; ++row) {
      const uint32_t entry = at.list.entries[row * at.list.stride + i];
      if (moved2_of(here, place_of(at, entry)) > at.near.reach2) continue;
      at.near.entries[kept++ * at.list.stride + i] = entry;
    }
    at.near.counts[i] = kept, at.near.listed[i] = here;
  }

  CUBOCT_DEVICE void meet_bonds(const RoundsFrame& at, uint32_t i, const Own& own, bool& fits) const {
    const int64_t x[3] = {at.from.x[0][i] >> at.guard, at.from.x[1][i] >> at.guard,
                          at.from.x[2][i] >> at.guard};
    const uint32_t count = at.list.counts[i];
    Together pairs{};
    pairs.own_type = at.from.type[i];
    for (uint32_t row = 0; row < count; row += kTogether) {
      uint32_t there = 0, met = 0;
      CUBOCT_UNROLL
      for (uint32_t l = 0; l < kTogether; ++l) {
        const bool one = row + l < count;
        const size_t slot = (one ? row + l : row) * at.list.stride + i;
        const uint32_t j = at.list.entries[slot] & ((1u << kPartnerBits) - 1);
        int64_t apart[3];
        for (int a = 0; a < 3; ++a) apart[a] = (at.from.x[a][j] >> at.guard) - x[a];
        const bool meets = at.bonds.meet(x, apart);
        for (int a = 0; a < 3; ++a) pairs.apart[a][l] = meets ? apart[a] : 0;
        pairs.j[l] = j, pairs.other_type[l] = at.from.type[j];
        pairs.slot[l] = slot;
        pairs.constants[l] =
            at.bonds.constants + at.bonds.kind[slot] * static_cast<uint32_t>(at.bonds.constant_count);
        there |= static_cast<uint32_t>(one) << l;
        met |= static_cast<uint32_t>(meets) << l;
      }
      pairs.live = there & met;
      const uint32_t counted = run_pairs(at, own, pairs, fits);
      if (counted == there) continue;
      CUBOCT_NO_UNROLL
      for (uint32_t l = 0; l < kTogether; ++l) {
        if (((there & ~counted) >> l & 1) == 0) continue;
        const size_t slot = (row + l) * at.list.stride + i;
        if ((met >> l & 1) == 0) fits = fits && broken(at, own, slot);
        keep(at, own, slot);
      }
    }
  }
  CUBOCT_DEVICE bool broken(const RoundsFrame& at, const Own& own, size_t slot) const {
    if (code.broken < 0) return false;
    const RoundsRegisters r = own.registers.from(static_cast<uint32_t>(code.registers));
    put_constants(code.broken_constants, r);
    for (uint32_t k = 0; k < code.broken_fetch.count; ++k) {
      const Fetch f = load(own.in(code.broken_fetch) + k);
      r.put_all(f.to, f.wide, of_bond(at, f, slot));
    }
    for (uint32_t k = 0; k < code.broken_code.count; ++k)
      operate(load(own.in(code.broken_code) + k), r, 0, code.broken_tables);
    return r.lane(static_cast<uint32_t>(code.broken), false, 0) != 0;
  }
  CUBOCT_DEVICE void keep(const RoundsFrame& at, const Own& own, size_t slot) const {
    for (uint32_t k = 0; k < code.bond_writes.count; ++k)
      at.bonds.keep(load(own.in(code.bond_writes) + k).to, slot);
  }

  // The lanes of those that count.
  CUBOCT_DEVICE uint32_t run_pairs(const RoundsFrame& at, const Own& own, const Together& pairs,
                                   bool& fits) const {
    const RoundsRegisters& r = own.registers;
    uint32_t live = pairs.live;
    put_apart(r, pairs);
    CUBOCT_NO_UNROLL
    for (bool late = code.when < 0;; late = true) {
      const Part<Fetch>& fetches = late ? code.late_fetch : code.early_fetch;
      for (uint32_t k = 0; k < fetches.count; ++k) put_pairs(at, r, load(own.in(fetches) + k), pairs);
      const Part<Operation>& operations = late ? code.late : code.early;
      const uint32_t wrong = Lanes(r, code.tables).run(own.in(operations), operations.count);
      if (late) {
        fits = (wrong & live) == 0 && fits;
        break;
      }
      const Quad when = r.low(static_cast<uint32_t>(code.when));
      CUBOCT_UNROLL
      for (int l = 0; l < kTogether; ++l)
        if (when.v[l] == 0) live &= ~(1u << l);
      if (live == 0) return 0;
    }
    for (uint32_t k = 0; k < code.terms.count; ++k) {
      const Store term = load(own.in(code.terms) + k);
      const WideQuad value = r.value(term.from, term.wide);
      int64_t sum = 0;
      CUBOCT_UNROLL
      for (int l = 0; l < kTogether; ++l)
        if (live >> l & 1) sum += value.v[l];
      own.sum(k) += sum;
    }
    if constexpr (Bonded)
      for (uint32_t k = 0; k < code.bond_writes.count; ++k) {
        const Store write = load(own.in(code.bond_writes) + k);
        const WideQuad value = r.value(write.from, write.wide);
        CUBOCT_UNROLL
        for (int l = 0; l < kTogether; ++l)
          if (live >> l & 1) at.bonds.to[write.to][pairs.slot[l]] = value.v[l];
      }
    return live;
  }

  CUBOCT_DEVICE static void put_constants(const Span<Constant>& constants, const RoundsRegisters& r) {
    for (int k = 0; k < constants.count; ++k)
      r.put_all(constants.data[k].to, constants.data[k].wide, constants.data[k].value);
  }
  CUBOCT_DEVICE void put_own(const RoundsFrame& at, const Own& own, const Fetch& f, uint32_t i) const {
    const bool sum = static_cast<graph::Source>(f.source) == graph::Source::sum;
    own.registers.put_all(f.to, f.wide, rounded(sum ? own.sum(f.index) : of_own(at, f, i), f.shift));
  }
  CUBOCT_DEVICE void put_apart(const RoundsRegisters& r, const Together& pairs) const {
    CUBOCT_UNROLL
    for (int a = 0; a < 3; ++a) {
      const Fetch& f = code.apart[a];
      if (f.to == kNowhere) continue;
      const Rounding by(f.shift);
      if (f.narrow) {
        const int32_t half = static_cast<int32_t>(by.half);
        Quad value;
        CUBOCT_UNROLL
        for (int l = 0; l < kTogether; ++l) {
          const auto apart = static_cast<int32_t>(pairs.apart[a][l]);
          value.v[l] = plus(plus(apart, half), apart >> 31 & by.odd) >> f.shift;
        }
        r.put(f.to, value);
      } else {
        WideQuad value;
        CUBOCT_UNROLL
        for (int l = 0; l < kTogether; ++l) value.v[l] = rounded(pairs.apart[a][l], by);
        r.put(f.to, f.wide, value);
      }
    }
  }
  CUBOCT_DEVICE void put_pairs(const RoundsFrame& at, const RoundsRegisters& r, const Fetch& f,
                               const Together& pairs) const {
    WideQuad value{};
    const auto each = [&](const auto& of) {
      CUBOCT_UNROLL
      for (int l = 0; l < kTogether; ++l) value.v[l] = of(l);
    };
    switch (static_cast<graph::Source>(f.source)) {
      case graph::Source::apart:
        // Not by a number that is known late: then it would stand in memory.
        each([&](int l) {
          return f.axis == 0 ? pairs.apart[0][l] : f.axis == 1 ? pairs.apart[1][l] : pairs.apart[2][l];
        });
        break;
      case graph::Source::other_v:
        each([&](int l) { return at.from.v[f.axis][pairs.j[l]]; });
        break;
      case graph::Source::other_constant:
        each([&](int l) { return at.type_constants[f.index * code.types + pairs.other_type[l]]; });
        break;
      case graph::Source::pair_constant:
        each([&](int l) {
          return at
              .pair_constants[(f.index * code.types + pairs.own_type) * code.types + pairs.other_type[l]];
        });
        break;
      case graph::Source::other_field:
        each([&](int l) { return at.from.fields[f.index][pairs.j[l]]; });
        break;
      case graph::Source::other_id:
        each([&](int l) { return int64_t{at.from.id[pairs.j[l]]}; });
        break;
      case graph::Source::bond_field:
        if constexpr (Bonded) each([&](int l) { return at.bonds.from[f.index][pairs.slot[l]]; });
        break;
      default:  // bond_constant
        if constexpr (Bonded) each([&](int l) { return pairs.constants[l][f.index]; });
    }
    const Rounding by(f.shift);
    if (f.shift > 0) each([&](int l) { return rounded(value.v[l], by); });
    r.put(f.to, f.wide, value);
  }

  CUBOCT_DEVICE int64_t of_own(const RoundsFrame& at, const Fetch& f, uint32_t i) const {
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
  CUBOCT_DEVICE int64_t of_bond(const RoundsFrame& at, const Fetch& f, size_t slot) const {
    if (static_cast<graph::Source>(f.source) == graph::Source::bond_field)
      return at.bonds.from[f.index][slot];
    return at.bonds.constant(f.index, slot);
  }
};

// A block of threads. Its memory holds the threads' registers, the image of their code, and their sums.
template <bool Bonded>
struct InterpretedBlock {
  RoundsStep<Interpreted<Bonded>> step;
  uint32_t count, threads;
  CUBOCT_DEVICE void operator()(uint32_t index, const Block& block, void* memory) const {
    const RoundCode& code = step.code;
    auto* registers = static_cast<Quad*>(memory);
    auto* image = reinterpret_cast<Line*>(
        registers + static_cast<uint32_t>(code.registers + code.broken_registers) * threads);
    auto* sums = reinterpret_cast<int64_t*>(image + code.image.count);
    block.each(static_cast<uint32_t>(code.image.count),
               [&](uint32_t k) { store(image + k, load(code.image.data + k)); });
    block.each(threads, [&](uint32_t k) {
      if (const uint32_t i = index * threads + k; i < count)
        step(i, {RoundsRegisters{registers + k, threads}, sums + k, threads, image});
    });
  }
};

}  // namespace cuboct::gpu
