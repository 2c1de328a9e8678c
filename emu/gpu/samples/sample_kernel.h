// SPDX-License-Identifier: MIT
// Many small periodic samples of one element under Tersoff's potential, each in the shared memory of one
// block: atoms, bonds and forces leave it when the block ends. The formulas are
// model/atoms/bond_order/tersoff_terms.h.
//
// A bond is an ordered pair (i, j, image) nearer than cutoff + skin, one thread's work: it reads the bonds of
// its atom i and makes the partial force G_ij = dE_i/d(x_j - x_i). F_i = sum_j (G_ij - G_ji) needs no
// atomics. Z. Fan et al., Phys. Rev. B 92 (2015) 094301.
#pragma once

#include <cmath>
#include <cstdint>

#include "emu/gpu/device/device.h"
#include "emu/gpu/grid_view.h"
#include "model/atoms/bond_order/tersoff_terms.h"
#include "model/atoms/multiscale/sample_descent.h"

namespace cuboct::gpu {

enum class SampleFault : uint32_t { none, too_many_bonds, not_finite };

// What a sample leaves; energy in the unit of A, lengths in that of R.
template <class Real>
struct SampleSums {
  Real energy = 0;
  Real virial[6] = {};  // xx, yy, zz, yz, xz, xy of dE/dstrain
  Real force = 0;       // the largest component of any atom's
  uint32_t steps = 0;   // that relaxing took
  SampleFault fault = SampleFault::none;
};

// All samples, in the device's memory; [sample][axis][atom].
template <class Real>
struct SamplesView {
  Real* x = nullptr;
  Real* v = nullptr;
  Real* f = nullptr;
  const Real* cell = nullptr;     // [sample][9]: the edge vectors, one after the other
  const Real* inverse = nullptr;  // [sample][9]: its rows times x are shares of the edges
  SampleSums<Real>* sums = nullptr;
};

template <class Real>
struct SampleRule {
  TersoffTerm<Real> term;
  Real skin = 0;
  uint32_t atoms = 0, most_bonds = 0;  // most_bonds: of a sample, both ways
};

// Threads of a block: a bond each, of four an atom. More than 512 leave fewer blocks to a processor.
inline int sample_threads(uint32_t atoms) {
  const uint32_t threads = (4 * atoms + 31) / 32 * 32;
  return static_cast<int>(threads < 32 ? 32 : threads > 512 ? 512 : threads);
}

// What a block does with its sample.
template <class Real>
struct SampleTask {
  enum class Kind : uint8_t { evaluate, advance, relax } kind = Kind::evaluate;
  uint32_t steps = 0;     // advance: of velocity Verlet; relax: evaluations at most
  Real dt = 0;            // advance alone
  Real inverse_mass = 0;  // the same
  Real tolerance = 0;     // relax: the largest component of a force at rest
  Real stiffness = 0;     // relax: of the stiffest vibration
};

// The shared memory of a block, carved up. Bytes: SampleMemory<Real>::bytes(rule).
template <class Real>
struct SampleMemory {
  Real *x, *v, *f, *at;             // [axis * atoms + atom]; `at`: positions when bonds were listed
  Real *unit, *r, *fc, *order, *g;  // of bonds: direction [axis * most_bonds + b], length, fc, dE/dzeta, G
  Real* radial;                     // dE_b/dr at a fixed zeta
  Real* shift;                      // [axis * 27 + image]
  Real* scratch;                    // [kScratch * atoms]
  uint16_t *first, *owner, *partner, *back;  // `back`: the same bond from its other end
  uint8_t* image;
  uint32_t* flag;  // [0]: atoms have moved half a skin; [1]: bonds that were found

  static constexpr uint32_t kScratch = 7;

