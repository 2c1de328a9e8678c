// SPDX-License-Identifier: MIT
#include "model/rules/lps_terms.h"

#include <fmt/format.h>

#include <atomic>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "model/base/dense.h"
#include "model/base/error.h"
#include "model/base/hash.h"
#include "model/base/parallel.h"
#include "model/rules/lps_bond.h"
#include "model/rules/lps_surface.h"
#include "model/rules/quadrature.h"

namespace cuboct {
namespace {

constexpr size_t kRows = 256;  // least rows that are worth a thread

class TermsOfBody final : public LpsTerms {
 public:
  TermsOfBody(const LpsMaterial& material, double whole, ReferenceBonds bonds, const std::vector<Vec3>& x,
              const std::vector<char>& unbreakable, int threads)
      : m_(material), whole_(whole), threads_(threads), x0_(x), bonds_(std::move(bonds)) {
    const size_t n = x.size();
    weigh();
    u_.assign(n, Vec3::Zero());
    pressure_.assign(n, 0);
    dilatation_.assign(n, 0);
    force_.assign(n, Vec3::Zero());
    inverse_.assign(n, 0);
    if (m_.breaks()) {
      most_.assign(bonds_.other.size(), -1);
      left_.assign(bonds_.other.size(), 1);
      keep_unbroken(unbreakable);
    }
    if (m_.corrected) shape_.assign(n, Mat3::Zero()), missing_.assign(n, Vec3::Zero());
    for (size_t i = 0; i < n; ++i) look_at(i);
  }

  void begin(const std::vector<Vec3>& x) override {
    std::atomic<size_t> lost{x.size()};
    for_each_range(
        x.size(), kRows,
        [&](size_t begin, size_t end) {
          for (size_t i = begin; i < end; ++i) {
            u_[i] = x[i] - x0_[i];
            if (!u_[i].allFinite() && i < lost) lost = i;
          }
        },
        threads_);
    if (lost < x.size())
      throw std::runtime_error(fmt::format("particle {} has a position that is not finite", lost.load()));
  }

  void pair(size_t round, size_t begin, size_t end, bool keeps) override {
    if (round == 0 && m_.breaks() && keeps) stretch(begin, end);
    if (round == 0) return m_.finite ? open<true>(begin, end) : open<false>(begin, end);
    m_.finite ? pull<true>(begin, end) : pull<false>(begin, end);
  }

  void finish(size_t round, size_t begin, size_t end) override {
    for (size_t i = begin; i < end; ++i) {
      if (round == 0) {
        const auto made = lps_dilated<double>(dilatation_[i], inverse_[i], m_.dimensions, factor_);
        dilatation_[i] = made.dilatation, pressure_[i] = made.pressure;
      } else {
        if (m_.corrected) force_[i] += dilatation_[i] * missing_[i];
        force_[i] *= m_.volume;
      }
    }
  }

  const std::vector<Vec3>& force() const override { return force_; }

  // W = (C1 (lambda - mu)/2d) t^2 + (C2 mu/4m) sum w V e^2 per volume.
  double energy() const override {
    double sum = 0;
    for (size_t i = 0; i < u_.size(); ++i) {
      double stretched = 0;
      for (uint64_t b = bonds_.begin(i); b < bonds_.end(i); ++b) {
        const double e = lengthening(i, b);
        stretched += left(b) * weight_[b] * e * e;
      }
      sum += m_.dilatation_factor() / (2 * m_.dimensions) * dilatation_[i] * dilatation_[i] +
             m_.stretch_factor() / (4 * weighted(i)) * stretched;
    }
    return sum * m_.volume;
  }

  Mat3 stress(size_t i, double volume) const override {
    Mat3 sum = Mat3::Zero();
    for (uint64_t b = bonds_.begin(i); b < bonds_.end(i); ++b) {
      const Vec3 y = m_.finite ? Vec3(bonds_.vector[b] + u_[bonds_.other[b]] - u_[i]) : bonds_.vector[b];
      sum += tension(i, b) / y.norm() * y * y.transpose();
    }
    return sum * (m_.volume / (2 * volume));
  }

