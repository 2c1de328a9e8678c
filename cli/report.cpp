// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>

#include "cli/check.h"
#include "cli/outputs.h"
#include "cli/plot.h"
#include "cli/summary.h"
#include "model/base64.h"
#include "model/compare.h"
#include "model/directory_lock.h"
#include "model/output.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

const Curve* find_curve(const Trace& trace, const std::string& ending) {
  for (const Curve& curve : trace.curves)
    if (curve.name.ends_with(ending) && curve.value.size() > 1) return &curve;
  return nullptr;
}

// The stress-strain curve of a trace, where it has one.
struct Tension {
  const Curve *strain = nullptr, *stress = nullptr;
  size_t peak = 0;  // sample of the largest stress
};
std::optional<Tension> tension_of(const Trace& trace) {
  Tension tension{find_curve(trace, ".strain"), find_curve(trace, ".stress"), 0};
  if (!tension.strain || !tension.stress) return std::nullopt;
  const auto& value = tension.stress->value;
  tension.peak = static_cast<size_t>(std::max_element(value.begin(), value.end()) - value.begin());
  return tension;
}

size_t nearest_frame(const Trace& trace, uint64_t step) {
  size_t best = 0;
  const auto distance = [&](size_t k) {
    return trace.frames[k].step > step ? trace.frames[k].step - step : step - trace.frames[k].step;
  };
  for (size_t k = 1; k < trace.frames.size(); ++k)
    if (distance(k) < distance(best)) best = k;
  return best;
}

// Four frames that tell the story: the start, the largest stress, a quarter of the way from there to the end,
// the end; where those fall together or no stress was measured, evenly spread ones.
std::vector<size_t> choose_frames(const Trace& trace) {
  const size_t last = trace.frames.size() - 1;
  std::set<size_t> chosen{0, last};
  if (const auto tension = tension_of(trace)) {
    const size_t peak = nearest_frame(trace, tension->stress->step[tension->peak]);
    chosen.insert(peak);
    chosen.insert(peak + (last - peak) / 4);
  }
  for (size_t k = 1; k <= 2; ++k)
    if (chosen.size() < 4) chosen.insert(k * last / 3);
  return {chosen.begin(), chosen.end()};
}

std::string pictures(const Loaded& loaded, const Trace& trace, const std::vector<size_t>& chosen) {
  const Plan& plan = loaded.setup.plan;
  const auto positions = [&](const State& state) {
    return to_real(state, plan.rule, plan.lattice, plan.origin).x;
  };
  const double radius = frame_style(loaded.scene).radius;

  // Of one frame at a time only the strains are kept: there may be millions of particles.
  std::vector<std::vector<float>> strains;
  Vec3 lower = Vec3::Constant(INFINITY), upper = -lower;
  {
    const StrainMeter meter = strain_meter(loaded.scene, positions(loaded.setup.initial));
    for (const size_t k : chosen) {
      const std::vector<Vec3> x = positions(trace.frames[k]);
      for (const Vec3& one : x) lower = lower.cwiseMin(one), upper = upper.cwiseMax(one);
      const std::vector<double> strain = meter.axial(x, strain_axis(loaded.scene));
      strains.emplace_back(strain.begin(), strain.end());
    }
  }
  // The scale ends at the 98th percentile: the few pairs that a crack parts would else take all of it.
  std::vector<float> all;
  for (const auto& strain : strains) all.insert(all.end(), strain.begin(), strain.end());
  const auto end = all.begin() + static_cast<ptrdiff_t>(all.size() * 98 / 100);
  std::nth_element(all.begin(), end, all.end());
  const double low = 0, high = std::max(double{*end}, 1e-4);
  all = {};
  int height = 0;
  constexpr int kWidth = 1100;
  const View view = view_of(lower - Vec3::Constant(radius), upper + Vec3::Constant(radius), kWidth, height);
  std::vector<Image> images;
  std::vector<std::string> labels;
  for (size_t n = 0; n < chosen.size(); ++n) {
    const State& state = trace.frames[chosen[n]];
    std::vector<Colour> colours;
    colours.reserve(strains[n].size());
    for (const float strain : strains[n]) colours.push_back(viridis((strain - low) / (high - low)));
    images.push_back(render(positions(state), colours, radius, view, kWidth, height));
    labels.push_back(
        fmt::format("step {}    t = {:.4g} s", state.step, static_cast<double>(state.step) * plan.rule.dt));
  }
  const std::string png = plot_pictures(
      images, labels, fmt::format("axial strain along {}", "xyz"[strain_axis(loaded.scene)]), low, high);
  return base64(png.data(), png.size());
}