  CUBOCT_HD static uint32_t reals(const SampleRule<Real>& rule) {
    return (12 + kScratch) * rule.atoms + 10 * rule.most_bonds + 3 * 27;
  }
  CUBOCT_HD static uint32_t bytes(const SampleRule<Real>& rule) {
    const uint32_t shorts = rule.atoms + 1 + 3 * rule.most_bonds;
    return (reals(rule) * static_cast<uint32_t>(sizeof(Real)) + 2 * (shorts + shorts % 2) + 8 +
            rule.most_bonds + 15) /
           16 * 16;
  }
  // Of 4 bytes, from `flag` to the end of `image`: the list of bonds.
  CUBOCT_HD static uint32_t list_words(const SampleRule<Real>& rule) {
    return (8 + 2 * (rule.atoms + 1 + 3 * rule.most_bonds) + rule.most_bonds + 3) / 4;
  }
  CUBOCT_DEVICE SampleMemory(void* memory, const SampleRule<Real>& rule) {
    auto* real = static_cast<Real*>(memory);
    const auto take = [&](uint32_t count) {
      Real* at = real;
      real += count;
      return at;
    };
    const uint32_t n = rule.atoms, b = rule.most_bonds;
    x = take(3 * n), v = take(3 * n), f = take(3 * n), this->at = take(3 * n), scratch = take(kScratch * n);
    unit = take(3 * b), r = take(b), fc = take(b), order = take(b), g = take(3 * b), radial = take(b);
    shift = take(3 * 27);
    flag = reinterpret_cast<uint32_t*>(real);
    first = reinterpret_cast<uint16_t*>(flag + 2);
    owner = first + n + 1, partner = owner + b, back = partner + b;
    image = reinterpret_cast<uint8_t*>(back + b);
  }
};

// One block at work on one sample. Code outside `each` is run by all of a block's threads alike.
template <class Real, class Block>
class SampleBlock {
 public:
  CUBOCT_DEVICE SampleBlock(const Block& block, const SampleRule<Real>& rule, const Real* cell,
                            const Real* inverse, void* memory)
      : block_(block),
        rule_(rule),
        cell_(cell),
        inverse_(inverse),
        m_(memory, rule),
        n_(rule.atoms),
        stride_(rule.most_bonds) {}

  CUBOCT_DEVICE void load(const Real* x, const Real* v) {
    block_.each(3 * n_, [&](uint32_t k) { m_.x[k] = x[k], m_.v[k] = v[k]; });
    place_images();
  }
  CUBOCT_DEVICE void store(Real* x, Real* v, Real* f) const {
    block_.each(3 * n_, [&](uint32_t k) { x[k] = m_.x[k], v[k] = m_.v[k], f[k] = m_.f[k]; });
  }

  // Fractions of the edges, of atoms that all stand `away` further along each.
  CUBOCT_DEVICE void load_places(const Real* place, Real away) {
    block_.each(n_, [&](uint32_t i) {
      for (int a = 0; a < 3; ++a) {
        Real sum = 0;
        for (int e = 0; e < 3; ++e) sum += cell_[3 * e + a] * (place[n_ * e + i] + away);
        m_.x[n_ * a + i] = sum;
      }
    });
    place_images();
  }
  CUBOCT_DEVICE void store_places(Real* place, Real away) const {
    block_.each(n_, [&](uint32_t i) {
      for (int e = 0; e < 3; ++e)
        place[n_ * e + i] = share(e, m_.x[i], m_.x[n_ + i], m_.x[2 * n_ + i]) - away;
    });
  }

  // What list_bonds left, for other samples of the lattice.
  CUBOCT_DEVICE void store_list(uint32_t* words) const {
    block_.each(SampleMemory<Real>::list_words(rule_), [&](uint32_t k) { words[k] = m_.flag[k]; });
  }
  // Takes the list that was made of atoms at `place` (fractions, less what load_places adds) in a cell whose
  // inverse is `was`, where it holds. With H = (1 + E) H_0, the vector between the atoms of a pair has
  // changed by E r_0 + H (d_j - d_i): less than |E| (cutoff + skin) + 2 max |H d| for each that may have come
  // near.
  CUBOCT_DEVICE bool take_list(const uint32_t* words, const Real* place, const Real* was, Real away) {
    Real strain2 = 0;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        Real sum = a == b ? Real(-1) : Real(0);
        for (int e = 0; e < 3; ++e) sum += cell_[3 * e + a] * was[3 * e + b];
        strain2 += sum * sum;
      }
    block_.each(n_, [&](uint32_t i) {
      Real way2 = 0;
      for (int a = 0; a < 3; ++a) {
        Real d = m_.x[n_ * a + i];
        for (int e = 0; e < 3; ++e) d -= cell_[3 * e + a] * (place[n_ * e + i] + away);
        way2 += d * d;
      }
      m_.scratch[i] = way2;
    });
    const Real farthest = std::sqrt(tree(n_, larger));
    const Real reach = rule_.term.R + rule_.term.D + rule_.skin;
    left_ = rule_.skin - std::sqrt(strain2) * reach - 2 * farthest;
    if (!(left_ > 0)) return false;
    block_.each(SampleMemory<Real>::list_words(rule_), [&](uint32_t k) { m_.flag[k] = words[k]; });
    block_.each(3 * n_, [&](uint32_t k) { m_.at[k] = m_.x[k]; });
    bonds_ = m_.flag[1];
    return true;
  }

