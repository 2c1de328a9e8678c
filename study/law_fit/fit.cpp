// SPDX-License-Identifier: MIT
#include "study/law_fit/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/base/text.h"
#include "study/law_fit/curve_error.h"
#include "study/law_fit/evolution.h"
#include "study/law_fit/packing_fit.h"
#include "study/sweep/interrupted.h"
#include "study/sweep/thread_time.h"
#include "study/sweep/work.h"

namespace cuboct::fit {
namespace {

using Sample = std::vector<double>;
constexpr double kMove = 0.02;  // of a parameter's bounds, for slopes
// A curve that is off by less is equal, where the fit's own error is smaller.
constexpr double kLeastDifference = 0.005;

// A fit that is further off is told to be none.
constexpr double kFar = 0.05;

// A pressure at rest, over the strength, that counts as none.
constexpr double kPressureAtRest = 0.01;

LawPoints law_of(const FitStudy& study, const Sample& sample) {
  return points_of(draw(parameters_of(study, sample), study.scale));
}

Evaluation evaluate(const FitStudy& study, const Sample& sample) {
  const double begin = study::thread_seconds();
  const Tested tested = run_test(study.test, law_of(study, sample));
  Evaluation out;
  out.sample = sample;
  out.stress = first_passage(tested.strain, tested.stress, study.target.even_strain);
  out.error = curve_error(out.stress, study.target.even_stress);
  if (tested.refused || !std::isfinite(out.error)) {
    out.error = kRefused;
    out.stress.assign(out.stress.size(), 0);
  }
  if (!tested.strain.empty()) out.largest_strain = *std::ranges::max_element(tested.strain);
  out.particle_steps = tested.particle_steps;
  out.stop = tested.stop;
  out.seconds = study::thread_seconds() - begin;
  return out;
}

class Runner {
 public:
  Runner(const FitStudy& study, Evaluations& evaluations, const FitOptions& options)
      : study_(study), evaluations_(evaluations), options_(options) {}

  // In their order. What was computed before an interrupt is saved.
  std::vector<const Evaluation*> all(const std::vector<Sample>& samples, const std::string& label) {
    std::vector<Evaluation> fresh(samples.size());
    std::vector<study::Piece> pieces;
    for (size_t k = 0; k < samples.size(); ++k)
      if (!evaluations_.find(samples[k]))
        pieces.push_back({1, [&, k] {
                            if (interrupted()) throw study::Interrupted();
                            fresh[k] = evaluate(study_, samples[k]);
                          }});
    const auto keep = [&] {
      for (Evaluation& evaluation : fresh)
        if (!evaluation.sample.empty() && !evaluations_.find(evaluation.sample))
          evaluations_.add(std::move(evaluation));
      evaluations_.save();
    };
    try {
      study::work_off(std::move(pieces), options_.jobs, label, options_.progress);
    } catch (...) {
      keep();
      throw;
    }
    keep();
    std::vector<const Evaluation*> out;
    for (const Sample& sample : samples) out.push_back(evaluations_.find(sample));
    return out;
  }

