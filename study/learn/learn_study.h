// SPDX-License-Identifier: MIT
// The study file of `cuboct learn`: a peridynamic solid learned from atoms, after H. Q. You, X. Xu, Y. Yu,
// S. Silling, M. D'Elia and J. Foster, Appl. Math. Mech. 44 (2023) 1125, called the paper.
// docs/user/learn.md is the reference of the format.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/atoms/bond_order/tersoff_parameters.h"

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
  int points = 20;       // along an edge
  int fine_points = 32;  // of the finer grid of the third prediction
  int coarse_points = 14;
  double radius = 2;    // of the cone, over the spacing
  double noise = 0.03;  // angstrom, of CrackSight
  double tube = 2;      // angstrom, of CrackSight
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

struct FractureInput {
  double slit = 25;     // angstrom, from the lower edge
  double grip = 3;      // angstrom, of both edges
  double velocity = 0;  // angstrom/ps, of an edge at the bottom, 0 at the top
  double push = 0;      // b0 of the test, eV/angstrom on an atom
  double duration = 0;  // t_r of the test, ps
  int frames = 40;
  double interval = 0.0495;  // ps, between frames
  double dt = 5e-4;          // ps
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

struct StretchInput {
  bool positive = true;              // a kernel of its own breaks; false: the learned one, as in the paper
  double horizon = 4;                // over the spacing: of that kernel
  int degree = 3;                    // of it
  double width = 0.05;               // eta
  double low = 0.04, high = 0.44;    // between which s0 is looked for
  std::array<int, 2> frames{5, 20};  // of the training, inclusive
};

struct PredictionInput {
  double collar = 2;  // over the spacing: points nearer to the edge have the atoms' displacements
  double dt = 0.5;    // of the largest stable step
  double watts = 10;  // of a core, assumed: joules are seconds times this
};

struct LearnStudy {
  std::string path, title;
  SheetInput sheet;
  GridInput grid;
  StaticInput still;
  KernelInput kernel;
  bool cracks = false;  // whether there is a [fracture], with what follows
  FractureInput fracture;
  StretchInput stretch;
  PredictionInput prediction;
  uint64_t static_hash = 0, fracture_hash = 0;  // of all that the data hang on
};

// Throws InputError with file:line:column.
LearnStudy read_learn_study(const std::string& path);

}  // namespace cuboct::learn
