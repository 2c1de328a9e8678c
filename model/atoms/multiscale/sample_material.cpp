// SPDX-License-Identifier: MIT
#include "model/atoms/multiscale/sample_material.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "model/base/dense.h"
#include "model/base/error.h"
#include "model/solid/moduli.h"

namespace cuboct {
namespace {

constexpr double kReach = 1.2;       // of the guess: a search for the edge goes no further
constexpr double kEdgeStep = 0.005;  // of the guess, between two looks of it
constexpr double kPressure = 1e3;    // Pa: zero, of a stress that bends like 1e11 Pa
constexpr double kMove = 1e-4;       // angstrom, of atoms, for second derivatives
constexpr double kStrain = 1e-4;     // for constants: the error is its square times some 10
constexpr double kForce = 1e-9;      // eV/angstrom, of samples at rest for constants
constexpr double kSoftest = 1e-3;    // of the stiffest vibration: less does not count as restored

double pull(AtomicForces& forces, const AtomicLattice& lattice) {
  return held_sample(forces, lattice.cell, lattice.place).stress.trace() / 3;
}

// Bisection between two edges of unlike pull.
double rest_edge(AtomicForces& forces, AtomicLattice lattice, int cells, double low, double high) {
  const auto at = [&](double edge) {
    lattice.cell = edge * cells * Mat3::Identity();
    return pull(forces, lattice);
  };
  for (int turn = 0; turn < 80; ++turn) {
    const double middle = (low + high) / 2, stress = at(middle);
    if (std::abs(stress) < kPressure) return middle;
    (stress < 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

// The edge nearest to the guess about which a shorter one pushes and a longer one pulls.
double find_edge(AtomicForces& forces, AtomicLattice lattice, int cells, double guess) {
  const auto pulls = [&](double edge) {
    lattice.cell = edge * cells * Mat3::Identity();
    return pull(forces, lattice);
  };
  const double step = kEdgeStep * guess;
  for (double away = 0; away <= (kReach - 1) * guess; away += step)
    for (const double low : {guess + away, guess - away - step})
      if (pulls(low) <= 0 && pulls(low + step) > 0) return rest_edge(forces, lattice, cells, low, low + step);
  throw InputError(fmt::format("no edge of a cubic cell between {:.4g} and {:.4g} angstrom is without stress",
                               guess / kReach, guess * kReach),
                   "the parameters of the potential hold no such lattice");
}

Eigen::VectorXd eigenvalues_of(AtomicForces& forces, const AtomicLattice& lattice) {
  const auto size = static_cast<Eigen::Index>(3 * lattice.place.size());
  std::vector<Vec3> x, plus(lattice.place.size()), minus = plus;
  for (const Vec3& place : lattice.place) x.push_back(lattice.cell * place);
  Eigen::MatrixXd hessian(size, size);
  Mat3 virial;
  for (Eigen::Index k = 0; k < size; ++k) {
    double& moved = x[static_cast<size_t>(k / 3)][k % 3];
    const double here = moved;
    moved = here + kMove;
    forces.evaluate(lattice.cell, x, plus, virial);
    moved = here - kMove;
    forces.evaluate(lattice.cell, x, minus, virial);
    moved = here;
    for (Eigen::Index i = 0; i < size; ++i)
      hessian(i, k) =
          (minus[static_cast<size_t>(i / 3)][i % 3] - plus[static_cast<size_t>(i / 3)][i % 3]) / (2 * kMove);
  }
  return eigenvalues<Eigen::MatrixXd>((hessian + hessian.transpose()) / 2);
}

Mat3 voigt_strain(int v, double size) {
  Mat3 out = Mat3::Zero();
  const auto [a, b] = kVoigt[v];
  out(a, b) += size / 2;
  out(b, a) += size / 2;
  return out;
}

Matrix6 constants_of(const SampleMaterial& material, AtomicForces& forces, bool held) {
  Relaxation how = material.relaxation;
  how.force = kForce;
  Matrix6 out;
  for (int v = 0; v < 6; ++v) {
    std::array<Mat3, 2> stress;
    for (const int side : {0, 1}) {
      const Mat3 cell =
          (Mat3::Identity() + voigt_strain(v, side == 0 ? kStrain : -kStrain)) * material.lattice.cell;
      std::vector<Vec3> place = material.lattice.place;
      stress[side] =
          held ? held_sample(forces, cell, place).stress : relax_sample(forces, cell, place, how).stress;
    }
    for (int w = 0; w < 6; ++w)
      out(w, v) = (stress[0] - stress[1])(kVoigt[w][0], kVoigt[w][1]) / (2 * kStrain);
  }
  return (out + out.transpose()) / 2;
}

// Three vibrations are translations, whose stiffness is 0.
void check_vibrations(const Eigen::VectorXd& stiffness) {
  const double most = stiffness[stiffness.size() - 1];
  if (stiffness[0] < -kSoftest * most || stiffness[3] < kSoftest * most)
    throw InputError(
        fmt::format("the sample's lattice is no minimum of the energy: a vibration has the stiffness "
                    "{:.3g} eV/angstrom^2, the stiffest {:.3g}",
                    std::min(stiffness[0], stiffness[3]), most),
        "these parameters of the potential are unstable");
}

}  // namespace

SampleMaterial crystal_material(Crystal crystal, std::shared_ptr<const AtomicLaw> law, double guess,
                                int cells, double mass, double force) {
  SampleMaterial out;
  const std::unique_ptr<AtomicForces> forces = law->forces();
  out.law = std::move(law);
  out.lattice = crystal_lattice(crystal, guess, cells, mass);
  out.lattice = crystal_lattice(crystal, find_edge(*forces, out.lattice, cells, guess), cells, mass);
  const Eigen::VectorXd stiffness = eigenvalues_of(*forces, out.lattice);
  check_vibrations(stiffness);
  out.softest = stiffness[3];
  out.relaxation = {.force = force, .stiffness = stiffness[stiffness.size() - 1]};
  out.energy = held_sample(*forces, out.lattice.cell, out.lattice.place).energy /
               static_cast<double>(out.lattice.place.size());
  out.constants = constants_of(out, *forces, false);
  out.clamped = constants_of(out, *forces, true);
  if (const double softest = softest_strain(out.constants); !(softest > 0))
    throw InputError(fmt::format("the sample gives way to a strain: its least elastic constant is {:.3g} GPa",
                                 softest / 1e9),
                     "these parameters of the potential are unstable");
  return out;
}

Mat3 green_strain(const Mat3& gradient) { return (gradient.transpose() * gradient - Mat3::Identity()) / 2; }

Mat3 stress_of(const Matrix6& constants, const Mat3& strain) {
  Eigen::Matrix<double, 6, 1> e;
  for (int v = 0; v < 6; ++v) e[v] = (v < 3 ? 1 : 2) * strain(kVoigt[v][0], kVoigt[v][1]);
  const Eigen::Matrix<double, 6, 1> s = constants * e;
  Mat3 out;
  for (int v = 0; v < 6; ++v) out(kVoigt[v][0], kVoigt[v][1]) = out(kVoigt[v][1], kVoigt[v][0]) = s[v];
  return out;
}

}  // namespace cuboct
