// SPDX-License-Identifier: MIT
#include "study/cost.h"

#include "hw/setup.h"
#include "model/neighbours.h"

namespace cuboct::study {
namespace {

constexpr double kTransistorsPerTableBit = 6, kTransistorsPerBitProduct = 34;

// Ordered pairs inside the cutoff at the start: each is worked on by both of its nodes.
double ordered_pairs(const Scene& scene) {
  CellList cells(scene.rule.law->cutoff(), scene.periodic);
  cells.build(scene.body.x);
  double pairs = 0;
  cells.for_each_pair(scene.body.x, [&](uint32_t, uint32_t, const Vec3&, double) { pairs += 2; });
  return pairs;
}

// Bit products of one evaluation of a table, and its bits of memory.
struct Table {
  double products = 0, bits = 0;
};
Table table_of(const FixedTable& table, int entry_bits) {
  const double entries = static_cast<double>(table.c0.size());
  return {double(table.degree) * entry_bits * (table.fraction_bits + 1),
          entries * entry_bits * (table.degree + 1)};
}

double fixed_area(const FixedRule& rule) {
  const Widths& w = rule.widths;
  const double d = w.difference_frac + 1, s = w.strength_bits, relative = w.relative_velocity_bits;
  const Table force = table_of(rule.force, w.strength_bits);
  double products = 3 * d * d + force.products + 3 * s * d, bits = force.bits;
  if (rule.damped) {
    const Table damp = table_of(rule.damp, w.strength_bits);
    products += 3 * relative * d + damp.products + s * relative;
    bits += damp.bits;
  }
  if (rule.scaled) products += s * (w.scale_frac + 2);
  return products + bits * kTransistorsPerTableBit / kTransistorsPerBitProduct;
}

// r2, a square root and a division as wide as a product, a cubic, three products for the kick.
double real_area(const Rule& rule, double bits) {
  double products = 3 + 2 + 3 + 3;
  if (rule.damping.coefficient > 0) products += 3 + 3 + 1;
  return products * bits * bits;
}

}  // namespace

double cost_of(const Case& c) {
  double area = 0;
  switch (c.settings.arithmetic) {
    case Arithmetic::float64:
      area = real_area(c.scene.rule, 53);
      break;
    case Arithmetic::float32:
      area = real_area(c.scene.rule, 24);
      break;
    case Arithmetic::fixed:
      area = fixed_area(plan_of(c.scene, c.arch).rule);
      break;
  }
  return area * ordered_pairs(c.scene) / c.scene.rule.dt;
}

}  // namespace cuboct::study
