// SPDX-License-Identifier: MIT
#include "study/sweep/measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cuboct::study {
namespace {

using Kind = Measure::Kind;

// "figure0_young_s_modulus"
std::string id_of(const std::string& name, size_t n) {
  std::string id = fmt::format("figure{}_", n);
  for (const char c : name) {
    const bool capital = c >= 'A' && c <= 'Z';
    const bool plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    id += capital ? static_cast<char>(c - 'A' + 'a') : plain ? c : '_';
  }
  constexpr size_t kLongest = 60;  // it is part of a file's name
  id.resize(std::min(id.size(), kLongest));
  return id;
}

std::vector<Measure> measured(const Results& results, std::vector<Measure> all) {
  std::erase_if(all, [&](const Measure& measure) {
    return std::none_of(results.outcomes.begin(), results.outcomes.end(),
                        [&](const Outcome& outcome) { return std::isfinite(measure.value(outcome)); });
  });
  return all;
}

}  // namespace

std::vector<double> values_of(const Results& results, const Measure& measure) {
  std::vector<double> values;
  for (const Outcome& outcome : results.outcomes) values.push_back(measure.value(outcome));
  return values;
}

double figure_floor(const Truth& truth, size_t n) {
  if (truth.rungs.size() < 2) return 0;
  const auto& last = truth.rungs.back().figures;
  const auto& before = truth.rungs[truth.rungs.size() - 2].figures;
  if (n >= last.size() || n >= before.size() || last[n] == 0) return 0;
  const double moved = std::abs((last[n] - before[n]) / last[n]);
  return std::isfinite(moved) ? moved : 0;
}

double worst_figure_error(const Outcome& outcome) {
  double worst = kNotMeasured;
  for (const double error : outcome.errors.figures) {
    if (std::isnan(error)) return kNotMeasured;
    worst = std::fmax(worst, error);
  }
  return worst;
}

std::vector<Measure> error_measures(const Results& results) {
  const auto of = [](double Errors::*member) {
    return [member](const Outcome& outcome) { return outcome.errors.*member; };
  };
  std::vector<Measure> all{
      {Kind::force, "force_median", "force error, median over particles", true, 0, of(&Errors::force_median)},
      {Kind::force, "force_999", "force error that 99.9 % of particles stay below", true, 0,
       of(&Errors::force_999)},
      {Kind::force, "force_max", "force error, largest", true, 0, of(&Errors::force_max)},
      {Kind::trajectory, "trajectory", "distance from the true trajectory, pitches (rms)", true,
       std::isfinite(results.truth.floor) ? results.truth.floor : 0, of(&Errors::trajectory)},
      {Kind::drift, "drift_per_step", "energy drift per step, of the largest kinetic energy", true, 0,
       [](const Outcome& outcome) { return std::abs(outcome.errors.drift_per_step); }},
      {Kind::drift, "drift_per_oscillation", "energy drift per oscillation, of the largest kinetic energy",
       true, 0, [](const Outcome& outcome) { return std::abs(outcome.errors.drift_per_oscillation); }},
      {Kind::momentum, "momentum", "change of momentum, of the sum of |m v|", true, 0,
       of(&Errors::momentum)}};
  if (results.figure_names.size() > 1) {
    double floor = 0;
    for (size_t n = 0; n < results.figure_names.size(); ++n)
      floor = std::max(floor, figure_floor(results.truth, n));
    all.push_back({Kind::figure, "figures_worst", "relative error of the worst figure", true, floor,
                   worst_figure_error});
  }
  for (size_t n = 0; n < results.figure_names.size(); ++n)
    all.push_back({Kind::figure, id_of(results.figure_names[n], n),
                   "relative error of " + results.figure_names[n], true, figure_floor(results.truth, n),
                   [n](const Outcome& outcome) {
                     return n < outcome.errors.figures.size() ? outcome.errors.figures[n] : kNotMeasured;
                   }});
  return measured(results, std::move(all));
}

std::vector<Measure> speed_measures(const Results& results) {
  return measured(
      results, {{Kind::speed, "simulated_seconds", "simulated seconds per second", false, 0,
                 [](const Outcome& outcome) { return outcome.speed.simulated_seconds; }},
                {Kind::speed, "particle_steps", "particle-steps per second", false, 0,
                 [](const Outcome& outcome) { return outcome.speed.particle_steps; }},
                {Kind::speed, "cost", "cost, transistors x time per simulated second (less is better)", true,
                 0, [](const Outcome& outcome) { return outcome.cost; }}});
}

}  // namespace cuboct::study
