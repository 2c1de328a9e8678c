// SPDX-License-Identifier: MIT
#include "study/report/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/base/json.h"
#include "model/base/text.h"
#include "study/search/front.h"
#include "study/sweep/measures.h"

namespace cuboct::study {
namespace {

std::string number(double value) { return std::isfinite(value) ? fmt::format("{:.3g}", value) : "-"; }

double error_of(const Results& results, const Outcome& outcome) {
  return results.figure_names.empty() ? outcome.errors.trajectory : worst_figure_error(outcome);
}

bool is_timed(const Results& results) {
  return std::ranges::any_of(results.outcomes, [](const Outcome& outcome) {
    return std::isfinite(outcome.speed.simulated_seconds);
  });
}

// The fastest point of each decade of errors; where nothing was timed, the cheapest.
std::vector<Cheapest> best_points(const Results& results) {
  const ValueOf speed =
      is_timed(results) ? ValueOf(default_speed) : [](const Outcome& outcome) { return -outcome.cost; };
  const ValueOf error = [&](const Outcome& outcome) { return error_of(results, outcome); };
  return cheapest_by_decade(results.outcomes, error, speed);
}

// The settings, and where they were timed.
std::string told(const Outcome& outcome) {
  return short_name(outcome.settings) +
         (outcome.measured_on().empty() ? "" : fmt::format(" ({})", line_text(outcome.measured_on())));
}

}  // namespace

std::string short_name(const Settings& settings) {
  std::string text = name_of(settings.arithmetic);
  if (settings.engine != default_engine(settings.arithmetic)) text = line_text(settings.engine) + " " + text;
  if (settings.arithmetic != Arithmetic::fixed)
    text += settings.integrator == Integrator::velocity_verlet ? " verlet" : " euler";
  const auto add = [&](const Change& change) {
    if (change.value.empty() || change.value == "\"auto\"") return;
    std::string value = change.value;
    std::erase(value, '"');
    text += line_text(fmt::format(" {} {}", change.key.substr(change.key.rfind('.') + 1), value));
  };
  for (const Change& change : settings.scene) add(change);
  for (const Change& change : settings.arch) add(change);
  if (settings.threads > 1 && !on_gpu(settings)) text += fmt::format(" threads {}", settings.threads);
  return text;
}

std::string cheapest_per_decade(const Results& results) {
  const auto row = [](const std::string& most, const std::string& error, const std::string& cost,
                      const std::string& rate, const std::string& simulated, const std::string& settings) {
    return fmt::format("{:>8}  {:>9}  {:>9}  {:>10}  {:>10}  {}\n", most, error, cost, rate, simulated,
                       settings);
  };
  std::string text =
      fmt::format("the {} point for each error of {}\n", is_timed(results) ? "fastest" : "cheapest",
                  results.figure_names.empty() ? "the trajectory" : "the worst figure");
  text += row("error", "", "", "particle-", "simulated", "");
  text += row("at most", "error", "cost", "steps/s", "s/s", "settings");
  for (const Cheapest& best : best_points(results)) {
    const Outcome& outcome = results.outcomes[best.point];
    text += row(best.exponent == Cheapest::kExact ? "0" : fmt::format("1e{}", best.exponent),
                number(error_of(results, outcome)), number(outcome.cost),
                number(outcome.speed.particle_steps), number(outcome.speed.simulated_seconds), told(outcome));
  }
  return text;
}

std::string cheapest_json(const Results& results) {
  return json_array(best_points(results), [&](const Cheapest& best) {
    const Outcome& outcome = results.outcomes[best.point];
    return json_object(
        {{"error_at_most", json(best.exponent == Cheapest::kExact ? 0.0 : std::pow(10.0, best.exponent))},
         {"error", json(error_of(results, outcome))},
         {"cost", json(outcome.cost)},
         {"particle_steps_per_second", json(outcome.speed.particle_steps)},
         {"simulated_seconds_per_second", json(outcome.speed.simulated_seconds)},
         {"settings", json(told(outcome))}});
  });
}

std::string describe(const Truth& truth, const Results& results) {
  std::string text = fmt::format("{:>10}  {:>10}  {:>10}  {:>9}", "dt", "cutoff", "trajectory", "change");
  for (const std::string& name : results.figure_names) text += fmt::format("  {:>14}", line_text(name));
  text += '\n';
  for (const Rung& rung : truth.rungs) {
    text += fmt::format("{:>10.4g}  {:>10.4g}  {:>10}  {:>9}", rung.dt, rung.cutoff, number(rung.trajectory),
                        number(rung.change));
    for (const double value : rung.figures) text += fmt::format("  {:>14.8g}", value);
    text += '\n';
  }
  text += fmt::format("horizon {:.4g} s, Lyapunov time {:.4g} s, the truth's own error there {:.2g}\n",
                      truth.grid.horizon_time(), truth.lyapunov_time, truth.floor);
  for (const std::string& note : truth.notes) text += line_text(note) + "\n";
  return text;
}

}  // namespace cuboct::study
