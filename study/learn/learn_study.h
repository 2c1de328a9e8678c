// SPDX-License-Identifier: MIT
// The study file of `cuboct learn`: a peridynamic solid learned from atoms, after H. Q. You, X. Xu, Y. Yu,
// S. Silling, M. D'Elia and J. Foster, Appl. Math. Mech. 44 (2023) 1125, called the paper.
// docs/user/learn.md is the reference of the format.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/bond_order/tersoff_parameters.h"

namespace cuboct::learn {

// Lengths in angstrom, energies in eV, times in ps: those of atoms.
struct SheetInput {
  std::string potential;
  Tersoff tersoff;
  double bond = 0;             // a first guess of the bond, which is then brought to rest
  double mass = 0;             // eV ps^2/angstrom^2
  double thickness = 0;        // angstrom
  std::array<int, 2> cells{};  // rectangles of four atoms along x and y
};

struct GridInput {
  int points = 20;    // along an edge
  double radius = 2;  // of the cone, over the spacing
};

// Equation 44: a push within three discs, at the middle and at both ends of an axis.
struct DiscInput {
  int force = 0;      // axis
  int centres = 0;    // axis along which they lie
  double radius = 0;  // angstrom
};

struct StaticInput {
  double strain = 0.005;         // that loads are made for
  double most = 0.02;            // of a bond; beyond is an error
  int waves = 5;                 // k = 0 ... waves, in units of 2 pi over the edge
  double force = 1e-7;           // eV/angstrom: at rest
  std::vector<DiscInput> discs;  // of the validation
};

struct KernelInput {
  std::vector<double> horizons{2.5, 3, 4};  // over the spacing
  std::vector<int> degrees{3, 5, 7};        // P
  double smoothing = 1e-6;                  // of the regularisation
  double isotropy = 1;                      // weight of (C66/mu - 1)^2 + (C'/mu - 1)^2 of long waves
  double zeta = 1e-3;                       // of the constraints, over the square of the shear modulus' scale
  int seeds = 5;                            // samples drawn anew, and starts
  int evaluations = 2000;
  uint64_t seed = 1;
};

struct LearnStudy {
  std::string path, title;
  SheetInput sheet;
  GridInput grid;
  StaticInput still;
  KernelInput kernel;
  uint64_t data_hash = 0;  // of all that the data hang on
};

// Throws InputError with file:line:column.
LearnStudy read_learn_study(const std::string& path);

}  // namespace cuboct::learn
