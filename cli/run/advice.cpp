// SPDX-License-Identifier: MIT
#include "cli/run/advice.h"

#include <fmt/format.h>

#include <cmath>

#include "model/program/integer_program.h"
#include "model/scene/auto_margin.h"

namespace cuboct {
namespace {

std::string what_happened(const StopReason& stop, const Plan& plan) {
  const Widths& w = plan.rule.widths;
  const double per_step = std::ldexp(static_cast<double>(stop.number), -w.velocity_frac());
  switch (stop.fault) {
    case Fault::velocity:
      return fmt::format("particle {} would move {:.3g} cells in a step, {:.3g} fit", stop.particle,
                         std::abs(per_step), std::ldexp(1.0, w.velocity_bits - 1 - w.velocity_frac()));
    case Fault::sum:
      return fmt::format(
          "the pairs would change particle {}'s velocity by {:.3g} cells per step at once, "
          "{:.3g} fit",
          stop.particle, std::abs(per_step), std::ldexp(1.0, w.sum_bits - 1 - w.velocity_frac()));
    case Fault::displacement:
      return fmt::format("particle {} is {:.3g} cells from its anchor, {:.3g} fit", stop.particle,
                         std::abs(per_step), std::ldexp(1.0, w.displacement_bits - 1 - w.velocity_frac()));
    case Fault::relative_velocity:
      return fmt::format("a pair of particle {} moves apart or together at {:.3g} cells per step, {:.3g} fit",
                         stop.particle,
                         std::abs(std::ldexp(static_cast<double>(stop.number), -w.relative_velocity_frac)),
                         std::ldexp(1.0, w.relative_velocity_bits - 1 - w.relative_velocity_frac));
    case Fault::strength:
      if (plan.program != nullptr && plan.program->rows != nullptr)
        return fmt::format("a bond of particle {} is longer or shorter than the tables of the rule reach",
                           stop.particle);
      if (plan.program != nullptr)
        return fmt::format("a pair of particle {} came nearer than the tables of the rule reach",
                           stop.particle);
      return fmt::format("law and damping of a pair of particle {} together exceed {} bits", stop.particle,
                         w.strength_bits);
    case Fault::full_x:
    case Fault::full_y:
    case Fault::full_z:
      return fmt::format("particle {} came, and the cell holds {} particles", stop.particle,
                         plan.arch.capacity);
    case Fault::left_x:
    case Fault::left_y:
    case Fault::left_z:
      return fmt::format("particle {} went where no cell is", stop.particle);
    case Fault::link_check:
    case Fault::link_order:
    case Fault::link_silent:
      return "the link lost or changed what it carries";
    case Fault::bond_lost:
      return fmt::format("particle {} has a bond to particle {}, which is in none of the cells around it",
                         stop.particle, stop.number);
    case Fault::none:
      break;
  }
  return "";
}

const char* what_helps(Fault fault, bool program, bool foreseen) {
  switch (fault) {
    case Fault::velocity:
      return "use a smaller run.dt or a larger node.cell_edge; a run that was stable until then met an "
             "impact, "
             "or its dt is too long";
    case Fault::sum:
      return "use a smaller run.dt or more widths.sum_bits";
    case Fault::displacement:
      return "raise kp of the constraint, or widths.displacement_bits";
    case Fault::relative_velocity:
      return "use a smaller run.dt or more widths.relative_velocity_bits";
    case Fault::strength:
      return program ? "use a smaller run.dt, or the reference engine"
                     : "use a smaller run.dt, less damping or more widths.strength_bits";
    case Fault::full_x:
    case Fault::full_y:
    case Fault::full_z:
      return "raise node.capacity, or take a shorter node.cell_edge where it is longer than the cutoff";
    case Fault::left_x:
    case Fault::left_y:
    case Fault::left_z:
      return foreseen ? "reach.margin = \"auto\" did not foresee it: give reach.margin in lengths, or "
                        "reach.min and "
                        "reach.max beside it"
                      : "raise reach.margin, or give reach.min and reach.max";
    case Fault::link_check:
    case Fault::link_order:
    case Fault::link_silent:
      return "mend it, or use link.check = \"retry\" in the arch";
    case Fault::bond_lost:
      return "let bonds break for ever ('broken' of the rule), raise node.cell_edge, or use a smaller run.dt";
    case Fault::none:
      break;
  }
  return "";
}

}  // namespace

std::string advice_on(const StopReason& stop, const Plan& plan, const Scene& scene) {
  if (stop.fault == Fault::none) return "";  // the reason is all that is known
  const Cell& c = plan.lattice.cell(stop.cell);
  Vec3 centre;
  for (int a = 0; a < 3; ++a) centre[a] = plan.origin[a] + (c[a] + 0.5) * plan.rule.edges()[a];
  const std::string dt = stop.fault == Fault::velocity && scene.dt_limit > 0
                             ? fmt::format(" (now {:.3g} of the limit)", scene.rule.dt / scene.dt_limit)
                             : "";
  return fmt::format("cell ({} {} {}) at ({:.4g}, {:.4g}, {:.4g}) m: {}; {}{}", c[0], c[1], c[2], centre[0],
                     centre[1], centre[2], what_happened(stop, plan),
                     what_helps(stop.fault, plan.program != nullptr, has_auto_margin(scene)), dt);
}

}  // namespace cuboct
