// SPDX-License-Identifier: MIT
#include "study/sweep/truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "model/base/error.h"
#include "model/config/config.h"
#include "model/rules/rounds_rule.h"
#include "model/solid/dynamical_matrix.h"
#include "study/sweep/measure_run.h"
#include "study/sweep/sampling.h"
#include "study/sweep/sensitivity.h"

namespace cuboct::study {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr int kForceStates = 4;
constexpr int kLengthenings = 12;  // of the cutoff, in all 15-fold

// A figure that moves by more than so many tolerances if every second sample is left out is noted. All runs
// are looked at at the same times, so in errors most of that cancels; ten tolerances are a per mille by
// default, which is what errors of figures are read to.
constexpr double kSamplingTolerances = 10;

Settings verlet_in_doubles() {
  Settings settings;
  settings.engine = default_engine(Arithmetic::float64);
  settings.arithmetic = Arithmetic::float64;
  settings.integrator = Integrator::velocity_verlet;
  return settings;
}

// The samples at which states are kept: quarters of the way to the horizon. Not the start: a packing at rest
// has no forces to compare.
std::vector<uint64_t> kept_samples(const TimeGrid& grid) {
  std::vector<uint64_t> samples;
  for (uint64_t k = 1; k <= kForceStates; ++k)
    samples.push_back(std::max<uint64_t>(1, grid.horizon * k / kForceStates));
  samples.erase(std::unique(samples.begin(), samples.end()), samples.end());
  return samples;
}

// A finished rung: what it showed, and where its particles were at the kept samples.
struct Climb {
  Rung rung;
  Run run;
  std::string lacks;  // the first figure that the run does not hold, and why; empty: it holds all
};

Climb climb(const Study& study, Case c, const TimeGrid& grid, uint64_t per_sample, uint64_t until,
            int threads) {
  c.scene.rule.dt = grid.sample / static_cast<double>(per_sample);
  RunRequest request;
  request.grid = grid;
  request.until = until;
  request.curves = until == grid.samples && !study.figures.empty();
  request.energies = request.curves;
  request.keep = kept_samples(grid);
  request.threads = threads;
  Climb result;
  result.run = run_case(c, request);
  result.rung.dt = result.run.dt;
  result.rung.cutoff = c.scene.rule.cutoff();
  result.rung.trajectory = result.rung.change = kNone;
  if (!result.run.stop.empty())
    throw InputError(
        fmt::format("the run in doubles at dt = {:.4g} s has no end: {}", result.run.dt, result.run.stop),
        "a study needs a scene that runs");
  for (const Figure& figure : study.figures) {
    try {
      result.rung.figures.push_back(value_of(figure, result.run.curves, result.run.dt));
    } catch (const std::runtime_error& error) {
      result.rung.figures.push_back(kNone);
      if (result.lacks.empty()) result.lacks = error.what();
    }
  }
  return result;
}

// Largest relative change of a figure that both have; nan where there is none.
double change_between(const std::vector<double>& a, const std::vector<double>& b) {
  double change = kNone;
  for (size_t k = 0; k < a.size(); ++k)
    if (std::isfinite(a[k]) && std::isfinite(b[k]))
      change = std::fmax(change, a[k] == b[k] ? 0 : std::abs(a[k] - b[k]) / std::abs(b[k]));
  return change;
}

double largest_frequency_of(const Scene& scene) {
  if (!(scene.pitch > 0) || scene.rule.rounds != nullptr) return 0;
  return largest_frequency(scene.rule, scene.pitch);
}

void keep_states(const Run& run, const TimeGrid& grid, Truth& truth) {
  const std::vector<uint64_t> samples = kept_samples(grid);
  truth.states.clear();
  for (size_t k = 0; k < run.kept.size(); ++k)
    truth.states.push_back({static_cast<double>(samples[k]) * grid.sample, run.kept[k]});
  truth.horizon = truth.states.back();
}

// A run's error by the last two changes of refinement by halves: of second order the last change is three
// times the error that is left, of first order it is the error; where the changes do not fall as such, no
// more than the last change is known.
double error_left(double before, double last) {
  const double ratio = before / last;
  return ratio >= 2 ? last / (std::min(ratio, 4.0) - 1) : last;
}

void refine(const Study& study, const Case& c, int threads, Truth& truth,
            const std::function<void(const Truth&)>& save) {
  const uint64_t first = truth.grid.steps_per_sample(c.scene.rule.dt);
  const double unit = length_unit(c.scene);
  const auto ended = [&] {
    return truth.converged || truth.rungs.size() >= static_cast<size_t>(study.truth_rungs);
  };
  while (!ended()) {
    const size_t k = truth.rungs.size();
    Climb now = climb(study, c, truth.grid, first << k, truth.grid.samples, threads);
    if (!now.lacks.empty())
      throw InputError(
          fmt::format("{}: the run in doubles does not hold a figure: {}", study.path, now.lacks),
          "another window, or a longer run");
    if (k > 0) {
      now.rung.change = change_between(truth.rungs.back().figures, now.rung.figures);
      now.rung.trajectory =
          rms_distance(truth.horizon.body.x, now.run.kept.back().x, c.scene.periodic) / unit;
      truth.floor =
          k > 1 ? error_left(truth.rungs.back().trajectory, now.rung.trajectory) : now.rung.trajectory;
    }
    truth.rungs.push_back(now.rung);
    keep_states(now.run, truth.grid, truth);
    // Of each rung, so that they are there where a refinement goes on behind its last one.
    truth.notes = sampling_notes(study.figures, now.run.curves, now.run.dt,
                                 kSamplingTolerances * study.truth_tolerance);
    // From the third rung on, so that one change that is small by chance does not end the refinement.
    truth.converged =
        k > 1 && now.rung.trajectory < study.truth_tolerance && !(now.rung.change >= study.truth_tolerance);
    if (save) save(truth);
  }
  if (!truth.converged)
    truth.notes.push_back(fmt::format(
        "the truth has not converged: at dt = {:.4g} s figures still change by {:.2g}, positions by {:.2g}",
        truth.rungs.back().dt, truth.rungs.back().change, truth.rungs.back().trajectory));
  truth.figures = truth.rungs.back().figures;
}

bool is_cut_for_speed(const Base& base) {
  const auto law = parse_config(base.scene_text, base.scene_path).table_at("law");
  const auto kind = law ? law->find("kind") : std::nullopt;
  return kind && kind->is_string() && kind->string() == "lj";
}

void lengthen(const Study& study, const Case& c, int threads, Truth& truth) {
  if (!is_cut_for_speed(study.base)) {
    truth.notes.push_back(fmt::format("the cutoff is a part of this {}: it is not lengthened",
                                      c.scene.rule.rounds != nullptr ? "rule" : "law"));
    return;
  }
  if (study.figures.empty()) return;
  if (!study.lengthen_cutoff) {
    truth.notes.push_back("the cutoff is not lengthened, as the study says");
    return;
  }
  const uint64_t per_sample = truth.grid.steps_per_sample(truth.rungs.back().dt);
  const bool reduced = is_reduced(study.base);
  double cutoff = c.scene.rule.cutoff();
  for (int k = 0; k < kLengthenings; ++k) {
    cutoff *= 1.25;
    Settings settings = c.settings;
    settings.scene.push_back(
        {"law.cutoff", reduced ? fmt::format("{}", cutoff) : fmt::format("\"{} m\"", cutoff)});
    try {
      // Positions with another cutoff are those of another law: they are not compared.
      Climb now =
          climb(study, resolve(study.base, settings), truth.grid, per_sample, truth.grid.samples, threads);
      now.rung.change = change_between(truth.rungs.back().figures, now.rung.figures);
      truth.rungs.push_back(now.rung);
      truth.figures = now.rung.figures;
      if (!(now.rung.change >= study.truth_tolerance)) return;
    } catch (const InputError& error) {
      std::string text = error.what();
      std::replace(text.begin(), text.end(), '\n', ' ');
      truth.converged = false;
      truth.notes.push_back(
          fmt::format("the cutoff was lengthened up to {:.4g} m only, where figures changed by "
                      "{:.2g}: {}",
                      cutoff / 1.25, truth.rungs.back().change, text));
      return;
    }
  }
  truth.converged = false;
  truth.notes.push_back(
      fmt::format("the cutoff was lengthened up to {:.4g} m, where figures still changed by {:.2g}", cutoff,
                  truth.rungs.back().change));
}

}  // namespace