  // Wraps the atoms into the cell and lists all bonds. False where there are more than memory holds.
  CUBOCT_DEVICE bool list_bonds() {
    block_.each(n_, [&](uint32_t i) { wrap(i); });
    block_.each(n_, [&](uint32_t i) {
      uint32_t found = 0;
      each_near(i, [&](uint32_t, uint32_t) { ++found; });
      m_.first[i + 1] = static_cast<uint16_t>(found < 0xffff ? found : 0xffff);
    });
    block_.each(1, [&](uint32_t) {
      uint32_t sum = 0;
      m_.first[0] = 0;
      for (uint32_t i = 0; i < n_ && sum <= stride_; ++i)
        sum += m_.first[i + 1], m_.first[i + 1] = static_cast<uint16_t>(sum);
      m_.flag[0] = 0, m_.flag[1] = sum;
    });
    bonds_ = m_.flag[1], left_ = rule_.skin;
    if (bonds_ > stride_) return false;
    block_.each(n_, [&](uint32_t i) {
      uint32_t b = m_.first[i];
      each_near(i, [&](uint32_t j, uint32_t image) {
        m_.owner[b] = static_cast<uint16_t>(i), m_.partner[b] = static_cast<uint16_t>(j);
        m_.image[b++] = static_cast<uint8_t>(image);
      });
    });
    block_.each(bonds_, [&](uint32_t b) {
      const uint32_t j = m_.partner[b], image = 26u - m_.image[b];
      m_.back[b] = static_cast<uint16_t>(b);  // roundings may list one end alone, at the rim of the skin
      for (uint32_t t = m_.first[j]; t < m_.first[j + 1]; ++t)
        if (m_.partner[t] == m_.owner[b] && m_.image[t] == image) m_.back[b] = static_cast<uint16_t>(t);
    });
    return true;
  }

  // Fills forces. The bonds must hold: see `moved`.
  CUBOCT_DEVICE void forces() {
    block_.each(bonds_, [&](uint32_t b) { stretch_of(b); });
    block_.each(bonds_, [&](uint32_t b) { order_of(b); });
    block_.each(bonds_, [&](uint32_t b) { partial_of(b); });
    block_.each(n_, [&](uint32_t i) {
      for (int a = 0; a < 3; ++a) {
        Real sum = 0;
        for (uint32_t b = m_.first[i]; b < m_.first[i + 1]; ++b)
          sum += m_.g[stride_ * a + b] - m_.g[stride_ * a + m_.back[b]];
        m_.f[n_ * a + i] = sum;
      }
    });
  }

  // To be asked between two `each` calls where atoms were moved by `note_way`. True where bonds must be
  // listed.
  CUBOCT_DEVICE bool moved() const { return m_.flag[0] != 0; }

  // Velocity Verlet. False where a list had no room.
  CUBOCT_DEVICE bool advance(uint32_t steps, Real dt, Real inverse_mass) {
    const Real half = dt / 2 * inverse_mass;
    for (uint32_t k = 0; k < steps; ++k) {
      block_.each(n_, [&](uint32_t i) {
        for (int a = 0; a < 3; ++a) {
          const uint32_t at = n_ * a + i;
          m_.v[at] += half * m_.f[at];
          m_.x[at] += dt * m_.v[at];
        }
        note_way(i);
      });
      if (!renew()) return false;
      block_.each(3 * n_, [&](uint32_t at) { m_.v[at] += half * m_.f[at]; });
    }
    return true;
  }

  // As relax_sample of model/atoms/multiscale/atomic_sample.h. Forces must be there. Fills `steps` with the
  // evaluations. False where a list had no room.
  CUBOCT_DEVICE bool relax(const SampleTask<Real>& task, uint32_t* steps) {
    *steps = 1;
    bool rests = false;
    if (!descend(task, steps, &rests) || (!rests && !fall(task, steps))) return false;
    block_.each(3 * n_, [&](uint32_t at) { m_.v[at] = 0; });
    return true;
  }

