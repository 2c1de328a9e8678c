// SPDX-License-Identifier: MIT
#include "study/runner.h"

#include <algorithm>
#include <mutex>
#include <set>
#include <thread>

#include "model/error.h"
#include "study/measure_errors.h"
#include "study/measure_run.h"
#include "study/measure_speed.h"
#include "study/work.h"

namespace cuboct::study {
namespace {

// The name under which the store keeps a truth that is not refined to its end; no scene has it.
constexpr const char* kBegun = "(begun)";

}  // namespace

Runner::Runner(const Study& study, Store& store, const RunnerOptions& options)
    : study_(study), store_(store), options_(options) {
  if (options_.jobs <= 0)
    options_.jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

const Truth& Runner::truth() {
  const auto [at, fresh] = truths_.try_emplace("");
  if (!fresh) return at->second;
  try {
    if (auto kept = store_.truth("")) return at->second = std::move(*kept);
    const auto compute = [&] {
      at->second = make_truth(study_, options_.jobs, store_.truth(kBegun).value_or(Truth()),
                              [&](const Truth& so_far) { store_.put_truth(kBegun, so_far); });
    };
    work_off({{1, compute}}, 1, "the run in doubles", options_.progress);
    store_.put_truth(at->second);
    store_.drop_truth(kBegun);
  } catch (...) {
    truths_.erase(at);
    throw;
  }
  return at->second;
}

// Where the settings' own scene has no run in doubles, the point will be refused for the same reason: any truth
// does.
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
    if (!store_.has_errors(settings) && known.insert(settings.numbers_key()).second) missing.push_back(settings);
  if (!missing.empty()) {
    make_truths(missing);
    std::vector<Piece> pieces;
    for (const Settings& settings : missing)
      pieces.push_back({size_of_run(study_, settings), [&, settings] {
                          store_.put_errors(
                              measure_errors(study_, truths_.at(""), truth_of(settings), settings));
                        }});
    work_off(std::move(pieces), options_.jobs, "points", options_.progress);
  }
  std::vector<Outcome> outcomes;
  for (const Settings& settings : points) outcomes.push_back(*store_.errors(settings));
  return outcomes;
}

void Runner::measure_speeds() {
  std::vector<Piece> pieces;
  for (const Settings& settings : study_.points)
    if (!store_.has_speed(settings))
      pieces.push_back({1, [&] { store_.put_speed(settings, measure_speed(study_, settings)); }});
  work_off(std::move(pieces), 1, "speeds", options_.progress);
}

void Runner::run() {
  truth();
  errors_of(study_.points);
  if (options_.speed) measure_speeds();
}

}  // namespace cuboct::study
