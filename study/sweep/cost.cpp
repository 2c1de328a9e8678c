// SPDX-License-Identifier: MIT
#include "study/sweep/cost.h"

#include "hw/cost/node_area.h"
#include "hw/plan/setup.h"
#include "model/contract/neighbours.h"
#include "model/rules/rounds_rule.h"
#include "study/sweep/outcome.h"

namespace cuboct::study {
namespace {

// Ordered pairs inside the cutoff at the start: each is worked on by both of its nodes. Without those at the
// cutoff itself: bond laws end at the second neighbours, and rounding alone would tell how many of these
// count.
double ordered_pairs(const Scene& scene) {
  const double cutoff = scene.rule.cutoff();
  CellList cells(cutoff, scene.periodic);
  cells.build(scene.body.x);
  double pairs = 0;
  cells.for_each_pair(scene.body.x, [&](uint32_t, uint32_t, const Vec3&, double r) {
    if (r < cutoff * (1 - 1e-6)) pairs += 2;
  });
  return pairs;
}

}  // namespace

double cost_of(const Case& c) {
  if (c.scene.rule.rounds != nullptr) return kNotMeasured;
  // No node has such a cell.
  if (c.settings.arithmetic == Arithmetic::fixed &&
      cell_edges_of(c.scene, c.arch, CellForm::any).shape != kCube)
    return kNotMeasured;
  const auto transistors = [&] {
    switch (c.settings.arithmetic) {
      case Arithmetic::float64:
        return area_of(c.scene.rule, c.arch, 53, 64).transistors();
      case Arithmetic::float32:
        return area_of(c.scene.rule, c.arch, 24, 32).transistors();
      case Arithmetic::fixed:
        break;
    }
    return area_of(plan_of(c.scene, c.arch)).transistors();
  };
  return transistors() * ordered_pairs(c.scene) / c.arch.force_pipes / c.scene.rule.dt;
}

}  // namespace cuboct::study
