// SPDX-License-Identifier: MIT
#include "study/learn/samples.h"

namespace cuboct::learn {

Vec3 Grid::at(size_t k) const {
  const auto n = static_cast<size_t>(points);
  const double half = points / 2.0;
  return {(static_cast<double>(k % n) + 0.5 - half) * spacing[0],
          (static_cast<double>(k / n) + 0.5 - half) * spacing[1], 0};
}

std::vector<Vec3> Grid::all() const {
  std::vector<Vec3> out;
  for (size_t k = 0; k < size(); ++k) out.push_back(at(k));
  return out;
}

CoarsePoints Grid::coarse(bool periodic) const {
  const Vec3 period = periodic ? Vec3(points * spacing[0], points * spacing[1], 0) : Vec3(Vec3::Zero());
  return {2, all(), radius, volume(), period};
}

AtomCell resting_sheet(const SheetInput& input) {
  TersoffForces forces(input.tersoff);
  const AtomCell one = at_no_pressure(forces, graphene_sheet(input.bond, input.thickness, 1, 1));
  AtomCell sheet = graphene_sheet(one.box.edges(1, 1) / 3, input.thickness, input.cells[0], input.cells[1]);
  const Vec3 half = sheet.box.edges.diagonal() / 2;
  for (Vec3& x : sheet.x) x -= Vec3(half[0], half[1], 0);
  return sheet;
}

Grid grid_of(const LearnStudy& study, const AtomCell& sheet, int points) {
  Grid grid;
  grid.points = points;
  grid.spacing = sheet.box.edges.diagonal() * kAngstrom / grid.points;
  grid.spacing[2] = 0;
  grid.thickness = study.sheet.thickness * kAngstrom;
  grid.radius = study.grid.radius * grid.step();
  return grid;
}

}  // namespace cuboct::learn
