// SPDX-License-Identifier: MIT
// Compiled once per instruction set: those of model/atoms/bond_order/tersoff_kernel.cpp, whose lanes lists
// have.
#include "model/atoms/multiscale/spring_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "model/atoms/multiscale/spring_kernel.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cuboct::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

// The springs of all shells at distance r: force and energy.
HWY_INLINE void springs_at(const ShellSprings& springs, V r, V& force, V& energy) {
  const D d;
  const double inverse = 1 / springs.width;
  force = energy = hn::Zero(d);
  for (const ShellSprings::Shell& shell : springs.shells) {
    const V u = hn::Sub(r, hn::Set(d, shell.rest)), part = hn::Mul(u, hn::Set(d, inverse));
    const V q = hn::Max(hn::NegMulAdd(part, part, hn::Set(d, 1)), hn::Zero(d)), q2 = hn::Mul(q, q);
    force = hn::MulAdd(hn::Mul(hn::Set(d, shell.stiffness), u), q2, force);
    energy = hn::MulAdd(hn::Set(d, -shell.stiffness / (6 * inverse * inverse)), hn::Mul(q2, q), energy);
  }
}

void spring_forces(const ShellSprings& springs, const BondList& list, const double* x, double* sums) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  const hn::RebindToSigned<D> wide;
  const hn::Rebind<int32_t, D> narrow;
  const V half = hn::Set(d, 0.5), tiny = hn::Set(d, 1e-300);
  for (size_t group = 0; group < list.groups(); ++group) {
    V home[3], unused, sum[10];
    for (V& one : sum) one = hn::Zero(d);
    hn::LoadInterleaved4(d, x + 4 * group * lanes, home[0], home[1], home[2], unused);
    for (size_t row = list.first_row()[group]; row < list.first_row()[group + 1]; ++row) {
      const auto index = hn::PromoteTo(
          wide, hn::LoadU(narrow, reinterpret_cast<const int32_t*>(list.entry().data() + row * lanes)));
      V to[3];
      for (int a = 0; a < 3; ++a) to[a] = hn::Sub(hn::GatherIndex(d, x + a, index), home[a]);
      const V r2 = hn::MulAdd(to[2], to[2], hn::MulAdd(to[1], to[1], hn::Mul(to[0], to[0])));
      const V r = hn::Sqrt(r2);
      V force, energy;
      springs_at(springs, r, force, energy);
      const V share = hn::Div(force, hn::Max(r, tiny));
      V pull[3];
      for (int a = 0; a < 3; ++a) pull[a] = hn::Mul(share, to[a]), sum[a] = hn::Add(sum[a], pull[a]);
      sum[3] = hn::MulAdd(half, energy, sum[3]);
      constexpr int kAxes[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
      for (int k = 0; k < 6; ++k)
        sum[4 + k] = hn::MulAdd(hn::Mul(half, to[kAxes[k][0]]), pull[kAxes[k][1]], sum[4 + k]);
    }
    for (size_t k = 0; k < 10; ++k) hn::StoreU(sum[k], d, sums + (group * 10 + k) * lanes);
  }
}

}  // namespace cuboct::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cuboct {

HWY_EXPORT(spring_forces);

void spring_forces(const ShellSprings& springs, const BondList& list, const double* x, double* sums) {
  HWY_DYNAMIC_DISPATCH(spring_forces)(springs, list, x, sums);
}

}  // namespace cuboct
#endif
