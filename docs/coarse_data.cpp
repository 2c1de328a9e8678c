// SPDX-License-Identifier: MIT
// Prints, for docs/plot_coarse.sh, a sheet of graphene that is pulled apart at its edges until a slit from
// its lower edge runs on: where atoms are, then where points are by plain weights, and by weights that avoid
// jumps. Blocks of x and y in angstrom, two empty lines between them.
#include <fmt/format.h>

#include <cmath>

#include "model/atoms/bond_order/atom_cell.h"
#include "model/atoms/bond_order/atom_motion.h"
#include "model/atoms/coarse/coarse_grain.h"

using namespace cuboct;

namespace {

constexpr double kBond = 1.4606, kSlit = 25, kGrip = 3, kSpeed = 8, kTime = 1.3, kDt = 5e-4;  // angstrom, ps
constexpr double kMass = 2e-26 / 1.602176634e-23;  // eV ps^2/angstrom^2
constexpr int kPoints = 20;

// Symmetric about a column of atoms, which is left out along the slit: its faces are out of reach.
std::vector<Vec3> slit_sheet(Vec3& extent) {
  const AtomCell sheet = graphene_sheet(kBond, 3.35, 40, 23);
  extent = sheet.box.edges.diagonal();
  std::vector<Vec3> x;
  for (const Vec3& at : sheet.x) {
    const Vec3 place = at - Vec3(20 * std::sqrt(3) * kBond, extent[1] / 2 - kBond / 4, 0);
    if (std::abs(place[0]) > 0.1 || place[1] > kSlit - extent[1] / 2) x.push_back(place);
  }
  return x;
}

void print(const std::vector<Vec3>& x, const std::vector<Vec3>& u) {
  for (size_t i = 0; i < x.size(); ++i) fmt::print("{:.3f} {:.3f}\n", x[i][0] + u[i][0], x[i][1] + u[i][1]);
  fmt::print("\n\n");
}

}  // namespace

int main() {
  Vec3 extent;
  AtomSystem system{{}, slit_sheet(extent), {}, {}, {kMass}};
  system.box.edges = extent.asDiagonal();
  AtomLoads loads;
  for (const Vec3& x : system.x) {
    system.v.emplace_back(kSpeed * x[0] / (extent[0] / 2) * (0.5 - x[1] / extent[1]), 0, 0);
    loads.imposed.push_back({std::abs(x[0]) > extent[0] / 2 - kGrip, false, false});
  }
  loads.velocity = system.v;
  const std::vector<Vec3> home = system.x;
  AtomMotion motion(tersoff_set("c_1989"), system, {.dt = kDt, .skin = 0.4});
  motion.load(loads);
  motion.step(static_cast<uint64_t>(kTime / kDt));
  std::vector<Vec3> u = motion.atoms().x;
  for (size_t i = 0; i < u.size(); ++i) u[i] -= home[i];
  CoarsePoints points{
      2, {}, 2 * extent[0] / kPoints, extent[0] * extent[1] / (kPoints * kPoints), Vec3::Zero()};
  for (int k = 0; k < kPoints * kPoints; ++k)
    points.x.emplace_back((k % kPoints + 0.5) * extent[0] / kPoints - extent[0] / 2,
                          (k / kPoints + 0.5) * extent[1] / kPoints - extent[1] / 2, 0);
  CoarseGrain grain(points, home, std::vector<double>(home.size(), 1));
  print(home, u);
  print(points.x, grain.linear_mean(u));
  grain.look(u, {.noise = 0.03, .tube = 2});
  print(points.x, grain.linear_mean(u));
}
