// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "cli/answer.h"
#include "cli/programs.h"
#include "cli/run/check.h"
#include "cli/run/report.h"
#include "cli/run/report_pictures.h"
#include "cli/run/summary.h"
#include "cli/run/turning_picture.h"
#include "hw/program/options.h"
#include "model/analysis/story.h"
#include "model/analysis/tension.h"
#include "model/base/base64.h"
#include "model/base/directory_lock.h"
#include "model/base/input_file.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/base/quantity_text.h"
#include "model/base/tensor.h"
#include "model/base/text.h"
#include "model/trace/compare.h"
#include "model/trace/cycles.h"
#include "model/trace/guarded_trace.h"
#include "model/trace/plot.h"
#include "model/trace/raster_plot.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

// The first probe that has a stress-strain curve in the trace.
const Probe* first_tension(const Scene& scene, const Trace& trace) {
  for (const Probe& probe : scene.probes)
    if (probe.kind == Probe::Kind::stress_strain && tension_of(trace.curves, probe.name)) return &probe;
  return nullptr;
}

// Where the colours end: as `cuboct picture` has it, of the same rasters; without them the frames tell.
std::optional<double> colour_limit(const std::string& directory) {
  const std::string rasters = directory + "/rasters.h5";
  if (!is_file(rasters)) return std::nullopt;
  return usual_limit(guarded_rasters(rasters), Field::strain);
}

std::string pictures(const Loaded& loaded, const Shots& shots, const std::vector<size_t>& chosen,
                     std::optional<size_t> onset, const std::string& directory) {
  std::vector<std::string> labels;
  for (const size_t k : chosen)
    labels.push_back(fmt::format("step {}    t = {:.4g} s{}", shots.step(k),
                                 static_cast<double>(shots.step(k)) * loaded.setup.plan.rule.dt,
                                 k == onset ? "    first frame with a broken bond" : ""));
  return draw_frames(
      loaded.scene, labels, [&](size_t n) { return shots.frame(chosen[n]); }, colour_limit(directory));
}

// Where the frame's step falls on a curve.
size_t sample_at(const Curve& curve, uint64_t step) {
  return static_cast<size_t>(
      std::min<ptrdiff_t>(std::lower_bound(curve.step.begin(), curve.step.end(), step) - curve.step.begin(),
                          static_cast<ptrdiff_t>(curve.step.size()) - 1));
}

std::string figure(const std::vector<Series>& series, const std::string& x, const std::string& y) {
  return "<figure>" + plot_lines(series, x, y) + "</figure>\n";
}

// The figures of a tension test beside those of the datasheet, where the scene gives one.
std::string tension_table(const Tension& tension, const Scene& scene, const Probe& probe) {
  const TensionFigures figures = tension_figures(tension_test(tension, scene, probe));
  const Datasheet sheet = probe.datasheet.value_or(Datasheet{});
  std::string rows;
  const auto row = [&](const char* name, const CurveFigure& measured, double given, double unit,
                       const char* unit_name, const char* how = "") {
    const auto text = [&](double value) { return fmt::format("{:.3g} {}", value / unit, unit_name); };
    const std::string found =
        measured.value ? fmt::format("{} ± {:.1g}{}</td><td>{:.3g} to {:.3g} %", text(*measured.value),
                                     measured.error / unit, how, 100 * measured.from, 100 * measured.to)
                       : fmt::format("not there</td><td>{}", html_text(measured.why));
    rows += fmt::format("<tr><th>{}</th><td>{}</td>{}</tr>\n", name, found,
                        probe.datasheet ? "<td>" + (given > 0 ? text(given) : "–") + "</td>" : "");
  };
  row("modulus", figures.modulus, sheet.modulus, 1e9, "GPa");
  row("strength", figures.strength, sheet.strength, 1e6, "MPa",
      figures.rises_at_end ? ", still rising at the end" : "");
  row("strain at the strength", figures.yield_strain, sheet.yield_strain, 0.01, "%");
  row("strain at break", figures.strain_at_break, sheet.strain_at_break, 0.01, "%");
  const std::string given =
      probe.datasheet
          ? "<th>datasheet" + (sheet.source.empty() ? "" : ": " + html_text(sheet.source)) + "</th>"
          : "";
  return fmt::format(
      "<div class=\"wide\"><table>\n<tr><th></th><th>measured</th><th>read from strains</th>{}</tr>\n{}"
      "</table></div>\n<p class=\"note\">Modulus: slope of the straight part, of means over a round trip of "
      "waves, behind the first one. Strength and break: of the running mean over {} readings; broken where "
      "it "
      "stays below a tenth of the strength. ±: standard error, or the spacing of readings.</p>\n",
      given, rows, tension_window(tension.strain->value.size()));
}

