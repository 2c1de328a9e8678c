// SPDX-License-Identifier: MIT
// The rule in real numbers for the engine of emu/gpu/machine.h. A position counts from the corner of its
// cell, in cutoffs: floats then resolve it to 2^-24 of a cell's edge wherever in space the cell is.
#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>

#include "emu/gpu/device/device.h"
#include "emu/gpu/grid_view.h"
#include "emu/gpu/particle.h"
#include "emu/gpu/real/real_rule.h"
#include "emu/gpu/real/real_tables.h"

namespace cuboct::gpu {

template <class Real>
struct RealView {
  RealRule<Real> rule;
  Real edge[3];  // of a cell, cutoffs
};

// Owns what a RealView points to.
template <class Real>
class RealRuleOnDevice {
 public:
  RealRuleOnDevice(Stream& stream, const RealTables<Real>& tables, const double (&edge)[3])
      : cache_(stream.device()), strength_(stream.device()), types_(stream.device()) {
    cache_.set(stream, tables.cache);
    strength_.set(stream, tables.strength);
    types_.set(stream, tables.types);
    view_.rule = tables.rule(cache_.data(), strength_.data(), types_.data());
    for (int a = 0; a < 3; ++a) view_.edge[a] = static_cast<Real>(edge[a]);
  }
  const RealView<Real>& view() const { return view_; }
  const void* cache() const { return cache_.data(); }
  size_t cache_words() const { return cache_.size() * sizeof(Real) / 4; }

 private:
  RealView<Real> view_{};
  Array<Real> cache_, strength_;
  Array<RealType<Real>> types_;
};

template <class Real>
struct RealPolicy {
  static constexpr bool kFixed = false;
  static constexpr int kReach = 1;     // cells that a list may span along an axis
  static constexpr int kTogether = 3;  // partners loaded at once
  static constexpr bool kSingle = sizeof(Real) == 4;
  using Position =
      Four<Real, std::conditional_t<kSingle, uint32_t, uint64_t>>;  // cutoffs; type and near anchor
  using Velocity = Four<Real, std::conditional_t<kSingle, uint32_t, uint64_t>>;  // cutoffs per step; anchor
  using Extra = Three<Real>;                                                     // u, cutoffs
  using Sum = Three<Real>;                                                       // kicks, cutoffs per step
  using View = RealView<Real>;
  using Rule = RealRuleOnDevice<Real>;

  struct CachedRule {
    const RealRule<Real>& rule;
    const Real* cache;
    const Real* edge;
  };
  template <LawKind kKind, bool Damped, bool Scaled>
  struct Variant {
    static constexpr bool kDamped = Damped;
    struct Cached : CachedRule {
      static constexpr LawKind kLaw = kKind;
      static constexpr bool kDamps = Damped, kScales = Scaled;
    };
    CUBOCT_DEVICE static Cached cached(const View& view, const void* cache) {
      return {{view.rule, static_cast<const Real*>(cache), view.edge}};
    }
  };
  template <class Use>
  static void with_variant(const View& view, const Use& use) {
    with_kinds(view.rule,
               [&]<LawKind kKind, bool kDamped, bool kScaled>() { use(Variant<kKind, kDamped, kScaled>()); });
  }

  // What a pair adds to the sum of one of its particles.
  struct Part {
    Real factor, d[3];
  };
  // What the other, whose cell lies `away`, does to the one.
  template <class Cached>
  CUBOCT_DEVICE static bool part_of(const Cached& rule, const GridView&, const Position& one,
                                    const Velocity& v, const Position& other, const Velocity& w,
                                    const int (&away)[3], Part& part) {
    Real dv[3];
    for (int a = 0; a < 3; ++a) {
      part.d[a] = (other.at[a] - one.at[a]) + static_cast<Real>(away[a]) * rule.edge[a];
      dv[a] = w.at[a] - v.at[a];
    }
    pair_factor<Cached::kLaw, Cached::kDamps, Cached::kScales>(
        rule.rule, rule.cache, part.d, dv, type_in(one.last), type_in(other.last), part.factor);
    return true;
  }
  CUBOCT_DEVICE static void add(const Part& part, Sum& sum) { add_kick(part.factor, part.d, sum.at); }
  template <class Cached>
  CUBOCT_DEVICE static bool add_pair(const Cached& rule, const GridView& grid, const Position& one,
                                     const Velocity& v, const Position& other, const Velocity& w,
                                     const int (&away)[3], Sum& sum) {
    Part part;
    part_of(rule, grid, one, v, other, w, away, part);
    add(part, sum);
    return true;
  }

  // One step of the particle. False: a position is not finite.
  template <class Cached>
  CUBOCT_DEVICE static bool finish(const Cached& rule, const Sum& sum, Position& x, Three<uint32_t>&,
                                   Velocity& v, Extra* u) {
    gpu::finish(rule.rule, sum.at, x.at, v.at, u ? u->at : nullptr, type_in(x.last));
    // Cells are counted in 32 bits; what goes beyond in one step is on its way to infinity.
    bool sound = true;
    for (int a = 0; a < 3; ++a) sound = sound && x.at[a] > Real(-1e6) && x.at[a] < Real(1e6);
    return sound;
  }

  // What the coming step adds to v; `u` may be null unless the rule has PD types.
  template <class Cached>
  CUBOCT_DEVICE static void gains(const Cached& rule, const Sum& sum, const Velocity& v, const Extra* u,
                                  int type, double (&gain)[3]) {
    const RealType<Real>& of = rule.rule.types[type];
    for (int a = 0; a < 3; ++a)
      gain[a] = of.imposed[a]
                    ? 0
                    : static_cast<double>(velocity_gain(of, sum.at[a], v.at[a], u ? u->at : nullptr, a));
  }

  CUBOCT_DEVICE static Real whole(const View&, const Position& x, const Three<uint32_t>&, int axis) {
    return x.at[axis];
  }

  // In cutoffs.
  CUBOCT_DEVICE static float along(const View&, const GridView&, const Position& x, int axis) {
    return static_cast<float>(x.at[axis]);
  }
  CUBOCT_DEVICE static int cells_off(const View& view, const GridView&, const Position& x, int axis) {
    return static_cast<int>(floor(x.at[axis] / view.edge[axis]));
  }
  CUBOCT_DEVICE static void take_off(const View& view, const GridView&, Position& x, int axis, int cells) {
    x.at[axis] -= static_cast<Real>(cells) * view.edge[axis];
  }
};

}  // namespace cuboct::gpu
