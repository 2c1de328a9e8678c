// SPDX-License-Identifier: MIT
// The data: sheets of graphene under loads, computed atom by atom and seen on points (section 5.1 of the
// paper). Samples are in SI units, of a sheet that has its thickness.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "model/atoms/bond_order/atom_cell.h"
#include "model/atoms/coarse/coarse_grain.h"
#include "model/base/atom_units.h"
#include "model/base/error.h"
#include "model/base/vec.h"
#include "study/learn/learn_study.h"

namespace cuboct::learn {

// Points in rows along x and y, (i + 1/2) spacings from the lower corner; the middle of the sheet is at 0.
struct Grid {
  int points = 0;               // along an edge
  Vec3 spacing = Vec3::Zero();  // m
  double thickness = 0;         // m
  double radius = 0;            // m, of the cone

  double volume() const { return spacing[0] * spacing[1] * thickness; }
  double step() const { return std::max(spacing[0], spacing[1]); }  // what horizons are counted in
  size_t size() const { return static_cast<size_t>(points) * static_cast<size_t>(points); }
  Vec3 at(size_t k) const;  // x changes first
  std::vector<Vec3> all() const;
  CoarsePoints coarse(bool periodic) const;
};

// A sheet at rest without stress, its middle at 0. Angstrom.
AtomCell resting_sheet(const SheetInput& sheet);
Grid grid_of(const LearnStudy& study, const AtomCell& sheet, int points);

// The error with the place of the study's key that it is about.
InputError placed(const LearnStudy& study, const InputError& error);

// A load on a sheet that repeats, and what it does.
struct StaticLoad {
  std::string name;
  bool training = true;
  double size = 0;                           // eV/angstrom on an atom, at most
  std::function<Vec3(const Vec3& x)> shape;  // of it, x in angstrom
};
std::vector<StaticLoad> static_loads(const LearnStudy& study, const AtomCell& sheet);

struct StaticSample {
  std::vector<Vec3> u, b;  // m, N/m^3: on the points
  double strain = 0;       // of the bond that is lengthened or shortened most
};
// InputError where a bond's strain is above StaticInput::most; std::runtime_error where it comes to no rest.
StaticSample rest_under(const LearnStudy& study, const AtomCell& sheet, const StaticLoad& load);

}  // namespace cuboct::learn
