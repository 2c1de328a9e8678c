// SPDX-License-Identifier: MIT
#include "hw/node_area.h"

#include <algorithm>
#include <bit>

#include "hw/rtl_design.h"
#include "model/base/fixed_math.h"

namespace cuboct {
namespace {

constexpr double kBitProduct = 34, kAdderBit = 28, kMemoryBit = 6;
// Multiplicands of constant width in rtl/lib: pair scales and weights, gains.
constexpr double kScaleBits = 18, kGainBits = 18;

// Bits of two's complement that hold every value of a table: ForceBits, DampBits of the RTL.
int value_bits(const FixedTable& table) {
  const ValueRange range = table_range(table);
  int bits = 1;
  while (!fits(range.low, bits) || !fits(range.high, bits)) ++bits;
  return bits;
}

// Of one table: entry_bits * (T + 1) at degree 1; at degree 2 another, and the slope has one bit more.
double table_products(const FixedTable& table, int entry_bits) {
  const double t = table.fraction_bits + 1;
  return table.degree == 1 ? entry_bits * t : (2 * entry_bits + 1) * t;
}
double table_bits(const FixedTable& table, int entry_bits) {
  return static_cast<double>(table.c0.size()) * entry_bits * (table.degree + 1);
}

// Slots, a FIFO of arrivals per face, halos of C, C, 3C, 3C, 9C, 9C records, the queue of candidates, and a
// sum per slot and pipe; or those of a brick. A halo record lies where its cell is: without the cell's
// number.
double particle_memory(const Arch& arch, const HeldWords& held, double particle_bits, double halo_bits,
                       double sum_bits) {
  const double capacity = arch.capacity;
  return kMemoryBit * (held.particles * capacity * particle_bits + held.halos * capacity * halo_bits +
                       arch.queue_depth * (halo_bits + arch.filter_lanes) +
                       arch.force_pipes * held.sums * capacity * 3 * sum_bits);
}

}  // namespace

NodeArea area_of(const Plan& plan) {
  const FixedRule& rule = plan.rule;
  const Widths& w = rule.widths;
  const Arch& arch = plan.arch;
  const double P = w.position_frac, V = w.velocity_bits, relative = w.relative_velocity_bits;
  const double d = w.difference_frac + 1, r2 = 2.0 * w.difference_frac + 2;
  const double force = value_bits(rule.force), s = rule.damped ? w.strength_bits : force;
  const double kick = std::max(2.0, s + d - rule.kick_shift);
  const double sum = kick + std::bit_width(27u * static_cast<unsigned>(arch.capacity) - 1);

  double products = 3 * d * d + table_products(rule.force, w.strength_bits) + 3 * s * d;
  double memory = table_bits(rule.force, w.strength_bits);
  double adders = 3 * (P + 3) + 3 * d + 2 * r2 + force + 3 * kick + 3 * sum;
  if (rule.damped) {
    const double damp = value_bits(rule.damp), wd = relative + d + 2;
    products += 3 * relative * d + table_products(rule.damp, w.strength_bits) + damp * relative;
    memory += table_bits(rule.damp, w.strength_bits);
    adders += 3 * (V + 1) + 3 * (V + 2) + 2 * wd + relative + damp + s;
  }
  if (rule.scaled) products += s * kScaleBits, adders += s;

  // A lane: differences, their rounding and sizes; three sums of two, one of three; seven comparisons.
  const double lane = 3 * (P + 3) + 6 * (d + 4) + 4 * (d + 4) + 7 * (d + 4);
  // Update, per axis: two adders of v, and x with its residue.
  double update_adders = 3 * (2 * V + P + w.guard + 2), update_products = 0;
  if (rule.weighted) update_products += 3 * kScaleBits * w.sum_bits, update_adders += 3 * w.sum_bits;
  if (rule.pd) {
    update_products += 3 * kGainBits * (w.displacement_bits + V + 1);
    update_adders += 3 * (2 * V + 2 * w.displacement_bits + kGainBits);
  }

  NodeArea area;
  area.multipliers = kBitProduct * (arch.force_pipes * products + update_products);
  area.tables = kMemoryBit * arch.force_pipes * memory;
  area.adders = kAdderBit * (arch.force_pipes * adders + arch.filter_lanes * lane + update_adders);
  area.particles =
      particle_memory(arch, held_words(arch.brick, plan.bricks.one_cell() ? 3 : rule.axes),
                      plan.words.particle_bits, plan.words.halo_bits - plan.words.halo_cell_bits, sum);
  return area;
}

double memory_bits(const Plan& plan) { return area_of(plan).particles / kMemoryBit; }

NodeArea area_of(const Rule& rule, const Arch& arch, int mantissa, int bits) {
  const bool damped = rule.damping.coefficient > 0;
  // r2, root, division, cubic by Horner, kick; w.d, the damping's two squares and its product with w.d.
  double products = 3 + 1 + 1 + 3 + 3, adders = 3 + 2 + 3 + 3;
  if (damped) products += 3 + 2 + 1, adders += 3 + 2 + 2;
  const double lane = 3 + 4 + 7, update = 3 * 3;
  NodeArea area;
  area.multipliers = kBitProduct * arch.force_pipes * products * mantissa * mantissa;
  area.adders = kAdderBit * 3 * mantissa * (arch.force_pipes * adders + arch.filter_lanes * lane + update);
  area.particles =
      particle_memory(arch, held_words(arch.brick, 3), 6.0 * bits, (damped ? 6.0 : 3.0) * bits, bits);
  return area;
}

}  // namespace cuboct