// `marks`: the steps of the frames that are pictured.
std::string stress_strain(const Tension& tension, const Scene& scene, const Probe& probe,
                          const std::vector<uint64_t>& marks) {
  const size_t window = tension_window(tension.strain->value.size());
  Series readings, mean;
  readings.faint = true;
  readings.title = "readings", mean.title = "running mean";
  for (const double strain : tension.strain->value) readings.x.push_back(100 * strain);
  for (const double stress : tension.stress->value) readings.y.push_back(1e-6 * stress);
  mean.x = running_mean(readings.x, window), mean.y = running_mean(readings.y, window);
  for (const uint64_t step : marks) {
    const size_t at = sample_at(*tension.strain, step);
    mean.marks.emplace_back(mean.x[at], mean.y[at]);
  }
  return figure({readings, mean}, "strain of the gauge length, %", "stress, MPa") +
         tension_table(tension, scene, probe);
}

// Curves over time, in one figure; `names`: with what the key calls them. `change`: since the first sample.
std::string over_time(const Trace& trace, double dt,
                      const std::vector<std::pair<std::string, std::string>>& names, const std::string& label,
                      bool change = false) {
  std::vector<Series> all;
  std::string unit;
  double latest = 0, largest = 0;
  for (const auto& [name, key] : names) {
    const Curve* curve = find_curve(trace.curves, name);
    if (!curve) continue;
    unit = curve->unit;
    Series& series = all.emplace_back(Series{key, {}, curve->value, {}});
    for (const uint64_t step : curve->step) series.x.push_back(static_cast<double>(step) * dt);
    for (double& value : series.y) {
      if (change) value -= curve->value.front();
      largest = std::max(largest, std::abs(value));
    }
    latest = std::max(latest, series.x.back());
  }
  if (all.empty()) return "";
  const Multiple time = multiple_of(latest, "s"), number = multiple_of(largest, unit);
  for (Series& series : all) {
    for (double& x : series.x) x /= time.unit;
    for (double& y : series.y) y /= number.unit;
  }
  return figure(all, "time, " + time.name, label + ", " + number.name);
}

// Its figure: the curve of the whole, and what those of the axes begin with, if it has any.
struct Probed {
  Probe::Kind kind;
  const char *title, *label, *whole, *part;
};
constexpr Probed kProbed[] = {
    {Probe::Kind::force, "Force", "force", "force", "force_"},
    {Probe::Kind::displacement, "Displacement", "displacement", "along", ""},
    {Probe::Kind::velocity, "Velocity", "velocity", "velocity", "velocity_"},
    {Probe::Kind::kinetic_energy, "Kinetic energy", "kinetic energy", "kinetic_energy", nullptr},
    {Probe::Kind::temperature, "Temperature", "temperature", "temperature", nullptr}};

constexpr std::pair<const char*, const char*> kCrack[] = {{"length", "length"},
                                                          {"speed", "speed over some readings"},
                                                          {"energy", "energy of the broken bonds"},
                                                          {"broken", "broken bonds"}};

