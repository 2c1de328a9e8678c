// SPDX-License-Identifier: MIT
// Prints, for docs/lps_table, the moduli of the peridynamic solid on lattices ("table") or Young's modulus by
// direction in the plane of [100] and [011], over that of the material, at a Poisson's ratio of 0.3
// ("polar").
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>

#include "model/rules/lps_lattice.h"

using namespace cuboct;

namespace {

struct Case {
  const char* name;
  std::vector<Vec3> full;
  double horizon, influence, volume;
};

const double kFcc = 1 / std::sqrt(2.0), kRatio = 0.3;

std::vector<Case> cases() {
  return {{"simple cubic, three spacings, w = 1", simple_cubic_bonds(1, 3), 3, 0, 1},
          {"simple cubic, three spacings, w = 1/r", simple_cubic_bonds(1, 3), 3, 1, 1},
          {"simple cubic, two shells, w = 1", simple_cubic_bonds(1, 1.5), 1.5, 0, 1},
          {"FCC, one shell", fcc_bonds(1, 1.1), 1.1, 0, kFcc},
          {"FCC, two shells, w = 1", fcc_bonds(1, 1.5), 1.5, 0, kFcc},
          {"FCC, two shells, w = 1/r^4", fcc_bonds(1, 1.5), 1.5, 4, kFcc},
          {"FCC, three shells, w = 1/r^2", fcc_bonds(1, 1.8), 1.8, 2, kFcc}};
}

LpsMaterial material(const Case& of) {
  LpsMaterial m;
  m.mu = 1, m.lambda = 2 * kRatio / (1 - 2 * kRatio);
  m.horizon = of.horizon, m.influence = of.influence, m.volume = of.volume;
  return m;
}

// J. F. Nye, Physical Properties of Crystals, 1957, ch. VIII.
double young(const CubicModuli& c, const Vec3& n) {
  const double s11 = (c.c11 + c.c12) / ((c.c11 - c.c12) * (c.c11 + 2 * c.c12));
  const double s12 = -c.c12 / ((c.c11 - c.c12) * (c.c11 + 2 * c.c12)), s44 = 1 / c.c44;
  const Vec3 q = n.cwiseAbs2();
  const double j = q[0] * q[1] + q[1] * q[2] + q[2] * q[0];
  return 1 / (s11 - 2 * (s11 - s12 - s44 / 2) * j);
}

void polar() {
  const auto all = cases();
  for (int k = 0; k <= 360; k += 2) {
    const double a = k * std::numbers::pi / 180;
    const Vec3 n(std::cos(a), std::sin(a) / std::numbers::sqrt2, std::sin(a) / std::numbers::sqrt2);
    fmt::print("{}", k);
    for (const size_t of : {size_t{0}, size_t{3}, size_t{5}})
      fmt::print(" {:.5f}", young(lattice_moduli(material(all[of]), all[of].full), n) / (2 * (1 + kRatio)));
    fmt::print("\n");
  }
}

void table() {
  fmt::print("lattice\tneighbours\tK\tC44\tC'\tE, least\tE, most\n");
  for (const Case& of : cases()) {
    const LpsMaterial m = material(of);
    const CubicModuli c = lattice_moduli(m, of.full);
    const double a = young(c, Vec3::UnitX()), b = young(c, Vec3(1, 1, 1).normalized()), e = 2 * (1 + kRatio);
    fmt::print("{}\t{}\t{:.4f}\t{:.4f}\t{:.4f}\t{:.3f}\t{:.3f}\n", of.name, of.full.size(),
               c.bulk() / m.bulk(), c.shear(), c.prime(), std::min(a, b) / e, std::max(a, b) / e);
  }
}

}  // namespace

int main(int, char** arguments) { std::string(arguments[1]) == "polar" ? polar() : table(); }
