// SPDX-License-Identifier: MIT
// The two kernels of a step of the linear peridynamic solid, a thread a particle. Lengths, volumes, pressures
// and times are in the units of emu/gpu/lps/lps_layout.h.
#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>

#include "emu/gpu/device/device.h"
#include "emu/gpu/grid_view.h"
#include "emu/gpu/lps/lps_layout.h"
#include "emu/gpu/particle.h"
#include "model/rules/lps_bond.h"

namespace cuboct::gpu {

template <class Real>
struct alignas(16) LpsKindOf {
  Real r[3], length, weight, pull, critical, volume;  // as LpsKind
};

// What a type does to its particles, per step.
template <class Real>
struct LpsType {
  Real kick = 0;  // velocity per force density
  Real gravity[3] = {}, velocity[3] = {};
  uint32_t imposed = 0;  // bit per axis
};

// `Kind`: a number of that type tells a bond's kind.
template <class Real, class Kind>
struct LpsView {
  const LpsKindOf<Real>* kinds;
  const uint32_t *slice, *count, *other;
  const Kind* kind;
  Real* most;     // [slot]: largest stretch so far, of particles that are `hurt`; else less than 0
  uint8_t* hurt;  // [particle]: some bond of it has given way
  Four<Real, Real>*now, *ready;  // displacement; the same with the pressure of the dilatation round
  Three<Real>* v;
  const Three<double>* packed;  // in doubles alone: where it stood
  const Real* inverse;          // 1 over the weighted volume
  Real* dilatation;
  const uint8_t* type;
  const LpsType<Real>* types;
  uint32_t* lost;  // the least particle whose position is no number
  Real dimensions, factor, width, dt;
  bool breaks;

  CUBOCT_DEVICE uint32_t first(uint32_t i) const { return slice[i / kLpsLanes] + i % kLpsLanes; }
  CUBOCT_DEVICE Real left(uint32_t slot, const LpsKindOf<Real>& bond) const {
    return intact_share(most[slot], bond.critical, width);
  }
};

// The displacement of `far` less that of `near`.
template <class Real>
CUBOCT_DEVICE inline Three<Real> moved_between(const Four<Real, Real>& near, const Four<Real, Real>& far) {
  return {{far.at[0] - near.at[0], far.at[1] - near.at[1], far.at[2] - near.at[2]}};
}

// The dilatation round. With `keeps` bonds give way: a step is being made.
template <class Real, class Kind, bool kFinite>
struct LpsDilate {
  LpsView<Real, Kind> w;
  bool keeps;

  CUBOCT_DEVICE void operator()(uint32_t i) const {
    const Four<Real, Real> here = load(w.now + i);
    const uint32_t count = w.count[i];
    bool hurt = w.breaks && w.hurt[i] != 0;
    Real sum = 0;
    uint32_t slot = w.first(i);
    for (uint32_t k = 0; k < count; ++k, slot += kLpsLanes) {
      const LpsKindOf<Real> bond = load(w.kinds + w.kind[slot]);
      const Three<Real> moved = moved_between(here, load(w.now + w.other[slot]));
      const LpsBondNow<Real> now = lps_now(bond.r, bond.length, moved.at);
      const Real weight = bond.weight * (w.breaks ? left(i, slot, bond, now.longer / bond.length, hurt) : 1);
      sum += kFinite ? lps_opening(now, bond.length, weight) : lps_small_opening(bond.r, moved.at, weight);
    }
    const LpsDilated<Real> made = lps_dilated(sum, w.inverse[i], w.dimensions, w.factor);
    w.dilatation[i] = made.dilatation;
    w.ready[i] = {{here.at[0], here.at[1], here.at[2]}, made.pressure};
  }

 private:
  // A particle all of whose bonds are whole reads and writes none of their stretches.
  CUBOCT_DEVICE Real left(uint32_t i, uint32_t slot, const LpsKindOf<Real>& bond, Real stretch,
                          bool& hurt) const {
    if (!keeps) return hurt ? w.left(slot, bond) : Real(1);
    if (!hurt) {
      if (intact_share(stretch, bond.critical, w.width) == 1) return 1;
      w.hurt[i] = 1, hurt = true;
    }
    if (stretch > w.most[slot]) w.most[slot] = stretch;
    return w.left(slot, bond);
  }
};

// The force round, and the step that it makes.
template <class Real, class Kind, bool kFinite>
struct LpsMove {
  LpsView<Real, Kind> w;

  CUBOCT_DEVICE void operator()(uint32_t i) const {
    const Four<Real, Real> here = load(w.ready + i);
    const Three<Real> force = pull(i, here);
    const LpsType<Real> type = w.types[w.type[i]];
    Three<Real> v = w.v[i];
    Four<Real, Real> next{};
    bool finite = true;
    for (int a = 0; a < 3; ++a) {
      const Real acceleration = force.at[a] * type.kick + type.gravity[a];
      v.at[a] = (type.imposed >> a & 1u) != 0 ? type.velocity[a] : v.at[a] + acceleration * w.dt;
      next.at[a] = moved(i, a, here.at[a], v.at[a] * w.dt);
      finite &= next.at[a] - next.at[a] == 0;
    }
    w.v[i] = v;
    w.now[i] = next;
    if (!finite) atomic_min(w.lost, i);
  }

 private:
  CUBOCT_DEVICE Three<Real> pull(uint32_t i, const Four<Real, Real>& here) const {
    const uint32_t count = w.count[i];
    const bool hurt = w.breaks && w.hurt[i] != 0;
    Three<Real> sum{};
    uint32_t slot = w.first(i);
    for (uint32_t k = 0; k < count; ++k, slot += kLpsLanes) {
      const LpsKindOf<Real> bond = load(w.kinds + w.kind[slot]);
      const Four<Real, Real> far = load(w.ready + w.other[slot]);
      const Three<Real> moved = moved_between(here, far);
      const Real weight = hurt ? bond.weight * w.left(slot, bond) : bond.weight;
      const Real pressure = here.last + far.last;
      if constexpr (kFinite) {
        const LpsBondNow<Real> now = lps_now(bond.r, bond.length, moved.at);
        const Real size = lps_pull(now, bond.length, weight, pressure, bond.pull);
        for (int a = 0; a < 3; ++a) sum.at[a] += size * now.y[a];
      } else {
        const Real size = lps_small_pull(bond.r, moved.at, bond.length, weight, pressure, bond.pull);
        for (int a = 0; a < 3; ++a) sum.at[a] += size * bond.r[a];
      }
    }
    return sum;
  }
  // In doubles the position is rounded, as that of the reference. Floats keep the displacement alone.
  CUBOCT_DEVICE Real moved(uint32_t i, int axis, Real u, Real by) const {
    if constexpr (std::is_same_v<Real, double>) return (w.packed[i].at[axis] + u + by) - w.packed[i].at[axis];
    return u + by;
  }
};

// The share of a particle's bonds that is gone, by volume.
template <class Real, class Kind>
struct LpsDamage {
  LpsView<Real, Kind> w;
  Real* out;

  CUBOCT_DEVICE void operator()(uint32_t i) const {
    out[i] = 0;
    if (!w.breaks || w.hurt[i] == 0) return;
    Real whole = 0, here = 0;
    uint32_t slot = w.first(i);
    for (uint32_t k = 0; k < w.count[i]; ++k, slot += kLpsLanes) {
      const LpsKindOf<Real> bond = load(w.kinds + w.kind[slot]);
      whole += bond.volume, here += bond.volume * w.left(slot, bond);
    }
    out[i] = 1 - here / whole;
  }
};

}  // namespace cuboct::gpu
