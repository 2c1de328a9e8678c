// SPDX-License-Identifier: MIT
// A relaxation of a small periodic sample under Tersoff's potential as a node would compute it: sums and
// products alone, functions from tables by squares of distances and by cosines, one division a step. For any
// number: doubles with exact functions (then it is TersoffForces with relax_sample's steps, as a test says),
// or numbers of some width that count what is done with them (study/sample_node/sample_node.h).
//
//   bond   r^2 -> 1/r, fc, fc', P = fc A exp(-l1 r)/2, P', Q = fc B exp(-l2 r)/2, Q'
//   pair   cos -> g, g';  r_j - r_k -> exp((l3 (r_j - r_k))^m), its slope over it
//   order  zeta -> b, b'
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model/atoms/bond_order/tersoff_terms.h"

namespace cuboct {

// As they stand in the sample's memory.
template <class Real>
struct DatapathSample {
  using Triple = std::array<Real, 3>;
  struct Bond {
    uint32_t other = 0;
    Triple shift{};  // to the image
  };
  std::vector<Triple> x;
  std::vector<uint32_t> first;  // of each atom's bonds, and the end
  std::vector<Bond> bonds;
};

template <class Real>
struct DatapathForces {
  std::vector<std::array<Real, 3>> f;
  std::array<Real, 6> virial{};  // xx, yy, zz, yz, xz, xy of sum d_ij G_ij
  Real energy{};
};

template <class Real>
struct DatapathBond {
  std::array<Real, 3> d{}, e{}, t{};  // to the other atom; unit vector; of G, what is across the bond
  Real r{}, inverse_r{}, cut{}, cut_slope{}, push{}, push_slope{}, pull{}, pull_slope{}, zeta{}, p{},
      radial{};
};
template <class Real>
struct DatapathPair {
  Real cosine{}, g{}, g_slope{}, stretch_jk{}, over_jk{}, stretch_kj{}, over_kj{};
};

// Of an atom, in turn. The second and the fourth take its pairs of bonds one by one, the others its bonds.
enum class DatapathStage : uint8_t { meet, angles, orders, turns, add };
inline constexpr size_t kDatapathStages = 5;

template <class Real>
Real dot(const std::array<Real, 3>& a, const std::array<Real, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// `tables`: bond(r2, DatapathBond&), angle(cosine, g, slope), stretch(x, value, over), order(zeta, b, slope),
// and `stretched`, whether lambda3 is not 0.
template <class Real, class Tables>
class TersoffDatapath {
 public:
  explicit TersoffDatapath(const Tables& tables) : tables_(tables) {}

  void evaluate(const DatapathSample<Real>& sample, DatapathForces<Real>& out) {
    evaluate(sample, out, [](DatapathStage) {});
  }
  // `after(stage)` once for each stage of each atom.
  template <class After>
  void evaluate(const DatapathSample<Real>& sample, DatapathForces<Real>& out, const After& after) {
    out = {};
    out.f.resize(sample.x.size());
    for (uint32_t i = 0; i + 1 < sample.first.size(); ++i) {
      meet(sample, i), after(DatapathStage::meet);
      angles(), after(DatapathStage::angles);
      orders(out), after(DatapathStage::orders);
      turns(), after(DatapathStage::turns);
      add(sample, i, out), after(DatapathStage::add);
    }
  }

 private:
  using Bond = DatapathBond<Real>;
  using Pair = DatapathPair<Real>;

  void meet(const DatapathSample<Real>& sample, uint32_t i) {
    bonds_.clear();
    for (uint32_t at = sample.first[i]; at < sample.first[i + 1]; ++at) {
      const auto& [other, shift] = sample.bonds[at];
      Bond bond;
      for (size_t a = 0; a < 3; ++a) bond.d[a] = sample.x[other][a] + shift[a] - sample.x[i][a];
      const Real r2 = dot(bond.d, bond.d);
      tables_.bond(r2, bond);
      bond.r = r2 * bond.inverse_r;
      for (size_t a = 0; a < 3; ++a) bond.e[a] = bond.d[a] * bond.inverse_r;
      bonds_.push_back(bond);
    }
  }

  template <class On>
  void for_each_pair(const On& on) {
    size_t n = 0;
    for (size_t j = 0; j < bonds_.size(); ++j)
      for (size_t k = j + 1; k < bonds_.size(); ++k) on(bonds_[j], bonds_[k], pairs_[n++]);
  }

  void angles() {
    pairs_.assign(bonds_.size() * bonds_.size() / 2, {});
    for_each_pair([&](Bond& j, Bond& k, Pair& pair) {
      pair.cosine = dot(j.e, k.e);
      tables_.angle(pair.cosine, pair.g, pair.g_slope);
      Real on_j = pair.g * k.cut, on_k = pair.g * j.cut;
      if (tables_.stretched) {
        tables_.stretch(j.r - k.r, pair.stretch_jk, pair.over_jk);
        tables_.stretch(k.r - j.r, pair.stretch_kj, pair.over_kj);
        on_j = on_j * pair.stretch_jk, on_k = on_k * pair.stretch_kj;
      }
      j.zeta = j.zeta + on_j, k.zeta = k.zeta + on_k;
    });
  }

  void orders(DatapathForces<Real>& out) {
    for (Bond& bond : bonds_) {
      Real b, slope;
      tables_.order(bond.zeta, b, slope);
      out.energy = out.energy + (bond.push - b * bond.pull);
      bond.p = bond.pull * slope;  // minus of what moves the energy with zeta
      bond.radial = bond.push_slope - b * bond.pull_slope;
    }
  }

  // As in tersoff_kernel.cpp: dcos/dd_j = (e_k - cos e_j)/r_j.
  void turns() {
    for_each_pair([&](Bond& j, Bond& k, const Pair& pair) {
      Real to_j = j.p, to_k = k.p;
      if (tables_.stretched) to_j = to_j * pair.stretch_jk, to_k = to_k * pair.stretch_kj;
      const Real k_share = to_j * k.cut, j_share = to_k * j.cut;
      const Real turning = (k_share + j_share) * pair.g_slope;
      Real on_j = to_k * j.cut_slope, on_k = to_j * k.cut_slope;
      if (tables_.stretched) {
        const Real pull = k_share * pair.over_jk - j_share * pair.over_kj;
        on_j = on_j + pull, on_k = on_k - pull;
      }
      const Real cos_j = turning * j.inverse_r, cos_k = turning * k.inverse_r;
      j.radial = j.radial - (pair.g * on_j - pair.cosine * cos_j);
      k.radial = k.radial - (pair.g * on_k - pair.cosine * cos_k);
      for (size_t a = 0; a < 3; ++a) j.t[a] = j.t[a] - cos_j * k.e[a], k.t[a] = k.t[a] - cos_k * j.e[a];
    });
  }

  void add(const DatapathSample<Real>& sample, uint32_t i, DatapathForces<Real>& out) {
    static constexpr size_t kAxes[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
    uint32_t at = sample.first[i];
    for (const Bond& bond : bonds_) {
      std::array<Real, 3> partial;
      for (size_t a = 0; a < 3; ++a) partial[a] = bond.radial * bond.e[a] + bond.t[a];
      auto &own = out.f[i], &other = out.f[sample.bonds[at++].other];
      for (size_t a = 0; a < 3; ++a) own[a] = own[a] + partial[a], other[a] = other[a] - partial[a];
      for (size_t k = 0; k < 6; ++k)
        out.virial[k] = out.virial[k] + bond.d[kAxes[k][0]] * partial[kAxes[k][1]];
    }
  }

  const Tables& tables_;
  std::vector<Bond> bonds_;
  std::vector<Pair> pairs_;
};

// The functions themselves, in doubles.
struct TersoffExact {
  explicit TersoffExact(const TersoffTerm<double>& term) : t(term), stretched(term.lambda3 != 0) {}
  void bond(double r2, DatapathBond<double>& out) const {
    const double r = std::sqrt(r2);
    const auto cut = tersoff_cutoff(t, r), push = tersoff_repulsion(t, r), pull = tersoff_attraction(t, r);
    out.inverse_r = 1 / r, out.cut = cut.value, out.cut_slope = cut.slope;
    out.push = cut.value * push.value / 2;
    out.push_slope = (cut.slope * push.value + cut.value * push.slope) / 2;
    out.pull = cut.value * pull.value / 2;
    out.pull_slope = (cut.slope * pull.value + cut.value * pull.slope) / 2;
  }
  void angle(double cosine, double& g, double& slope) const {
    const auto at = tersoff_angle(t, cosine);
    g = at.value, slope = at.slope;
  }
  void stretch(double x, double& value, double& over) const {
    value = tersoff_stretch(t, x).value;
    over = t.m == 3 ? 3 * t.lambda3 * t.lambda3 * t.lambda3 * x * x : t.lambda3;
  }
  void order(double zeta, double& b, double& slope) const {
    const auto at = tersoff_order(t, zeta);
    b = at.value, slope = at.slope;
  }
  TersoffTerm<double> t;
  bool stretched;
};

// Products whose small bits count: in fixed point those of two small numbers.
inline double whole_product(double a, double b) { return a * b; }

// Barzilai and Borwein's steps (model/atoms/multiscale/atomic_sample.h). `quotient(a, b)` divides and clamps.
// Until no component of a force is above `force`, or `most` evaluations; returns their number.
template <class Real, class Tables, class Quotient>
uint32_t relax_by_datapath(const Tables& tables, DatapathSample<Real>& sample, DatapathForces<Real>& now,
                           Real length, Real force, uint32_t most, const Quotient& quotient) {
  TersoffDatapath<Real, Tables> datapath(tables);
  datapath.evaluate(sample, now);
  DatapathForces<Real> last;
  for (uint32_t evaluations = 1;; ++evaluations) {
    bool rests = true;
    for (const auto& f : now.f)
      for (const Real& component : f) rests = !(component > force) && !(-component > force) && rests;
    if (rests || evaluations >= most) return evaluations;
    for (size_t i = 0; i < sample.x.size(); ++i)
      for (size_t a = 0; a < 3; ++a) sample.x[i][a] = sample.x[i][a] + length * now.f[i][a];
    last.f.swap(now.f);
    datapath.evaluate(sample, now);
    Real way{}, bend{};  // of step s = length f: s s/length and s (last - now)/length
    for (size_t i = 0; i < sample.x.size(); ++i) {
      std::array<Real, 3> change;
      for (size_t a = 0; a < 3; ++a) change[a] = last.f[i][a] - now.f[i][a];
      for (size_t a = 0; a < 3; ++a) {
        way = way + whole_product(last.f[i][a], last.f[i][a]);
        bend = bend + whole_product(last.f[i][a], change[a]);
      }
    }
    length = length * quotient(way, bend);
  }
}

}  // namespace cuboct
