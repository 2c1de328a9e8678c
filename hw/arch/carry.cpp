// SPDX-License-Identifier: MIT
#include "hw/arch/carry.h"

namespace cuboct {

bool& Carry::operator[](size_t k) {
  const std::array<bool*, kCount> fields{&damping, &scales, &types, &pd, &masses, &third_axis, &empty_nodes};
  return *fields.at(k);
}

Carry Carry::everything() { return {true, true, true, true, true, true, true}; }

FixedRule carrying(FixedRule rule, const Carry& carry) {
  if (carry.types && rule.type_bits == 0) rule.type_bits = 1;
  if (carry.scales && !rule.scaled) {
    rule.scaled = true;
    // round_odd(s * 2^F, F) == s.
    rule.scale.assign(rule.types.size(),
                      std::vector<int32_t>(rule.types.size(), int32_t{1} << rule.widths.scale_frac));
  }
  if (carry.damping && !rule.damped) {
    rule.damped = true;
    rule.damp = rule.force;
    for (auto* column : {&rule.damp.c0, &rule.damp.c1, &rule.damp.c2})
      column->assign(column->empty() ? 0 : size_t{1} << rule.damp.index_bits, 0);
    rule.damp_shift = rule.widths.relative_velocity_frac - 1;
  }
  if (carry.pd) rule.pd = true;
  if (carry.masses) rule.weighted = true;
  if (carry.third_axis) rule.axes = 3;
  return rule;
}

}  // namespace cuboct
