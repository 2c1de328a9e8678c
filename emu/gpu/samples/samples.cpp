// SPDX-License-Identifier: MIT
#include "emu/gpu/samples/samples.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "emu/gpu/messages.h"
#include "emu/gpu/samples/sample_kernel.h"

namespace cuboct::gpu {
namespace {

template <class Real>
TersoffTerm<Real> term_in(const TersoffTerm<double>& t) {
  const auto real = [](double value) { return static_cast<Real>(value); };
  return {
      t.m,          real(t.gamma),   real(t.lambda3), real(t.c), real(t.d), real(t.cos_theta0), real(t.n),
      real(t.beta), real(t.lambda2), real(t.B),       real(t.R), real(t.D), real(t.lambda1),    real(t.A)};
}

template <class Real>
class SamplesOf final : public Samples {
 public:
  SamplesOf(const TersoffTerm<double>& term, const SampleOptions& options)
      : options_(options),
        stream_(options.device),
        x_(options.device),
        v_(options.device),
        f_(options.device),
        start_x_(options.device),
        start_v_(options.device),
        cell_(options.device),
        inverse_(options.device),
        sums_(options.device) {
    rule_.term = term_in<Real>(term);
    rule_.skin = static_cast<Real>(options.skin);
  }

  void set(std::span<const AtomCell> samples) override {
    count_ = samples.size();
    rule_.atoms = samples.empty() ? 0 : static_cast<uint32_t>(samples.front().x.size());
    give_room(static_cast<uint32_t>(std::ceil(options_.bonds_per_atom * rule_.atoms)));
    std::vector<Real> cell, inverse, x;
    for (const AtomCell& sample : samples) {
      check_cell(sample.box, static_cast<size_t>(&sample - samples.data()));
      const Mat3& edges = sample.box.edges;
      const Mat3 shares = edges.inverse();
      for (int e = 0; e < 3; ++e)
        for (int a = 0; a < 3; ++a) {
          cell.push_back(static_cast<Real>(edges(a, e)));
          inverse.push_back(static_cast<Real>(shares(e, a)));
        }
      for (int a = 0; a < 3; ++a)
        for (const Vec3& at : sample.x) x.push_back(static_cast<Real>(at[a]));
    }
    cell_.set(stream_, cell), inverse_.set(stream_, inverse), x_.set(stream_, x);
    for (Array<Real>* other : {&v_, &f_, &start_x_, &start_v_}) other->resize(x_.size());
    v_.zero(stream_);
    sums_.resize(count_);
  }

  void evaluate() override { run({.kind = Kind::evaluate}); }
  void advance(uint32_t steps, double dt, double mass) override {
    run({.kind = Kind::advance,
         .steps = steps,
         .dt = static_cast<Real>(dt),
         .inverse_mass = static_cast<Real>(1 / (mass * kMassUnit))});
  }
  void relax(double tolerance, double stiffness, uint32_t most) override {
    run({.kind = Kind::relax,
         .steps = most,
         .tolerance = static_cast<Real>(tolerance),
         .stiffness = static_cast<Real>(stiffness)});
  }

  std::vector<SampleState> states() const override {
    std::vector<SampleState> states;
    for (const SampleSums<Real>& from : sums_.host(stream_, 0, count_)) {
      SampleState& to = states.emplace_back();
      to.energy = static_cast<double>(from.energy), to.force = static_cast<double>(from.force);
      for (size_t k = 0; k < 6; ++k) to.virial[k] = static_cast<double>(from.virial[k]);
      to.evaluations = from.steps;
    }
    return states;
  }
  std::vector<Vec3> positions() const override { return by_atom(x_); }
  std::vector<Vec3> velocities() const override { return by_atom(v_); }
  std::vector<Vec3> forces() const override { return by_atom(f_); }
  size_t block_bytes() const override { return SampleMemory<Real>::bytes(rule_); }

 private:
  using Kind = typename SampleTask<Real>::Kind;

  // So that each image of an atom that is near stands in the cell or beside it.
  void check_cell(const AtomBox& box, size_t sample) const {
    const double reach = static_cast<double>(rule_.term.R + rule_.term.D + rule_.skin);
    for (int e = 0; e < 3; ++e) {
      const double face = box.edges.col((e + 1) % 3).cross(box.edges.col((e + 2) % 3)).norm();
      if (!(box.volume() > reach * face)) throw_thin_cell(sample, box.volume() / face, reach);
    }
  }
  void give_room(uint32_t bonds) {
    rule_.most_bonds = bonds;
    require_sample(options_.device, rule_.atoms, bonds, block_bytes());
  }

  std::vector<Vec3> by_atom(const Array<Real>& values) const {
    const size_t n = rule_.atoms;
    const std::vector<Real> from = values.host(stream_, 0, values.size());
    std::vector<Vec3> out(count_ * n);
    for (size_t k = 0; k < out.size(); ++k)
      for (size_t a = 0; a < 3; ++a)
        out[k][static_cast<int>(a)] = static_cast<double>(from[(k / n * 3 + a) * n + k % n]);
    return out;
  }

  // Where a sample had no room for its bonds, all begin anew with more.
  void run(const SampleTask<Real>& task) {
    const size_t bytes = x_.size() * sizeof(Real);
    copy(stream_, start_x_.data(), options_.device, x_.data(), options_.device, bytes);
    copy(stream_, start_v_.data(), options_.device, v_.data(), options_.device, bytes);
    while (true) {
      const SamplesView<Real> view{x_.data(),    v_.data(),       f_.data(),
                                   cell_.data(), inverse_.data(), sums_.data()};
      for_each_block(stream_, static_cast<uint32_t>(count_), sample_threads(rule_.atoms), block_bytes(),
                     SampleKernel<Real>{view, rule_, task});
      const std::vector<SampleSums<Real>> sums = sums_.host(stream_, 0, count_);
      const auto fault = [&](SampleFault which) {
        return std::find_if(sums.begin(), sums.end(), [&](const auto& s) { return s.fault == which; });
      };
      if (const auto at = fault(SampleFault::not_finite); at != sums.end())
        throw_lost_sample(static_cast<size_t>(at - sums.begin()));
      if (fault(SampleFault::too_many_bonds) == sums.end()) return;
      give_room(rule_.most_bonds + rule_.most_bonds / 2);
      copy(stream_, x_.data(), options_.device, start_x_.data(), options_.device, bytes);
      copy(stream_, v_.data(), options_.device, start_v_.data(), options_.device, bytes);
    }
  }

  SampleOptions options_;
  SampleRule<Real> rule_;
  size_t count_ = 0;
  mutable Stream stream_;
  Array<Real> x_, v_, f_, start_x_, start_v_, cell_, inverse_;
  Array<SampleSums<Real>> sums_;
};

}  // namespace

std::unique_ptr<Samples> make_samples(const TersoffTerm<double>& term, const SampleOptions& options) {
  if (options.doubles) return std::make_unique<SamplesOf<double>>(term, options);
  return std::make_unique<SamplesOf<float>>(term, options);
}

}  // namespace cuboct::gpu