  // Energy, virial and the largest force, of the last `forces`.
  CUBOCT_DEVICE void sums(SampleSums<Real>* out) {
    out->force = largest_force();
    block_.each(bonds_, [&](uint32_t b) { m_.radial[b] = energy_of(b); });
    constexpr int kFirst[] = {0, 1, 2, 1, 0, 0}, kSecond[] = {0, 1, 2, 2, 2, 1};
    block_.each(n_, [&](uint32_t i) {
      Real energy = 0;
      for (uint32_t b = m_.first[i]; b < m_.first[i + 1]; ++b) energy += m_.radial[b];
      m_.scratch[i] = energy;
      for (int k = 0; k < 6; ++k) {
        const uint32_t c = stride_ * kFirst[k], d = stride_ * kSecond[k];
        Real sum = 0;
        for (uint32_t b = m_.first[i]; b < m_.first[i + 1]; ++b)
          sum += m_.r[b] * (m_.unit[c + b] * m_.g[d + b] + m_.unit[d + b] * m_.g[c + b]);
        m_.scratch[n_ * (k + 1) + i] = sum / 2;
      }
    });
    tree_sums(7);
    out->energy = m_.scratch[0];
    for (int k = 0; k < 6; ++k) out->virial[k] = m_.scratch[n_ * (k + 1)];
    block_.each(0, [](uint32_t) {});  // before the scratch is used again
  }

 private:
  CUBOCT_DEVICE static int steps_along(uint32_t image, int edge) {
    for (int e = 0; e < edge; ++e) image /= 3;
    return static_cast<int>(image % 3) - 1;
  }

  CUBOCT_DEVICE void place_images() {
    block_.each(27, [&](uint32_t image) {
      for (int a = 0; a < 3; ++a) {
        Real sum = 0;
        for (int e = 0; e < 3; ++e) sum += cell_[3 * e + a] * static_cast<Real>(steps_along(image, e));
        m_.shift[27 * a + image] = sum;
      }
    });
  }
  CUBOCT_DEVICE Real share(int edge, Real x, Real y, Real z) const {
    return inverse_[3 * edge] * x + inverse_[3 * edge + 1] * y + inverse_[3 * edge + 2] * z;
  }

  CUBOCT_DEVICE void wrap(uint32_t i) {
    Real x[3] = {m_.x[i], m_.x[n_ + i], m_.x[2 * n_ + i]};
    for (int e = 0; e < 3; ++e) {
      const Real whole = std::floor(share(e, x[0], x[1], x[2]));
      if (whole != 0)
        for (int a = 0; a < 3; ++a) x[a] -= whole * cell_[3 * e + a];
    }
    for (int a = 0; a < 3; ++a) m_.x[n_ * a + i] = m_.at[n_ * a + i] = x[a];
  }

  // Calls f(j, image) for each atom within cutoff + skin of atom i, by image and then by atom.
  template <class F>
  CUBOCT_DEVICE void each_near(uint32_t i, const F& f) const {
    const Real most = rule_.term.R + rule_.term.D + rule_.skin, most2 = most * most;
    for (uint32_t image = 0; image < 27; ++image) {
      Real from[3];
      for (int a = 0; a < 3; ++a) from[a] = m_.x[n_ * a + i] - m_.shift[27 * a + image];
      for (uint32_t j = 0; j < n_; ++j) {
        Real r2 = 0;
        for (int a = 0; a < 3; ++a) {
          const Real d = m_.x[n_ * a + j] - from[a];
          r2 += d * d;
        }
        if (r2 < most2 && !(j == i && image == 13)) f(j, image);
      }
    }
  }

  CUBOCT_DEVICE void note_way(uint32_t i) {
    Real way2 = 0;
    for (int a = 0; a < 3; ++a) {
      const Real d = m_.x[n_ * a + i] - m_.at[n_ * a + i];
      way2 += d * d;
    }
    if (!(way2 < left_ * left_ / 4)) m_.flag[0] = 1;
  }