std::string physics_key(const Settings& settings) {
  std::string key;
  for (const Change& change : settings.scene) {
    if (change.key.starts_with("run.") || change.key.starts_with("reach.")) continue;
    key += (key.empty() ? "" : ", ") + change.key + " = " + change.value;
  }
  return key;
}

Truth make_truth(const Study& study, int jobs, Truth begun, const std::function<void(const Truth&)>& save) {
  const Case c = resolve(study.base, verlet_in_doubles());
  // Fewer particles than that are not worth a thread, and less than that where the machine has other work.
  constexpr size_t kPerThread = 16384;
  const int threads = std::clamp(static_cast<int>(c.scene.body.size() / kPerThread), 1, std::max(1, jobs));
  Truth truth = std::move(begun);
  if (truth.rungs.empty()) {
    truth.grid = study.grid;
    truth.largest_frequency = largest_frequency_of(c.scene);
    const Sensitivity sensitivity = sensitivity_of(separation(c, study.grid, threads), study.grid.sample);
    truth.lyapunov_time = sensitivity.lyapunov_time;
    truth.grid.horizon = sensitivity.horizon;
    if (study.horizon > 0)
      truth.grid.horizon = std::clamp<uint64_t>(
          static_cast<uint64_t>(study.horizon / study.grid.sample * (1 + 1e-9)), 1, sensitivity.horizon);
  }
  refine(study, c, threads, truth, save);
  lengthen(study, c, threads, truth);
  return truth;
}

