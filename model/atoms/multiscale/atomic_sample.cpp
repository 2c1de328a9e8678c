// SPDX-License-Identifier: MIT
#include "model/atoms/multiscale/atomic_sample.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "model/atoms/multiscale/sample_descent.h"
#include "model/base/atom_units.h"
#include "model/base/fire.h"
#include "model/base/mat3.h"

namespace cuboct {
namespace {

using Eigen::VectorXd;

// A sample in one cell; its degrees of freedom are the atoms' coordinates.
class Strained {
 public:
  Strained(AtomicForces& forces, const Mat3& cell, const std::vector<Vec3>& place)
      : forces_(forces), cell_(cell), x_(3 * place.size()) {
    for (size_t i = 0; i < place.size(); ++i)
      x_.segment<3>(static_cast<Eigen::Index>(3 * i)) = cell * eigen(place[i]);
  }

  VectorXd& x() { return x_; }
  const SampleAnswer& answer() const { return answer_; }

  void evaluate(const VectorXd& x, VectorXd& f) {
    f.resize(x.size());
    const auto atoms = static_cast<size_t>(x.size() / 3);
    Mat3 virial;
    answer_.energy = forces_.evaluate(cell_, {reinterpret_cast<const Vec3*>(x.data()), atoms},
                                      {reinterpret_cast<Vec3*>(f.data()), atoms}, virial);
    answer_.stress = kPascal / std::abs(cell_.determinant()) * virial;
    answer_.force = f.cwiseAbs().maxCoeff();
    ++answer_.evaluations;
  }

  // Downhill until at rest, or for as long as that pays.
  bool descend(const Relaxation& how) {
    VectorXd f, last_f, step;
    evaluate(x_, f);
    double length = 1 / how.stiffness;
    while (!rests(how)) {
      if (answer_.evaluations >= kDescentEvaluations) return false;
      step = length * f;
      if (const double most = step.cwiseAbs().maxCoeff(); most > kLongestMove) step *= kLongestMove / most;
      x_ += step;
      last_f.swap(f);
      evaluate(x_, f);
      const double bend = step.dot(last_f - f);
      length = bend > 0 ? std::clamp(step.squaredNorm() / bend, kShortestDescent / how.stiffness,
                                     kLongestDescent / how.stiffness)
                        : 1 / how.stiffness;
    }
    return true;
  }

  void fall(const Relaxation& how) {
    const FireOptions options{.stiffness = how.stiffness, .longest_step = kLongestMove, .most = how.most};
    fire(
        x_, [&](const VectorXd& x, VectorXd& f) { return evaluate(x, f), rests(how); }, options);
  }

  bool rests(const Relaxation& how) { return answer_.at_rest = answer_.force <= how.force; }

  void leave(std::vector<Vec3>& place) const {
    const Mat3 inverse = cell_.inverse();
    for (size_t i = 0; i < place.size(); ++i)
      place[i] = inverse * x_.segment<3>(static_cast<Eigen::Index>(3 * i));
  }

 private:
  AtomicForces& forces_;
  Mat3 cell_;
  VectorXd x_;  // angstrom
  SampleAnswer answer_;
};

static_assert(sizeof(Vec3) == 3 * sizeof(double));

}  // namespace

double AtomicLattice::density() const {
  return mass * static_cast<double>(place.size()) /
         (std::abs(cell.determinant()) * kAngstrom * kAngstrom * kAngstrom);
}

AtomicLattice crystal_lattice(Crystal crystal, double edge, int cells, double mass) {
  const std::array<Vec3, 8> sites{Vec3(0, 0, 0),       Vec3(0, .5, .5),     Vec3(.5, 0, .5),
                                  Vec3(.5, .5, 0),     Vec3(.25, .25, .25), Vec3(.25, .75, .75),
                                  Vec3(.75, .25, .75), Vec3(.75, .75, .25)};
  const std::span<const Vec3> basis(sites.data(), crystal == Crystal::fcc ? 4 : 8);
  AtomicLattice out{edge * cells * Mat3::Identity(), {}, mass};
  for (int k = 0; k < cells; ++k)
    for (int j = 0; j < cells; ++j)
      for (int i = 0; i < cells; ++i)
        for (const Vec3& site : basis) out.place.push_back((Vec3(i, j, k) + site) / cells);
  return out;
}

SampleAnswer relax_sample(AtomicForces& forces, const Mat3& cell, std::vector<Vec3>& place,
                          const Relaxation& how) {
  Strained sample(forces, cell, place);
  if (!sample.descend(how)) sample.fall(how);
  sample.leave(place);
  return sample.answer();
}

SampleAnswer held_sample(AtomicForces& forces, const Mat3& cell, const std::vector<Vec3>& place) {
  Strained sample(forces, cell, place);
  VectorXd f;
  sample.evaluate(sample.x(), f);
  return sample.answer();
}

}  // namespace cuboct
