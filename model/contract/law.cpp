// SPDX-License-Identifier: MIT
#include "model/contract/law.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "model/base/error.h"
#include "model/contract/law_energies.h"
#include "model/contract/law_function.h"

namespace cuboct {
namespace {

void require_positive(const char* law, const char* what, double value, const char* unit) {
  if (!(value > 0) || !std::isfinite(value)) {
    throw InputError(
        fmt::format("{}: {} is {:g}{}{}, but must be above 0", law, what, value, *unit ? " " : "", unit));
  }
}

// The part that all laws share: the linear core and the cutoff around the law proper.
class CoredLaw : public PairLaw {
 public:
  double force(double r) const final {
    if (r >= cutoff_) return 0;
    return r < core_ ? r * core_slope_ : outer_force(r);
  }
  double slope(double r) const final {
    if (r >= cutoff_) return 0;
    return r < core_ ? core_slope_ : outer_slope(r);
  }
  double energy(double r) const final {
    if (r >= cutoff_) return 0;
    return r < core_ ? core_energy_ + 0.5 * core_slope_ * (core_ * core_ - r * r) : outer_energy(r);
  }
  double cutoff() const final { return cutoff_; }
  double core() const final { return core_; }
  EnergyEnds ends() const { return {core_, cutoff_, core_energy_, core_slope_}; }

 protected:
  CoredLaw(const char* name, double core, double cutoff) : core_(core), cutoff_(cutoff) {
    require_positive(name, "cutoff", cutoff, "m");
    require_positive(name, "core", core, "m");
    if (core >= cutoff) {
      throw InputError(fmt::format("{}: core {:g} m is not below the cutoff {:g} m", name, core, cutoff));
    }
  }
  // To be called at the end of a constructor, when the law proper can be asked.
  void set_core() {
    core_slope_ = outer_force(core_) / core_;
    core_energy_ = outer_energy(core_);
  }

  // For core <= r < cutoff.
  virtual double outer_force(double r) const = 0;
  virtual double outer_slope(double r) const = 0;
  virtual double outer_energy(double r) const = 0;

 private:
  double core_, cutoff_;
  double core_slope_ = 0, core_energy_ = 0;
};

class LennardJones final : public CoredLaw {
 public:
  LennardJones(double epsilon, double sigma, double cutoff, double core, Smoothing smoothing)
      : CoredLaw("lennard_jones", core, cutoff), epsilon_(epsilon), sigma_(sigma), end_(cutoff) {
    require_positive("lennard_jones", "epsilon", epsilon, "J");
    require_positive("lennard_jones", "sigma", sigma, "m");
    end_energy_ = whole_energy(cutoff);
    if (smoothing == Smoothing::linear) end_force_ = whole_force(cutoff);
    set_core();
  }
  LawForm form() const override { return LennardJonesForm{epsilon_, sigma_, -end_force_}; }
  LennardJonesEnergy energies() const { return {sigma_, 4 * epsilon_, end_, end_energy_, end_force_}; }

 private:
  double sixth(double r) const {
    const double q2 = (sigma_ / r) * (sigma_ / r);
    return q2 * q2 * q2;
  }
  double whole_energy(double r) const { return 4 * epsilon_ * sixth(r) * (sixth(r) - 1); }
  double whole_force(double r) const { return 24 * epsilon_ * sixth(r) * (2 * sixth(r) - 1) / r; }
  double outer_force(double r) const override { return whole_force(r) - end_force_; }
  double outer_slope(double r) const override {
    return -24 * epsilon_ * sixth(r) * (26 * sixth(r) - 7) / (r * r);
  }
  double outer_energy(double r) const override {
    return whole_energy(r) - end_energy_ - end_force_ * (end_ - r);
  }

  double epsilon_, sigma_, end_;
  double end_energy_ = 0, end_force_ = 0;  // taken off: J; N, 0 where the force may jump
};

// Cubic pieces by their values and slopes at the points.
class HermiteLaw final : public CoredLaw {
 public:
  HermiteLaw(const char* name, Hermite force, double core)
      : CoredLaw(name, core, force.end()), force_(std::move(force)), energies_(force_.energies()) {
    set_core();
  }
  LawForm form() const override { return force_.pieces(); }
  const CubicEnergy& energies() const { return energies_; }

 private:
  double outer_force(double r) const override { return force_.at(r); }
  double outer_slope(double r) const override { return force_.slope(r); }
  double outer_energy(double r) const override { return force_.integral_from(r); }