// Every curve that has more than one sample.
std::string curve_section(const Loaded& loaded, const Trace& trace, const std::vector<uint64_t>& marks) {
  const double dt = loaded.scene.rule.dt;
  const Probe* first = first_tension(loaded.scene, trace);
  std::string out;
  const auto section = [&](const std::string& title, const std::string& figure) {
    if (!figure.empty()) out += "<h2>" + html_text(title) + "</h2>\n" + figure;
  };
  for (const Probe& probe : loaded.scene.probes) {
    if (probe.kind == Probe::Kind::stress_strain) {
      if (const auto tension = tension_of(trace.curves, probe.name))
        section(
            "Stress and strain: " + probe.name,
            stress_strain(*tension, loaded.scene, probe, &probe == first ? marks : std::vector<uint64_t>()));
      continue;
    }
    if (probe.kind == Probe::Kind::crack) {
      std::string figures;
      for (const auto& [quantity, label] : kCrack)
        figures += over_time(trace, dt, {{probe.name + "." + quantity, ""}}, label);
      section("Crack: " + probe.name, figures);
      continue;
    }
    if (probe.kind == Probe::Kind::field) {
      std::vector<std::pair<std::string, std::string>> names{{probe.name + "." + probe.field, ""}};
      for (const char axis : {'x', 'y', 'z'})
        names.emplace_back(probe.name + "." + probe.field + "_" + axis, std::string(1, axis));
      section(probe.field + ": " + probe.name, over_time(trace, dt, names, probe.field));
      continue;
    }
    if (probe.kind == Probe::Kind::stress) {
      std::vector<std::pair<std::string, std::string>> names;
      for (const std::string& component : kTensorNames)
        names.emplace_back(probe.name + "." + component, component);
      section("Stress: " + probe.name, over_time(trace, dt, names, "stress"));
      continue;
    }
    const auto& [kind, title, label, whole, part] = *std::ranges::find(kProbed, probe.kind, &Probed::kind);
    std::vector<std::pair<std::string, std::string>> names{{probe.name + "." + whole, ""}};
    for (int axis = 0; part && axis < 3; ++axis)
      names.emplace_back(probe.name + "." + part + "xyz"[axis], std::string(1, "xyz"[axis]));
    section(title + (": " + probe.name), over_time(trace, dt, names, label));
  }
  // On axes of their own: the potential energy's change would else flatten the others.
  std::string energies;
  for (const char* part : {"kinetic", "potential", "gravity", "total"})
    if (const Curve* curve = find_curve(trace.curves, std::string("energy.") + part);
        curve &&
        std::ranges::any_of(curve->value, [&](double value) { return value != curve->value.front(); }))
      energies +=
          over_time(trace, dt, {{curve->name, ""}}, std::string("change of ") + part + " energy", true);
  section("Energy, since the start", energies);
  section("Temperature", over_time(trace, dt, {{"temperature", ""}}, "temperature"));
  section("Pressure", over_time(trace, dt, {{"pressure", ""}}, "pressure"));
  return out;
}

// `before`: as `cuboct check` tells them.
std::string warning_section(const std::vector<std::string>& before, const Trace& trace) {
  if (before.empty() && trace.findings.empty() && !trace.stop) return "";
  std::string out = "<h2>Warnings</h2>\n<ul class=\"bad\">\n";
  for (const std::string& text : before) out += "<li>warning: " + html_text(text) + "</li>\n";
  for (const Finding& finding : trace.findings) out += "<li>warning: " + html_text(finding.text) + "</li>\n";
  if (trace.stop) out += "<li>stopped: " + html_text(trace.stop->text) + "</li>\n";
  return out + "</ul>\n";
}

std::string engine_line(const Loaded& loaded, const Trace& trace, const std::string& equal) {
  const uint64_t updates = trace.steps() * loaded.setup.plan.particles;
  const auto cycles = cycles_per_step(trace);
  // Time steps of a static run count its load: particles are not updated in them.
  const bool moves = !loaded.scene.loading;
  return fmt::format(
      "<tr><th>{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.3g}</td><td>{}</td></"
      "tr>\n",
      html_text(trace.engine), trace.steps(), moves ? std::to_string(updates) : "–", equal,
      cycles ? fmt::format("{:.1f}", cycles->mean) : "–", cycles ? std::to_string(cycles->max) : "–",
      trace.seconds,
      moves && trace.seconds > 0 ? fmt::format("{:.3g}", static_cast<double>(updates) / trace.seconds) : "–");
}

