// SPDX-License-Identifier: MIT
#include "study/sweep/runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <set>

#include "model/base/error.h"
#include "model/base/resources.h"
#include "study/sweep/gpu_program.h"
#include "study/sweep/measure_errors.h"
#include "study/sweep/measure_run.h"
#include "study/sweep/measure_speed.h"
#include "study/sweep/work.h"

namespace cuboct::study {
namespace {

// The name under which the store keeps a truth that is not refined to its end; no scene has it.
constexpr const char* kBegun = "(begun)";

}  // namespace

Runner::Runner(const Study& study, Store& store, const RunnerOptions& options)
    : study_(study), store_(store), options_(options) {
  most_gpu_jobs_ = options_.jobs > 0 ? options_.jobs : gpu_runs_at_once();
  if (options_.jobs <= 0) options_.jobs = usable_cores();
}

const Truth& Runner::truth() {
  const auto added = truths_.try_emplace("");
  Truth& truth = added.first->second;
  if (!added.second) return truth;
  try {
    if (auto kept = store_.truth(""); kept && kept->figures.size() == study_.figures.size())
      return truth = std::move(*kept);
    const auto compute = [&] {
      truth = make_truth(study_, options_.jobs, store_.truth(kBegun).value_or(Truth()),
                         [&](const Truth& so_far) { store_.put_truth(kBegun, so_far); });
    };
    work_off({{1, compute}}, 1, "the run in doubles", options_.progress);
    store_.put_truth(truth);
    store_.drop_truth(kBegun);
  } catch (...) {
    truths_.erase(added.first);
    throw;
  }
  return truth;
}

// Where the settings' own scene has no run in doubles, the point will be refused for the same reason: any
// truth does.
const Truth& Runner::truth_of(const Settings& settings) {
  const auto found = truths_.find(physics_key(settings));
  return found == truths_.end() ? truths_.at("") : found->second;
}

void Runner::make_truths(const std::vector<Settings>& points) {
  const Truth& own = truth();
  std::map<std::string, Settings> missing;
  for (const Settings& settings : points) {
    const std::string key = physics_key(settings);
    if (truths_.contains(key) || no_truth_.contains(key) || missing.contains(key)) continue;
    if (auto kept = store_.truth(key))
      truths_[key] = std::move(*kept);
    else
      missing[key] = settings;
  }
  std::mutex mutex;
  std::vector<Piece> pieces;
  for (const auto& [key, settings] : missing)
    pieces.push_back({1, [&, key = key, settings = settings] {
                        try {
                          Truth truth = make_own_truth(study_, own, settings);
                          store_.put_truth(key, truth);
                          const std::lock_guard guard(mutex);
                          truths_[key] = std::move(truth);
                        } catch (const InputError&) {
                          const std::lock_guard guard(mutex);
                          no_truth_.insert(key);
                        }
                      }});
  work_off(std::move(pieces), options_.jobs, "other scenes in doubles", options_.progress);
}

std::vector<Outcome> Runner::errors_of(const std::vector<Settings>& points) {
  std::vector<Settings> missing;
  std::set<std::string> known;
  for (const Settings& settings : points)
    if (!store_.has_errors(settings) && known.insert(settings.numbers_key()).second)
      missing.push_back(settings);
  if (!missing.empty()) {
    const bool some_on_gpu = std::ranges::any_of(missing, on_gpu);
    if (some_on_gpu && !has_gpu()) throw InputError(no_gpu_);
    make_truths(missing);
    std::vector<Piece> here, there;
    std::unique_ptr<GpuRuns> gpu;
    for (const Settings& settings : missing)
      (on_gpu(settings) ? there : here).push_back({size_of_run(study_, settings), [&, settings] {
                                                     Outcome outcome = measure_errors(
                                                         study_, truths_.at(""), truth_of(settings), settings,
                                                         on_gpu(settings) ? gpu.get() : nullptr);
                                                     if (on_gpu(settings)) outcome.machine = *gpu_;
                                                     store_.put_errors(outcome);
                                                   }});
    work_off(std::move(here), options_.jobs, "points", options_.progress);
    if (!there.empty()) {
      gpu_jobs_ = std::min(most_gpu_jobs_, static_cast<int>(there.size()));
      gpu = std::make_unique<GpuRuns>(gpu_jobs_);
      work_off(std::move(there), gpu_jobs_, "points on the GPU", options_.progress);
    }
  }
  std::vector<Outcome> outcomes;
  for (const Settings& settings : points) outcomes.push_back(*store_.errors(settings));
  return outcomes;
}

void Runner::measure_speeds(const std::vector<Settings>& points) {
  std::vector<Piece> pieces;
  for (const Settings& settings : points)
    if (!store_.has_speed(settings) && (!on_gpu(settings) || has_gpu()))
      pieces.push_back({1, [&] {
                          Speed speed = measure_speed(study_, settings);
                          if (on_gpu(settings)) speed.machine = *gpu_;
                          store_.put_speed(settings, speed);
                        }});
  work_off(std::move(pieces), 1, "speeds", options_.progress);
}

bool Runner::has_gpu() {
  if (!gpu_) gpu_ = find_gpu(no_gpu_);
  return !gpu_->empty();
}

void Runner::run() {
  truth();
  const auto lacks = [&](const Settings& settings) {
    return on_gpu(settings) &&
           (!store_.has_errors(settings) || (options_.speed && !store_.has_speed(settings)));
  };
  std::vector<Settings> points = study_.points;
  const auto lacking = std::ranges::count_if(points, lacks);
  if (lacking > 0 && !has_gpu()) {
    left_out_ =
        fmt::format("{} point{} of the gpu engine left out: {}", lacking, lacking == 1 ? "" : "s", no_gpu_);
    std::erase_if(points, [&](const Settings& s) { return on_gpu(s) && !store_.has_errors(s); });
  }
  errors_of(points);
  if (options_.speed) measure_speeds(points);
}

}  // namespace cuboct::study
