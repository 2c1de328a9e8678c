// SPDX-License-Identifier: MIT
// Compiled once per instruction set. Products and sums are rounded apart and as PairLaw::energy() has them,
// so that all give the same bits.
#include "model/contract/law_energies.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "model/contract/law_energies.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cuboct::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

HWY_INLINE V set(double value) { return hn::Set(D(), value); }

template <class Law>
HWY_INLINE void each(const Law& law, const EnergyEnds& ends, std::span<const double> r,
                     std::span<double> energy) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  const V core2 = set(ends.core * ends.core), half_slope = set(0.5 * ends.core_slope);
  const auto of = [&](V at) HWY_ATTR {
    const V inner = hn::Add(set(ends.core_energy), hn::Mul(half_slope, hn::Sub(core2, hn::Mul(at, at))));
    const V outer = hn::IfThenElse(hn::Lt(at, set(ends.core)), inner, law.outer(at));
    return hn::IfThenElseZero(hn::Lt(at, set(ends.cutoff)), outer);
  };
  size_t k = 0;
  for (; k + lanes <= r.size(); k += lanes) hn::StoreU(of(hn::LoadU(d, &r[k])), d, &energy[k]);
  if (k == r.size()) return;
  double rest[HWY_MAX_BYTES / sizeof(double)];
  std::fill_n(rest, lanes, r[k]);
  std::copy(r.begin() + static_cast<ptrdiff_t>(k), r.end(), rest);
  hn::StoreU(of(hn::LoadU(d, rest)), d, rest);
  std::copy_n(rest, r.size() - k, &energy[k]);
}

struct LennardJones {
  const LennardJonesEnergy& law;
  HWY_INLINE V outer(V r) const {
    const V q = hn::Div(set(law.sigma), r);
    const V q2 = hn::Mul(q, q);
    const V sixth = hn::Mul(hn::Mul(q2, q2), q2);
    const V whole = hn::Mul(hn::Mul(set(law.epsilon4), sixth), hn::Sub(sixth, set(1)));
    return hn::Sub(hn::Sub(whole, set(law.end_energy)),
                   hn::Mul(set(law.end_force), hn::Sub(set(law.end), r)));
  }
};

// `Terms`: how a vector of pieces finds their numbers.
template <class Terms>
HWY_INLINE V on_piece(V r, const Terms& of) {
  const V t = hn::Div(hn::Sub(r, of(CubicEnergy::start)), of(CubicEnergy::width));
  V sum = hn::Add(of(CubicEnergy::c2), hn::Mul(t, of(CubicEnergy::c3)));
  sum = hn::Add(of(CubicEnergy::c1), hn::Mul(t, sum));
  sum = hn::Add(of(CubicEnergy::c0), hn::Mul(t, sum));
  const V rest = hn::Sub(of(CubicEnergy::whole), hn::Mul(t, sum));
  return hn::Add(of(CubicEnergy::after), hn::Mul(of(CubicEnergy::width), rest));
}

// The pieces of a preset are few: a choice for each is less than a gather.
struct FewPieces {
  static constexpr size_t kMost = 6;
  const CubicEnergy& law;
  HWY_INLINE V outer(V r) const {
    return on_piece(r, [&](size_t term) HWY_ATTR {
      const std::vector<double>& starts = law.term[CubicEnergy::start];
      const double* const values = law.term[term].data();
      V value = set(values[0]);
      for (size_t k = 1; k < starts.size(); ++k)
        value = hn::IfThenElse(hn::Ge(r, set(starts[k])), set(values[k]), value);
      return value;
    });
  }
};

struct ManyPieces {
  const CubicEnergy& law;
  HWY_INLINE V outer(V r) const {
    const hn::RebindToSigned<D> i;
    const std::vector<double>& starts = law.term[CubicEnergy::start];
    auto piece = hn::Zero(i);
    for (size_t k = 1; k < starts.size(); ++k)
      piece = hn::Add(piece, hn::IfThenElseZero(hn::RebindMask(i, hn::Ge(r, set(starts[k]))), hn::Set(i, 1)));
    return on_piece(r,
                    [&](size_t term) HWY_ATTR { return hn::GatherIndex(D(), law.term[term].data(), piece); });
  }
};

void lennard_jones(const LennardJonesEnergy& law, const EnergyEnds& ends, std::span<const double> r,
                   std::span<double> energy) {
  each(LennardJones{law}, ends, r, energy);
}
void cubics(const CubicEnergy& law, const EnergyEnds& ends, std::span<const double> r,
            std::span<double> energy) {
  if (law.term[0].size() <= FewPieces::kMost)
    each(FewPieces{law}, ends, r, energy);
  else
    each(ManyPieces{law}, ends, r, energy);
}

}  // namespace cuboct::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cuboct {

HWY_EXPORT(lennard_jones);
HWY_EXPORT(cubics);

void energies_of(const LennardJonesEnergy& law, const EnergyEnds& ends, std::span<const double> r,
                 std::span<double> energy) {
  HWY_DYNAMIC_DISPATCH(lennard_jones)(law, ends, r, energy);
}
void energies_of(const CubicEnergy& law, const EnergyEnds& ends, std::span<const double> r,
                 std::span<double> energy) {
  HWY_DYNAMIC_DISPATCH(cubics)(law, ends, r, energy);
}

}  // namespace cuboct
#endif
