// SPDX-License-Identifier: MIT
#include "hw/plan/probe_accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "hw/plan/two_digits.h"
#include "model/base/error.h"
#include "model/contract/format_cures.h"
#include "model/contract/quantise.h"
#include "model/program/integer_program.h"
#include "model/rules/rounds_rule.h"

namespace cuboct {
namespace {

// Fractional bits of a factor: model/program/integer_program.h.
constexpr int kFactorFrac = 26;
// What an estimate may be too low by: half where a slow load rings (docs/measured/accuracy.md).
constexpr double kTooLow = 2;

ProbeError error_of_field(const Scene& scene, const IntegerProgram& program, const Probe& probe) {
  ProbeError error{probe.name, {}, {}};
  if (probe.kind != Probe::Kind::field) {
    error.why = "a rule of text: its fields alone are";
    return error;
  }
  if (has_bond_memory(scene.rule)) {
    error.why = "bonds keep what they went through: one that gives way sooner makes another run";
    return error;
  }
  double worst = 0;
  for (const auto& round : program.tables)
    for (const Integers::Fit& fit : round) worst = std::max(worst, fit.error);
  error.curves = {{probe.field, worst + std::ldexp(1.0, -kFactorFrac)}};
  error.why = "the tables and factors of the rule's text";
  const auto& fields = program.program.fields;
  const auto of = std::ranges::find(fields, probe.field, &graph::Field::name);
  const RuleProgram& text = *scene.rule.rounds->text();
  if (of == fields.end()) return error;
  const auto k = static_cast<size_t>(of - fields.begin());
  if (text.particle[program.field[k]].resolution == 0) return error;
  // In each step twelve neighbours round by half a unit at most, which has a variance of 1/12.
  const double unit = std::ldexp(1.0, -of->frac);
  error.curves[0].error = unit * std::sqrt(static_cast<double>(scene.steps)) +
                          error.curves[0].error * unit * static_cast<double>(of->range.high);
  const std::vector<RuleField>& declared = text.declaration.particle;
  const std::string& named = declared[place_of(declared, probe.field)].unit;
  error.curves[0].unit = named.empty() ? kPlainNumber : named;
  error.why = fmt::format("the resolution of {}", probe.field);
  return error;
}

// Of a probe that asks for one: its accuracy, and the curve that is off most.
struct Lack {
  const Probe* probe = nullptr;
  CurveError curve;
  double ratio = 0;  // error over accuracy
};

// Of all probes the one that lacks most; none: all keep what they ask for.
Lack lack_of(const Scene& scene, const std::vector<ProbeError>& errors) {
  Lack lack;
  for (size_t k = 0; k < errors.size(); ++k) {
    const Probe& probe = scene.probes[k];
    if (!(probe.accuracy > 0)) continue;
    if (errors[k].curves.empty())
      throw InputError(fmt::format("no accuracy can be asked of probe '{}': {}", probe.name, errors[k].why))
          .about({fmt::format("probe[{}].accuracy", probe.name)});
    const bool means = std::ranges::any_of(errors[k].curves, &CurveError::of_means);
    for (const CurveError& curve : errors[k].curves)
      if (const double ratio = kTooLow * curve.error / probe.accuracy;
          curve.of_means == means && ratio > 1 && ratio > lack.ratio)
        lack = {&probe, curve, ratio};
  }
  return lack;
}

// Whether two rules have the formats that accuracy chooses in common.
bool same_formats(const FixedRule& one, const FixedRule& other) {
  const auto formats = [](const FixedRule& rule) {
    const Widths& w = rule.widths;
    return std::array{w.position_frac,          w.guard,         w.difference_frac,
                      w.relative_velocity_frac, w.strength_bits, rule.force.index_bits};
  };
  return formats(one) == formats(other);
}

void tell_reasons(const AutoWidths& before, const FixedRule& was, AutoWidths& now, const FixedRule& is,
                  const std::string& why) {
  for (WidthReason& reason : now.reasons)
    for (const WidthReason& other : before.reasons)
      if (reason.key == other.key && reason.bits != other.bits) reason.why += ", " + why;
  const auto add = [&](const char* key, int one, int other) {
    if (one != other) now.reasons.push_back({key, one, one, false, why});
  };
  add("strength_bits", is.widths.strength_bits, was.widths.strength_bits);
  add("index_bits", is.force.index_bits, was.force.index_bits);
}

}  // namespace

bool asks_accuracy(const Scene& scene) {
  return !scene.loading && scene.steps > 0 &&
         std::ranges::any_of(scene.probes, [](const Probe& probe) { return probe.accuracy > 0; });
}

void refine_for_probes(const Scene& scene, const Arch& arch, const CellEdges& edges, AutoWidths& chosen,
                       FixedRule& rule) {
  // The least that any format asks for: a scene's least accuracy and what twice an estimate is above a part.
  constexpr double kLeast = 1e-9;
  constexpr int kIdle = 8;  // halvings below which the least formats that are taken may all be enough
  const ProbeErrors errors(scene);
  const Lack first = lack_of(scene, errors.of(rule));
  if (first.probe == nullptr) return;
  Lack best = first;
  FixedRule last = rule;
  int idle = 0;
  for (double accuracy = scene.accuracy / 2; accuracy > kLeast; accuracy /= 2) {
    AutoWidths finer = auto_widths(scene, edges.longest, arch.widths, accuracy);
    FixedRule tried;
    try {
      tried = quantise(scene.rule, edges, finer.widths, arch.table, finer.half_unit);
    } catch (const InputError&) {
      break;  // formats that fit one another end here
    }
    const Lack lack = lack_of(scene, errors.of(tried));
    if (lack.probe == nullptr) {
      tell_reasons(chosen, rule, finer, tried,
                   fmt::format("by the accuracy of probe '{}'", best.probe->name));
      chosen = std::move(finer), rule = std::move(tried);
      return;
    }
    if (lack.ratio < best.ratio) best = lack;
    idle = same_formats(tried, last) ? idle + 1 : 0;
    if (idle > 0 && (idle == kIdle || tried.widths.strength_bits == kWidestStrength)) break;
    last = std::move(tried);
  }
  throw InputError(
      fmt::format("the {} of probe '{}' cannot be had within {:.2g}: the best that formats do is "
                  "about {:.2g}",
                  best.curve.quantity, best.probe->name, best.probe->accuracy, kTooLow * best.curve.error),
      fmt::format("accuracy = {:.2g}, or doubles (--engine reference)",
                  two_digits_up(kTooLow * best.curve.error)))
      .about({fmt::format("probe[{}].accuracy", best.probe->name)});
}

std::vector<ProbeError> probe_errors(const Scene& scene, const Plan& plan) {
  if (plan.program == nullptr) return probe_errors(scene, plan.rule);
  std::vector<ProbeError> errors;
  for (const Probe& probe : scene.probes) errors.push_back(error_of_field(scene, *plan.program, probe));
  return errors;
}

}  // namespace cuboct