  // Downhill until at rest, or for as long as that pays. v holds the forces before the last step.
  CUBOCT_DEVICE bool descend(const SampleTask<Real>& task, uint32_t* steps, bool* rests) {
    Real length = 1 / task.stiffness, step = 0;
    while (true) {
      const Look now = look();
      *rests = now.most <= task.tolerance;
      // A force that is no number ends here too: it would leave atoms without bonds, and so at rest.
      if (!(now.most > task.tolerance) || *steps >= task.steps || *steps >= kDescentEvaluations) return true;
      if (step > 0) {
        const Real bend = now.bend, shortest = Real(kShortestDescent) / task.stiffness,
                   longest = Real(kLongestDescent) / task.stiffness;
        length = step * now.before / bend;
        length = !(bend > 0)         ? 1 / task.stiffness
                 : length < shortest ? shortest
                 : length > longest  ? longest
                                     : length;
      }
      step = length * now.most > Real(kLongestMove) ? Real(kLongestMove) / now.most : length;
      block_.each(n_, [&](uint32_t i) {
        for (int a = 0; a < 3; ++a) {
          const uint32_t at = n_ * a + i;
          m_.x[at] += step * m_.f[at];
          m_.v[at] = m_.f[at];
        }
        note_way(i);
      });
      if (!renew()) return false;
      ++*steps;
    }
  }

  // FIRE as in model/base/fire.cpp, whose constants and source it has.
  CUBOCT_DEVICE bool fall(const SampleTask<Real>& task, uint32_t* steps) {
    const Real radian = 1 / std::sqrt(task.stiffness);
    Real dt = Real(0.2) * radian, mixing = Real(0.25);
    int downhill = 0;
    bool first = true;
    block_.each(3 * n_, [&](uint32_t at) { m_.v[at] = 0; });
    for (; largest_force() > task.tolerance && *steps < task.steps; ++*steps) {
      if (dot(m_.f, m_.v) > 0) {
        if (++downhill > 20) {
          dt = dt * Real(1.1) < radian ? dt * Real(1.1) : radian;
          mixing *= Real(0.99);
        }
      } else {
        block_.each(3 * n_, [&](uint32_t at) { m_.x[at] -= dt / 2 * m_.v[at], m_.v[at] = 0; });
        if (!first) dt = dt / 2 > Real(0.002) * radian ? dt / 2 : Real(0.002) * radian;
        downhill = 0, mixing = Real(0.25);
      }
      first = false;
      block_.each(3 * n_, [&](uint32_t at) { m_.v[at] += dt * m_.f[at]; });
      const Real ff = dot(m_.f, m_.f), vv = dot(m_.v, m_.v);
      const Real turn = ff > 0 ? mixing * std::sqrt(vv / ff) : Real(0);
      block_.each(n_, [&](uint32_t i) {
        for (int a = 0; a < 3; ++a) {
          const uint32_t at = n_ * a + i;
          Real v = (1 - mixing) * m_.v[at] + turn * m_.f[at];
          const Real most = Real(kLongestMove) / dt;
          v = v > most ? most : v < -most ? -most : v;
          m_.v[at] = v;
          m_.x[at] += dt * v;
        }
        note_way(i);
      });
      if (!renew()) return false;
    }
    return true;
  }

  // Forces of atoms that have moved. False where a list had no room.
  CUBOCT_DEVICE bool renew() {
    if (moved() && !list_bonds()) return false;
    forces();
    return true;
  }

  CUBOCT_DEVICE void stretch_of(uint32_t b) {
    const uint32_t i = m_.owner[b], j = m_.partner[b], image = m_.image[b];
    Real d[3], r2 = 0;
    for (int a = 0; a < 3; ++a) {
      d[a] = m_.x[n_ * a + j] - m_.x[n_ * a + i] + m_.shift[27 * a + image];
      r2 += d[a] * d[a];
    }
    const Real r = std::sqrt(r2), over = 1 / r;
    for (int a = 0; a < 3; ++a) m_.unit[stride_ * a + b] = d[a] * over;
    m_.r[b] = r;
    m_.fc[b] = tersoff_cutoff(rule_.term, r).value;
  }