// Where the frame's step falls on a curve.
size_t sample_at(const Curve& curve, uint64_t step) {
  return static_cast<size_t>(
      std::min<ptrdiff_t>(std::lower_bound(curve.step.begin(), curve.step.end(), step) - curve.step.begin(),
                          static_cast<ptrdiff_t>(curve.step.size()) - 1));
}

std::string curve_section(const Loaded& loaded, const Trace& trace, const std::vector<size_t>& chosen) {
  if (const auto tension = tension_of(trace)) {
    Series series;
    for (size_t k = 0; k < tension->strain->value.size(); ++k) {
      series.x.push_back(100 * tension->strain->value[k]);
      series.y.push_back(1e-6 * tension->stress->value[k]);
    }
    for (const size_t k : chosen) {
      const size_t at = sample_at(*tension->strain, trace.frames[k].step);
      series.marks.emplace_back(series.x[at], series.y[at]);
    }
    return fmt::format(
        "<h2>Stress and strain</h2>\n<figure>{}</figure>\n<p>Largest stress {:.4g} MPa at a strain of {:.3g} "
        "%.</p>\n",
        plot_lines({series}, "strain of the gauge length, %", "stress, MPa"), series.y[tension->peak],
        series.x[tension->peak]);
  }
  std::vector<Series> energies;
  for (const char* part : {"energy.kinetic", "energy.potential", "energy.total"})
    if (const Curve* curve = find_curve(trace, part)) {
      Series series{std::string(part).substr(7), {}, curve->value, {}};
      for (const uint64_t step : curve->step)
        series.x.push_back(static_cast<double>(step) * loaded.setup.plan.rule.dt);
      energies.push_back(std::move(series));
    }
  return energies.empty()
             ? ""
             : "<h2>Energy</h2>\n<figure>" + plot_lines(energies, "time, s", "energy, J") + "</figure>\n";
}

std::string engine_row(const Loaded& loaded, const Trace& trace, const std::string& equal) {
  const uint64_t updates = trace.steps() * loaded.setup.plan.particles;
  const auto cycles = cycles_per_step(trace);
  return fmt::format(
      "<tr><th>{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.3g}</td><td>{}</td></"
      "tr>\n",
      escaped(trace.engine), trace.steps(), updates, equal,
      cycles ? fmt::format("{:.1f}", cycles->mean) : "–", cycles ? std::to_string(cycles->max) : "–",
      trace.seconds,
      trace.seconds > 0 ? fmt::format("{:.3g}", static_cast<double>(updates) / trace.seconds) : "–");
}

std::string engine_section(const Loaded& loaded, const Trace& run, const std::string& directory) {
  std::string rows = engine_row(loaded, run, "the run above");
  std::vector<std::string> files;
  const fs::path checks = fs::path(directory) / "crosscheck";
  if (fs::is_directory(checks))
    for (const auto& entry : fs::directory_iterator(checks))
      if (entry.path().extension() == ".h5") files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  std::vector<Trace> traces;
  for (const std::string& file : files) traces.push_back(read_trace(file));
  for (const Trace& trace : traces) {
    // Every engine against the first, and its cycles against each that counts them.
    std::string verdict;
    for (const Trace& other : traces)
      if (&other != &trace && verdict.empty())
        if (const auto mismatch = compare(other, trace))
          verdict = "<b class=\"bad\">" +
                    escaped(mismatch->text(other.engine, trace.engine, loaded.setup.plan.lattice)) + "</b>";
    const uint64_t bits = trace.steps() * loaded.setup.plan.particles *
                          static_cast<uint64_t>(loaded.setup.plan.words.particle_bits);
    if (verdict.empty()) verdict = traces.size() < 2 ? "alone" : fmt::format("{} bits equal", bits);
    rows += engine_row(loaded, trace, verdict);
  }
  return "<h2>Engines</h2>\n<table>\n<tr><th></th><th>steps</th><th>particle updates</th><th>state bits</th>"
         "<th>cycles per step, mean</th><th>max</th><th>host time, s</th><th>particle-steps/s</th></tr>\n" +
         rows + "</table>\n";
}