  const LpsMaterial& material() const override { return m_; }
  const ReferenceBonds& reference() const override { return bonds_; }
  const std::vector<double>& volumes() const override { return bare_; }
  const std::vector<double>& weights() const override { return weight_; }
  const std::vector<double>& inverse_weighted() const override { return inverse_; }
  const std::vector<double>& dilatation() const override { return dilatation_; }
  bool breaks(uint64_t b) const override { return !most_.empty() && most_[b] != kNever; }

  std::vector<Field> fields() override {
    const auto numbers = [](auto& of) {
      return std::span(reinterpret_cast<double*>(of.data()), of.size() * sizeof(of[0]) / sizeof(double));
    };
    std::vector<Field> all{{"displacement", numbers(u_)},
                           {"weighted_volume", numbers(inverse_)},
                           {"dilatation", numbers(dilatation_)},
                           {"pressure", numbers(pressure_)},
                           {kForceField, numbers(force_)}};
    if (m_.corrected) {
      all.push_back({"shape", numbers(shape_)});
      all.push_back({"missing", numbers(missing_)});
    }
    if (m_.breaks()) {
      all.push_back({"largest_stretch", numbers(most_), true});
      all.push_back({"whole", numbers(left_), true});
    }
    return all;
  }

  std::vector<double> damage() const override {
    std::vector<double> damaged;
    for (size_t i = 0; i < u_.size() && !left_.empty(); ++i) {
      double whole = 0, here = 0;
      for (uint64_t b = bonds_.begin(i); b < bonds_.end(i); ++b)
        whole += volume_share(b), here += left_[b] * volume_share(b);
      damaged.push_back(1 - here / whole);
    }
    return damaged;
  }
  uint64_t bonds() const override { return bonds_.other.size() / 2; }
  std::vector<std::vector<double>> shown() const override {
    std::vector<std::vector<double>> fields{dilatation_};
    if (m_.breaks()) fields.push_back(damage());
    return fields;
  }

  std::vector<uint64_t> memory() const override {
    std::vector<uint64_t> words;
    words.reserve(most_.size());
    for (const double most : most_) words.push_back(std::bit_cast<uint64_t>(most));
    return words;
  }
  void recall(const std::vector<uint64_t>& words) override {
    if (words.size() != most_.size())
      throw InputError(fmt::format("the state holds {} bonds, the body has {}", words.size(), most_.size()));
    for (size_t b = 0; b < words.size(); ++b) {
      const auto most = std::bit_cast<double>(words[b]);
      if ((most == kNever) != (most_[b] == kNever) || std::isnan(most))
        throw InputError(fmt::format("the state's bond {} has no stretch that it could have", b));
      most_[b] = most;
      left_[b] = left_of(most_[b]);
    }
    for (size_t i = 0; i < u_.size(); ++i) look_at(i);
  }
  uint64_t memory_hash() const override {
    Hash hash;
    for (const double number : {m_.critical_stretch, m_.damage_width})
      hash.add(std::bit_cast<int64_t>(number));
    for (const uint64_t first : bonds_.first) hash.add(static_cast<int64_t>(first));
    for (uint64_t b = 0; b < bonds_.other.size(); ++b) hash.add(bonds_.other[b] | int64_t{breaks(b)} << 32);
    return hash.value();
  }

 private:
  static constexpr double kNever = -std::numeric_limits<double>::infinity();  // of a bond that cannot break

  double left(uint64_t b) const { return left_.empty() ? 1 : left_[b]; }
  double left_of(double most) const { return most == kNever ? 1 : m_.left(most); }
  double weighted(size_t i) const { return 1 / inverse_[i]; }
  double volume_share(uint64_t b) const { return bare_[b]; }