  CUBOCT_DEVICE Real cosine(uint32_t b, uint32_t t) const {
    return m_.unit[b] * m_.unit[t] + m_.unit[stride_ + b] * m_.unit[stride_ + t] +
           m_.unit[2 * stride_ + b] * m_.unit[2 * stride_ + t];
  }
  CUBOCT_DEVICE Sloped<Real> stretch(Real x) const {
    if (rule_.term.lambda3 == 0) return {Real(1), Real(0)};
    return tersoff_stretch(rule_.term, x);
  }
  CUBOCT_DEVICE Real zeta_of(uint32_t b) const {
    Real zeta = 0;
    for (uint32_t t = m_.first[m_.owner[b]]; t < m_.first[m_.owner[b] + 1]; ++t)
      if (t != b && m_.fc[t] > 0)
        zeta += m_.fc[t] * tersoff_angle(rule_.term, cosine(b, t)).value * stretch(m_.r[b] - m_.r[t]).value;
    return zeta;
  }

  CUBOCT_DEVICE void order_of(uint32_t b) {
    const Sloped<Real> fc = tersoff_cutoff(rule_.term, m_.r[b]);
    if (!(fc.value > 0)) {
      m_.order[b] = m_.radial[b] = 0;
      return;
    }
    const Sloped<Real> bond = tersoff_order(rule_.term, zeta_of(b));
    const Sloped<Real> repulsion = tersoff_repulsion(rule_.term, m_.r[b]),
                       attraction = tersoff_attraction(rule_.term, m_.r[b]);
    m_.order[b] = -fc.value * attraction.value * bond.slope / 2;
    m_.radial[b] = (fc.slope * (repulsion.value - bond.value * attraction.value) +
                    fc.value * (repulsion.slope - bond.value * attraction.slope)) /
                   2;
  }
  CUBOCT_DEVICE Real energy_of(uint32_t b) const {
    const Real fc = m_.fc[b];
    if (!(fc > 0)) return 0;
    const Real bond = tersoff_order(rule_.term, zeta_of(b)).value;
    return fc *
           (tersoff_repulsion(rule_.term, m_.r[b]).value -
            bond * tersoff_attraction(rule_.term, m_.r[b]).value) /
           2;
  }

  // G of bond b: its own zeta by b, and the zeta of each other bond t of the atom by b.
  //   zeta_b has fc_t g e(r_b - r_t), zeta_t has fc_b g e(r_t - r_b); dcos/dd_b = (u_t - cos u_b)/r_b
  CUBOCT_DEVICE void partial_of(uint32_t b) {
    const Sloped<Real> fc = tersoff_cutoff(rule_.term, m_.r[b]);
    Real along = m_.radial[b], across[3] = {};
    const Real own = m_.order[b];
    for (uint32_t t = m_.first[m_.owner[b]]; t < m_.first[m_.owner[b] + 1]; ++t) {
      if (t == b || !(m_.fc[t] > 0) || !(fc.value > 0)) continue;
      const Real c = cosine(b, t), x = m_.r[b] - m_.r[t];
      const Sloped<Real> g = tersoff_angle(rule_.term, c), mine = stretch(x), its = stretch(-x);
      const Real to_mine = own * m_.fc[t], to_its = m_.order[t];
      along +=
          to_mine * g.value * mine.slope + to_its * g.value * (fc.slope * its.value - fc.value * its.slope);
      const Real turn = (to_mine * mine.value + to_its * fc.value * its.value) * g.slope;
      along -= turn * c / m_.r[b];
      for (int a = 0; a < 3; ++a) across[a] += turn * m_.unit[stride_ * a + t];
    }
    for (int a = 0; a < 3; ++a)
      m_.g[stride_ * a + b] = along * m_.unit[stride_ * a + b] + across[a] / m_.r[b];
  }

