// SPDX-License-Identifier: MIT
// Particles from files of other programs: extended XYZ, as ASE and OVITO write it, and LAMMPS's data files.
// docs/user/scene.md, [particles].
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "model/base/vec.h"
#include "model/body/particle_text.h"

namespace cuboct {

// Of one of the file's, in SI units.
struct ParticleUnits {
  double length = 0;    // m
  double velocity = 0;  // m/s
  double mass = 0;      // kg
};

// LAMMPS's unit styles, and "ase".
const std::vector<std::string>& particle_unit_names();
ParticleUnits particle_units(size_t name);
// Of momenta in extended XYZ, kg m/s: ASE's sqrt(u eV).
double ase_momentum();

// As the file has it. `at`: the byte of its text where the number stands.
struct ParticleFileBox {
  Vec3 low = Vec3::Zero(), extent = Vec3::Zero();
  std::array<bool, 3> periodic{};
  size_t at = 0;
};

// One frame in the file's own units. Particles are in the order of their ids, where the file has any.
struct ParticleFile {
  std::unique_ptr<ParticleText> text;  // for errors
  bool data = false;                   // LAMMPS's format
  size_t frames = 1;
  std::vector<Vec3> x;
  std::vector<Vec3> v;             // empty: the file has none
  bool momenta = false;            // of which `v` then is
  std::vector<double> mass;        // by particle; empty: the file has none
  std::vector<std::string> kinds;  // materials, species or types, in the order in which they come
  std::vector<uint16_t> kind;      // by particle, index into `kinds`; empty: the file tells none
  std::vector<double> kind_mass;   // by kind: LAMMPS's Masses; empty: the file has none
  std::vector<size_t> at;          // by particle: byte of its position
  std::optional<ParticleFileBox> box;
  // Units that the file states, as texts: of a LAMMPS file the style, else those of columns. Empty: none.
  std::string style, length_unit, velocity_unit;

  size_t size() const { return x.size(); }
  // Byte of one of the three numbers, which are columns side by side.
  size_t at_axis(size_t i, int axis) const;
};

struct ParticleFileChoice {
  std::optional<uint64_t> frame;          // counted from 0; none: the last
  bool box = true;                        // it counts: one that is no cuboid is refused
  std::optional<std::string> atom_style;  // of LAMMPS's data; none: as the file says
};
// LAMMPS's atom styles that are read.
const std::vector<std::string>& particle_atom_styles();

// The frame that was asked for is not there.
struct NoSuchFrame {
  size_t frames = 0;
};
// Atoms has no comment that names its style, and so many columns that several styles have.
struct UnknownAtomStyle {
  size_t columns = 0;
  std::vector<std::string> styles;
};

// A file whose name ends in .xyz or .extxyz, or whose first line is a whole number, is extended XYZ, any
// other LAMMPS's. Throws InputError with the place in the file, NoSuchFrame, UnknownAtomStyle.
ParticleFile read_particle_file(const std::string& path, const ParticleFileChoice& choice);

// Its formats, from where `file.text` is.
void read_xyz(const ParticleFileChoice& choice, ParticleFile& file);
void read_lammps_data(const ParticleFileChoice& choice, ParticleFile& file);

// The kinds of particles as they come, by name.
class ParticleKinds {
 public:
  explicit ParticleKinds(ParticleFile& file) : file_(file) {}
  void add(std::string_view word);

 private:
  ParticleFile& file_;
  uint16_t last_ = 0;
};

// Puts particles in the order of their ids. InputError where two have one.
void order_particles(std::vector<uint64_t>& ids, ParticleFile& file);

}  // namespace cuboct
