// SPDX-License-Identifier: MIT
// A law for tests: springs to the 4 nearest and the 12 next atoms of diamond, stiffer where pressed. Bonds
// are those of the first cell that it is asked for, which is to be without strain.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "model/atoms/multiscale/atomic_sample.h"
#include "model/base/mat3.h"

namespace cuboct::test {

struct Springs : AtomicLaw {
  double near = 9, next = 2, harder = -4;  // eV/angstrom^2; of the stiffness per angstrom of stretch
  double edge = 5.43;                      // angstrom, at which no spring is strained
  std::unique_ptr<AtomicForces> forces() const override;
};

class SpringForces : public AtomicForces {
 public:
  explicit SpringForces(const Springs& law) : law_(law) {}

  double evaluate(const Mat3& cell, std::span<const Vec3> x, std::span<Vec3> f, Mat3& virial) override {
    if (bonds_.empty()) find(cell, x);
    for (Vec3& one : f) one.setZero();
    virial.setZero();
    double energy = 0;
    for (const Bond& bond : bonds_) {
      const Vec3 d = x[bond.j] + cell * bond.image - x[bond.i];
      const double r = d.norm(), u = r - bond.rest, k = bond.stiffness;
      energy += k * u * u / 2 * (1 + law_.harder * u / 3);
      const Vec3 pull = k * u * (1 + law_.harder * u / 2) / r * d;
      f[bond.i] += pull, f[bond.j] -= pull;
      virial += pull * d.transpose();
    }
    return energy;
  }

 private:
  struct Bond {
    size_t i, j;
    Vec3 image;
    double rest, stiffness;
  };

  void find(const Mat3& cell, std::span<const Vec3> x) {
    const std::array<double, 2> rest{std::sqrt(3.0) / 4 * law_.edge, std::sqrt(0.5) * law_.edge};
    for (size_t i = 0; i < x.size(); ++i)
      for (size_t j = 0; j < x.size(); ++j)
        for (int n = 0; n < 27; ++n) {
          const Vec3 image(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
          const double r = (x[j] + cell * image - x[i]).norm();
          for (const int shell : {0, 1})
            if (std::abs(r / rest[shell] - 1) < 0.1 && (i < j || (i == j && n < 13)))
              bonds_.push_back({i, j, image, rest[shell], shell == 0 ? law_.near : law_.next});
        }
  }

  Springs law_;
  std::vector<Bond> bonds_;
};

inline std::unique_ptr<AtomicForces> Springs::forces() const { return std::make_unique<SpringForces>(*this); }

}  // namespace cuboct::test
