// SPDX-License-Identifier: MIT
#include "model/rules/lps.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "model/base/error.h"
#include "model/base/mat3.h"
#include "model/rules/lps_bond.h"
#include "model/rules/lps_lattice.h"
#include "model/rules/lps_terms.h"

namespace cuboct {
namespace {

// Of the ball, sphere area times the integral of r^(p-1) h^-p... : sum of (h/r)^q r^k over volume.
double ball(const LpsMaterial& m, double k) {
  const double pi = std::numbers::pi, area = m.dimensions == 3 ? 4 * pi : 2 * pi;
  const double power = k - m.influence + m.dimensions;
  if (!m.bernstein.empty()) {
    // Of t^(power - 1) times each polynomial over [0, 1]: (P over j) B(power + j, P - j + 1).
    double sum = 0;
    const auto degree = static_cast<double>(m.bernstein.size() - 1);
    for (size_t j = 0; j < m.bernstein.size(); ++j) {
      const auto order = static_cast<double>(j);
      sum += m.bernstein[j] * std::tgamma(degree + 1) / std::tgamma(order + 1) * std::tgamma(power + order) /
             std::tgamma(power + degree + 1);
    }
    return area * std::pow(m.horizon, k + m.dimensions) * sum;
  }
  // Of a sheet V is an area times a thickness, which the caller's volume has and this integral has not.
  return area * std::pow(m.horizon, k + m.dimensions) / power;
}

// sum w r^k V.
double moment(const LpsMaterial& m, const std::vector<Vec3>& full, double k) {
  if (full.empty() || m.quadrature == LpsQuadrature::fitted) return ball(m, k);
  double sum = 0;
  for (const Vec3& r : full) sum += m.weight(r.norm()) * std::pow(r.norm(), k) * share_of(m, r.norm());
  return sum * m.volume;
}

RuleDeclaration declaration_of(const LpsMaterial& m) {
  RuleDeclaration rule;
  rule.name = "lps";
  rule.constants = {{"reference", 3, "m", "the bond in the body as packed"},
                    {"weight", 1, "m^3", "influence times the volume that the other end stands for"}};
  if (m.breaks())
    rule.bond = {{"largest_stretch", 1, "1", "so far; never falls"},
                 {"whole", 1, "1", "what is left of the bond, 1 to 0"}};
  rule.particle = {{"displacement", 3, "m", "from the place as packed"},
                   {"weighted_volume", 1, "m^5", "sum of weight times length squared, of the undamaged body"},
                   {"dilatation", 1, "1", "growth of the volume about the particle"},
                   {"pressure", 1, "N/m^8", "dilatation over weighted volume, times 3K - 5G or its like"},
                   {kForceField, 3, "N", "on the particle"}};
  rule.ready = {"displacement", "weighted_volume"};
  RuleRound dilatation{"dilatation",
                       {"displacement"},
                       {{"opening", 1, "m^5", "weighted bond lengthening"}},
                       {},
                       {"dilatation", "pressure"}};
  RuleRound force{"force",
                  {"displacement", "weighted_volume", "pressure"},
                  {{"pull", 3, "N/m^3", "of bonds, a density"}},
                  {},
                  {kForceField}};
  if (m.breaks()) dilatation.updated = {"largest_stretch", "whole"};
  if (m.corrected) {
    rule.particle.push_back({"shape", 6, "1", "inverse of the second moment of the bonds that are left"});
    rule.particle.push_back({"missing", 3, "N/m^3", "force per dilatation of the bonds that are not there"});
    rule.ready.insert(rule.ready.end(), {"shape", "missing"});
    if (m.breaks()) dilatation.made.insert(dilatation.made.end(), {"shape", "missing"});
  }
  rule.rounds = {std::move(dilatation), std::move(force)};
  rule.shown = {{"dilatation", 1, "1", "growth of the volume about the particle"}};
  if (m.breaks()) rule.shown.push_back({"damage", 1, "1", "of its bonds' volume the share that is gone"});
  return rule;
}

void check(const LpsMaterial& m) {
  if (!(m.mu > 0)) throw InputError(fmt::format("the shear modulus {:.6g} Pa is not above 0", m.mu));
  if (!(m.bulk() > 0)) throw InputError(fmt::format("the bulk modulus {:.6g} Pa is not above 0", m.bulk()));
  if (!(m.horizon > 0)) throw InputError(fmt::format("the horizon {:.6g} m is not above 0", m.horizon));
  if (!(m.volume > 0)) throw InputError(fmt::format("the volume {:.6g} m^3 is not above 0", m.volume));
  if (!(m.influence < m.dimensions + 2))
    throw InputError(fmt::format("with the influence 1/r^{:g} the weighted volume is infinite", m.influence),
                     fmt::format("a power below {}", m.dimensions + 2));
  if (!(m.critical_stretch > 0))
    throw InputError(fmt::format("the critical stretch {:.6g} is not above 0", m.critical_stretch));
  if (m.corrected && m.finite)
    throw InputError("the free-surface correction is one of small displacements", "strain = \"small\"");
}

}  // namespace

double bernstein(size_t k, size_t degree, double r) {
  double binomial = 1;
  for (size_t j = 1; j <= k; ++j) binomial *= static_cast<double>(degree + 1 - j) / static_cast<double>(j);
  return binomial * std::pow(r, k) * std::pow(1 - r, degree - k);
}

double LpsMaterial::weight(double r) const {
  const double power = std::pow(horizon / r, influence);
  if (bernstein.empty()) return power;
  double shape = 0;
  // A bond may be longer than the horizon by rounding.
  for (size_t k = 0; k < bernstein.size(); ++k)
    shape += bernstein[k] * cuboct::bernstein(k, bernstein.size() - 1, std::min(r / horizon, 1.0));
  return power * shape;
}

double LpsMaterial::left(double most) const { return intact_share(most, critical_stretch, damage_width); }

double full_weight(const LpsMaterial& material, const std::vector<Vec3>& full) {
  return moment(material, full, 2);
}

double critical_stretch(const LpsMaterial& m, const std::vector<Vec3>& full, double energy) {
  // The mean of |cos| over two: bonds that cross a plane, each once.
  const double crossing = m.dimensions == 3 ? 0.25 : 1 / std::numbers::pi;
  const double square = m.dimensions * m.dimensions;
  return std::sqrt(energy * moment(m, full, 2) / (crossing * square * m.bulk() * moment(m, full, 3)));
}

std::vector<Vec3> lattice_bonds(const std::array<Vec3, 3>& basis, double horizon) {
  Mat3 m;
  m << eigen(basis[0]), eigen(basis[1]), eigen(basis[2]);
  const double reach = horizon * (1 + 1e-6);
  // |n_k| is at most the reach times the length of the k-th row of the inverse.
  const Mat3 inverse = m.inverse();
  Eigen::Vector3i most;
  for (int k = 0; k < 3; ++k) most[k] = static_cast<int>(std::ceil(reach * inverse.row(k).norm()));
  std::vector<Vec3> bonds;
  for (int a = -most[0]; a <= most[0]; ++a)
    for (int b = -most[1]; b <= most[1]; ++b)
      for (int c = -most[2]; c <= most[2]; ++c) {
        const Vec3 r = m * Vec3(a, b, c);
        if ((a != 0 || b != 0 || c != 0) && r.norm() < reach) bonds.push_back(r);
      }
  return bonds;
}

std::vector<Vec3> fcc_bonds(double pitch, double horizon) {
  const double half = pitch / std::numbers::sqrt2;
  return lattice_bonds({Vec3(0, half, half), Vec3(half, 0, half), Vec3(half, half, 0)}, horizon);
}

std::vector<Vec3> simple_cubic_bonds(double spacing, double horizon) {
  return lattice_bonds({Vec3(spacing, 0, 0), Vec3(0, spacing, 0), Vec3(0, 0, spacing)}, horizon);
}

LpsRule::LpsRule(const LpsMaterial& material, std::vector<Vec3> full, std::vector<Slit> slits,
                 std::vector<char> unbreakable)
    : material_(material),
      full_(std::move(full)),
      slits_(std::move(slits)),
      unbreakable_(std::move(unbreakable)),
      declaration_(declaration_of(material)) {
  check(material_);
  cuboct::check(declaration_);
  if (!(full_weight(material_, full_) > 0))
    throw InputError(fmt::format("no neighbour is within the horizon of {:.6g} m", material_.horizon));
}

double LpsRule::bond_reach() const {
  double shortest = material_.horizon;
  for (const Vec3& r : full_) shortest = std::min(shortest, r.norm());
  return shortest * (1 + material_.critical_stretch);
}

double LpsRule::stiffness() const {
  return full_.empty() ? 0 : largest_lps_rate(material_, full_) * material_.volume;
}

double LpsRule::stable_time_step(double mass, double) const {
  return full_.empty() ? 0 : 2 / std::sqrt(stiffness() / mass);
}

double LpsRule::sound_speed(double mass) const {
  return std::sqrt((material_.lambda + 2 * material_.mu) * material_.volume / mass);
}

std::vector<DeclarationLine> LpsRule::settings() const {
  const LpsMaterial& m = material_;
  std::vector<DeclarationLine> lines{
      {"lambda", fmt::format("{:.6g} Pa", m.lambda), m.dimensions == 2 ? "of the sheet" : ""},
      {"shear modulus", fmt::format("{:.6g} Pa", m.mu), ""},
      {"horizon", fmt::format("{:.6g} m", m.horizon),
       full_.empty() ? "" : fmt::format("{} bonds of a particle inside", full_.size())},
      {"influence", m.influence == 0 ? "1" : fmt::format("1/r^{:g}", m.influence), ""},
      {"volume", fmt::format("{:.6g} m^3", m.volume), "of a particle"},
      {"strain", m.finite ? "finite" : "small", m.corrected ? "with the free-surface correction" : ""}};
  const char* kNames[] = {"points", "partial", "fitted"};
  lines.push_back({"quadrature", kNames[static_cast<int>(m.quadrature)], ""});
  if (m.breaks())
    lines.push_back({"critical stretch", fmt::format("{:.6g}", m.critical_stretch),
                     m.damage_width > 0 ? fmt::format("over a width of {:.3g}", m.damage_width) : "at once"});
  for (const Slit& slit : slits_) lines.push_back({"slit", slit.told(), ""});
  if (const auto kept = std::ranges::count(unbreakable_, 1); kept > 0)
    lines.push_back({"unbreakable", fmt::format("{} particles", kept), "all bonds of theirs"});
  return lines;
}

std::unique_ptr<RoundsTerms> LpsRule::bind(const Rule&, const Body& body, const Periodic& periodic,
                                           int threads) const {
  return make_lps_terms(material_, full_weight(material_, full_),
                        reference_bonds(body.x, periodic, material_.horizon, slits_), body.x, unbreakable_,
                        threads);
}

}  // namespace cuboct
