// SPDX-License-Identifier: MIT
#include "cli/study/budget.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <vector>

#include "model/base/error.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/base/spelling.h"
#include "model/base/text.h"
#include "study/search/budget.h"

namespace cuboct {
namespace {

using study::Axis;
using study::BudgetAnswer;
using study::Spending;

std::string percent(double error) { return std::isnan(error) ? "-" : fmt::format("{:.3g} %", 100 * error); }
std::string signed_percent(double error) {
  return std::isnan(error) ? "-" : fmt::format("{:+.3g} %", 100 * error);
}

std::string label(const BudgetAnswer& answer, size_t axis, const study::Notches& at) {
  return answer.axes[axis].labels[static_cast<size_t>(at[axis])];
}

// Why a point that is one notch cheaper does not do.
std::string verdict(const Spending& s, double budget) {
  if (std::isnan(s.error)) return "cannot be run";
  if (std::abs(s.error) > budget) return percent(std::abs(s.error));
  if (std::isinf(s.sum)) return percent(std::abs(s.error)) + ", but a finer notch cannot be run";
  return fmt::format("{}, but its parts make {}", percent(std::abs(s.error)), percent(s.sum));
}

// Rows of text in columns, the last one free.
std::string in_columns(const std::vector<std::vector<std::string>>& rows) {
  std::vector<size_t> width;
  for (const auto& row : rows)
    for (size_t k = 0; k < row.size(); ++k) {
      if (k == width.size()) width.push_back(0);
      width[k] = std::max(width[k], line_text(row[k]).size());
    }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (size_t k = 0; k < row.size(); ++k) line += fmt::format("{:<{}}", line_text(row[k]), width[k] + 2);
    text += line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
  }
  return text;
}

bool is_used(const BudgetAnswer& answer, size_t axis) {
  return study::matters(answer.axes, answer.result.best.at, axis);
}

std::string table(const BudgetAnswer& answer, double budget) {
  const study::SearchResult& result = answer.result;
  std::vector<std::vector<std::string>> rows{{"setting", "chosen", "its part", "one notch cheaper"}};
  for (size_t a = 0; a < answer.axes.size(); ++a) {
    if (!is_used(answer, a)) {
      rows.push_back({answer.axes[a].name, "not used"});
      continue;
    }
    std::string cheaper = "there is none";
    for (const auto& c : result.cheaper)
      if (c.axis == a)
        cheaper = fmt::format("{}: {}", label(answer, a, c.spending.at), verdict(c.spending, budget));
    rows.push_back(
        {answer.axes[a].name, label(answer, a, result.best.at), percent(result.best.parts.at(a)), cheaper});
  }
  rows.push_back({"finest settings", "", percent(std::abs(result.reference_error))});
  rows.push_back({"sum", "", percent(result.best.sum)});
  std::string text = in_columns(rows);
  for (size_t k = 0; k < result.cheaper.size(); ++k)
    if (!answer.why[k].empty()) {
      const size_t axis = result.cheaper[k].axis;
      text += fmt::format("{} {}: {}\n", answer.axes[axis].name,
                          label(answer, axis, result.cheaper[k].spending.at), answer.why[k]);
    }
  return text;
}

std::string settings_of(const BudgetAnswer& answer, const study::Notches& at) {
  std::string text;
  for (size_t a = 0; a < answer.axes.size(); ++a)
    if (is_used(answer, a))
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", answer.axes[a].name, label(answer, a, at));
  return text;
}

std::string command_of(const study::Settings& settings, const std::string& out) {
  if (settings.arithmetic == study::Arithmetic::fixed)
    return fmt::format("cuboct run {} --arch {}", shell_word(out + "/cheapest.toml"),
                       shell_word(out + "/cheapest_arch.toml"));
  return fmt::format("cuboct run {} --engine reference{}{}", shell_word(out + "/cheapest.toml"),
                     settings.arithmetic == study::Arithmetic::float32 ? " --precision float" : "",
                     settings.integrator == Integrator::velocity_verlet ? " --integrator verlet" : "");
}

void print_failure(const Answer& told, const BudgetAnswer& answer, const std::string& figure,
                   const std::string& error) {
  const study::SearchResult& result = answer.result;
  told.say("no settings of [search] keep '{}' within {}\n", line_text(figure), line_text(error));
  told.say("the best: {} with {}\n",
           std::isnan(result.best.error) ? "cannot be run (" + line_text(answer.chosen.why) + ")"
                                         : signed_percent(result.best.error),
           line_text(settings_of(answer, result.best.at)));
  if (result.accident)
    told.say("  by accident: with a notch finer next to it the error is above the budget\n");
  const double size = std::abs(result.best.error);
  if (result.limit < 0)
    told.say("what limits cannot be told: no setting has another notch that runs\n");
  else if (result.limit_change < 0.1 * size)
    told.say(
        "what limits is none of these settings: a notch of {}, which matters most, changes the error by {}\n",
        line_text(answer.axes[static_cast<size_t>(result.limit)].name), percent(result.limit_change));
  else
    told.say("what limits is {}: the notch next to it still changes the error by {}\n",
             line_text(answer.axes[static_cast<size_t>(result.limit)].name), percent(result.limit_change));
}

// What was chosen, or the best that does not keep the budget, for scripts.
std::string json_of(const BudgetAnswer& answer, const std::string& figure, const std::string& unit,
                    double truth, const std::string& command) {
  const study::SearchResult& result = answer.result;
  std::vector<std::string> settings;
  for (size_t a = 0; a < answer.axes.size(); ++a)
    if (is_used(answer, a))
      settings.push_back(json_object(
          {{"name", json(answer.axes[a].name)}, {"value", json(label(answer, a, result.best.at))}}));
  return json_object({{"figure", json(figure)},
                      {"unit", json(unit)},
                      {"truth", json(truth)},
                      {"met", json(result.met)},
                      {"value", json(answer.chosen.value)},
                      {"error", json(answer.chosen.error)},
                      {"cost", json(answer.chosen.cost)},
                      {"standard_cost", json(answer.standard.cost)},
                      {"dt", json(answer.chosen.dt)},
                      {"measured", std::to_string(result.measured)},
                      {"settings", json_array(settings)},
                      {"command", command.empty() ? "null" : json(command)}});
}

}  // namespace

