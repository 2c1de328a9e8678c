// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "model/atoms/bond_order/atom_motion.h"
#include "model/base/error.h"
#include "model/base/mat3.h"
#include "model/base/places.h"
#include "model/config/config.h"
#include "study/learn/samples.h"

namespace cuboct::learn {
namespace {

// Of graphene, for the size of loads alone: the strain that comes out is told.
constexpr double kShear = 0.72e12;  // Pa
constexpr uint64_t kMostEvaluations = 200000;

const char* kAxis = "xy";

// Along `axis`, cos k1 x cos k2 y: equation 43.
StaticLoad wave(const LearnStudy& study, const Vec3& extent, int axis, int m1, int m2) {
  const Vec3 k(2 * std::numbers::pi * m1 / extent[0], 2 * std::numbers::pi * m2 / extent[1], 0);
  // u = b/(G k^2) at most, and its slope k u: an atom stands for 3 sqrt(3)/4 bond^2 of the sheet.
  const double area = 3 * std::sqrt(3) / 4 * study.sheet.bond * study.sheet.bond;
  const double stiffness = kShear * kAngstrom * kAngstrom * kAngstrom / kElectronVolt;  // eV/angstrom^3
  StaticLoad load;
  load.name = fmt::format("wave {} {} {}", kAxis[axis], m1, m2);
  load.size = study.still.strain * stiffness * k.norm() * area * study.sheet.thickness;
  load.shape = [k, axis](const Vec3& x) {
    return Vec3(std::cos(k[0] * x[0]) * std::cos(k[1] * x[1]) * Vec3::Unit(axis));
  };
  return load;
}

// Equation 44, L being half of the edge: discs at -L, 0 and L, of which those at the ends are one in a sheet
// that repeats.
StaticLoad discs(const LearnStudy& study, const Vec3& extent, const DiscInput& disc) {
  StaticLoad load = wave(study, extent, 0, 1, 0);
  load.name = fmt::format("discs {} along {}, {:g}", kAxis[disc.force], kAxis[disc.centres], disc.radius);
  load.training = false;
  // A disc of radius R is some quarter of a wave of length 4 R.
  load.size *= extent[0] / (4 * disc.radius);
  const double half = extent[disc.centres] / 2;
  load.shape = [disc, half](const Vec3& x) {
    double sum = 0;
    for (int j = -1; j <= 1; ++j) {
      const double r = eigen(x - j * half * Vec3::Unit(disc.centres)).head<2>().norm();
      sum += (j == 0 ? 1 : -1) * std::cos(std::numbers::pi / 2 * std::min(1.0, r / disc.radius));
    }
    return Vec3(sum * Vec3::Unit(disc.force));
  };
  return load;
}

// Forces on the atoms whose sum is 0, as a sheet that repeats needs.
std::vector<Vec3> forces_of(const AtomCell& sheet, const StaticLoad& load) {
  std::vector<Vec3> forces;
  Vec3 mean = Vec3::Zero();
  for (const Vec3& x : sheet.x) forces.push_back(load.size * load.shape(x)), mean += forces.back();
  for (Vec3& f : forces) f -= mean / static_cast<double>(sheet.x.size());
  return forces;
}

// Of the sheet's bonds.
double largest_strain(const AtomCell& sheet, const std::vector<Vec3>& u, double bond) {
  const Vec3 period = sheet.box.edges.diagonal();
  double most = 0;
  for (size_t i = 0; i < sheet.x.size(); ++i)
    for (size_t j = 0; j < i; ++j) {
      Vec3 d = sheet.x[j] - sheet.x[i];
      if (std::abs(d[1]) > 1.1 * bond && std::abs(d[1]) < period[1] - 1.1 * bond) continue;
      for (int a = 0; a < 2; ++a) d[a] -= period[a] * std::round(d[a] / period[a]);
      if (d.norm() > 1.1 * bond) continue;
      most = std::max(most, std::abs((d + u[j] - u[i]).norm() / d.norm() - 1));
    }
  return most;
}

}  // namespace

InputError placed(const LearnStudy& study, const InputError& error) {
  return parse_config(read_config_text(study.path), study.path).places().placed(error);
}

std::vector<StaticLoad> static_loads(const LearnStudy& study, const AtomCell& sheet) {
  const Vec3 extent = sheet.box.edges.diagonal();
  std::vector<StaticLoad> loads;
  for (int axis = 0; axis < 2; ++axis)
    for (int m1 = 0; m1 <= study.still.waves; ++m1)
      for (int m2 = 0; m2 <= study.still.waves; ++m2)
        if (m1 + m2 > 0) loads.push_back(wave(study, extent, axis, m1, m2));
  for (const DiscInput& disc : study.still.discs) loads.push_back(discs(study, extent, disc));
  return loads;
}

StaticSample rest_under(const LearnStudy& study, const AtomCell& sheet, const StaticLoad& load) {
  const std::vector<Vec3> forces = forces_of(sheet, load);
  AtomMotion motion(study.sheet.tersoff, {sheet.box, sheet.x, {}, {}, {study.sheet.mass}}, {.dt = 1e-3});
  motion.load({forces, {}, {}});
  const AtomMotion::Rest rest = motion.rest(study.still.force, kMostEvaluations);
  if (!rest.reached)
    throw std::runtime_error(fmt::format("{}: no rest after {} evaluations: {:.3g} eV/angstrom are left",
                                         load.name, rest.evaluations, rest.force));
  std::vector<Vec3> u = motion.atoms().x;
  Vec3 mean = Vec3::Zero();
  for (size_t i = 0; i < u.size(); ++i) u[i] -= sheet.x[i], mean += u[i];
  for (Vec3& moved : u) moved -= mean / static_cast<double>(u.size());
  StaticSample out;
  out.strain = largest_strain(sheet, u, study.sheet.bond);
  if (out.strain > study.still.most)
    throw placed(study, InputError(fmt::format("{}: a bond is strained by {:.3g} %, more than {:g} %",
                                               load.name, 100 * out.strain, 100 * study.still.most),
                                   "a smaller 'strain'")
                            .about({"static.strain", "static"}));
  const Grid grid = grid_of(study, sheet, study.grid.points);
  std::vector<Vec3> x = sheet.x, b = forces;
  for (size_t i = 0; i < x.size(); ++i)
    x[i] *= kAngstrom, u[i] *= kAngstrom, b[i] *= kElectronVolt / kAngstrom;
  try {
    const CoarseGrain grain(grid.coarse(true), x, std::vector<double>(x.size(), 1));
    out.u = grain.linear_mean(u), out.b = grain.density_of(b);
  } catch (const InputError& error) {
    throw placed(study, error.about({"grid.radius", "grid.points"}));
  }
  return out;
}

}  // namespace cuboct::learn
