// SPDX-License-Identifier: MIT
#include "cli/run_gpu.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

#include "cli/summary.h"
#include "model/base/process.h"
#include "model/base/progress.h"

namespace cuboct {
namespace {

// Takes a counter out of the trace's, so that a summary can say what it is.
std::optional<double> take(Trace& trace, const char* name) {
  const auto at = std::find_if(trace.counters.begin(), trace.counters.end(),
                               [&](const auto& counter) { return counter.first == name; });
  if (at == trace.counters.end()) return std::nullopt;
  const double value = at->second;
  trace.counters.erase(at);
  return value;
}

// As that of the reference (cli/run_reference.cpp).
Items summarise_real(const Loaded& loaded, const Trace& trace, double momentum_change, double largest_speed) {
  const Scene& scene = loaded.scene;
  Items items;
  items.add("engine", trace.engine);
  for (const auto& [name, text] : trace.notes) items.add(name, text);
  items.add("integrator", "semi-implicit Euler");
  items.add("scene", scene.path);
  items.add("particles", static_cast<uint64_t>(scene.body.size()));
  items.add("steps", trace.steps());
  items.add("simulated time", static_cast<double>(trace.steps()) * scene.rule.dt, "s");
  items.add("host time", trace.seconds, "s");
  if (trace.seconds > 0)
    items.add("speed", static_cast<double>(trace.steps() * scene.body.size()) / trace.seconds,
              "particle-steps/s");
  items.add("momentum change", momentum_change, "kg m/s",
            keeps_momentum(scene.rule) ? "" : "held or driven from outside");
  add_curves(items, scene, trace.curves);
  items.add("largest speed", largest_speed, "cell/step");
  for (const auto& [name, value] : trace.counters) items.add(name, value);
  if (trace.watched) add_warnings(items, {}, trace.findings);
  if (trace.stop) items.add("stopped", trace.stop->text);
  return items;
}

Items summarise_gpu(const Loaded& loaded, Trace trace, const std::string& precision) {
  const double change = take(trace, "momentum_change").value_or(0);
  const double speed = take(trace, "largest_speed").value_or(0);
  const auto joules = take(trace, "joules_per_particle_step");
  Items items;
  if (precision == "fixed") {
    RunFacts facts;
    facts.momentum_after[0] = std::llround(change);
    facts.largest_speed = speed;
    facts.curves = trace.curves;
    facts.watch = trace.watched.has_value();
    facts.findings = trace.findings;
    facts.watched = trace.watched;
    items = summarise(loaded, trace, facts);
  } else {
    items = summarise_real(loaded, trace, change, speed);
  }
  if (joules) items.add("energy per particle-step", *joules, "J", "of the boards");
  return items;
}

}  // namespace

void GpuChoice::add_to(CLI::App& command) {
  auto* list =
      command
          .add_option("--devices", devices, "devices of gpu by CUDA's ordinals, one per part of the scene")
          ->delimiter(',')
          ->check(CLI::Range(0, 1023))
          ->type_name("A,B,...");
  command.add_option("--gpus", gpus, "the first N devices of gpu; default: one")
      ->check(CLI::Range(1, 64))
      ->excludes(list)
      ->type_name("N");
}

void GpuChoice::check_unused(const std::string& engine) const {
  const auto refuse = [&](bool given, const char* option) {
    if (given) throw InputError(fmt::format("{} is an option of the gpu engine, not of {}", option, engine));
  };
  refuse(gpus > 0, "--gpus");
  refuse(!devices.empty(), "--devices");
  refuse(joules, "--joules");
}

RunningEngine start_gpu(const Input& input, const GpuChoice& choice, const GpuRequest& request,
                        std::string path, bool progress) {
  std::vector<std::string> more{"--precision", request.precision};
  const auto add = [&](bool wanted, std::initializer_list<std::string> words) {
    if (wanted) more.insert(more.end(), words);
  };
  add(request.hash_every > 0, {"--hash-every", std::to_string(request.hash_every)});
  add(choice.gpus > 0, {"--gpus", std::to_string(choice.gpus)});
  add(!choice.devices.empty(), {"--devices", fmt::format("{}", fmt::join(choice.devices, ","))});
  add(request.energies, {"--energies"});
  add(request.watch, {"--watch"});
  add(request.forces, {"--forces"});
  add(choice.joules, {"--joules"});
  add(request.passes, {"--unpacked"});
  return {"gpu", input, request, std::move(path), progress, more};
}

GpuAnswer run_on_gpu(const Input& input, const Loaded& loaded, const GpuChoice& choice,
                     const GpuRequest& request, Recorder* recorder) {
  const Scratch scratch;
  const auto reader =
      start_gpu(input, choice, request, scratch.path("gpu.h5"), stderr_is_terminal()).finish_reading();
  GpuAnswer answer;
  answer.trace = reader->rest();
  answer.summary = summarise_gpu(loaded, answer.trace, request.precision);
  answer.failed = !answer.trace.findings.empty();
  if (recorder) {
    reader->frames([&](const State& state) { recorder->keep(state); });
    reader->bodies([&](const RealFrame& frame) { recorder->keep(frame); });
  }
  return answer;
}

}  // namespace cuboct
