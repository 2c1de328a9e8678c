// SPDX-License-Identifier: MIT
#include "study/law_fit/fit_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "model/base/output.h"
#include "model/base/text.h"
#include "model/trace/plot.h"

namespace cuboct::fit {
namespace {

constexpr const char* kAxes =
    "set border 3 lc '#444444'\nset tics nomirror\nset grid lc '#dddddd' lt 1 lw 0.5\nset key above\n";
constexpr const char *kTarget = "#222222", *kFitted = "#1f5fa8", *kStart = "#c8501e", *kFaint = "#bbbbbb";

struct Chart {
  std::string id, title, data, plot;
};

std::string block(const std::string& name, const std::vector<double>& x, const std::vector<double>& y,
                  double x_unit, double y_unit) {
  std::string text = fmt::format("${} << END\n", name);
  for (size_t k = 0; k < x.size(); ++k) text += fmt::format("{:.7g} {:.7g}\n", x[k] / x_unit, y[k] / y_unit);
  return text + "END\n";
}

std::string lines(const char* data, const char* colour, int width, const char* title) {
  return fmt::format("${} with lines lw {} lc '{}' title {}", data, width, colour, gnuplot_label(title));
}

// What stresses are told in.
std::pair<double, const char*> unit_of(const FitStudy& study) {
  if (study::is_reduced(study.test.base)) return {1, "reduced units"};
  const double most = study.target.strength;
  return most >= 1e9 ? std::pair{1e9, "GPa"} : most >= 1e5 ? std::pair{1e6, "MPa"} : std::pair{1.0, "Pa"};
}

Chart curve_chart(const FitStudy& study, const Fit& fit) {
  const auto [unit, name] = unit_of(study);
  const std::vector<double>& strain = study.target.even_strain;
  return {"curve", "Curve",
          block("target", strain, study.target.even_stress, 0.01, unit) +
              block("cheap", strain, fit.cheap->stress, 0.01, unit) +
              block("packing", strain, fit.packing->stress, 0.01, unit) +
              block("best", strain, fit.best->stress, 0.01, unit),
          fmt::format("{}set xlabel 'strain, %'\nset ylabel {}\nplot {}, {}, {}, {}\n", kAxes,
                      gnuplot_label(fmt::format("stress, {}", name)),
                      lines("cheap", kFaint, 1, "modulus and strength"),
                      lines("packing", kStart, 1, "even packing"), lines("target", kTarget, 2, "target"),
                      lines("best", kFitted, 2, "best law"))};
}

// Over the pitch and the height: the pull is what a tensile test sees, so the push is cut off.
Chart law_chart(const FitStudy& study, const Fit& fit) {
  const auto law = [&](const std::vector<double>& sample) {
    return draw(parameters_of(study, sample), study.scale);
  };
  const LawScale& scale = study.scale;
  const LawPoints start = points_of(law(fit.packing->sample)), best = points_of(law(fit.best->sample));
  std::vector<double> r, f;
  const DrawnLaw drawn = law(fit.best->sample);
  for (const ControlPoint& p : drawn.push) r.push_back(p.r), f.push_back(p.f);
  for (const ControlPoint& p : drawn.pull) r.push_back(p.r), f.push_back(p.f);
  const double least = std::min(0.0, *std::ranges::min_element(f)) / scale.height;
  return {
      "law", "Law",
      block("start", start.r, start.f, scale.pitch, scale.height) +
          block("best", best.r, best.f, scale.pitch, scale.height) +
          block("control", r, f, scale.pitch, scale.height),
      fmt::format("{}set xlabel 'distance, pitches'\nset ylabel {}\nset xrange [0.9:{}]\nset yrange [{}:2]\n"
                  "set xzeroaxis lc '#444444' lt 1\nplot {}, {}, $control with points pt 7 ps 0.7 lc '{}' "
                  "title 'control points'\n",
                  kAxes, gnuplot_label(fmt::format("force over {:.4g} N", scale.height)), scale.reach,
                  1.1 * least - 0.2, lines("start", kStart, 1, "even packing"),
                  lines("best", kFitted, 2, "best law"), kFitted)};
}

Chart error_chart(const FitStudy& study, const Fit& fit) {
  std::vector<double> at(fit.errors.size()), generation{0},
      best{std::min(fit.cheap->error, fit.packing->error)};
  std::iota(at.begin(), at.end(), 1.0);
  for (size_t k = 0; k < fit.best_errors.size(); ++k) {
    generation.push_back(static_cast<double>((k + 1) * study.search.samples));
    best.push_back(fit.best_errors[k]);
  }
  return {"error", "Error",
          block("samples", at, fit.errors, 1, 0.01) + block("best", generation, best, 1, 0.01),
          fmt::format(
              "{}set xlabel 'evaluations'\nset ylabel 'error of the curve, %'\nset logscale y\nset xrange "
              "[0:{}]\nset yrange [*<{}:{}]\nplot {}$best with lines lw 2 lc '{}' title 'best so far'\n",
              kAxes, std::max<size_t>(1, fit.errors.size()), 100 * fit.best->error, 200,
              fit.errors.empty()
                  ? ""
                  : fmt::format("$samples with points pt 7 ps 0.3 lc '{}' title 'samples', ", kFaint),
              kFitted)};
}

std::vector<Chart> charts_of(const FitStudy& study, const Fit& fit) {
  return {curve_chart(study, fit), law_chart(study, fit), error_chart(study, fit)};
}

std::string row(const std::string& name, const std::string& value) {
  return fmt::format("<tr><th>{}</th><td>{}</td></tr>\n", html_text(name), html_text(value));
}

std::string parameter_table(const FitStudy& study, const Fit& fit) {
  const Parameters p = parameters_of(study, fit.best->sample);
  std::string text =
      "<h2>Parameters</h2>\n<table>\n<tr><th>name</th><th>value</th><th>bounds</th><th>known "
      "within</th></tr>\n";
  for (size_t k = 0; k < kParameters; ++k) {
    const auto at = std::ranges::find(fit.free, k) - fit.free.begin();
    const bool known = at < std::ssize(fit.free) && !fit.told.uncertainty.empty();
    text += fmt::format("<tr><th>{}</th><td>{:.4g}</td><td>{:g} to {:g}</td><td>{}</td></tr>\n",
                        parameter_names()[k], p[k], study.bounds[k].low, study.bounds[k].high,
                        known ? uncertainty_text(fit.told.uncertainty[static_cast<size_t>(at)]) : "–");
  }
  return text + "</table>\n";
}

std::string told_table(const Fit& fit) {
  if (fit.told.combinations.empty()) return {};
  std::string text = fmt::format(
      "<h2>What the curve tells apart</h2>\n<p>By how much the curve changes, over the target, where a "
      "combination of "
      "parameters moves by the width of its bounds. Below {:.2g} % nothing tells.</p>\n<table>\n",
      100 * fit.told_within);
  for (const Combination& c : fit.told.combinations)
    text += row(fmt::format("{:.2g} %", 100 * c.change), combination_text(c, fit.free));
  return text + "</table>\n";
}

constexpr const char* kHead =
    "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
    "<meta name=\"viewport\" content=\"width=device-width\">\n<title>{0}</title>\n<style>\n"
    "body {{ font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 60rem; margin: 2rem auto; "
    "padding: 0 1rem "
    "}}\nh2 {{ font-size: 1.15rem; border-bottom: 1px solid #ddd }}\nsvg {{ width: 100%; height: auto }}\n"
    "table {{ border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .9rem }}\n"
    "th, td {{ text-align: left; padding: .2rem 1rem .2rem 0; border-bottom: 1px solid #eee }}\n"
    "</style>\n</head>\n<body>\n<h1>{0}</h1>\n";

}  // namespace

std::string uncertainty_text(double uncertainty) {
  return uncertainty >= kUnknown ? "not at all" : fmt::format("{:.2g} % of its bounds", 100 * uncertainty);
}

std::string combination_text(const Combination& combination, const std::vector<size_t>& free) {
  constexpr double kShown = 0.2;
  std::vector<size_t> order(free.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, std::greater(), [&](size_t k) { return std::abs(combination.weights[k]); });
  std::string text;
  for (const size_t k : order) {
    const double weight = combination.weights[k];
    if (std::abs(weight) < kShown) break;
    text += fmt::format("{}{:.2f} {}",
                        text.empty() ? ""
                        : weight < 0 ? " - "
                                     : " + ",
                        std::abs(weight), parameter_names()[free[k]]);
  }
  return text;
}

void write_page(const FitStudy& study, const Fit& fit, const std::string& path) {
  std::string text = fmt::format(kHead, html_text(study.title.empty() ? study.path : study.title));
  text += "<table>\n" + row("target", study.target.source) +
          row("error of the curve", fmt::format("{:.3g} %", 100 * fit.best->error)) +
          row("of the law of modulus and strength", fmt::format("{:.3g} %", 100 * fit.cheap->error)) +
          row("of the evenly deformed packing's law", fmt::format("{:.3g} %", 100 * fit.packing->error)) +
          row("evaluations", std::to_string(fit.evaluations)) +
          row("particle-steps", fmt::format("{:.3g}", static_cast<double>(fit.particle_steps))) +
          "</table>\n";
  for (const std::string& note : fit.notes) text += "<p>" + html_text(note) + "</p>\n";
  for (const Chart& chart : charts_of(study, fit)) {
    const std::string svg = gnuplot(chart.data, chart.plot, "svg", 800, 420);
    text += fmt::format("<h2>{}</h2>\n{}\n", chart.title, svg.substr(svg.find("<svg")));
  }
  text += parameter_table(study, fit) + told_table(fit) + "</body>\n</html>\n";
  write_text(path, text);
}

std::vector<std::string> write_charts(const FitStudy& study, const Fit& fit, const std::string& directory) {
  make_directory(directory);
  std::vector<std::string> files;
  for (const Chart& chart : charts_of(study, fit))
    for (const char* kind : {"png", "svg"}) {
      files.push_back(fmt::format("{}.{}", chart.id, kind));
      draw_plot(directory + "/" + files.back(), chart.data, chart.plot, 800, 480);
    }
  return files;
}

}  // namespace cuboct::fit
