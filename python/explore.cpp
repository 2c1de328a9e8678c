// SPDX-License-Identifier: MIT
#include "python/explore.h"

#include "model/base/error.h"
#include "python/sources.h"

#ifdef CUBOCT_HAS_STUDIES
#include <algorithm>
#include <functional>

#include "model/base/directory_lock.h"
#include "python/catch_interrupt.h"
#include "study/report/table.h"
#include "study/sweep/interrupted.h"
#include "study/sweep/measures.h"
#include "study/sweep/runner.h"
#include "study/sweep/series.h"
#endif

namespace cuboct::python {

#ifdef CUBOCT_HAS_STUDIES
namespace {

using study::Outcome, study::Results;

class Columns {
 public:
  explicit Columns(const Results& results) : outcomes_(results.outcomes) {}

  void numbers(const std::string& name, const std::function<double(const Outcome&)>& of) {
    Column& column = all.emplace_back();
    column.name = name;
    for (const Outcome& outcome : outcomes_) column.numbers.push_back(of(outcome));
  }
  void texts(const std::string& name, const std::function<std::string(const Outcome&)>& of) {
    Column& column = all.emplace_back();
    column.name = name;
    for (const Outcome& outcome : outcomes_) column.texts.push_back(of(outcome));
  }
  std::vector<Column> all;

 private:
  const std::vector<Outcome>& outcomes_;
};

// The keys of scene or arch that some point sets, in the order in which they come.
std::vector<std::string> keys_of(const Results& results, std::vector<Change> study::Settings::*changes) {
  std::vector<std::string> keys;
  for (const Outcome& outcome : results.outcomes)
    for (const Change& change : outcome.settings.*changes)
      if (std::ranges::find(keys, change.key) == keys.end()) keys.push_back(change.key);
  return keys;
}

void add_settings(Columns& columns, const Results& results, std::vector<Change> study::Settings::*changes,
                  const std::string& prefix) {
  for (const std::string& key : keys_of(results, changes))
    columns.texts(prefix + key, [&](const Outcome& outcome) {
      const auto& list = outcome.settings.*changes;
      const auto at = std::ranges::find(list, key, &Change::key);
      std::string value = at == list.end() ? "" : at->value;
      if (value.size() >= 2 && value.front() == '"' && value.back() == '"')
        value = value.substr(1, value.size() - 2);
      return value;
    });
}

std::vector<Column> columns_of(const Results& results) {
  Columns columns(results);
  columns.texts("settings", [](auto& o) { return study::short_name(o.settings); });
  columns.texts("engine", [](auto& o) { return o.settings.engine; });
  columns.texts("arithmetic", [](auto& o) { return study::name_of(o.settings.arithmetic); });
  add_settings(columns, results, &study::Settings::scene, "");
  add_settings(columns, results, &study::Settings::arch, "arch.");
  columns.texts("status", [](auto& o) { return study::label(o.status); });
  columns.texts("why", [](auto& o) { return o.why; });
  columns.numbers("dt", [](auto& o) { return o.dt; });
  columns.numbers("particles", [](auto& o) { return o.particles; });
  columns.numbers("steps", [](auto& o) { return static_cast<double>(o.steps); });
  for (size_t k = 0; k < results.figure_names.size(); ++k)
    columns.numbers(results.figure_names[k], [k](auto& o) {
      return k < o.errors.values.size() ? o.errors.values[k] : study::kNotMeasured;
    });
  for (const study::Measure& measure : study::error_measures(results))
    columns.numbers("error." + measure.id, measure.value);
  columns.numbers("cost", [](auto& o) { return o.cost; });
  columns.numbers("particle_steps_per_second", [](auto& o) { return o.speed.particle_steps; });
  columns.numbers("simulated_seconds_per_second", [](auto& o) { return o.speed.simulated_seconds; });
  columns.texts("machine", [](auto& o) { return o.measured_on(); });
  return std::move(columns.all);
}

}  // namespace

Table explore(const ExploreAsked& asked) {
  const study::Study plan = study::read_study(asked.study);
  if (plan.points.empty())
    throw InputError(asked.study + ": no [[sweep]], so there are no points",
                     "cuboct explore --error asks its [search]");
  const DirectoryLock lock(asked.out, "cuboct explore");
  study::Store store(asked.out + "/results.db", plan);
  const CatchForHost catching;
  study::Runner runner(plan, store, {.jobs = asked.jobs, .speed = asked.speed});
  try {
    runner.run();
  } catch (const study::Interrupted&) {
    throw Interrupted();
  }
  return {columns_of(store.results()), runner.left_out()};
}

#else

Table explore(const ExploreAsked&) {
  throw InputError("explore: this cuboct was built without studies", "configure with -DCUBOCT_STUDIES=ON");
}

#endif

}  // namespace cuboct::python