  Hermite force_;
  CubicEnergy energies_;
};

class FunctionLaw final : public CoredLaw {
 public:
  FunctionLaw(std::shared_ptr<const LawFunction> of, double cutoff, double core)
      : CoredLaw("function_law", core, cutoff), of_(std::move(of)), step_((cutoff - core) / kKnots) {
    for (int k = 0; k <= kKnots; ++k) {
      const double r = knot(k), f = of_->force(r);
      if (!std::isfinite(f) || !std::isfinite(of_->slope(r)))
        throw InputError(fmt::format("the force, or its slope, is no number at r = {:.6g} m", r),
                         "between 'core' and 'reach' it must be one everywhere");
      force_[static_cast<size_t>(k)] = f;
    }
    for (int k = kKnots; k-- > 0;)
      after_[static_cast<size_t>(k)] = after_[static_cast<size_t>(k) + 1] + integral(knot(k), knot(k + 1));
    set_core();
  }
  void forces(std::span<const double> r, std::span<double> f) const { of_->forces(r, f); }

 private:
  static constexpr int kKnots = 8192;
  double knot(int k) const { return k == kKnots ? cutoff() : core() + k * step_; }
  double integral(double from, double to) const {
    const double near = std::sqrt(5 - 2 * std::sqrt(10.0 / 7)) / 3,
                 far = std::sqrt(5 + 2 * std::sqrt(10.0 / 7)) / 3;
    const double near_weight = (322 + 13 * std::sqrt(70.0)) / 900,
                 far_weight = (322 - 13 * std::sqrt(70.0)) / 900;
    const double half = (to - from) / 2, middle = from + half;
    const std::array<double, 5> r{middle, middle - near * half, middle + near * half, middle - far * half,
                                  middle + far * half};
    std::array<double, 5> f{};
    of_->forces(r, f);
    return half * (128.0 / 225 * f[0] + near_weight * (f[1] + f[2]) + far_weight * (f[3] + f[4]));
  }
  double outer_force(double r) const override { return of_->force(r); }
  double outer_slope(double r) const override { return of_->slope(r); }
  double outer_energy(double r) const override {
    const auto k = static_cast<size_t>(std::min((r - core()) / step_, kKnots - 1.0));
    const double s = (r - core()) / step_ - static_cast<double>(k), rise = after_[k + 1] - after_[k];
    const double m0 = -step_ * force_[k], m1 = -step_ * force_[k + 1];
    return after_[k] + s * (m0 + s * (3 * rise - 2 * m0 - m1 + s * (m0 + m1 - 2 * rise)));
  }

  std::shared_ptr<const LawFunction> of_;
  double step_;                                       // m
  std::array<double, kKnots + 1> force_{}, after_{};  // at the knots; J, from a knot to the cutoff
};

// A clamped uniform quadratic B-spline as a chain of Bezier arcs: with equal knot intervals its joints are
// the middles of the inner legs of the control polygon, and the control points between them are the arcs'
// middle points.
class BSplineLaw final : public CoredLaw {
 public:
  BSplineLaw(const std::vector<double>& r, const std::vector<double>& f, double core)
      : CoredLaw("spline_law", core, r.back()) {
    const size_t n = r.size();
    for (size_t k = 0; k + 2 < n; ++k) {
      const bool first = k == 0, last = k + 3 == n;
      arcs_.push_back(
          {{first ? r[0] : (r[k] + r[k + 1]) / 2, r[k + 1], last ? r[n - 1] : (r[k + 1] + r[k + 2]) / 2},
           {first ? f[0] : (f[k] + f[k + 1]) / 2, f[k + 1], last ? f[n - 1] : (f[k + 1] + f[k + 2]) / 2},
           0});
      joints_.push_back(arcs_.back().r[0]);
    }
    joints_.push_back(r[n - 1]);
    for (size_t k = arcs_.size(); k-- > 0;) {
      arcs_[k].energy_after =
          k + 1 < arcs_.size() ? arcs_[k + 1].energy_after + rest_of_arc(arcs_[k + 1], 0) : 0;
    }
    set_core();
  }
  LawForm form() const override {
    std::vector<ArcPiece> pieces;
    for (const Arc& arc : arcs_)
      pieces.push_back(
          {arc.r[0], linear(arc.r), quadratic(arc.r), arc.f[0], linear(arc.f), quadratic(arc.f)});
    return pieces;
  }

 private:
  struct Arc {
    std::array<double, 3> r, f;  // Bezier points
    double energy_after;         // energy at the end of the arc
  };
  // b(t) = b0 + t (linear + t quadratic)
  static double linear(const std::array<double, 3>& b) { return 2 * (b[1] - b[0]); }
  static double quadratic(const std::array<double, 3>& b) { return b[0] - 2 * b[1] + b[2]; }

