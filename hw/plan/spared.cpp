// SPDX-License-Identifier: MIT
#include "hw/plan/spared.h"

#include <algorithm>

#include "hw/arch/auto_widths.h"

namespace cuboct {

Spared spared(const Plan& plan) {
  const auto words_with = [&](const Carry& carry) {
    return words_of(carrying(plan.rule, carry), plan.arch, plan.particles);
  };
  const FixedRule& r = plan.rule;
  Spared out;
  out.box = bounding_cells(plan.lattice);
  out.missing = out.box - plan.lattice.size();
  out.all = words_with(Carry::everything());
  // In the order of Carry.
  const std::array<bool, Carry::kCount - 1> used{r.damped, r.scaled,   r.type_bits > 0,
                                                 r.pd,     r.weighted, r.axes == 3};
  for (size_t k = 0; k < used.size(); ++k) {
    if (used[k]) continue;
    Carry carry;
    carry[k] = true;
    carry.types = carry.types || carry.scales;  // without types there is no pair of them
    const Words words = words_with(carry);
    out.parts.push_back(
        {k, words.halo_bits - plan.words.halo_bits, words.particle_bits - plan.words.particle_bits});
  }
  return out;
}

std::optional<LooserFormats> looser_formats(const Scene& scene, const Plan& plan) {
  // Formats that are chosen are no matter of accuracy.
  if (std::ranges::any_of(plan.reasons, &WidthReason::asked) || asks_accuracy(scene)) return std::nullopt;
  const FixedRule& rule = plan.rule;
  Scene loose = scene;
  loose.accuracy *= 10;
  const AutoWidths chosen = auto_widths(loose, rule.cell_edge, automatic_widths());
  FixedRule other = quantise(loose.rule, rule.edges(), chosen.widths, plan.arch.table, chosen.half_unit);
  other.axes = rule.axes;
  other = carrying(std::move(other), plan.arch.carry);
  const Words words = words_of(other, plan.arch, plan.particles);
  if (words.halo_bits == plan.words.halo_bits && words.particle_bits == plan.words.particle_bits &&
      other.widths.difference_frac == rule.widths.difference_frac &&
      other.widths.strength_bits == rule.widths.strength_bits)
    return std::nullopt;
  return LooserFormats{loose.accuracy, other.widths, words};
}

}  // namespace cuboct
