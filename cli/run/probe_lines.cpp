// SPDX-License-Identifier: MIT
#include "cli/run/probe_lines.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/run/plan_text.h"
#include "hw/plan/probe_accuracy.h"
#include "hw/plan/setup.h"
#include "model/base/json.h"
#include "model/base/quantity_text.h"
#include "model/rules/rounds_rule.h"

namespace cuboct {
namespace {

std::string size_of(const Scene& scene, const CurveError& curve) {
  if (curve.unit.empty()) return fmt::format("{:.2g} %", 100 * curve.error);
  return scene.boltzmann == 1 || curve.unit == kPlainNumber ? fmt::format("{:.3g}", curve.error)
                                                            : quantity_text(curve.error, curve.unit.c_str());
}

std::string json_of(const ProbeError& error) {
  std::string list;
  for (const CurveError& curve : error.curves)
    list += fmt::format("{}{{\"quantity\": {}, \"error\": {}, \"unit\": {}, \"of_means\": {}}}",
                        list.empty() ? "" : ", ", json(curve.quantity), json(curve.error),
                        json(curve.unit.empty() ? "1" : curve.unit), curve.of_means);
  return "[" + list + "]";
}

}  // namespace

std::string error_text(const Scene& scene, const ProbeError& error) {
  if (error.curves.empty()) return "not estimated: " + error.why;
  std::string text;
  for (const CurveError& curve : error.curves)
    text += text.empty()     ? fmt::format("{} within about {}", curve.quantity, size_of(scene, curve))
            : curve.of_means ? fmt::format(", its mean {}", size_of(scene, curve))
                             : fmt::format(", {} {}", curve.quantity, size_of(scene, curve));
  return fmt::format("{}{}; {}", text, error.until_breaks ? " until bonds break" : "", error.why);
}

std::vector<ProbeError> told_errors(const Scene& scene, const Plan& plan) {
  if (scene.loading) return {};
  if (has_machine(plan)) return probe_errors(scene, plan);
  const RoundsRule* rounds = scene.rule.rounds.get();
  if (rounds == nullptr || rounds->text() == nullptr ||
      std::ranges::none_of(scene.probes, [](const Probe& probe) { return probe.kind == Probe::Kind::field; }))
    return {};
  try {
    return probe_errors(scene, program_plan_of(scene, plan.arch));
  } catch (const InputError&) {  // no integers hold it
    return {};
  }
}

void add_probe_errors(Items& items, const Scene& scene, const Plan& plan) {
  for (const ProbeError& error : told_errors(scene, plan)) {
    items.add("probe " + error.probe, error_text(scene, error));
    items.also("errors", json_of(error));
  }
}

}  // namespace cuboct