  // The parameter of the arc at r: the root in [0, 1] of quadratic t^2 + linear t = r - r0, in the form that
  // does not cancel (linear > 0). The discriminant is (dr/dt)^2 > 0 there.
  static double parameter(const Arc& arc, double r) {
    const double a = quadratic(arc.r), b = linear(arc.r), c = r - arc.r[0];
    return 2 * c / (b + std::sqrt(std::max(0.0, b * b + 4 * a * c)));
  }
  // Integral of f dr/dt dt from t to 1.
  static double rest_of_arc(const Arc& arc, double t) {
    const double f0 = arc.f[0], f1 = linear(arc.f), f2 = quadratic(arc.f);
    const double r1 = linear(arc.r), r2 = 2 * quadratic(arc.r);
    const auto integral = [&](double x) {
      return x *
             (f0 * r1 + x * ((f1 * r1 + f0 * r2) / 2 + x * ((f2 * r1 + f1 * r2) / 3 + x * (f2 * r2) / 4)));
    };
    return integral(1) - integral(t);
  }
  double outer_force(double r) const override {
    const Arc& arc = arcs_[piece_of(joints_, r)];
    const double t = parameter(arc, r);
    return arc.f[0] + t * (linear(arc.f) + t * quadratic(arc.f));
  }
  double outer_slope(double r) const override {
    const Arc& arc = arcs_[piece_of(joints_, r)];
    const double t = parameter(arc, r);
    return (linear(arc.f) + 2 * t * quadratic(arc.f)) / (linear(arc.r) + 2 * t * quadratic(arc.r));
  }
  double outer_energy(double r) const override {
    const Arc& arc = arcs_[piece_of(joints_, r)];
    return arc.energy_after + rest_of_arc(arc, parameter(arc, r));
  }

