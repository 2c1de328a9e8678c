// SPDX-License-Identifier: MIT
#include "hw/plan/reach_cost.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "hw/plan/reach.h"
#include "hw/plan/two_digits.h"
#include "model/analysis/motion_reach.h"
#include "model/base/error.h"
#include "model/base/quantity_text.h"
#include "model/rules/rounds_rule.h"
#include "model/scene/auto_margin.h"

namespace cuboct {
namespace {

constexpr uint64_t kLeastCells = 10000;  // a run of fewer is not slow by them
constexpr double kMostCellsEach = 20;

// With those that keep the lattice closed; none where they are more than can be built.
std::optional<double> cells_of(const Scene& scene, const Plan& plan) {
  const Cell period = plan.lattice.period();
  try {
    return Lattice(reachable_cells(scene, plan.rule.edges(), plan.origin, period, plan.rule.axes), period)
        .size();
  } catch (const InputError&) {
    return std::nullopt;
  }
}

// As a scene has it: "[2, 2, 60] mm".
std::string margin_text(const Vec3& margin, bool reduced) {
  const Multiple multiple = reduced ? Multiple{1, ""} : multiple_of(margin.maxCoeff(), "m");
  const Vec3 shown = margin / multiple.unit;
  const std::string list = fmt::format("[{:.4g}, {:.4g}, {:.4g}]", shown[0], shown[1], shown[2]);
  return reduced ? list : fmt::format("\"{} {}\"", list, multiple.name);
}

}  // namespace

uint64_t cells_with_matter(const Scene& scene, const Plan& plan) {
  const CellEdges edges = plan.rule.edges();
  const Cell period = plan.lattice.period();
  std::vector<char> holds(plan.lattice.size(), 0);
  for (const Vec3& x : scene.body.x) {
    Cell at{};
    for (int a = 0; a < 3; ++a) {
      at[a] = static_cast<int32_t>(std::floor((x[a] - plan.origin[a]) / edges[a]));
      if (period[a] > 0) at[a] = (at[a] % period[a] + period[a]) % period[a];
    }
    if (plan.rule.axes == 2) at[2] = 0;
    if (const uint32_t cell = plan.lattice.find(at); cell != kNoCell) holds[cell] = 1;
  }
  return static_cast<uint64_t>(std::ranges::count(holds, 1));
}

std::string reach_warning(const Scene& scene, const Plan& plan) {
  const uint64_t all = plan.lattice.size();
  if (all < kLeastCells || has_auto_margin(scene)) return {};
  const uint64_t matter = cells_with_matter(scene, plan);
  if (static_cast<double>(all) <= kMostCellsEach * static_cast<double>(matter)) return {};
  const bool reduced = scene.boltzmann == 1;
  const double edge = plan.rule.edges().longest;
  Scene other = scene;
  other.reach_margin = Vec3::Constant(kAutoMargin), other.reach = {Vec3::Zero(), Vec3::Zero()};
  const std::optional<double> automatic = cells_of(other, plan);
  if (!automatic || *automatic > 0.5 * static_cast<double>(all)) return {};
  std::string text =
      fmt::format("{} cells are built, and {} hold matter at the start", count_text(static_cast<double>(all)),
                  count_text(static_cast<double>(matter)));
  const std::array<bool, 3> live{plan.lattice.period()[0] == 0, plan.lattice.period()[1] == 0,
                                 plan.lattice.period()[2] == 0 && plan.rule.axes == 3};
  std::vector<std::string> costs;
  for (int a = 0; a < 3 && scene.reach_margin[0] >= 0; ++a) {
    if (!live[static_cast<size_t>(a)] || scene.reach_margin[a] <= edge) continue;
    other.reach_margin = scene.reach_margin, other.reach = scene.reach;
    other.reach_margin[a] = edge;
    if (const auto cells = cells_of(other, plan))
      costs.push_back(fmt::format("{} along {}", count_text(*cells), "xyz"[a]));
  }
  if (!costs.empty())
    text += fmt::format(". With one cell edge, {}, for reach.margin they are {}",
                        quantity_text(edge, reduced ? "" : "m"), fmt::join(costs, ", "));
  if (scene.reach[0] != scene.reach[1]) {
    other.reach_margin = scene.reach_margin, other.reach = {Vec3::Zero(), Vec3::Zero()};
    if (const auto cells = cells_of(other, plan))
      text += fmt::format(". Without reach.min and reach.max they are {}", count_text(*cells));
  }
  other.reach_margin = Vec3::Constant(edge) + largest_beyond(scene, motion_reach(scene));
  for (double& margin : other.reach_margin) margin = two_digits_up(margin);
  other.reach = {Vec3::Zero(), Vec3::Zero()};
  text += fmt::format(". The motion of the scene asks for {} of them: set margin = \"auto\"",
                      count_text(*automatic));
  if (const auto lengths = cells_of(other, plan); lengths && *lengths < static_cast<double>(all))
    text += fmt::format(", or margin = {} for {}", margin_text(other.reach_margin, reduced),
                        count_text(*lengths));
  return text;
}

std::string reach_line(const Scene& scene, const Plan& plan) {
  if (!has_auto_margin(scene) || plan.lattice.size() == 0) return "";
  if (!moves(scene.rule)) return "the cells with matter: no particle moves";
  return reach_text(scene, motion_reach(scene), plan.rule.edges().longest);
}

}  // namespace cuboct
