// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <thread>
#include <utility>

#include "cli/answer.h"
#include "cli/command.h"
#include "cli/programs.h"
#include "cli/study/budget.h"
#include "cli/study/study_command.h"
#include "hw/engine/engines.h"
#include "hw/program/bounds.h"
#include "model/analysis/measure.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/base/quantity_text.h"
#include "model/base/text.h"
#include "model/trace/plot.h"
#include "study/search/pitch_search.h"

namespace cuboct {
namespace {

struct PitchOptions {
  std::string scene, arch, out, figure, curve;
  std::string engine = "lattice";
  std::string error = "5%";
  uint64_t most = 1'000'000;
  int threads = 0;
  bool anyway = false;
  Answer answer;
};

// As a study file has figures; without --curve the modulus of the scene's one stress-strain probe.
Figure figure_of(const PitchOptions& options, const Scene& scene) {
  std::string curve = options.curve, kind = options.figure.empty() ? "modulus" : options.figure;
  if (curve.empty()) {
    for (const Probe& probe : scene.probes) {
      if (probe.kind != Probe::Kind::stress_strain) continue;
      if (!curve.empty())
        throw InputError("the scene has several stress-strain probes", "name one curve by --curve");
      curve = probe.name + ".stress";
    }
    if (curve.empty())
      throw InputError("the scene has no probe of the kind 'stress_strain'",
                       "--figure KIND --curve NAME: what is to keep its error");
  }
  return read_figure(parse_config(
      fmt::format("kind = {}\ncurve = {}\n", toml_string(kind), toml_string(curve)), "--figure"));
}

// Before any run: a curve that no probe makes.
void check_curves(const Figure& figure, const Scene& scene) {
  try {
    value_of(figure, ProbeMeter(scene.probes, scene.periodic, scene.body.x).curves(), scene.rule.dt);
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error&) {  // they have no readings yet
  }
}

std::string length_text(double length, bool reduced) {
  return reduced ? fmt::format("{:.4g}", length) : quantity_text(length, "m");
}

std::string rough_percent(double share) { return fmt::format("{:.2g} %", 100 * share); }

void draw(const study::PitchAnswer& answer, const Figure& figure, const std::string& path) {
  const study::PitchLine& line = *answer.line;
  const std::string unit = answer.runs.back().unit;
  std::string data = "$runs << END\n";
  for (const study::PitchRun& run : answer.runs) data += fmt::format("{:.8g} {:.8g}\n", run.pitch, run.value);
  draw_plot(path, data + "END\n",
            fmt::format("set key off\nset grid\nset xrange [0:*]\nset xlabel 'pitch'\n"
                        "set ylabel {}\nset format y '%.2s %c{}'\nset format x '%.1s %cm'\n"
                        "plot {:.8g} + {:.8g} * x with lines lc rgb '#1f5fa8', "
                        "$runs with points pt 7 lc rgb '#d9703f'\n",
                        gnuplot_label(fmt::format("{} of {}", figure.name, figure.curve)), unit, line.limit,
                        line.slope),
            620, 420);
}

std::string json_of(const study::PitchAnswer& answer, const Figure& figure, const std::string& out) {
  const auto run_text = [&](const study::PitchRun& run) {
    return json_object({{"pitch", json(run.pitch)},
                        {"shift", std::to_string(run.shift)},
                        {"particles", std::to_string(run.particles)},
                        {"value", json(run.value)},
                        {"error", answer.line ? json(answer.line->error_at(run.pitch)) : "null"},
                        {"particle_steps", std::to_string(run.particle_steps)},
                        {"seconds", json(run.seconds)}});
  };
  return json_object({{"figure", json(figure.name)},
                      {"curve", json(figure.curve)},
                      {"unit", json(answer.runs.back().unit)},
                      {"runs", json_array(answer.runs, run_text)},
                      {"limit", answer.line ? json(answer.line->limit) : "null"},
                      {"slope", answer.line ? json(answer.line->slope) : "null"},
                      {"scatter", answer.line ? json(answer.line->scatter) : "null"},
                      {"limit_within", answer.line ? json(answer.line->limit_within) : "null"},
                      {"pitch", answer.pitch ? json(*answer.pitch) : "null"},
                      {"directory", json(out)}});
}

// The finest of its runs.
void check_size(const PitchOptions& options) {
  check_workers("--threads", options.threads, options.anyway);
  constexpr double kNeighbours = 18;  // of a packing with second neighbours
  const EngineCost& cost = engine_row(options.engine).cost;
  check_memory(fmt::format("--particles {}", options.most),
               static_cast<double>(options.most) * (cost.particle + kNeighbours * cost.neighbour + cost.cell),
               fmt::format("--particles {}", PitchOptions().most), options.anyway);
}

int find(const PitchOptions& options) {
  check_size(options);
  catch_interrupts();
  study::PitchQuestion question;
  question.base = study::read_base(options.scene, options.arch);
  study::check_refinable(question.base);
  const Scene scene = parse_scene(question.base.scene_text, question.base.scene_path);
  question.figure = figure_of(options, scene);
  check_curves(question.figure, scene);
  question.engine = options.engine;
  question.error = read_error_budget(options.error);
  question.most_particles = options.most;
  question.threads = options.threads > 0
                         ? options.threads
                         : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const std::string out = out_of(options.out, options.scene, ".pitch");
  const bool reduced = study::is_reduced(question.base);
  const Answer& answer = options.answer;
  return kept_in(out, "cuboct pitch", [&] {
    bool headed = false;
    const study::PitchAnswer found = study::find_pitch(question, out, [&](const study::PitchAnswer& so_far) {
      if (!std::exchange(headed, true))
        answer.say("{} of {}\n{:<12}{:>11}  {:<28}{:<10}{}\n", question.figure.name,
                   line_text(question.figure.curve), "pitch", "particles", "value", "off by", "host time");
      const std::vector<study::PitchRun>& runs = so_far.runs;
      double low = runs.back().value, high = low, seconds = 0;
      for (auto run = runs.rbegin(); run != runs.rend() && run->pitch == runs.back().pitch; ++run)
        low = std::min(low, run->value), high = std::max(high, run->value), seconds += run->seconds;
      answer.say("{:<12}{:>11}  {:<28}{:<10}{:.1f} s\n", length_text(runs.back().pitch, reduced),
                 runs.back().particles,
                 fmt::format("{} to {}", quantity_text(low, runs.back().unit),
                             quantity_text(high, runs.back().unit)),
                 so_far.line ? rough_percent(so_far.line->error_at(runs.back().pitch)) : "-", seconds);
      std::fflush(stdout);
    });
    if (found.line) {
      const std::string& unit = found.runs.back().unit;
      answer.say("limit       {}, known within {}\n", quantity_text(found.line->limit, unit),
                 rough_percent(found.line->limit_within / std::abs(found.line->limit)));
    }
    if (found.pitch) {
      const study::PitchRun& last = found.runs.back();
      const double times = last.pitch / *found.pitch;
      answer.say("pitch = {}   # within {}; about {} particles\n",
                 reduced ? fmt::format("{:.4g}", *found.pitch)
                         : fmt::format("\"{}\"", quantity_text(*found.pitch, "m")),
                 rough_percent(question.error),
                 count_text(static_cast<double>(last.particles) * times * times * times));
    }
    answer.close(json_of(found, question.figure, out));
    if (found.line) drawn("picture", [&] { draw(found, question.figure, out + "/pitch.svg"); });
    if (!found.pitch)
      throw Failed(fmt::format("no pitch of at most {} particles keeps {}", options.most,
                               rough_percent(question.error)),
                   "--particles N, --error E, or another figure");
    return 0;
  });
}

}  // namespace

void add_pitch(Command& app, int& exit_code) {
  auto [command, options] = add_command<PitchOptions>(app, "pitch", exit_code, find);
  command.option("scene", options->scene, "scene file (TOML)", "SCENE").required();
  command.option("--error", options->error, "wanted, of the figure, as 5% or 0.05", "E").show_default();
  command
      .option("--figure", options->figure,
              "modulus, strength, frequency, break_time, mean or final; default: modulus", "KIND")
      .proposed({"modulus", "strength", "frequency", "break_time", "mean", "final"});
  command.option("--curve", options->curve, "of a probe; default: the stress of the only one of its kind",
                 "CURVE");
  command
      .option("--engine", options->engine, "lattice or reference; a static scene is relaxed in doubles",
              "NAME")
      .one_of({"lattice", "reference"})
      .show_default();
  command.option("--arch", options->arch, "machine (TOML)", "ARCH");
  command.option("--particles", options->most, "at most so many", "N")
      .range(uint64_t{100}, uint64_t{100'000'000})
      .show_default();
  command.option("--threads", options->threads, "of the host; default: one per core", "N").range(1, 4096);
  add_anyway_to(command, options->anyway);
  add_out_to(command, options->out, "scene", ".pitch");
  options->answer.add_to(command);
}

}  // namespace cuboct
