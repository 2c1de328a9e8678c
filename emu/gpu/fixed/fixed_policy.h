// SPDX-License-Identifier: MIT
// The fixed rule for the engine of emu/gpu/machine.h. Its cells are the lattice's; a position counts from the
// corner of the cell in which its particle stood when the list was made, so that no list changes when a
// particle crosses a face. Its leading P fractional bits, which pairs see, stand apart from the G bits below,
// its residue.
#pragma once

#include <cstdint>
#include <vector>

#include "emu/gpu/device/device.h"
#include "emu/gpu/grid_view.h"
#include "emu/gpu/particle.h"
#include "hw/plan/plan.h"
#include "model/contract/fixed_step.h"

namespace cuboct::gpu {

// FixedTable's numbers; its entries stand in the cache from word `first` on: c0 and c1 side by side, then all
// c2.
struct DeviceTable {
  int shape, degree, difference_frac, index_bits, bin_bits, first_octave;
  Rounding fraction_bits;
  uint32_t first, entries;
};

struct DeviceType {
  bool imposed[3];
  bool pd;
  int64_t velocity[3], gravity[3];
  int64_t kp, kd;
  int64_t weight;
};

struct FixedView {
  Widths widths;
  int32_t cell_edge;    // in units of a position
  float position_unit;  // in cells
  uint64_t cutoff2;
  DeviceTable force, damp;
  bool damped, scaled, weighted;
  const int32_t* scale;  // types x types; with several laws as many again: the number of each pair's law
  int law_bits;
  uint64_t contact2;
  int type_count;
  const DeviceType* types;
  Rounding difference_shift, w_shift, q_shift, damp_shift, kick_shift;
};

// Owns what a FixedView points to.
class FixedRuleOnDevice {
 public:
  FixedRuleOnDevice(Stream& stream, const FixedRule& rule);
  const FixedView& view() const { return view_; }
  const void* cache() const { return cache_.data(); }
  size_t cache_words() const { return cache_.size(); }

 private:
  FixedView view_{};
  Array<int32_t> cache_, scale_;
  Array<DeviceType> types_;
};

// The view with its tables found in `cache`, with the members that model/contract/fixed_step.h asks of a
// rule.
template <bool Damped>
struct CachedFixedRule {
  struct Row {
    const int32_t* entries;
    int offset;
    CUBOCT_DEVICE int32_t operator[](uint32_t k) const {
      return entries[2 * k + static_cast<uint32_t>(offset)];
    }
  };
  struct Table {
    int shape, degree, difference_frac, index_bits, bin_bits, first_octave;
    const Rounding& fraction_bits;
    Row c0, c1;
    const int32_t* c2;
    CUBOCT_DEVICE Table(const DeviceTable& table, const int32_t* cache)
        : shape(table.shape),
          degree(table.degree),
          difference_frac(table.difference_frac),
          index_bits(table.index_bits),
          bin_bits(table.bin_bits),
          first_octave(table.first_octave),
          fraction_bits(table.fraction_bits),
          c0{cache + table.first, 0},
          c1{cache + table.first, 1},
          c2(cache + table.first + 2 * size_t{table.entries}) {}
  };
  struct Pairs {
    const int32_t* first;
    int types;
    CUBOCT_DEVICE const int32_t* operator[](int i) const { return first + i * types; }
  };

  const Widths& widths;
  int32_t cell_edge;  // in units of a position
  uint64_t cutoff2, contact2;
  Table force, damp;
  static constexpr bool damped = Damped;
  bool scaled, weighted;
  int law_bits;
  Pairs scale, law;
  const DeviceType* types;
  const Rounding &difference_shift, &w_shift, &q_shift, &damp_shift, &kick_shift;

  CUBOCT_DEVICE CachedFixedRule(const FixedView& view, const void* cache)
      : widths(view.widths),
        cell_edge(view.cell_edge),
        cutoff2(view.cutoff2),
        contact2(view.contact2),
        force(view.force, static_cast<const int32_t*>(cache)),
        damp(view.damp, static_cast<const int32_t*>(cache)),
        scaled(view.scaled),
        weighted(view.weighted),
        law_bits(view.law_bits),
        scale{view.scale, view.type_count},
        law{view.scaled ? view.scale + view.type_count * view.type_count : nullptr, view.type_count},
        types(view.types),
        difference_shift(view.difference_shift),
        w_shift(view.w_shift),
        q_shift(view.q_shift),
        damp_shift(view.damp_shift),
        kick_shift(view.kick_shift) {}
};

// VelocityNumber holds Widths::velocity_bits.
template <typename VelocityNumber>
struct FixedPolicy {
  static constexpr bool kFixed = true;
  static constexpr int kReach = 2;                        // cells that a list may span along an axis
  static constexpr int kTogether = 1;                     // partners loaded at once
  using Position = Four<int32_t, uint32_t>;               // P fractional bits; type and near anchor
  using Velocity = Four<VelocityNumber, VelocityNumber>;  // P+G fractional bits; anchor (storage.h)
  using Extra = Three<int64_t>;                           // u, P+G fractional bits
  using Sum = Three<int64_t>;                             // kicks, P+G fractional bits
  using View = FixedView;
  using Rule = FixedRuleOnDevice;

  struct Triple {
    int64_t value[3];
    CUBOCT_DEVICE int64_t& operator[](int a) { return value[a]; }
    CUBOCT_DEVICE const int64_t& operator[](int a) const { return value[a]; }
  };
  struct PairOutcome {
    bool inside = false;
    Fault fault = Fault::none;
    int64_t number = 0;
    Triple kick{};
  };
  struct FinishOutcome {
    Fault fault = Fault::none;
    int64_t number = 0;
    Triple x{}, v{}, u{};
  };

