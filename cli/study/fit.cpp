// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <memory>

#include "cli/answer.h"
#include "cli/command.h"
#include "cli/programs.h"
#include "cli/study/bond_fit.h"
#include "cli/study/study_command.h"
#include "model/base/clock.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/base/text.h"
#include "model/config/config.h"
#include "study/law_fit/fit_page.h"

namespace cuboct {
namespace {

struct FitOptions {
  std::string study, out;
  int jobs = 0;
  bool anyway = false;
  Answer answer;
};

// The page and the law so far, written anew as the search goes on; at most every few seconds, as gnuplot may
// take longer than a small study's generation.
class Shown {
 public:
  Shown(const fit::FitStudy& study, std::string out) : study_(study), out_(std::move(out)) {}

  void so_far(const fit::Fit& fit) {
    constexpr double kEvery = 5;  // s
    if (begun_ && seconds_since(last_) < kEvery) return;
    all(fit);
    begun_ = true;
    last_ = Clock::now();
  }
  void all(const fit::Fit& fit) {
    write_text(out_ + "/fitted.toml",
               fmt::format("# Law by cuboct fit: the curve is off by {:.3g} %.\n{}", 100 * fit.best->error,
                           fit::fitted_scene(study_, *fit.best)));
    pictured([&] { fit::write_page(study_, fit, out_ + "/page.html"); });
  }
  void charts(const fit::Fit& fit) {
    pictured([&] { fit::write_charts(study_, fit, out_ + "/charts"); });
  }
  bool draws() const { return draws_; }

 private:
  template <typename Draw>
  void pictured(Draw draw) {
    if (!draws_) return;
    try {
      draws_ = drawn("page and no charts", draw);
    } catch (const std::exception&) {
      if (interrupted())
        throw study::Interrupted();  // a signal to all processes of the terminal ends gnuplot too
      throw;
    }
  }