Truth make_own_truth(const Study& study, const Truth& study_truth, const Settings& settings) {
  Settings own = verlet_in_doubles();
  for (const Change& change : settings.scene)
    if (!change.key.starts_with("run.")) own.scene.push_back(change);
  const Case c = resolve(study.base, own);
  const Scene base = resolve(study.base, verlet_in_doubles()).scene;
  const auto refined = std::find_if(study_truth.rungs.rbegin(), study_truth.rungs.rend(),
                                    [&](const Rung& rung) { return rung.cutoff == base.rule.cutoff(); });
  const double scale = c.scene.dt_limit > 0 && base.dt_limit > 0 ? c.scene.dt_limit / base.dt_limit : 1;
  Truth truth;
  truth.grid = study_truth.grid;
  truth.largest_frequency = largest_frequency_of(c.scene);
  truth.lyapunov_time = study_truth.lyapunov_time;
  truth.converged = study_truth.converged;
  truth.figures = study_truth.figures;
  const uint64_t per_sample = truth.grid.steps_per_sample(refined->dt * scale);
  const Climb coarse =
      climb(study, c, truth.grid, std::max<uint64_t>(1, per_sample / 2), truth.grid.horizon, 1);
  Climb fine = climb(study, c, truth.grid, per_sample, truth.grid.horizon, 1);
  fine.rung.figures.clear();
  fine.rung.trajectory = truth.floor =
      rms_distance(coarse.run.kept.back().x, fine.run.kept.back().x, c.scene.periodic) / length_unit(c.scene);
  truth.rungs.push_back(fine.rung);
  keep_states(fine.run, truth.grid, truth);
  return truth;
}

}  // namespace cuboct::study
