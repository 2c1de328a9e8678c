// SPDX-License-Identifier: MIT
// Runs LAMMPS on a Body: velocity Verlet without thermostat, in LAMMPS's reduced units (`units lj`, where
// forces, masses and lengths are plain numbers as ours are).
#pragma once

#include <string>
#include <vector>

#include "model/atoms/bond_order/atom_box.h"
#include "model/base/mat3.h"
#include "model/contract/rule.h"

namespace cuboct::test {

bool have_lammps();

// What LAMMPS holds at one step, by particle.
struct LammpsFrame {
  std::vector<Vec3> x, v, f;    // x unwrapped
  std::vector<Mat3> virial;     // stress times volume, tension positive, without the kinetic part
  double potential_energy = 0;  // of all particles
  double kinetic_energy = 0;
};

struct LammpsRun {
  Periodic periodic;  // open axes get a fixed boundary well beyond the particles
  std::string pair;   // the lines that set pair_style and pair_coeff
  double mass = 1, dt = 0;
  int steps = 0;
  std::vector<std::pair<std::string, std::string>> files;  // name, text: put beside the input
  int every = 0;                                           // steps between samples
  int types = 1;                                           // of one mass
};

// What LAMMPS measures on its way, of all particles: J and Pa in our words.
struct LammpsSample {
  int step = 0;
  double potential_energy = 0, kinetic_energy = 0, pressure = 0;
};

// Frames at step 0 and at the last. std::runtime_error with LAMMPS's output where it fails.
std::vector<LammpsFrame> run_lammps(const LammpsRun& run, const Body& body);
// Samples at step 0, every, 2 every, ...; no frames.
std::vector<LammpsSample> sample_lammps(const LammpsRun& run, const Body& body);

// Runs `lines` of LAMMPS's own once the body is read and its pairs are set, and returns the texts of `files`
// that they wrote. Boxes of periodic axes, and boundaries of others as of run_lammps.
std::vector<std::string> ask_lammps(const LammpsRun& run, const Body& body, const std::string& lines,
                                    const std::vector<std::string>& files);

// Atoms in LAMMPS's metal units (eV, angstrom, bar), of any elements and any box.
struct LammpsAtoms {
  AtomBox box;  // edges upper triangular, as LAMMPS has them
  std::vector<Vec3> x;
  std::vector<uint8_t> element;  // empty: all are the first
  int elements = 1;
  std::string pair = {};   // the lines that set pair_style and pair_coeff
  std::string moves = {};  // lines that make them move: fixes, groups
  double mass = 12;        // g/mol, of all
  double dt = 0.001;       // ps
  int steps = 0;
};
struct LammpsForces {
  std::vector<Vec3> x;  // angstrom, unwrapped
  std::vector<Vec3> f;  // eV/angstrom
  double energy = 0;    // eV
  Mat3 virial;          // eV: dE/dstrain
};
// eV ps^2/angstrom^2 of a g/mol, as LAMMPS has it.
inline constexpr double kLammpsMass = 1.0364269e-4;
// At the last step.
LammpsForces lammps_forces(const LammpsAtoms& atoms);

}  // namespace cuboct::test