  const fit::FitStudy& study_;
  std::string out_;
  bool begun_ = false, draws_ = true;
  Clock::time_point last_;
};

std::string text_of(fit::End end) {
  switch (end) {
    case fit::End::converged:
      return "converged";
    case fit::End::goal:
      return "reached its goal";
    case fit::End::generations:
      return "ended after its last generation";
  }
  return "";
}

std::string told_text(const fit::FitStudy& study, const fit::Fit& fit) {
  const fit::Parameters p = fit::parameters_of(study, fit.best->sample);
  std::string text = "parameter      value     known within\n";
  for (size_t k = 0; k < fit.free.size(); ++k)
    text += fmt::format("  {:<13}{:<10.4g}{}\n", fit::parameter_names()[fit.free[k]], p[fit.free[k]],
                        fit::uncertainty_text(fit.told.uncertainty[k]));
  std::string blind;
  for (const fit::Combination& c : fit.told.combinations)
    if (c.change < fit.told_within)
      blind += fmt::format("  {:<8} {}\n", fmt::format("{:.2g} %", 100 * c.change),
                           fit::combination_text(c, fit.free));
  if (!blind.empty())
    text += fmt::format(
        "the data cannot tell these apart: a move by the width of the bounds changes the curve by less than "
        "{:.2g} "
        "%\n{}",
        100 * fit.told_within, blind);
  return text;
}

std::string json_of(const fit::FitStudy& study, const fit::Fit& fit, const std::string& out, double wall,
                    bool draws) {
  const fit::Parameters p = fit::parameters_of(study, fit.best->sample);
  std::vector<std::string> parameters, combinations;
  for (size_t k = 0; k < fit::kParameters; ++k) {
    const auto at = static_cast<size_t>(std::ranges::find(fit.free, k) - fit.free.begin());
    parameters.push_back(
        json_object({{"name", json(fit::parameter_names()[k])},
                     {"value", json(p[k])},
                     {"bounds", json(std::vector{study.bounds[k].low, study.bounds[k].high})},
                     {"uncertainty", at < fit.free.size() ? json(fit.told.uncertainty[at]) : "null"}}));
  }
  std::vector<std::string> free;
  for (const size_t k : fit.free) free.push_back(fit::parameter_names()[k]);
  for (const fit::Combination& c : fit.told.combinations)
    combinations.push_back(json_object({{"change", json(c.change)}, {"weights", json(c.weights)}}));
  return json_object({{"directory", json(out)},
                      {"error", json(fit.best->error)},
                      {"cheap_error", json(fit.cheap->error)},
                      {"packing_error", json(fit.packing->error)},
                      {"end", json(text_of(fit.end))},
                      {"generations", std::to_string(fit.best_errors.size())},
                      {"evaluations", std::to_string(fit.evaluations)},
                      {"particle_steps", std::to_string(fit.particle_steps)},
                      {"core_seconds", json(fit.seconds)},
                      {"wall_seconds", json(wall)},
                      {"notes", json(fit.notes)},
                      {"parameters", json_array(parameters)},
                      {"told_within", json(fit.told_within)},
                      {"free", json(free)},
                      {"combinations", json_array(combinations)},
                      {"law", json(out + "/fitted.toml")},
                      {"page", draws ? json(out + "/page.html") : "null"}});
}

// Studies of parameters of a potential have [fit], those of a curve's law have not.
bool is_bond_study(const std::string& path) {
  const auto fit = read_config(path).find("fit");
  return fit && fit->is_table();
}

int fit_study(const FitOptions& options) {
  const Clock::time_point begin = Clock::now();
  catch_interrupts();
  const fit::FitStudy study = fit::read_fit(options.study);
  const std::string out = out_of(options.out, options.study, ".fit");
  return kept_in(out, "cuboct fit", [&] {
    fit::Evaluations evaluations(out, study);
    Shown shown(study, out);
    fit::FitOptions how;
    how.jobs = options.jobs;
    how.see = [&](const fit::Fit& fit) { shown.so_far(fit); };
    const Answer& answer = options.answer;
    const fit::Fit fit = fit::run_fit(study, evaluations, how);
    shown.all(fit);
    shown.charts(fit);
    const double wall = seconds_since(begin);
    answer.say("modulus and strength   {:.3g} % off\neven packing           {:.3g} % off\n",
               100 * fit.cheap->error, 100 * fit.packing->error);
    answer.say("best law               {:.3g} % off\n", 100 * fit.best->error);
    answer.say("search         {} in {} generations\n", text_of(fit.end), fit.best_errors.size());
    answer.say("evaluations    {}, {:.3g} particle-steps, {:.1f} s of one core; this command took {:.1f} s\n",
               fit.evaluations, static_cast<double>(fit.particle_steps), fit.seconds, wall);
    answer.say("{}", told_text(study, fit));
    for (const std::string& note : fit.notes) answer.say("warning: {}\n", note);
    answer.say("law: {}\n", line_text(out + "/fitted.toml"));
    if (shown.draws()) answer.say("page: {}\n", line_text(out + "/page.html"));
    answer.close(json_of(study, fit, out, wall, shown.draws()));
    return 0;
  });
}

}  // namespace

#if !CUBOCT_HAS_BOND_FITS
int fit_bonds(const std::string&, const std::string&, int, const Answer&) {
  refuse_left_out("fit", kBondFits);
}
#endif

void add_fit(Command& app, int& exit_code) {
  auto options = std::make_shared<FitOptions>();
  Command command = add_command(app, "fit");
  add_study_to(command, options->study);
  add_out_to(command, options->out, "study", ".fit");
  add_jobs_to(command, options->jobs, options->anyway, "laws tried at once");
  options->answer.add_to(command);
  command.callback([options, &exit_code] {
    check_workers("--jobs", options->jobs, options->anyway);
    exit_code = is_bond_study(options->study)
                    ? fit_bonds(options->study, options->out, options->jobs, options->answer)
                    : fit_study(*options);
  });
}

}  // namespace cuboct