double read_error_budget(const std::string& text) {
  const bool percents = text.ends_with('%');
  const std::string digits = percents ? text.substr(0, text.size() - 1) : text;
  double value = 0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (code != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value))
    throw InputError(fmt::format("'{}' is no error", text),
                     "a percentage or a share: --error 1% or --error 0.01");
  if (percents) value /= 100;
  if (!(value > 0 && value < 1))
    throw InputError(
        fmt::format("an error of '{}' is out of range: above 0 and below 100%", text),
        text == "1" ? "did you mean '1%'?" : "a percentage or a share: --error 1% or --error 0.01");
  return value;
}

size_t figure_named(const study::Study& study, const std::string& name) {
  std::vector<std::string> names;
  for (const Figure& figure : study.figures) names.push_back(figure.name);
  if (names.empty()) throw InputError(fmt::format("{}: no [[figure]] whose error could be held", study.path));
  if (name.empty() && names.size() > 1)
    throw InputError(fmt::format("{}: which figure?", study.path), "--figure " + list_of(names));
  for (size_t k = 0; k < names.size(); ++k)
    if (name.empty() || names[k] == name) return k;
  const std::string near = did_you_mean(name, names);
  throw InputError(fmt::format("{}: no figure '{}'", study.path, name),
                   near.empty() ? "known: " + list_of(names) : near);
}

void check_budget(const study::Study& study, const std::string& error, const std::string& figure) {
  read_error_budget(error);
  figure_named(study, figure);
  if (study.search.empty())
    throw InputError(fmt::format("{}: no [search] to choose from", study.path),
                     "list settings from cheap to dear, e.g. [search] dt_safety = [0.8, 0.4, 0.2]");
}

int run_budget(const study::Study& study, const study::Truth& truth, const BudgetOptions& options,
               const Answer& told) {
  study::BudgetQuestion question;
  question.budget = read_error_budget(options.error);
  question.figure = figure_named(study, options.figure);
  question.jobs = options.jobs;
  study::Store store(options.out + "/search.db", study);
  const BudgetAnswer answer = study::keep_budget(study, truth, store, question);
  const std::string& figure = study.figures[question.figure].name;
  const study::SearchResult& result = answer.result;
  const std::string& unit = study.figure_units[question.figure];
  told.say("figure '{}': {:.6g} {} by the truth\n", line_text(figure), truth.figures[question.figure], unit);
  if (!result.met) {
    print_failure(told, answer, figure, options.error);
    told.close(json_of(answer, figure, unit, truth.figures[question.figure], ""));
    return 1;
  }
  told.say("the cheapest settings within {}\n\n{}\n", line_text(options.error),
           block_text(table(answer, question.budget)));
  told.say("as measured: {:.6g} {}, {}\n", answer.chosen.value, unit, signed_percent(answer.chosen.error));
  told.say("cost: {:.3g} transistors x pairs/s, {:.3g} of that of the study's own settings ({:.3g}, {})\n",
           answer.chosen.cost, answer.chosen.cost / answer.standard.cost, answer.standard.cost,
           std::isnan(answer.standard.error) ? line_text(answer.standard.why)
                                             : signed_percent(answer.standard.error));
  told.say("time step: {:.6g} s, {} to a sample\n", answer.chosen.dt,
           truth.grid.steps_per_sample(answer.chosen.dt));
  told.say("points: {} of {}\n", result.measured, [&] {
    size_t all = 1;
    for (const Axis& axis : answer.axes) all *= axis.sets.size();
    return all;
  }());
  study::Written texts = study::written(study, truth, answer.chosen.settings);
  const std::string head =
      line_text(fmt::format("# Chosen by `cuboct explore {} --error {}{}`: {} of '{}' by parts, cost {:.3g}.",
                            study.path, options.error,
                            options.figure.empty() ? "" : " --figure " + options.figure,
                            percent(result.best.sum), figure, answer.chosen.cost)) +
      "\n";
  write_text(options.out + "/cheapest.toml", head + texts.scene);
  write_text(options.out + "/cheapest_arch.toml", head + texts.arch);
  const std::string command = command_of(answer.chosen.settings, options.out);
  told.say("{}\n", line_text(command));
  told.close(json_of(answer, figure, unit, truth.figures[question.figure], command));
  return 0;
}

}  // namespace cuboct
