// SPDX-License-Identifier: MIT
// One side of tersoff_speed.sh: steps the matter that LAMMPS steps, and writes it for LAMMPS to read.
//
//   tersoff_speed sheet|silicon|silicon_1988 STEPS          velocity Verlet at constant energy, one thread
//   tersoff_speed sheet|silicon|silicon_1988 write FILE     a data file of LAMMPS
#include <fmt/format.h>
#include <fmt/os.h>

#include <cstdlib>
#include <random>
#include <string>

#include "model/atoms/bond_order/atom_cell.h"
#include "model/atoms/bond_order/atom_motion.h"

namespace cuboct {
namespace {

struct Matter {
  AtomCell cell;
  Tersoff tersoff;
  double mass = 0;  // g/mol
};

// Shaken a little: half a percent of a bond.
Matter matter_of(const std::string& name) {
  Matter matter =
      name == "sheet"     ? Matter{graphene_sheet(1.460601, 3.35, 150, 87), tersoff_set("c_1989"), 12.011}
      : name == "silicon" ? Matter{diamond_block(5.432115, 16, 16, 16), tersoff_set("si_1989"), 28.0855}
                          : Matter{diamond_block(5.431231, 16, 16, 16), tersoff_set("si_1988"), 28.0855};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> move(-0.01, 0.01);
  for (Vec3& x : matter.cell.x) x += Vec3(move(random), move(random), move(random));
  return matter;
}

void write(const Matter& matter, const std::string& path) {
  auto out = fmt::output_file(path);
  const AtomCell& cell = matter.cell;
  out.print("\n\n{} atoms\n1 atom types\n", cell.x.size());
  for (int a = 0; a < 3; ++a) {
    const bool ring = cell.box.periodic[a];
    out.print("{0:.17g} {1:.17g} {2}lo {2}hi\n", ring ? 0.0 : -10.0, ring ? cell.box.edges(a, a) : 10.0,
              "xyz"[a]);
  }
  out.print("\nMasses\n\n1 {}\n\nAtoms # atomic\n\n", matter.mass);
  for (size_t i = 0; i < cell.x.size(); ++i)
    out.print("{} 1 {:.17g} {:.17g} {:.17g}\n", i + 1, cell.x[i][0], cell.x[i][1], cell.x[i][2]);
}

}  // namespace
}  // namespace cuboct

int main(int argc, char** argv) {
  using namespace cuboct;
  if (argc < 3) return fmt::print(stderr, "usage: tersoff_speed MATTER STEPS | MATTER write FILE\n"), 2;
  const Matter matter = matter_of(argv[1]);
  if (argc == 4) return write(matter, argv[3]), 0;
  constexpr double kGram = 1.0364269e-4;  // eV ps^2/angstrom^2 of a g/mol
  AtomMotion motion(matter.tersoff, {matter.cell.box, matter.cell.x, {}, {}, {matter.mass * kGram}},
                    {.dt = 1e-3, .skin = 0.3});
  motion.step(static_cast<uint64_t>(std::atoi(argv[2])));
  fmt::print("{} atoms, potential energy {:.9g} eV, {} lists, {}\n", matter.cell.x.size(),
             motion.potential_energy(), motion.lists_made(), bond_simd());
}