std::string engine_section(const Loaded& loaded, const Trace& run, const std::string& directory) {
  std::string rows = engine_line(loaded, run, "the run above");
  std::vector<std::string> files;
  const fs::path checks = fs::path(directory) / "crosscheck";
  if (fs::is_directory(checks))
    for (const auto& entry : fs::directory_iterator(checks))
      if (entry.path().extension() == ".h5") files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  std::vector<Trace> traces;  // of this plan, with hashes
  for (const std::string& file : files) {
    Trace trace = guarded_trace(file);
    const bool other = trace.plan_hash != loaded.setup.plan.hash;
    if (!other && !trace.state_hash.empty()) {
      traces.push_back(std::move(trace));
      continue;
    }
    rows +=
        engine_line(loaded, trace,
                    other ? fmt::format("<b class=\"bad\">not compared: {} is of another scene or arch, plan "
                                        "{:016x}</b>",
                                        html_text(fs::path(file).filename().string()), trace.plan_hash)
                          : "no state hashes to compare");
  }
  for (const Trace& trace : traces) {
    // Every engine against the first, and its cycles against each that counts them.
    std::string verdict;
    for (const Trace& other : traces)
      if (&other != &trace && verdict.empty())
        if (const auto mismatch = compare(other, trace))
          verdict = "<b class=\"bad\">" +
                    html_text(mismatch->text(other.engine, trace.engine, loaded.setup.plan.lattice)) + "</b>";
    const uint64_t bits = trace.steps() * loaded.setup.plan.particles *
                          static_cast<uint64_t>(loaded.setup.plan.words.particle_bits);
    if (verdict.empty())
      verdict = traces.size() < 2 ? "no other trace to compare" : fmt::format("{} bits equal", bits);
    rows += engine_line(loaded, trace, verdict);
  }
  return "<h2>Engines</h2>\n<div class=\"wide\"><table>\n<tr><th></th><th>steps</th><th>particle "
         "updates</th><th>state bits</th>"
         "<th>mean cycles per step</th><th>most</th><th>host time, s</th><th>particle-steps/s</th></tr>\n" +
         rows + "</table></div>\n";
}

// What each phase takes, of the engines that count cycles: a node's mean over the run, and the longest.
std::string phase_section(const Trace& trace) {
  if (trace.cycles.empty() || trace.nodes == 0) return "";
  std::string rows;
  const auto phases = cycles_per_phase(trace);
  for (size_t k = 0; k < phases.size(); ++k)
    rows += fmt::format("<tr><th>{}</th><td>{:.1f}</td><td>{}</td></tr>\n",
                        phase_name(static_cast<int>(k), trace.rounds), phases[k].mean, phases[k].most);
  return "<h2>Cycles per phase</h2>\n<div class=\"wide\"><table>\n<tr><th></th><th>mean of a node</th>"
         "<th>most</th></tr>\n" +
         rows +
         "</table></div>\n<p class=\"note\">With the cycles in which a node waits for its neighbours.</p>\n";
}

// `without`: an item that is left out.
std::string table_of(const Items& items, const std::string& without = {}) {
  std::string out = "<div class=\"wide\"><table class=\"plain\">\n";
  for (const Items::Item& item : items.all())
    if (!item.list && item.name != without)  // lists are warnings, which have a section
      out += fmt::format("<tr><th>{}</th><td>{}{}{} <span class=\"note\">{}</span></td></tr>\n",
                         html_text(item.name), html_text(item.text), item.unit.empty() ? "" : " ",
                         html_text(item.unit), html_text(item.note));
  return out + "</table></div>\n";
}

constexpr char kPageStyle[] =
    "body{font:16px/1.5 system-ui,sans-serif;color:#222;background:#fff;max-width:1100px;margin:2.5rem "
    "auto;padding:0 "
    "1rem}"
    "h1{font-size:1.7rem;margin:0}h2{font-size:1.15rem;margin:2.4rem 0 .6rem;border-bottom:1px solid #ddd}"
    ".lead{color:#555;margin:.2rem 0 1.5rem}figure{margin:0}.wide{overflow-x:auto}"
    "img,svg,canvas{max-width:100%;height:auto;display:block;margin:auto}svg{width:720px}"
    "canvas{touch-action:none;cursor:grab}figcaption{text-align:center}"
    "table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:.92rem}"
    "th,td{padding:.25rem .8rem .25rem 0;text-align:left;border-bottom:1px solid #eee;vertical-align:top}"
    ".plain td{overflow-wrap:anywhere}th{font-weight:600}.note{color:#777}.bad{color:#b00020}";