  double lengthening(size_t i, uint64_t b) const {
    const Vec3& r = bonds_.vector[b];
    const Vec3 moved = u_[bonds_.other[b]] - u_[i];
    return m_.finite ? lps_now(r.data(), length_[b], moved.data()).longer
                     : lps_along(r.data(), moved.data()) / length_[b];
  }
  // Of a bond's pull the size, as a force density.
  double tension(size_t i, uint64_t b) const {
    const size_t j = bonds_.other[b];
    return left(b) * weight_[b] *
           ((pressure_[i] + pressure_[j]) * length_[b] +
            m_.stretch_factor() / 2 * (inverse_[i] + inverse_[j]) * lengthening(i, b));
  }

  // The volume that each bond's far end stands for, times its influence.
  void weigh() {
    bare_.resize(bonds_.other.size());
    weight_.resize(bare_.size());
    length_.resize(bare_.size());
    if (m_.quadrature == LpsQuadrature::fitted) bare_ = fitted_weights(m_, bonds_, threads_);
    for (size_t b = 0; b < bare_.size(); ++b) {
      length_[b] = bonds_.vector[b].norm();
      if (m_.quadrature != LpsQuadrature::fitted) bare_[b] = m_.volume * share_of(m_, length_[b]);
      weight_[b] = bare_[b] * m_.weight(length_[b]);
    }
  }

  void keep_unbroken(const std::vector<char>& unbreakable) {
    if (unbreakable.empty()) return;
    for (size_t i = 0; i < u_.size(); ++i)
      for (uint64_t b = bonds_.begin(i); b < bonds_.end(i); ++b)
        if (unbreakable[i] || unbreakable[bonds_.other[b]]) most_[b] = kNever;
  }

  // Makes what a particle keeps of its bonds: when the body is packed, and when some of them gave way.
  void look_at(size_t i) {
    SurfaceSums sums;
    Mat3 packed = Mat3::Zero();
    for (uint64_t b = bonds_.begin(i); b < bonds_.end(i); ++b) {
      const Vec3& r = bonds_.vector[b];
      packed += weight_[b] * r * r.transpose();
      sums.second += left(b) * weight_[b] * r * r.transpose();
      sums.first += left(b) * weight_[b] * r;
      sums.bare += left(b) * bare_[b] * r;
    }
    if (inverse_[i] == 0) check_span(i, packed);
    inverse_[i] = 1 / (m_.corrected ? whole_ : packed.trace());
    if (!m_.corrected) return;
    shape_[i] = shape_of(m_, whole_, sums);
    missing_[i] = missing_of(m_, whole_, sums, [&](const Vec3& n) {
      std::array<double, 2> third{};
      for (uint64_t b = bonds_.begin(i); b < bonds_.end(i); ++b) {
        const double along = bonds_.vector[b].dot(n), r2 = length_[b] * length_[b];
        const double w = left(b) * weight_[b] * along / r2;
        third[0] += w * along * along, third[1] += w * (r2 - along * along);
      }
      return third;
    });
  }

  void check_span(size_t i, const Mat3& second) const {
    const Vec3 values = eigensystem(second).values;
    const uint64_t count = bonds_.end(i) - bonds_.begin(i);
    // Of a sheet one of the three is 0, out of its plane.
    const bool unstable = values[0] < -1e-9 * std::abs(values[2]);
    if (!unstable && values[3 - m_.dimensions] > 1e-9 * std::abs(values[2])) return;
    const std::string where =
        fmt::format("particle {} at ({:.6g}, {:.6g}, {:.6g}) m", i, x0_[i][0], x0_[i][1], x0_[i][2]);
    if (unstable)
      throw InputError(fmt::format("{}: the weights of its {} bonds are of no stable solid: their second "
                                   "moment has the eigenvalue {:.3g}",
                                   where, count, values[0]),
                       "another influence or horizon");
    throw InputError(fmt::format("{} has {} bond{} within the horizon of {:.6g} m, which do not span {} "
                                 "dimensions",
                                 where, count, count == 1 ? "" : "s", m_.horizon, m_.dimensions),
                     "a larger horizon, or no such particle");
  }

