// SPDX-License-Identifier: MIT
// One side of lps_speed.sh: steps the linear peridynamic solid that LAMMPS steps, and writes it for LAMMPS.
//
//   lps_speed SIDE STEPS          velocity Verlet of SIDE^3 points, one thread
//   lps_speed SIDE write FILE     an input of LAMMPS
#include <fmt/format.h>
#include <fmt/os.h>

#include <cstdlib>
#include <random>
#include <string>

#include "model/rules/lps.h"

namespace cuboct {
namespace {

// The glass of LAMMPS's own example of peridynamics, in SI units; the horizon takes in the third neighbour.
constexpr double kSpacing = 5e-4, kBulk = 14.9e9, kShear = 8.94e9, kVolume = 1.25e-10, kDensity = 2200;
constexpr double kHorizon = 3 * kSpacing * (1 + 1e-9), kStep = 1e-8;

Body block(int side) {
  Body body;
  for (int i = 0; i < side * side * side; ++i)
    body.x.push_back(kSpacing * Vec3(i % side, i / side % side, i / side / side));
  std::mt19937_64 dice(1);
  std::normal_distribution<double> speed(0, 1);  // m/s
  for (size_t i = 0; i < body.size(); ++i) body.v.push_back(Vec3(speed(dice), speed(dice), speed(dice)));
  body.type.assign(body.size(), 0);
  return body;
}

LpsMaterial glass() {
  LpsMaterial m;
  m.mu = kShear, m.lambda = kBulk - 2 * kShear / 3;
  m.horizon = kHorizon, m.influence = 1, m.volume = kVolume, m.spacing = kSpacing;
  m.quadrature = LpsQuadrature::partial;
  return m;
}

void write(const Body& body, int side, const std::string& path) {
  auto out = fmt::output_file(path);
  out.print(
      "units si\nboundary s s s\natom_style peri\natom_modify map array\nneighbor 0.0002 bin\nlattice sc "
      "{0}\n"
      "region b block -1 {1} -1 {1} -1 {1} units lattice\ncreate_box 1 b\n"
      "region f block -0.5 {2} -0.5 {2} -0.5 {2} units lattice\ncreate_atoms 1 region f\n",
      kSpacing, side + 1, side - 0.5);
  out.print(
      "set group all density {}\nset group all volume {}\npair_style peri/lps\n"
      "pair_coeff * * {} {} {:.17g} 1e9 0.0\nvelocity all create 1 1\nvelocity all set 0 0 0\nfix 1 all nve\n"
      "timestep {}\nthermo 1000000\nrun 0\n",
      kDensity, kVolume, kBulk, kShear, kHorizon, kStep);
  for (size_t i = 0; i < body.size(); ++i)
    out.print("set atom {} vx {:.9g} vy {:.9g} vz {:.9g}\n", i + 1, body.v[i][0], body.v[i][1], body.v[i][2]);
  out.print("run ${{steps}}\n");
}

void evaluate(RoundsTerms& terms, const Body& body) {
  terms.begin(body.x);
  run_rounds(terms, 2, body.size(), true);
}

void kick(const RoundsTerms& terms, Body& body) {
  const double half = kStep / 2 / (kDensity * kVolume);
  for (size_t i = 0; i < body.size(); ++i) body.v[i] += half * terms.force()[i];
}

}  // namespace
}  // namespace cuboct

int main(int argc, char** argv) {
  using namespace cuboct;
  if (argc < 3) return fmt::print(stderr, "usage: lps_speed SIDE STEPS | SIDE write FILE\n"), 2;
  const int side = std::atoi(argv[1]);
  Body body = block(side);
  if (argc == 4) return write(body, side, argv[3]), 0;
  const LpsRule rule(glass(), simple_cubic_bonds(kSpacing, kHorizon));
  const auto terms = rule.bind({}, body, {}, 1);
  evaluate(*terms, body);
  for (int step = 0; step < std::atoi(argv[2]); ++step) {
    kick(*terms, body);
    for (size_t i = 0; i < body.size(); ++i) body.x[i] += kStep * body.v[i];
    evaluate(*terms, body);
    kick(*terms, body);
  }
  fmt::print("{} points, {} bonds, energy {:.9g} J\n", body.size(), terms->bonds(), terms->energy());
}