  // Of scratch[0 .. count), which it destroys: halves onto halves, so that the order is the same everywhere.
  CUBOCT_DEVICE Real tree_sum(uint32_t count) {
    return tree(count, [](Real a, Real b) { return a + b; });
  }
  template <class Op>
  CUBOCT_DEVICE Real tree(uint32_t count, const Op& op) {
    while (count > 1) {
      const uint32_t half = (count + 1) / 2;
      block_.each(count - half, [&](uint32_t k) { m_.scratch[k] = op(m_.scratch[k], m_.scratch[k + half]); });
      count = half;
    }
    const Real all = m_.scratch[0];
    block_.each(0, [](uint32_t) {});  // before the scratch is used again
    return all;
  }
  // The same of `lanes` sums at a time, each left at the begin of its n_.
  CUBOCT_DEVICE void tree_sums(uint32_t lanes) {
    for (uint32_t count = n_; count > 1; count = (count + 1) / 2) {
      const uint32_t half = (count + 1) / 2;
      block_.each(count - half, [&](uint32_t k) {
        for (uint32_t at = k; at < n_ * lanes; at += n_) m_.scratch[at] += m_.scratch[at + half];
      });
    }
  }
  // At the forces f, where those before were v.
  struct Look {
    Real most, before, bend;  // the largest component; |v|^2; v.(v - f)
  };
  CUBOCT_DEVICE Look look() {
    block_.each(n_, [&](uint32_t i) {
      Real before = 0, bend = 0;
      for (int a = 0; a < 3; ++a) {
        const Real v = m_.v[n_ * a + i];
        before += v * v, bend += v * (v - m_.f[n_ * a + i]);
      }
      m_.scratch[i] = largest_force_on(i), m_.scratch[n_ + i] = before, m_.scratch[2 * n_ + i] = bend;
    });
    for (uint32_t count = n_; count > 1; count = (count + 1) / 2) {
      const uint32_t half = (count + 1) / 2;
      block_.each(count - half, [&](uint32_t k) {
        m_.scratch[k] = larger(m_.scratch[k], m_.scratch[k + half]);
        m_.scratch[n_ + k] += m_.scratch[n_ + k + half];
        m_.scratch[2 * n_ + k] += m_.scratch[2 * n_ + k + half];
      });
    }
    const Look now{m_.scratch[0], m_.scratch[n_], m_.scratch[2 * n_]};
    block_.each(0, [](uint32_t) {});  // before the scratch is used again
    return now;
  }
  CUBOCT_DEVICE Real dot(const Real* a, const Real* b) {
    block_.each(n_, [&](uint32_t i) {
      m_.scratch[i] = a[i] * b[i] + a[n_ + i] * b[n_ + i] + a[2 * n_ + i] * b[2 * n_ + i];
    });
    return tree_sum(n_);
  }
  CUBOCT_DEVICE Real largest_force() {
    block_.each(n_, [&](uint32_t i) { m_.scratch[i] = largest_force_on(i); });
    return tree(n_, larger);
  }
  CUBOCT_DEVICE Real largest_force_on(uint32_t i) const {
    Real most = 0;
    for (int a = 0; a < 3; ++a) {
      const Real size = std::fabs(m_.f[n_ * a + i]);
      most = size <= most ? most : size;  // also where it is no number
    }
    return most;
  }
  CUBOCT_DEVICE static Real larger(Real a, Real b) { return a > b || a != a ? a : b; }

  Block block_;
  const SampleRule<Real>& rule_;
  const Real *cell_, *inverse_;
  SampleMemory<Real> m_;
  uint32_t n_, stride_, bonds_ = 0;
  Real left_ = 0;  // of the skin: two atoms that go half of it each keep the list
};

// A kernel: one block a sample.
template <class Real>
struct SampleKernel {
  SamplesView<Real> view;
  SampleRule<Real> rule;
  SampleTask<Real> task;

  template <class Block>
  CUBOCT_DEVICE void operator()(uint32_t sample, const Block& block, void* memory) const {
    const size_t first = size_t{3} * rule.atoms * sample;
    SampleBlock<Real, Block> work(block, rule, view.cell + 9 * size_t{sample},
                                  view.inverse + 9 * size_t{sample}, memory);
    SampleSums<Real> sums;
    work.load(view.x + first, view.v + first);
    bool room = work.list_bonds();
    if (room) work.forces();
    if (room && task.kind == SampleTask<Real>::Kind::advance)
      room = work.advance(task.steps, task.dt, task.inverse_mass);
    if (room && task.kind == SampleTask<Real>::Kind::relax) room = work.relax(task, &sums.steps);
    if (room) {
      work.sums(&sums);
      if (!(sums.force < Real(1e30))) sums.fault = SampleFault::not_finite;
      work.store(view.x + first, view.v + first, view.f + first);
    } else {
      sums.fault = SampleFault::too_many_bonds;
    }
    block.each(1, [&](uint32_t) { view.sums[sample] = sums; });
  }
};

}  // namespace cuboct::gpu
