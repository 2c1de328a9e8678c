// SPDX-License-Identifier: MIT
#include "hw/cost/pair_work.h"

#include <algorithm>
#include <bit>

#include "hw/cost/rule_work.h"
#include "hw/rtl/rtl_design.h"
#include "model/base/fixed_math.h"
#include "model/contract/format_cures.h"

namespace cuboct {
namespace {

// The slope times t; at degree 2 the second coefficient times t first, and the slope has one bit more.
void add_table(Work& work, const FixedTable& table, int entry_bits) {
  const int t = table.fraction_bits + 1;
  if (table.degree == 2) work.products.push_back({entry_bits, t, 1});
  work.products.push_back({table.degree == 2 ? entry_bits + 1 : entry_bits, t, 1});
  work.tables.push_back({table.c0.size(), entry_bits * (table.degree + 1), 1});
}

// Bits of a pair's strength, as the kick's product takes it.
int strength(const FixedRule& rule) {
  return rule.damped ? rule.widths.strength_bits : value_bits(rule.force);
}

// Of a sum of kicks.
int sum_width(const Plan& plan) {
  return kick_bits(plan.rule) +
         static_cast<int>(std::bit_width(27u * static_cast<unsigned>(plan.arch.capacity) - 1));
}

Work pair_of(const Plan& plan, int axes) {
  const FixedRule& rule = plan.rule;
  const Widths& w = rule.widths;
  const int P = w.position_frac, V = w.velocity_bits, relative = w.relative_velocity_bits;
  const int d = w.difference_frac + 1, r2 = 2 * w.difference_frac + 2;
  const int force = value_bits(rule.force), s = strength(rule), kick = kick_bits(rule);
  const int sum = sum_width(plan);
  Work work;
  work.products.push_back({d, d, axes});
  add_table(work, rule.force, w.strength_bits);
  work.products.push_back({s, d, axes});
  work.adder_bits = axes * (P + 3) + axes * d + (axes - 1) * r2 + force + axes * kick + axes * sum;
  // Operands, d, squares, r2, index and t, entry, value, the kick's products, kick, sum; d waits from r2 to
  // the kick, at least through the table's three cycles.
  work.register_bits = axes * (P + 2 + 2 * d + 2 * d + 3 * d + s + d + kick) + r2 +
                       (rule.force.degree + 1) * w.strength_bits + 2 * rule.force.fraction_bits + force;
  if (rule.damped) {
    const int damp = value_bits(rule.damp), wd = relative + d + 2;
    work.products.push_back({relative, d, axes});
    add_table(work, rule.damp, w.strength_bits);
    work.products.push_back({damp, relative, 1});
    work.adder_bits += axes * (V + 1) + axes * (V + 2) + (axes - 1) * wd + relative + damp + w.strength_bits;
    work.register_bits += axes * (V + V + 2 + relative + d) + wd + 2 * relative +
                          (rule.damp.degree + 1) * w.strength_bits + damp + relative + s;
  }
  if (rule.scaled) {
    work.products.push_back({s, kScaleBits, 1});
    work.adder_bits += s;
    work.register_bits += s + kScaleBits;
  }
  // With registers on both sides of a multiplier those of its operands.
  if (plan.arch.multipliers == Multipliers::parallel && plan.latency.product > 1)
    for (const Product& p : work.products) work.register_bits += p.count * (p.a + p.b);
  return work;
}

// The kick's products, their registers, kicks and their addition to a sum.
Work kick_of(const Plan& plan, int axes) {
  const FixedRule& rule = plan.rule;
  const int d = rule.widths.difference_frac + 1, s = strength(rule), kick = kick_bits(rule);
  Work work;
  work.products.push_back({s, d, axes});
  work.adder_bits = axes * (kick + sum_width(plan));
  work.register_bits = axes * (s + d + kick);
  return work;
}

Work lane_of(const Plan& plan, int axes, WorkOf of) {
  const Widths& w = plan.rule.widths;
  Work lane;
  if (of == WorkOf::cost) {
    // Differences, their rounding and sizes; three sums of two, one of three; seven comparisons.
    const int d = w.difference_frac + 1;
    lane.adder_bits = 3 * (w.position_frac + 3) + (6 + 4 + 7) * (d + 4);
    return lane;
  }
  // cuboct_filter_lane, cuboct_planar: differences of the leading bits; each size against its bound; each sum
  // of two, and of three axes that of all, with its bound.
  const int B = std::min(w.filter_frac, w.position_frac), pairs = axes == 3 ? 3 : 1;
  lane.adder_bits = axes * (B + 2) + axes * (B + 3) + pairs * 2 * (B + 3) + (axes == 3 ? 3 * (B + 4) : 0);
  lane.register_bits = axes * (B + 1) + (axes == 3 ? 5 : 2);  // sizes, tests
  return lane;
}

// cuboct_cull: each axis's distance from both sides of the box, a lane's tests; the record waits for these.
Work cull_of(const Plan& plan, int axes, const Work& lane) {
  Work cull;
  if (plan.arch.halos != Halos::arrival) return cull;
  const int B = std::min(plan.rule.widths.filter_frac, plan.rule.widths.position_frac);
  cull.adder_bits = lane.adder_bits - axes * (B + 2) + 2 * axes * (B + 3);
  cull.register_bits = kCullStages * plan.words.halo_bits + axes * (B + 2) + lane.register_bits;
  return cull;
}

// Per axis: two adders of v, and x with its residue.
Work update_of(const Plan& plan, int axes) {
  const FixedRule& rule = plan.rule;
  const Widths& w = rule.widths;
  const int P = w.position_frac, V = w.velocity_bits;
  Work work;
  work.adder_bits = axes * (2 * V + P + w.guard + 2);
  work.register_bits = axes * (w.sum_bits + V + P + w.guard + V + P + w.guard);
  if (rule.weighted) {
    work.products.push_back({kScaleBits, w.sum_bits, axes});
    work.adder_bits += axes * w.sum_bits;
    work.register_bits += axes * (kScaleBits + 2 * w.sum_bits);
  }
  if (rule.pd) {
    work.products.push_back({kGainBits, w.displacement_bits, axes});
    work.products.push_back({kGainBits, V + 1, axes});
    work.adder_bits += axes * (2 * V + 2 * w.displacement_bits + kGainBits);
    work.register_bits += axes * (2 * kGainBits + 2 * w.displacement_bits + 2 * (V + 1));
  }
  return work;
}

}  // namespace

double Work::bit_products() const {
  double sum = 0;
  for (const Product& p : products) sum += static_cast<double>(p.a) * p.b * p.count;
  return sum;
}

double Work::table_bits() const {
  double sum = 0;
  for (const TableWords& t : tables) sum += static_cast<double>(t.words) * t.bits;
  return sum;
}

int value_bits(const FixedTable& table) {
  const ValueRange range = table_range(table);
  int bits = 1;
  while (!fits(range.low, bits) || !fits(range.high, bits)) ++bits;
  return bits;
}

int kick_bits(const FixedRule& rule) {
  return std::max(2, strength(rule) + rule.widths.difference_frac + 1 - rule.kick_shift);
}

DatapathWork datapath_work(const Plan& plan, WorkOf of) {
  const int axes = of == WorkOf::cost ? 3 : plan.rule.axes;
  if (plan.program != nullptr) {
    DatapathWork work = rule_work(plan);
    if (plan.words.bonds == 0) work.lane = lane_of(plan, axes, of);
    return work;
  }
  DatapathWork work{
      pair_of(plan, axes), kick_of(plan, axes), lane_of(plan, axes, of), update_of(plan, axes), {}};
  if (of == WorkOf::built) work.cull = cull_of(plan, axes, work.lane);
  return work;
}

}  // namespace cuboct
