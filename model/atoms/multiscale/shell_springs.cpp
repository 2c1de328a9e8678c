// SPDX-License-Identifier: MIT
#include "model/atoms/multiscale/shell_springs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "model/atoms/bond_order/tersoff_kernel.h"
#include "model/atoms/multiscale/spring_kernel.h"
#include "model/atoms/multiscale/tersoff_law.h"
#include "model/base/error.h"

namespace cuboct {
namespace {

constexpr double kWidth = 0.06;  // of the edge: half of what is between the second and the third shell of
                                 // diamond

class SpringForces : public AtomicForces {
 public:
  explicit SpringForces(const ShellSprings& springs)
      : springs_(springs), list_(springs.cutoff(), kTersoffSkin, bond_lanes()) {}

  double evaluate(const Mat3& cell, std::span<const Vec3> x, std::span<Vec3> f, Mat3& virial) override {
    const AtomBox box{cell, {true, true, true}};
    list_.update(box, x);
    place(box, x);
    sums_.assign(10 * list_.slots(), 0);
    spring_forces(springs_, list_, x_.data(), sums_.data());
    double energy = 0;
    std::array<double, 6> sum{};
    for (size_t i = 0; i < x.size(); ++i) {
      const auto of = [&](size_t k) {
        return sums_[(i / list_.lanes() * 10 + k) * list_.lanes() + i % list_.lanes()];
      };
      f[i] = Vec3(of(0), of(1), of(2));
      energy += of(3);
      for (size_t k = 0; k < 6; ++k) sum[k] += of(4 + k);
    }
    virial << sum[0], sum[5], sum[4], sum[5], sum[1], sum[3], sum[4], sum[3], sum[2];
    return energy;
  }

 private:
  // Records of four numbers: atoms, what fills the last group, ghosts.
  void place(const AtomBox& box, std::span<const Vec3> x) {
    x_.assign(4 * (list_.slots() + list_.ghosts().size()), 0);
    const auto put = [&](size_t at, const Vec3& place) {
      std::copy_n(place.data(), 3, x_.begin() + static_cast<ptrdiff_t>(4 * at));
    };
    for (size_t i = 0; i < x.size(); ++i) put(i, x[i]);
    size_t at = list_.slots();
    for (const BondList::Ghost& ghost : list_.ghosts())
      put(at++, x[ghost.owner] + box.edges * Vec3(ghost.image[0], ghost.image[1], ghost.image[2]));
  }

  ShellSprings springs_;
  BondList list_;
  std::vector<double> x_, sums_;
};

struct SpringLaw : AtomicLaw {
  explicit SpringLaw(ShellSprings springs) : springs(std::move(springs)) {}
  std::unique_ptr<AtomicForces> forces() const override { return std::make_unique<SpringForces>(springs); }
  ShellSprings springs;
};

[[noreturn]] void refuse(const CauchyFit& fit, const char* of) {
  throw InputError(
      fmt::format("springs of C11 = {:.4g} GPa and C12 = C44 = {:.4g} GPa would not be positive: {}",
                  fit.c11 / 1e9, fit.c44 / 1e9, of),
      "an FCC crystal takes C11 above 2 C44, diamond besides C44 above 7/9 (C11 - 2 C44)");
}

}  // namespace

double ShellSprings::cutoff() const {
  double most = 0;
  for (const Shell& shell : shells) most = std::max(most, shell.rest);
  return most + width;
}

// d/dc of (c/c12 - 1)^2 + (c/c44 - 1)^2 is 0.
CauchyFit cauchy_fit(double c11, double c12, double c44) {
  return {c11, (1 / c12 + 1 / c44) / (1 / (c12 * c12) + 1 / (c44 * c44))};
}

// Sums over bonds per cubic cell of k r^2 n_x^4 and k r^2 n_x^2 n_y^2, with p = k/edge:
//   FCC       C11 = 2 p1 + 4 p2                   C12 = C44 = p1
//   diamond   C11 = p1/3 + 4 p2 + 83/11 p3        C12 = C44 = p1/3 + 2 p2 + 19/11 p3
// and in diamond the sublattices are pushed apart by p1/3 - 9/11 p3.
ShellSprings springs_of(Crystal crystal, double edge, const CauchyFit& fit) {
  const double more = fit.c11 - 2 * fit.c44, scale = edge / kPascal;
  if (!(more > 0)) refuse(fit, "C11 is not above 2 C44");
  ShellSprings out{{}, kWidth * edge};
  const double half = std::sqrt(0.5) * edge;
  if (crystal == Crystal::fcc) {
    out.shells = {{half, scale * fit.c44}, {edge, scale * more / 4}};
  } else {
    const double first = 0.75 * more, second = (fit.c44 - 28.0 / 27 * first) / 2;
    if (!(second > 0)) refuse(fit, "C44 is not above 7/9 (C11 - 2 C44)");
    out.shells = {{std::sqrt(3.0) / 4 * edge, scale * first},
                  {half, scale * second},
                  {std::sqrt(11.0) / 4 * edge, scale * first * 11 / 27}};
  }
  return out;
}

std::shared_ptr<const AtomicLaw> spring_law(ShellSprings springs) {
  return std::make_shared<const SpringLaw>(std::move(springs));
}

}  // namespace cuboct
