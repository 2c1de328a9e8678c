// SPDX-License-Identifier: MIT
// Fixed rules with any options and entries, whether a scene would make them or not.
#pragma once

#include "model/contract/fixed_rule.h"
#include "tests/support/dice.h"

namespace cuboct::test {

inline int64_t within_bits(Dice& dice, int bits) {
  const int64_t most = (int64_t{1} << (bits - 1)) - 1;
  if (dice.chance(15)) return dice.chance(50) ? most : -most - 1;
  const int used = dice.draw(1, bits);
  return wrap(static_cast<int64_t>(dice.bits(used)), used);
}

inline FixedTable rule_table(Dice& dice, const FixedRule& rule, int laws, int bits) {
  FixedTable table;
  table.shape = dice.chance(50) ? TableShape::uniform : TableShape::octaves;
  table.degree = dice.draw(1, 2);
  table.difference_frac = rule.widths.difference_frac;
  table.index_bits = dice.draw(3, 6);
  table.bin_bits = table.index_bits - 2;
  table.first_octave = 2 * table.difference_frac - dice.draw(2, 4);
  table.fraction_bits = std::min(dice.draw(2, 17), 2 * table.difference_frac - table.index_bits);
  table.value_frac = dice.draw(10, 20);
  // Each value is a sum of up to three coefficients.
  for (auto* c : {&table.c0, &table.c1, &table.c2})
    for (int k = 0; k < laws << table.index_bits && (c != &table.c2 || table.degree == 2); ++k)
      c->push_back(static_cast<int32_t>(within_bits(dice, bits - 2)));
  return table;
}

inline FixedType rule_type(Dice& dice, const FixedRule& rule) {
  FixedType type;
  if (rule.weighted) type.weight = dice.draw(1, 1 << 16);
  for (size_t a = 0; a < static_cast<size_t>(rule.axes); ++a) {
    type.imposed[a] = dice.chance(25);
    if (dice.chance(40)) type.velocity[a] = within_bits(dice, rule.widths.velocity_bits - 2);
    if (dice.chance(40)) type.gravity[a] = within_bits(dice, rule.widths.velocity_bits - 3);
  }
  type.pd = rule.pd && dice.chance(50);
  if (type.pd) type.kp = dice.draw(0, 1 << 17), type.kd = dice.draw(0, 1 << 17);
  return type;
}

inline FixedRule random_rule(uint64_t seed) {
  Dice dice(seed);
  FixedRule rule;
  Widths& w = rule.widths;
  w.position_frac = dice.draw(12, 24);
  w.guard = dice.draw(1, 10);
  w.difference_frac = dice.draw(8, std::min(w.position_frac, 20));
  w.velocity_bits = dice.draw(12, w.velocity_frac() + 1);
  w.relative_velocity_frac = dice.draw(8, w.velocity_frac());
  w.relative_velocity_bits = dice.draw(8, 24);
  w.strength_bits = dice.draw(10, 27);
  w.sum_bits = dice.draw(16, 48);
  w.displacement_bits = dice.draw(12, 36);
  const int64_t whole = int64_t{1} << (2 * w.difference_frac);
  rule.cutoff2 = static_cast<uint64_t>(whole / dice.draw(1, 6));
  rule.axes = dice.chance(30) ? 2 : 3;
  // Drawn apart, so that the other rules stay what they were.
  if (Dice shapes(seed + 1000); shapes.chance(30))
    for (double& share : rule.shape) share = shapes.chance(30) ? 1 : 0.75 + 0.01 * shapes.draw(0, 24);
  rule.damped = dice.chance(60), rule.scaled = dice.chance(60);
  rule.weighted = dice.chance(40), rule.pd = dice.chance(40);
  const int types = dice.draw(1, 3), laws = rule.scaled ? dice.draw(1, 3) : 1;
  rule.law_bits = laws > 1 ? 2 : 0;
  rule.force = rule_table(dice, rule, laws, w.strength_bits);
  if (rule.damped) rule.damp = rule_table(dice, rule, 1, w.strength_bits);
  if (rule.scaled && dice.chance(60)) rule.contact2 = rule.cutoff2 / static_cast<uint64_t>(dice.draw(1, 3));
  for (int i = 0; i < types; ++i) rule.types.push_back(rule_type(dice, rule));
  rule.scale.assign(rule.scaled ? static_cast<size_t>(types) : 0,
                    std::vector<int32_t>(static_cast<size_t>(types)));
  rule.law.assign(rule.law_bits > 0 ? static_cast<size_t>(types) : 0,
                  std::vector<uint8_t>(static_cast<size_t>(types)));
  for (size_t i = 0; i < rule.scale.size(); ++i)
    for (size_t j = 0; j <= i; ++j) {
      const int sign = rule.contact2 > 0 && dice.chance(40) ? -1 : 1;
      rule.scale[i][j] = rule.scale[j][i] = sign * dice.draw(1, 1 << w.scale_frac);
      if (rule.law_bits > 0) rule.law[i][j] = rule.law[j][i] = static_cast<uint8_t>(dice.draw(0, laws - 1));
    }
  rule.difference_shift = w.position_frac - w.difference_frac;
  rule.w_shift = w.velocity_frac() - w.relative_velocity_frac;
  rule.q_shift = w.difference_frac + 1;
  rule.damp_shift = dice.draw(0, w.relative_velocity_bits);
  rule.kick_shift = dice.draw(0, w.strength_bits);
  return rule;
}

}  // namespace cuboct::test