std::string page_head(const std::string& title) {
  // The policy lets a browser load nothing, and run the script of turning_picture.h alone.
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" "
      "content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src {2}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n",
      html_text(title), kPageStyle, turning_script_hash());
}

// A PNG file's bytes.
std::string page_picture(const std::string& png) {
  return fmt::format(
      "<figure class=\"wide\"><img alt=\"The particles, coloured by axial strain\" "
      "src=\"data:image/png;base64,{}\"></figure>\n",
      base64(png.data(), png.size()));
}

}  // namespace

void write_report(const std::string& directory, const std::string& out) {
  const RunRecord record = read_record(directory);
  const Trace trace = read_run(directory, record);
  const Loaded loaded = scene_of_run(directory, record, trace);
  const Plan& plan = loaded.setup.plan;
  const Shots shots(loaded, trace, directory + "/trace.h5");
  std::string html = page_head(loaded.scene.title.empty() ? record.scene : loaded.scene.title);
  html +=
      fmt::format("<p class=\"lead\">{} particles{}, {} steps of {:.4g} s in the {} engine{}.</p>\n",
                  plan.particles, trace.state_hash.empty() ? "" : fmt::format(" on {} nodes", plan.nodes()),
                  trace.steps(), plan.rule.dt, html_text(trace.engine),
                  trace.asked && trace.steps() != trace.asked && !trace.reached
                      ? fmt::format(", <b class=\"bad\">{} after {} of {} steps</b>", trace.ended(),
                                    trace.steps(), *trace.asked)
                      : "");
  html += warning_section(warnings_of(loaded, trace.state_hash.empty()), trace);
  std::vector<uint64_t> marks;
  if (shots.size() > 0) {
    const std::optional<size_t> onset = shots.crack_onset();
    std::vector<uint64_t> steps;
    for (size_t k = 0; k < shots.size(); ++k) steps.push_back(shots.step(k));
    const Probe* probe = first_tension(loaded.scene, trace);
    const std::vector<size_t> chosen =
        story_frames(steps, probe ? tension_of(trace.curves, probe->name)->stress : nullptr, onset);
    for (const size_t k : chosen) marks.push_back(shots.step(k));
    html += page_picture(pictures(loaded, shots, chosen, onset, directory));
    html += turning_picture(loaded.scene, shots.frame(chosen.back()), colour_limit(directory));
  }
  html += curve_section(loaded, trace, marks);
  html += engine_section(loaded, trace, directory);
  html += phase_section(trace);
  html += "<h2>Run</h2>\n" + table_of(facts_of(loaded, trace));
  html += "<h2>Plan</h2>\n" + table_of(resolve(loaded), "steps");  // the scene's, which need not be the run's
  html += "</body>\n</html>\n";
  write_text(out, html);
}

namespace {

void report(const std::string& directory, std::string out, const Answer& answer) {
  std::optional<DirectoryLock> lock;
  static_cast<void>(read_record(directory));  // a directory that holds no run gets no lock
  if (out.empty()) {
    lock.emplace(directory, "cuboct report");
    out = directory + "/report.html";
  }
  check_writable(out);
  write_report(directory, out);
  answer.say("{}\n", line_text(out));
  answer.close(json_object({{"file", json(out)}}));
}

}  // namespace

void add_report(Command& app, int&) {
  struct Options {
    std::string directory, out;
    Answer answer;
  };
  auto options = std::make_shared<Options>();
  Command command = add_command(app, "report");
  command
      .option("directory", options->directory,
              "what 'cuboct run --out' wrote; traces in its folder "
              "'crosscheck' join the table of engines",
              "DIR")
      .required();
  command.option("--out", options->out, "the HTML file; default: DIR/report.html", "FILE");
  options->answer.add_to(command);
  command.callback([options] { report(options->directory, options->out, options->answer); });
}

}  // namespace cuboct
