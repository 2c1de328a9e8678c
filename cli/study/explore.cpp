// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>

#include "cli/answer.h"
#include "cli/command.h"
#include "cli/programs.h"
#include "cli/run/estimate.h"
#include "cli/study/budget.h"
#include "cli/study/explore_machines.h"
#include "cli/study/study_command.h"
#include "hw/engine/scene_engine.h"
#include "model/base/json.h"
#include "model/base/resources.h"
#include "model/base/text.h"
#include "study/machines/machine_study.h"
#include "study/report/page.h"
#include "study/report/table.h"
#include "study/sweep/measure_run.h"
#include "study/sweep/runner.h"

namespace cuboct {
namespace {

struct ExploreOptions {
  std::string study, out, error, figure;
  std::vector<std::string> add;
  int jobs = 0;
  bool no_speed = false;
  bool best = false, confirm = false, anyway = false;
  std::string emit;
  Answer answer;
};

// Charts need gnuplot; the page does not, but a charting library in the build.
void report(const study::Results& results, const std::string& out, const std::string& left_out,
            const Answer& answer) {
  answer.say("{}\n{}", block_text(study::describe(results.truth, results)),
             block_text(study::cheapest_per_decade(results)));
  size_t refused = 0, unstable = 0;
  for (const study::Outcome& outcome : results.outcomes) {
    refused += outcome.status == study::Status::refused;
    unstable += outcome.status == study::Status::unstable;
  }
  answer.say("{} points, {} refused, {} unstable\n", results.outcomes.size(), refused, unstable);
  const std::string page = out + "/page.html";
  if (study::has_page()) {
    study::write_page(results, page);
    answer.say("page: {}\n", line_text(page));
  } else {
    fmt::print(stderr,
               "no page: this cuboct was built without the npm packages of study/report/web\n"
               "  hint: tools/setup fetches them; then configure and build again\n");
  }
  std::vector<std::string> charts;
  if (drawn("charts", [&] { charts = study::write_charts(results, out + "/charts"); }))
    answer.say("charts: {} in {}/charts\n", charts.size(), line_text(out));
  answer.close(json_object({{"directory", json(out)},
                            {"points", std::to_string(results.outcomes.size())},
                            {"refused", std::to_string(refused)},
                            {"unstable", std::to_string(unstable)},
                            {"left_out", left_out.empty() ? "null" : json(left_out)},
                            {"best", study::cheapest_json(results)},
                            {"page", study::has_page() ? json(page) : "null"},
                            {"charts", json(charts)}}));
}

int explore_machines_of(const ExploreOptions& options) {
  if (!options.error.empty() || !options.add.empty() || options.no_speed)
    throw InputError("--error, --figure, --add and --no-speed are of studies of errors",
                     "a study of machines has constraints = [\"error <= 1%\"]");
  const bool best = options.best || !options.emit.empty();
  return explore_machines({options.study, out_of(options.out, options.study, ".study"), options.jobs, best,
                           options.confirm, options.emit},
                          options.answer);
}

// Points that are computed at once hold their runs at once; `points` of them, with the study's own settings.
void check_points(const ExploreOptions& options, const study::Study& study, size_t points) {
  if (options.anyway) return;
  Estimate of_one;
  try {
    const study::Case c = study::resolve(study.base, {});
    RunSize size;
    size.engine = engine_for(c.scene), size.steps = c.scene.steps, size.threads = 1, size.hash_every = 0;
    of_one = estimate(c.scene, scene_plan_of(c.scene, c.arch, size.engine, false), size);
  } catch (const InputError&) {
    return;  // the study's own settings make no run; its points say so, each by itself
  }
  const double jobs = std::min<double>(options.jobs > 0 ? options.jobs : usable_cores(), points);
  check_memory(fmt::format("{} points at once", jobs), jobs * of_one.memory,
               "--jobs 1, a larger pitch or a smaller geometry", false);
  check_time(fmt::format("{} points", points),
             static_cast<double>(points) * of_one.seconds / std::min<double>(jobs, usable_cores()),
             "fewer points or a shorter run", false);
}

int explore(const ExploreOptions& options) {
  check_workers("--jobs", options.jobs, options.anyway);
  if (study::is_machine_study(options.study)) return explore_machines_of(options);
  if (options.best || options.confirm || !options.emit.empty())
    throw InputError("--best, --confirm and --emit are of studies of machines",
                     "give the file a [[machines]]");
  const study::Study study = study::read_study(options.study);
  const bool budget = !options.error.empty();
  if (budget) check_budget(study, options.error, options.figure);
  if (!budget && !options.figure.empty()) throw InputError("--figure names the figure of --error E");
  if (!budget && study.points.empty())
    throw InputError(fmt::format("{}: no [[sweep]], so there are no points", options.study),
                     "--error asks its [search]");
  if (!budget) check_points(options, study, study.points.size());
  const std::string out = out_of(options.out, options.study, ".study");
  for (const std::string& file : options.add) study::Store::check(file, study);
  return kept_in(out, "cuboct explore", [&] {
    study::Store store(out + "/results.db", study);
    for (const std::string& file : options.add)
      options.answer.say("{} rows from {}\n", store.add(file), line_text(file));
    study::Runner runner(study, store, {.jobs = options.jobs, .speed = !options.no_speed});
    if (budget)
      return run_budget(study, runner.truth(), {options.error, options.figure, out, options.jobs},
                        options.answer);
    runner.run();
    if (runner.gpu_jobs() > 0) options.answer.say("points on the GPU: {} at once\n", runner.gpu_jobs());
    if (!runner.left_out().empty())
      options.answer.say("{}\n  hint: --add FILE takes them from another machine's results.db\n",
                         line_text(runner.left_out()));
    report(store.results(), out, runner.left_out(), options.answer);
    return 0;
  });
}

}  // namespace

void add_explore(Command& app, int& exit_code) {
  auto [command, options] = add_command<ExploreOptions>(app, "explore", exit_code, explore);
  add_study_to(command, options->study);
  add_out_to(command, options->out, "study", ".study");
  add_jobs_to(command, options->jobs, options->anyway, "points computed at once");
  command.option("--add", options->add, "results of the same study from elsewhere", "FILE");
  command.option(
      "--error", options->error,
      "instead: the cheapest settings of [search] that keep a figure's error within E, as 1% or 0.01", "E");
  command.option("--figure", options->figure, "the figure of --error", "NAME");
  command.flag("--no-speed", options->no_speed, "measure errors alone");
  command.flag(
      "--best", options->best,
      "of a study of machines: choose the one that keeps all constraints and has the least of what is "
      "minimised");
  command.option("--emit", options->emit, "write the RTL project of that machine", "DIR");
  command.flag("--confirm", options->confirm, "synthesise the machine before it is chosen");
  options->answer.add_to(command);
}

}  // namespace cuboct