std::string table_of(const Items& items) {
  std::string out = "<table class=\"plain\">\n";
  for (const Items::Item& item : items.all())
    out += fmt::format("<tr><th>{}</th><td>{} {}</td><td class=\"note\">{}</td></tr>\n", escaped(item.name),
                       escaped(item.text), escaped(item.unit), escaped(item.note));
  return out + "</table>\n";
}

constexpr char kStyle[] =
    "body{font:16px/1.5 system-ui,sans-serif;color:#222;background:#fff;max-width:1100px;margin:2.5rem "
    "auto;padding:0 "
    "1rem}"
    "h1{font-size:1.7rem;margin:0}h2{font-size:1.15rem;margin:2.4rem 0 .6rem;border-bottom:1px solid #ddd}"
    ".lead{color:#555;margin:.2rem 0 "
    "1.5rem}figure{margin:0}img,svg{max-width:100%;height:auto;display:block;margin:auto}"
    "table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:.92rem}"
    "th,td{padding:.25rem .8rem .25rem 0;text-align:left;border-bottom:1px solid #eee;vertical-align:top}"
    "th{font-weight:600}.note{color:#777}.bad{color:#b00020}";

void report(const std::string& directory, std::string out) {
  std::optional<DirectoryLock> lock;
  const RunRecord record = read_record(directory);
  if (out.empty()) {
    lock.emplace(directory, "cuboct report");
    out = directory + "/report.html";
  }
  check_writable(out);
  const Loaded loaded = load({record.scene, record.arch});
  const Trace trace = read_trace(directory + "/trace.h5");
  const Plan& plan = loaded.setup.plan;
  if (trace.plan_hash != plan.hash)
    throw InputError(fmt::format("{}/trace.h5 was made by plan {:016x}, but {} now gives plan {:016x}",
                                 directory, trace.plan_hash, record.scene, plan.hash),
                     "run the scene again");
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width\">\n<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</"
      "h1>\n"
      "<p class=\"lead\">{2} particles on {3} nodes, {4} steps of {5:.4g} s in the {6} engine.</p>\n",
      escaped(loaded.scene.title.empty() ? record.scene : loaded.scene.title), kStyle, plan.particles,
      plan.nodes(), trace.frames.empty() ? trace.steps() : trace.frames.back().step, plan.rule.dt,
      escaped(trace.engine));
  std::vector<size_t> chosen;
  if (!trace.frames.empty()) {
    chosen = choose_frames(trace);
    html += fmt::format(
        "<figure><img alt=\"The particles, coloured by axial strain\" "
        "src=\"data:image/png;base64,{}\"></figure>\n",
        pictures(loaded, trace, chosen));
  }
  html += curve_section(loaded, trace, chosen);
  html += engine_section(loaded, trace, directory);
  if (trace.stop) html += "<p class=\"bad\">The run stopped: " + escaped(trace.stop->text) + "</p>\n";
  html += "<h2>Plan</h2>\n" + table_of(resolve(loaded));
  html += "</body>\n</html>\n";
  write_text(out, html);
  fmt::print("{}\n", out);
}

}  // namespace

void add_report(CLI::App& app, int&) {
  struct Options {
    std::string directory, out;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("report", "make one HTML file of a run's directory");
  command
      ->add_option("directory", options->directory,
                   "what 'cuboct run --out' wrote; traces in its folder "
                   "'crosscheck' join the table of engines")
      ->required()
      ->type_name("DIR");
  command->add_option("--out", options->out, "the HTML file; default: DIR/report.html")->type_name("FILE");
  command->callback([options] { report(options->directory, options->out); });
}

}  // namespace cuboct