  // Calls use(Variant) with what is known when kernels are compiled.
  template <bool Damped>
  struct Variant {
    static constexpr bool kDamped = Damped;
    using Cached = CachedFixedRule<Damped>;
    CUBOCT_DEVICE static Cached cached(const View& view, const void* cache) { return Cached(view, cache); }
  };
  template <class Use>
  static void with_variant(const View& view, const Use& use) {
    if (view.damped)
      use(Variant<true>());
    else
      use(Variant<false>());
  }

  // Both parts of a position, P+G fractional bits. The host reads states with it.
  CUBOCT_HD static int64_t whole(const Widths& widths, const Position& x, const Three<uint32_t>& residue,
                                 int axis) {
    return x.at[axis] * (int64_t{1} << widths.guard) + residue.at[axis];
  }
  CUBOCT_DEVICE static int64_t whole(const View& view, const Position& x, const Three<uint32_t>& residue,
                                     int axis) {
    return whole(view.widths, x, residue, axis);
  }

  CUBOCT_DEVICE static Triple triple(const int32_t (&at)[3]) { return {{at[0], at[1], at[2]}}; }
  template <typename Number>
  CUBOCT_DEVICE static Triple triple(const Four<Number, Number>& four) {
    return {{four.at[0], four.at[1], four.at[2]}};
  }

  // What a pair adds to the sum of one of its particles.
  using Part = Sum;
  // What the other, whose cell lies `away`, does to the one. False: golden would refuse.
  template <class Cached>
  CUBOCT_DEVICE static bool part_of(const Cached& rule, const GridView&, const Position& one,
                                    const Velocity& v, const Position& other, const Velocity& w,
                                    const int (&away)[3], Part& part) {
    Triple y;
    for (int a = 0; a < 3; ++a) y[a] = other.at[a] + int64_t{away[a]} * rule.cell_edge;
    const auto pair = pair_kick_of<PairOutcome>(rule, triple(one.at), triple(v), type_in(one.last), y,
                                                triple(w), type_in(other.last));
    for (int a = 0; a < 3; ++a) part.at[a] = pair.kick[a];
    return pair.fault == Fault::none;
  }
  CUBOCT_DEVICE static void add(const Part& part, Sum& sum) {
    for (int a = 0; a < 3; ++a) sum.at[a] += part.at[a];
  }
  template <class Cached>
  CUBOCT_DEVICE static bool add_pair(const Cached& rule, const GridView& grid, const Position& one,
                                     const Velocity& v, const Position& other, const Velocity& w,
                                     const int (&away)[3], Sum& sum) {
    Part part;
    const bool sound = part_of(rule, grid, one, v, other, w, away, part);
    add(part, sum);
    return sound;
  }

  // One step of the particle. False: golden would refuse.
  template <class Cached>
  CUBOCT_DEVICE static bool finish(const Cached& rule, const Sum& sum, Position& x, Three<uint32_t>& residue,
                                   Velocity& v, Extra* u) {
    Triple displacement{};
    if (u)
      for (int a = 0; a < 3; ++a) displacement[a] = u->at[a];
    const Triple sums{{sum.at[0], sum.at[1], sum.at[2]}};
    Triple position;
    for (int a = 0; a < 3; ++a) position[a] = whole(rule.widths, x, residue, a);
    const auto result =
        finish_of<FinishOutcome>(rule, sums, position, triple(v), displacement, type_in(x.last));
    for (int a = 0; a < 3; ++a) {
      x.at[a] = static_cast<int32_t>(result.x[a] >> rule.widths.guard);
      residue.at[a] = static_cast<uint32_t>(result.x[a] & ((int64_t{1} << rule.widths.guard) - 1));
      v.at[a] = static_cast<VelocityNumber>(result.v[a]);
    }
    if (u)
      for (int a = 0; a < 3; ++a) u->at[a] = result.u[a];
    return result.fault == Fault::none;
  }

  // What the coming step adds to v, of any size, in the unit of v; `u` may be null unless the rule has PD
  // types.
  template <class Cached>
  CUBOCT_DEVICE static void gains(const Cached& rule, const Sum& sum, const Velocity& v, const Extra* u,
                                  int type, double (&gain)[3]) {
    const DeviceType& of = rule.types[type];
    for (int a = 0; a < 3; ++a) {
      gain[a] = of.imposed[a] ? 0 : static_cast<double>(weighed(rule, of, sum.at[a]) + of.gravity[a]);
      if (of.pd && !of.imposed[a])
        gain[a] -= static_cast<double>(of.kp * u->at[a] + of.kd * (v.at[a] - of.velocity[a])) /
                   static_cast<double>(int64_t{1} << rule.widths.gain_frac);
    }
  }

  // In cells.
  CUBOCT_DEVICE static float along(const View& view, const GridView&, const Position& x, int axis) {
    return static_cast<float>(x.at[axis]) * view.position_unit;
  }
  CUBOCT_DEVICE static int cells_off(const View& view, const GridView&, const Position& x, int axis) {
    return x.at[axis] >> view.widths.position_frac;
  }
  CUBOCT_DEVICE static void take_off(const View& view, const GridView&, Position& x, int axis, int cells) {
    x.at[axis] -= cells * (1 << view.widths.position_frac);
  }
};

}  // namespace cuboct::gpu
