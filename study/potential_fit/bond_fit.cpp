// SPDX-License-Identifier: MIT
#include "study/potential_fit/bond_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "model/atoms/bond_order/atom_cell.h"
#include "model/base/interrupt.h"
#include "study/potential_fit/kept_starts.h"
#include "study/sweep/interrupted.h"
#include "study/sweep/thread_time.h"
#include "study/sweep/work.h"

namespace cuboct::bond_fit {
namespace {

constexpr size_t kBatch = 64;       // starts between two saves
constexpr double kDistinct = 0.01;  // of the bounds, of some parameter: two sets are two

Point start_point(const BondStudy& study, int number) {
  if (number == 0) return point_of(study.problem, free_of(study.from->term));
  return random_start(study.problem, study.seed, static_cast<uint64_t>(number));
}

// The work on `items`, each of which has a place of its own; what is done before an interrupt is kept.
template <typename Item, typename Work, typename Keep>
void in_threads(std::vector<Item>& items, const std::string& label, const BondFitOptions& options,
                const Work& work, const Keep& keep) {
  std::vector<char> done(items.size());
  std::vector<study::Piece> pieces;
  for (size_t k = 0; k < items.size(); ++k)
    pieces.push_back({1, [&, k] {
                        if (interrupted()) throw study::Interrupted();
                        work(items[k]);
                        done[k] = 1;
                      }});
  const auto keep_done = [&] {
    for (size_t k = 0; k < items.size(); ++k)
      if (done[k]) keep(items[k]);
  };
  try {
    study::work_off(std::move(pieces), options.jobs, label, options.progress);
  } catch (...) {
    keep_done();
    throw;
  }
  keep_done();
}

void run_starts(const BondStudy& study, KeptStarts& kept, const std::vector<int>& numbers,
                const BondFitOptions& options) {
  struct One {
    int number;
    Found found;
  };
  std::vector<int> open;
  for (const int number : numbers)
    if (!kept.start(number)) open.push_back(number);
  for (size_t from = 0; from < open.size(); from += kBatch) {
    std::vector<One> batch;
    for (size_t k = from; k < std::min(from + kBatch, open.size()); ++k) batch.push_back({open[k], {}});
    in_threads(
        batch, fmt::format("starts {} to {} of {}", from + 1, from + batch.size(), open.size()), options,
        [&](One& one) {
          one.found =
              descend(study.problem, Method::lbfgs, start_point(study, one.number), study.evaluations);
        },
        [&](One& one) { kept.add(one.number, one.found); });
    kept.save();
  }
}

bool same(const Point& a, const Point& b) {
  double most = 0;
  for (size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most < kDistinct;
}

// Of the least losses, distinct ones. Losses below `enough` are equal: then the first start is the first.
std::vector<size_t> candidates(const BondStudy& study, const std::vector<Found>& starts) {
  std::vector<size_t> order(starts.size()), out;
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, {}, [&](size_t k) { return std::max(starts[k].loss, study.enough); });
  for (const size_t k : order) {
    const bool known =
        std::ranges::any_of(out, [&](size_t other) { return same(starts[k].point, starts[other].point); });
    if (!known) out.push_back(k);
    if (out.size() == study.tried) break;
  }
  return out;
}

Tersoff tersoff_at(const BondStudy& study, const Found& found) {
  return {{study.element}, {with_free(study.problem.fixed, parameters_at(study.problem, found.point))}};
}

// One boundary of one candidate: the pieces of work.
struct Run {
  size_t candidate, boundary;
  Tried tried;
};

void run_trial(const BondStudy& study, const Found& found, Run& run) {
  const Tersoff tersoff = tersoff_at(study, found);
  try {
    TersoffForces forces(tersoff);
    run.tried.edge = 2 * at_no_pressure(forces, diamond_cell(study.problem.goal.edge)).box.edges(0, 1);
  } catch (const std::runtime_error& error) {
    run.tried.fault = error.what();
    return;
  }
  run.tried.endurance.runs[run.boundary] =
      endure(tersoff, run.tried.edge, study.trial, run.boundary, [] { return interrupted(); });
}

// Candidates one after another, the runs of each in threads: an interrupt costs one candidate.
void run_trials(const BondStudy& study, KeptStarts& kept, const std::vector<int>& numbers, BondFit& fit,
                const BondFitOptions& options) {
  for (size_t at = 0; at < fit.tried.size(); ++at) {
    Tried& tried = fit.tried[at];
    const int number = numbers[tried.start];
    if (const Tried* known = kept.trial(number)) {
      tried = {tried.start, known->fault, known->edge, known->endurance};
      continue;
    }
    std::vector<Run> runs;
    for (size_t b = 0; b < kBoundaries; ++b) runs.push_back({at, b, {}});
    in_threads(
        runs, fmt::format("set {} of {} in time", at + 1, fit.tried.size()), options,
        [&](Run& run) { run_trial(study, fit.starts[tried.start], run); },
        [&](Run& run) {
          tried.fault = run.tried.fault, tried.edge = run.tried.edge;
          tried.endurance.runs[run.boundary] = run.tried.endurance.runs[run.boundary];
        });
    kept.add(number, tried);
    kept.save();
  }
}

// Of the stable ones that with the least loss; of equal losses the one that stays coolest.
std::optional<size_t> best_of(const BondStudy& study, const BondFit& fit) {
  std::optional<size_t> best;
  const auto rank = [&](size_t k) {
    return std::pair(std::max(fit.starts[fit.tried[k].start].loss, study.enough),
                     fit.tried[k].endurance.hottest());
  };
  for (size_t k = 0; k < fit.tried.size(); ++k)
    if (fit.tried[k].stable() && (!best || rank(k) < rank(*best))) best = k;
  return best;
}

}  // namespace

BondFit run_bond_fit(const BondStudy& study, const std::string& directory, const BondFitOptions& options) {
  KeptStarts kept(directory, study);
  std::vector<int> numbers;
  for (int k = study.from ? 0 : 1; k <= study.starts; ++k) numbers.push_back(k);
  run_starts(study, kept, numbers, options);
  BondFit fit;
  for (const int number : numbers) {
    fit.starts.push_back(*kept.start(number));
    fit.evaluations += static_cast<uint64_t>(fit.starts.back().evaluations);
  }
  for (const size_t start : candidates(study, fit.starts)) fit.tried.push_back({start, {}, 0, {}});
  run_trials(study, kept, numbers, fit, options);
  fit.best = best_of(study, fit);
  return fit;
}

std::vector<Compared> compare_methods(const BondStudy& study, const BondFitOptions& options) {
  struct One {
    size_t method;
    uint64_t number;
    Found found;
    Descent descent;
    double seconds;
  };
  std::vector<Compared> out{
      {Method::lbfgs, {}, {}, 0}, {Method::nelder_mead, {}, {}, 0}, {Method::granular, {}, {}, 0}};
  std::vector<One> work;
  for (size_t m = 0; m < out.size(); ++m)
    for (int k = 1; k <= study.compare->starts; ++k) work.push_back({m, static_cast<uint64_t>(k), {}, {}, 0});
  in_threads(
      work, "methods", options,
      [&](One& one) {
        const double begin = study::thread_seconds();
        one.found = descend(study.problem, out[one.method].method,
                            random_start(study.problem, study.seed, one.number), study.compare->evaluations,
                            one.number, &one.descent);
        one.seconds = study::thread_seconds() - begin;
      },
      [&](One& one) {
        out[one.method].found.push_back(one.found);
        out[one.method].descents.push_back(one.descent);
        out[one.method].seconds += one.seconds;
      });
  return out;
}

}  // namespace cuboct::bond_fit