  std::vector<Arc> arcs_;
  std::vector<double> joints_;  // r at the ends of the arcs
};

// The presets' points between the pitch and the cutoff, r in pitches, f in stiffness * pitch; the slope is 0
// at each. A peak at 1 + h has the force -2h/3: the cubic from the pitch is then -h (s - s^3/3) with s = (r -
// 1)/h, whose curvature vanishes at the pitch. Below the pitch the same cubic runs to the core with h = -1/2.
struct Preset {
  const char* name;
  struct Point {
    double r, f;
  };
  std::vector<Point> points;
};
constexpr double peak(double h) { return -2.0 / 3.0 * h; }
const std::vector<Preset>& presets() {
  static const std::vector<Preset> table = {
      // name        peak (strength)      end of the plateau   hump (hardness)
      {"elastic", {{1.20, peak(0.20)}, {1.350, 0.004}}},
      {"brittle", {{1.06, peak(0.06)}, {1.160, 0.006}}},
      {"ductile", {{1.09, peak(0.09)}, {1.270, -0.050}, {1.350, 0.006}}},
      {"viscous", {{1.03, peak(0.03)}}},
  };
  return table;
}

}  // namespace

std::shared_ptr<const PairLaw> lennard_jones(double epsilon, double sigma, double cutoff, double core,
                                             Smoothing smoothing) {
  return std::make_shared<LennardJones>(epsilon, sigma, cutoff, core, smoothing);
}

std::shared_ptr<const PairLaw> spline_law(std::vector<double> r, std::vector<double> f,
                                          Interpolation interpolation, double core) {
  const size_t least = interpolation == Interpolation::b_spline ? 3 : 2;
  if (r.size() != f.size()) {
    throw InputError(fmt::format("spline_law: {} distances, but {} forces", r.size(), f.size()));
  }
  if (r.size() < least) {
    throw InputError(fmt::format("spline_law: {} points, but at least {} are needed", r.size(), least));
  }
  for (size_t k = 0; k < r.size(); ++k) {
    if (!std::isfinite(r[k]) || !std::isfinite(f[k])) {
      throw InputError(fmt::format("spline_law: point {} is ({:g} m, {:g} N)", k + 1, r[k], f[k]));
    }
    if (k > 0 && r[k] <= r[k - 1]) {
      throw InputError(
          fmt::format("spline_law: the distance of point {} ({:g} m) is not above that of point {} ({:g} m)",
                      k + 1, r[k], k, r[k - 1]));
    }
  }
  if (r.front() < 0)
    throw InputError(fmt::format("spline_law: the first distance is {:g} m, below 0", r.front()));
  if (core < r.front()) {
    throw InputError(
        fmt::format("spline_law: core {:g} m is below the first distance {:g} m", core, r.front()),
        "below its core a law is linear; let the points start at the core or below");
  }
  if (interpolation == Interpolation::b_spline) return std::make_shared<BSplineLaw>(r, f, core);
  std::vector<double> slopes = monotone_slopes(r, f);
  return hermite_law("spline_law", {std::move(r), std::move(f), std::move(slopes)}, core);
}

std::shared_ptr<const PairLaw> preset_law(const std::string& name, double pitch, double stiffness,
                                          double range) {
  for (const Preset& preset : presets()) {
    if (name != preset.name) continue;
    require_positive("preset_law", "pitch", pitch, "m");
    require_positive("preset_law", "stiffness", stiffness, "N/m");
    if (!(range > 0 && range <= 1))
      throw InputError(fmt::format("preset_law: the range {:g} is not in (0, 1]", range));
    std::vector<double> r{0.5 * pitch, pitch}, f{stiffness * pitch / 3, 0}, m{0, -stiffness};
    for (const Preset::Point& point : preset.points) {
      r.push_back(range == 1 ? point.r * pitch : pitch * (1 + range * (point.r - 1)));
      f.push_back(point.f * stiffness * pitch * range);
      m.push_back(0);
    }
    r.push_back(range == 1 ? std::numbers::sqrt2 * pitch : pitch * (1 + range * (std::numbers::sqrt2 - 1)));
    f.push_back(0);
    m.push_back(0);
    const double core = r.front();
    return hermite_law("preset_law", {std::move(r), std::move(f), std::move(m)}, core);
  }
  throw InputError(fmt::format("unknown preset law '{}'", name),
                   "the presets are elastic, brittle, ductile and viscous");
}

std::shared_ptr<const PairLaw> hermite_law(const char* name, Hermite force, double core) {
  return std::make_shared<HermiteLaw>(name, std::move(force), core);
}

std::shared_ptr<const PairLaw> function_law(std::shared_ptr<const LawFunction> of, double cutoff,
                                            double core) {
  return std::make_shared<FunctionLaw>(std::move(of), cutoff, core);
}

bool forces_of(const PairLaw& law, std::span<const double> r, std::span<double> f) {
  const auto* function = dynamic_cast<const FunctionLaw*>(&law);
  if (function != nullptr) function->forces(r, f);
  return function != nullptr;
}

void energies_of(const PairLaw& law, std::span<const double> r, std::span<double> energy) {
  // A class that is final has its members inlined.
  const auto each = [&](const auto& of) {
    for (size_t k = 0; k < r.size(); ++k) energy[k] = of.energy(r[k]);
  };
  if (const auto* cubic = dynamic_cast<const HermiteLaw*>(&law))
    energies_of(cubic->energies(), cubic->ends(), r, energy);
  else if (const auto* lj = dynamic_cast<const LennardJones*>(&law))
    energies_of(lj->energies(), lj->ends(), r, energy);
  else if (const auto* arcs = dynamic_cast<const BSplineLaw*>(&law))
    each(*arcs);
  else
    each(law);
}

namespace {
constexpr int kBondSamples = 4096;  // of a law's range
}

bool same_law(const PairLaw& one, const PairLaw& other) {
  if (&one == &other) return true;
  const LawForm form = one.form();
  return one.core() == other.core() && one.cutoff() == other.cutoff() &&
         !std::holds_alternative<std::monostate>(form) && form == other.form();
}

double stiffest_bond(const Rule& rule, double r) {
  double stiffest = 0;
  for (size_t k = 0; k < rule.laws(); ++k)
    stiffest = std::max(stiffest, -rule.law_at(k).slope(r) * rule.strongest_of(k));
  return stiffest;
}

double stiffest_rest_distance(const PairLaw& law) {
  double stiffest = 0, at = 0;
  for (int k = 0; k < kBondSamples; ++k) {
    const auto distance = [&](int n) { return law.core() + (law.cutoff() - law.core()) * n / kBondSamples; };
    const double r = distance(k), next = distance(k + 1);
    if (!(law.force(r) > 0) || law.force(next) > 0 || next >= law.cutoff()) continue;
    if (-law.slope(next) > stiffest) stiffest = -law.slope(next), at = next;
  }
  return at;
}

double push_end(const PairLaw& law) {
  double outside = stiffest_rest_distance(law);
  if (outside == 0) return law.cutoff();
  double inside = outside - (law.cutoff() - law.core()) / kBondSamples;
  for (;;) {
    const double middle = 0.5 * (inside + outside);
    if (middle <= inside || middle >= outside) return outside;
    (law.force(middle) > 0 ? inside : outside) = middle;
  }
}

}  // namespace cuboct
