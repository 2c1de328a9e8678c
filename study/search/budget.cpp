// SPDX-License-Identifier: MIT
#include "study/search/budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/base/error.h"
#include "model/base/places.h"
#include "model/config/config.h"
#include "study/sweep/cost.h"
#include "study/sweep/measure_errors.h"
#include "study/sweep/measure_run.h"
#include "study/sweep/measures.h"
#include "study/sweep/work.h"

namespace cuboct::study {
namespace {

// A time step's part is the method's alone as long as numbers are still the finest, so what sets the
// precision comes after it; an axis of the list keeps its place otherwise.
std::vector<Axis> in_order(std::vector<Axis> axes) {
  std::stable_partition(axes.begin(), axes.end(), [](const Axis& axis) {
    return axis.name == "pitch" || axis.name == "cutoff" || axis.name == "integrator" || axis.name == "dt" ||
           axis.name == "dt_safety";
  });
  return axes;
}

// The case with the time step that the grid leaves, as run_case takes it.
Case fitted(const Study& study, const Truth& truth, const Settings& settings) {
  Case c = resolve(study.base, settings);
  c.scene.rule.dt = truth.grid.fitted(c.scene.rule.dt);
  c.scene.steps = truth.grid.steps_per_sample(c.scene.rule.dt) * truth.grid.samples;
  return c;
}

void check(const Study& study, const Truth& truth, const BudgetQuestion& question) {
  const std::string& name = study.figures.at(question.figure).name;
  const double value = truth.figures.at(question.figure);
  if (!std::isfinite(value) || value == 0)
    throw InputError(fmt::format("{}: the figure '{}' of the truth is {}: no relative error can be told",
                                 study.path, name, std::isfinite(value) ? "0" : "not to be had"));
  const double known = figure_floor(truth, question.figure);
  if (known >= question.budget)
    throw InputError(
        fmt::format("{}: the truth of '{}' is known to {:.2g} only, worse than the budget of {:.2g}",
                    study.path, name, known, question.budget),
        "a smaller 'tolerance' or more 'rungs' in [truth]");
}

// Answers to settings, out of the store where it has them.
class Runs {
 public:
  Runs(const Study& study, const Truth& truth, Store& store, const BudgetQuestion& question)
      : study_(study), truth_(truth), store_(store), question_(question) {}

  std::vector<double> errors(const std::vector<Settings>& wanted) {
    std::vector<Settings> fresh;
    for (const Settings& settings : wanted)
      if (!store_.has_errors(settings) && std::ranges::find(fresh, settings) == fresh.end())
        fresh.push_back(settings);
    run(fresh);
    std::vector<double> errors;
    for (const Settings& settings : wanted) errors.push_back(error_of(*store_.errors(settings)));
    return errors;
  }

  double error_of(const Outcome& outcome) const {
    const double truth = truth_.figures[question_.figure];
    return (outcome.errors.values.at(question_.figure) - truth) / std::abs(truth);
  }

  Priced priced(const Settings& settings) {
    Priced p;
    p.settings = settings;
    p.error = errors({settings})[0];
    const Outcome outcome = *store_.errors(settings);
    p.value = outcome.errors.values[question_.figure];
    p.dt = outcome.dt;
    p.why = outcome.why;
    p.cost = cost(settings);
    return p;
  }

  double cost(const Settings& settings) const {
    try {
      return cost_of(fitted(study_, truth_, settings));
    } catch (const InputError&) {
      return kNotMeasured;
    }
  }

 private:
  void run(const std::vector<Settings>& fresh) {
    std::vector<Piece> pieces;
    for (const Settings& settings : fresh)
      pieces.push_back({size_of_run(study_, settings),
                        [&, settings] { store_.put_errors(measure_figures(study_, truth_, settings)); }});
    made_ += pieces.size();
    work_off(std::move(pieces), question_.jobs, fmt::format("search, {} runs in all", made_),
             question_.progress);
  }

