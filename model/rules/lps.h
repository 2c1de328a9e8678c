// SPDX-License-Identifier: MIT
// The linear peridynamic solid: S. A. Silling, M. Epton, O. Weckner, J. Xu and E. Askari, J. Elasticity 88
// (2007) 151; with bond damage and the free-surface correction of H. Q. You, X. Xu, Y. Yu, S. Silling, M.
// D'Elia and J. Foster, Appl. Math. Mech. 44 (2023) 1125, equations 22 to 33.
// docs/reference/peridynamics.md has the formulas.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "model/rules/reference_bonds.h"
#include "model/rules/rounds_rule.h"

namespace cuboct {

// How a sum over a particle's bonds stands for the integral over its horizon.
enum class LpsQuadrature : uint8_t {
  points,   // each neighbour with its whole volume: exact moduli where the lattice has them
  partial,  // less of the volume of those at the horizon's edge: a straight line over one spacing (LAMMPS)
  fitted,   // weights that integrate polynomials exactly (model/rules/quadrature.h)
};

struct LpsMaterial {
  int dimensions = 3;    // 2: a sheet along x and y
  double lambda = 0;     // Pa, Lame's first parameter; of a sheet that of plane stress or plane strain
  double mu = 0;         // Pa
  double horizon = 0;    // m
  double influence = 0;  // p: a bond of length r has the weight (horizon/r)^p
  // D_k of sum D_k B_k,P(r/horizon), Bernstein's polynomials of degree P = size - 1, by which the weight is
  // multiplied; equation 35. Empty: 1.
  std::vector<double> bernstein = {};
  double volume = 0;   // m^3, of a particle
  double spacing = 0;  // m, of the points, over which `partial` tapers
  LpsQuadrature quadrature = LpsQuadrature::points;
  int order = 5;           // of the polynomials that `fitted` integrates
  bool finite = true;      // bonds turn with the body; else displacements are small
  bool corrected = false;  // the free-surface correction; of small displacements alone
  double critical_stretch = std::numeric_limits<double>::infinity();
  double damage_width = 0;  // the stretch over which a bond goes, eta of equation 22; 0: at once

  bool breaks() const { return critical_stretch < std::numeric_limits<double>::infinity(); }
  double weight(double r) const;  // 1
  // What is left of a bond that has been stretched by `most` at most, 1 to 0. Equation 22.
  double left(double most) const;
  // K and G of the solid, or of the sheet in its plane. Pa
  double bulk() const { return lambda + 2 * mu / dimensions; }
  // The operator's two factors, C1 (lambda - mu) and C2 mu: in three dimensions 3K - 5G and 30 G.
  double dilatation_factor() const { return dimensions * (lambda - mu); }
  double stretch_factor() const { return (dimensions == 3 ? 30 : 16) * mu; }
};

// (P over k) r^k (1 - r)^(P - k), equation 36.
double bernstein(size_t k, size_t degree, double r);

// sum w r^2 V over the bonds `full` of a particle that lacks none; without any the integral over the horizon.
// m^5, of a sheet m^4 times its thickness.
double full_weight(const LpsMaterial& material, const std::vector<Vec3>& full);

// The stretch at which a plane of broken bonds has taken `energy` (J/m^2): with the energy of a bond under
// equal stretch of all, e = d^2 K s^2 w r^2/m, and |cos| averaged over directions, which in 3D is
//   G0 = sum |r|/4 e V = (9 K s^2/4) sum w r^3 V / sum w r^2 V.
// By the integral that is s^2 = 8 G0/(15 K horizon) for w = 1 and 5 G0/(9 K horizon) for w = 1/r.
double critical_stretch(const LpsMaterial& material, const std::vector<Vec3>& full, double energy);

// The bonds of a particle of a perfect lattice, m: all sums of `basis` within the reach of the horizon.
std::vector<Vec3> lattice_bonds(const std::array<Vec3, 3>& basis, double horizon);
std::vector<Vec3> fcc_bonds(double pitch, double horizon);
std::vector<Vec3> simple_cubic_bonds(double spacing, double horizon);

class LpsRule final : public RoundsRule {
 public:
  // `full`: the bonds of a particle that lacks none; empty where no lattice is known. `unbreakable`: [id],
  // whose bonds never break; empty: none. InputError where the material cannot be: a shear modulus or a bulk
  // modulus that is not positive, an influence whose integral diverges, ...
  LpsRule(const LpsMaterial& material, std::vector<Vec3> full, std::vector<Slit> slits = {},
          std::vector<char> unbreakable = {});

  const RuleDeclaration& declaration() const override { return declaration_; }
  double bond_reach() const override;
  double stable_time_step(double mass, double pitch) const override;
  double stiffness() const override;
  double sound_speed(double mass) const override;
  std::vector<DeclarationLine> settings() const override;
  std::unique_ptr<RoundsTerms> bind(const Rule&, const Body& body, const Periodic& periodic,
                                    int threads) const override;

  const LpsMaterial& material() const { return material_; }
  const std::vector<Vec3>& full() const { return full_; }

 private:
  LpsMaterial material_;
  std::vector<Vec3> full_;
  std::vector<Slit> slits_;
  std::vector<char> unbreakable_;
  RuleDeclaration declaration_;
};

}  // namespace cuboct