  // Equations 22 and 23: the largest stretch so far, and what it leaves of the bond.
  void stretch(size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      bool weaker = false;
      for (uint64_t b = bonds_.begin(i); b < bonds_.end(i); ++b) {
        if (left_[b] == 0 || most_[b] == kNever) continue;
        const Vec3 moved = u_[bonds_.other[b]] - u_[i];
        const double s = lps_now(bonds_.vector[b].data(), length_[b], moved.data()).longer / length_[b];
        if (s <= most_[b]) continue;
        most_[b] = s;
        const double left = left_of(s);
        weaker |= left != left_[b];
        left_[b] = left;
      }
      if (weaker && m_.corrected) look_at(i);
    }
  }

  // Sums the weighted lengthening, w V |r| e. With the correction w V r.M.(u_j - u_i) of equation 31.
  template <bool kFinite>
  void open(size_t begin, size_t end) {
    const bool breaks = m_.breaks();
    for (size_t i = begin; i < end; ++i) {
      const Vec3 home = u_[i];
      double sum = 0;
      for (uint64_t b = bonds_.begin(i), last = bonds_.end(i); b < last; ++b) {
        const Vec3& r = bonds_.vector[b];
        const Vec3 moved = u_[bonds_.other[b]] - home;
        const double w = breaks ? left_[b] * weight_[b] : weight_[b];
        if (kFinite)
          sum += lps_opening(lps_now(r.data(), length_[b], moved.data()), length_[b], w);
        else if (m_.corrected)
          sum += w * r.dot(shape_[i] * moved);
        else
          sum += lps_small_opening(r.data(), moved.data(), w);
      }
      dilatation_[i] = sum;
    }
  }

  template <bool kFinite>
  void pull(size_t begin, size_t end) {
    const bool breaks = m_.breaks();
    const double half = m_.stretch_factor() / 2;
    for (size_t i = begin; i < end; ++i) {
      const Vec3 home = u_[i];
      const double pressure = pressure_[i], inverse = inverse_[i];
      Vec3 sum = Vec3::Zero();
      for (uint64_t b = bonds_.begin(i), last = bonds_.end(i); b < last; ++b) {
        const size_t j = bonds_.other[b];
        const Vec3& r = bonds_.vector[b];
        const Vec3 moved = u_[j] - home;
        const double w = breaks ? left_[b] * weight_[b] : weight_[b];
        const double p = pressure + pressure_[j], q = half * (inverse + inverse_[j]);
        if (kFinite) {
          const LpsBondNow<double> now = lps_now(r.data(), length_[b], moved.data());
          sum += lps_pull(now, length_[b], w, p, q) * Vec3(now.y);
        } else {
          sum += lps_small_pull(r.data(), moved.data(), length_[b], w, p, q) * r;
        }
      }
      force_[i] = sum;
    }
  }

  const LpsMaterial m_;
  const double whole_, factor_ = m_.dilatation_factor();
  const int threads_;
  const std::vector<Vec3> x0_;
  const ReferenceBonds bonds_;
  std::vector<double> bare_, weight_, length_;  // [bond]: m^3, m^3, m
  std::vector<double> most_, left_;             // [bond]: largest stretch, what is left
  std::vector<Vec3> u_, force_, missing_;
  std::vector<Mat3> shape_;
  std::vector<double> pressure_, dilatation_, inverse_;  // inverse_: 1 over the weighted volume
};

}  // namespace

double share_of(const LpsMaterial& m, double r) {
  if (m.quadrature != LpsQuadrature::partial || r < m.horizon - m.spacing / 2) return 1;
  return 0.5 + (m.horizon - r) / m.spacing;
}

std::unique_ptr<LpsTerms> make_lps_terms(const LpsMaterial& material, double whole, ReferenceBonds bonds,
                                         const std::vector<Vec3>& x, const std::vector<char>& unbreakable,
                                         int threads) {
  return std::make_unique<TermsOfBody>(material, whole, std::move(bonds), x, unbreakable, threads);
}

}  // namespace cuboct