 private:
  const FitStudy& study_;
  Evaluations& evaluations_;
  const FitOptions& options_;
};

void count(const std::vector<const Evaluation*>& done, Fit& fit) {
  for (const Evaluation* evaluation : done) {
    ++fit.evaluations;
    fit.particle_steps += evaluation->particle_steps;
    fit.seconds += evaluation->seconds;
  }
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// `begun`: generations before this round.
void take(const std::vector<const Evaluation*>& done, size_t begun, Fit& fit) {
  count(done, fit);
  for (const Evaluation* evaluation : done) {
    fit.errors.push_back(evaluation->error);
    if (evaluation->error < fit.best->error) fit.best = evaluation;
  }
  fit.best_errors.push_back(fit.best->error);
  const double middle = median({fit.errors.end() - static_cast<ptrdiff_t>(done.size()), fit.errors.end()});
  const bool first = fit.least_medians.size() == begun;
  fit.least_medians.push_back(first ? middle : std::min(middle, fit.least_medians.back()));
}

// Whether over the last `patience` generations of a round, which began after `begun` of them, neither the
// best error nor the least median of a generation fell by the threshold: the median falls while the search
// still gathers about a law, the best long after it has no better.
bool stands(const Fit& fit, size_t begun, const Search& search) {
  const size_t now = fit.best_errors.size();
  if (now <= begun + search.patience) return false;
  const auto stands_still = [&](const std::vector<double>& least) {
    return least[now - 1] > (1 - search.threshold) * least[now - 1 - search.patience];
  };
  return stands_still(fit.best_errors) && stands_still(fit.least_medians);
}

// What the run that came closest says of the target.
std::vector<std::string> notes_of(const FitStudy& study, const Fit& fit) {
  std::vector<std::string> notes;
  const double last = study.target.strain.back(), largest = fit.best->largest_strain;
  if (fit.best->error > kFar)
    notes.push_back(fmt::format(
        "the best law is still {:.3g} % off: perhaps no law within these bounds makes such a curve",
        100 * fit.best->error));
  const double pressure = packing_pressure(study, parameters_of(study, fit.best->sample));
  if (std::abs(pressure) > kPressureAtRest * study.target.strength)
    notes.push_back(
        fmt::format("the undeformed packing is under a pressure of {:.3g} Pa with the best law: its reach of "
                    "{:g} pitches "
                    "takes in second neighbours",
                    pressure, study.scale.reach));
  if (!fit.best->stop.empty())
    notes.push_back(fmt::format("the run of the best law ended early: {}", line_text(fit.best->stop)));
  if (largest < (1 - 1e-3) * last)
    notes.push_back(
        fmt::format("the run of the best law reads strains up to {:.4g}, the target goes to {:.4g}: beyond, "
                    "its stress counts as "
                    "0; a longer run may help",
                    largest, last));
  return notes;
}

void search_round(const FitStudy& study, Runner& runner, double spread, const std::function<bool()>& over,
                  const FitOptions& options, Fit& fit) {
  const Search& search = study.search;
  Evolution evolution(fit.best->sample, fit.best->error, search.samples, spread, search.seed);
  const size_t begun = fit.best_errors.size();
  while (!over() && !stands(fit, begun, search)) {
    const auto tests = runner.all(
        evolution.ask(),
        fmt::format("generation {}, error {:.3g} %", fit.best_errors.size() + 1, 100 * fit.best->error));
    take(tests, begun, fit);
    options.see(fit);
    evolution.tell({fit.errors.end() - search.samples, fit.errors.end()});
  }
}

void tell_apart(const FitStudy& study, Runner& runner, Fit& fit) {
  std::vector<Sample> moved;
  std::vector<double> by;
  for (size_t k = 0; k < kParameters; ++k) {
    if (study.bounds[k].low == study.bounds[k].high) continue;
    fit.free.push_back(k);
    moved.push_back(fit.best->sample);
    // Into the bounds, whatever side of the mirror the sample is on.
    double& x = moved.back()[k];
    x = std::abs(std::remainder(x, 2.0));
    by.push_back(x < 0.5 ? kMove : -kMove);
    x += by.back();
  }
  const std::vector<const Evaluation*> tests = runner.all(moved, "what the data tell");
  count(tests, fit);
  std::vector<Slopes> slopes;
  for (size_t k = 0; k < tests.size(); ++k) {
    slopes.emplace_back();
    for (size_t i = 0; i < fit.best->stress.size(); ++i)
      slopes.back().push_back((tests[k]->stress[i] - fit.best->stress[i]) / by[k]);
  }
  fit.told_within = std::max(fit.best->error, kLeastDifference);
  fit.told = identifiability(slopes, study.target.even_stress, fit.told_within);
}

}  // namespace

Fit run_fit(const FitStudy& study, Evaluations& evaluations, const FitOptions& options) {
  const Search& search = study.search;
  Runner runner(study, evaluations, options);
  Fit fit;
  const std::vector<const Evaluation*> first =
      runner.all({sample_of(study, study.start), sample_of(study, fit_packing(study))}, "the cheap case");
  fit.cheap = first[0], fit.packing = first[1];
  fit.best = first[0]->error < first[1]->error ? first[0] : first[1];
  count(first, fit);
  if (fit.best->error == kRefused)
    throw InputError(
        fmt::format("the scene cannot run the law that modulus and strength give: {}", fit.best->stop));
  options.see(fit);
  // The errors of a specimen that slips are rough: a good law may stand alone among samples that lie far
  // apart. So each round looks about the best law within half the distance, until one finds nothing better.
  const auto over = [&] {
    if (fit.best->error <= search.goal) return fit.end = End::goal, true;
    return fit.best_errors.size() >= search.generations;
  };
  double spread = search.spread;
  for (bool gains = true; gains && !over(); spread /= 2) {
    const double before = fit.best->error;
    search_round(study, runner, spread, over, options, fit);
    gains = fit.best->error < (1 - search.threshold) * before;
    if (!gains && !over()) fit.end = End::converged;
  }
  fit.notes = notes_of(study, fit);
  tell_apart(study, runner, fit);
  options.see(fit);
  return fit;
}

std::string fitted_scene(const FitStudy& study, const Evaluation& evaluation) {
  return scene_with(study.test.base, law_of(study, evaluation.sample));
}

}  // namespace cuboct::fit