  const Study& study_;
  const Truth& truth_;
  Store& store_;
  const BudgetQuestion& question_;
  size_t made_ = 0;
};

}  // namespace

Settings settings_at(const std::vector<Axis>& axes, const Notches& at) {
  Settings settings;
  for (size_t a = 0; a < axes.size(); ++a) axes[a].sets.at(static_cast<size_t>(at[a]))(settings);
  return canonical(std::move(settings));
}

bool matters(const std::vector<Axis>& axes, Notches at, size_t axis) {
  const Settings settings = settings_at(axes, at);
  const size_t notches = axes[axis].sets.size();
  for (size_t n = 0; n < notches; ++n) {
    at[axis] = static_cast<int>(n);
    if (!(settings_at(axes, at) == settings)) return true;
  }
  return notches == 1;
}

Outcome measure_figures(const Study& study, const Truth& truth, const Settings& settings) {
  return answered(study, settings, [&](Outcome& outcome) {
    const Case c = fitted(study, truth, settings);
    outcome.dt = c.scene.rule.dt;
    outcome.pitch = c.scene.pitch;
    outcome.particles = static_cast<uint32_t>(c.scene.body.size());
    RunRequest request;
    request.grid = truth.grid;
    request.until = truth.grid.samples;
    request.curves = true;
    request.energies =
        std::ranges::any_of(study.figures, [](const Figure& f) { return f.curve.starts_with("energy."); });
    const Run run = run_case(c, request);
    outcome.steps = run.steps;
    if (run.stop.empty()) return compare_figures(study, truth, run, outcome);
    outcome.status = Status::unstable;
    outcome.why = one_line(run.stop);
  });
}

BudgetAnswer keep_budget(const Study& study, const Truth& truth, Store& store,
                         const BudgetQuestion& question) {
  check(study, truth, question);
  BudgetAnswer answer;
  answer.axes = in_order(study.search);
  Runs runs(study, truth, store, question);
  SearchSpace space;
  for (const Axis& axis : answer.axes) space.sizes.push_back(static_cast<int>(axis.sets.size()));
  space.errors = [&](const std::vector<Notches>& points) {
    std::vector<Settings> wanted;
    for (const Notches& p : points) wanted.push_back(settings_at(answer.axes, p));
    return runs.errors(wanted);
  };
  space.cost = [&](const Notches& p) { return runs.cost(settings_at(answer.axes, p)); };
  space.finest_alike = [&](Notches p) {
    for (size_t a = 0; a < p.size(); ++a)
      if (!matters(answer.axes, p, a)) p[a] = space.sizes[a] - 1;
    return p;
  };
  try {
    answer.result = search(space, question.budget);
  } catch (const NotchOrder& order) {
    const Axis& axis = answer.axes[order.axis];
    const auto notch = static_cast<size_t>(order.notch);
    parse_config(read_config_text(study.path), study.path)
        .places()
        .fail({"search." + axis.name, "search"},
              fmt::format("'{}' of {} costs more than '{}' after it", axis.labels[notch], axis.name,
                          axis.labels[notch + 1]),
              "notches go from cheap to dear");
  }
  for (const auto& c : answer.result.cheaper)
    answer.why.push_back(
        std::isnan(c.spending.error) ? store.errors(settings_at(answer.axes, c.spending.at))->why : "");
  answer.chosen = runs.priced(settings_at(answer.axes, answer.result.best.at));
  answer.standard = runs.priced(canonical({}));
  return answer;
}

Written written(const Study& study, const Truth& truth, const Settings& settings) {
  const Case c = fitted(study, truth, settings);
  std::vector<Change> changes = settings.scene;
  const auto put = [&](const char* key, const std::string& value) {
    std::erase_if(changes, [&](const Change& change) { return change.key == key; });
    changes.push_back({key, value});
  };
  put("run.dt_safety", "");
  put("run.dt",
      is_reduced(study.base) ? fmt::format("{}", c.scene.rule.dt) : fmt::format("\"{} s\"", c.scene.rule.dt));
  put("run.duration", "");
  put("run.steps", fmt::format("{}", c.scene.steps));
  put("run.probe_every", fmt::format("{}", truth.grid.steps_per_sample(c.scene.rule.dt)));
  return {with_changes(study.base.scene_text, study.base.scene_path, changes), c.arch_text};
}

}  // namespace cuboct::study
