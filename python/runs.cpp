// SPDX-License-Identifier: MIT
#include "python/runs.h"

#include <fmt/format.h>

#include <set>

#include "cli/run/engine_run.h"
#include "cli/run/estimate.h"
#include "cli/run/outputs.h"
#include "cli/run/run_engines.h"
#include "cli/run/summary.h"
#include "hw/engine/engines.h"
#include "hw/engine/scene_engine.h"
#include "model/analysis/meter.h"
#include "model/base/interrupt.h"
#include "model/base/process.h"
#include "model/base/steps.h"
#include "model/rules/rounds_rule.h"
#include "model/run/rounds_run.h"
#include "model/scene/readings.h"
#include "model/trace/compare.h"
#include "python/catch_interrupt.h"

namespace cuboct::python {
namespace {

// What a program says of its own end is no error of the user's where he asked for it.
template <typename Work>
auto unless_interrupted(Work work) {
  try {
    auto result = work();
    if (interrupted()) throw Interrupted();
    return result;
  } catch (const std::runtime_error&) {
    if (interrupted()) throw Interrupted();
    throw;
  }
}

// With the engine that the scene asks for, where none is named, and whole load steps.
RunAsked for_scene(RunAsked asked, const Scene& scene) {
  if (asked.engine.empty()) asked.engine = engine_for(scene);
  asked.options.check({asked.engine}, {});
  asked.options.anyway = asked.anyway;
  asked.steps = whole_steps(scene, asked.steps.value_or(scene.steps));
  if (asked.keep_every) asked.keep_every = whole_steps(scene, *asked.keep_every);
  return asked;
}

void check_size(const Loaded& loaded, const RunAsked& asked, uint64_t steps) {
  RunSize size = run_size(loaded.scene, steps);
  size.engine = asked.engine;
  size.frame_every = asked.keep_every.value_or(0);
  size.hash_every = hashes_every(asked.engine, asked.options);
  size.cycles = asked.options.cycles;
  size.threads = asked.options.threads;
  size.ranks = asked.options.ranks;
  check_fits(loaded.scene, size, estimate(loaded.scene, loaded.setup.plan, size), "");
}

// What the rule shows of the frame's particles.
Fields shown_by(const Rule& rule, const RealFrame& frame) {
  Fields fields;
  for (size_t k = 0; k < frame.shown.size(); ++k)
    fields.emplace_back(rule.rounds->declaration().shown[k].name, frame.shown[k]);
  return fields;
}

}  // namespace

WholeRun run(const Sources& sources, const RunAsked& given) {
  if (!given.engine.empty()) given.options.check({engine_row(given.engine).name}, {});
  Loaded loaded = load_plan(sources, false, given.engine, given.options.is_real(given.engine));
  const Scene& scene = loaded.scene;
  const Plan& plan = loaded.setup.plan;
  const RunAsked asked = for_scene(given, scene);
  WholeRun result;
  result.dt = scene.rule.dt;
  RunRequest request;
  request.steps = *asked.steps;
  if (!asked.anyway) check_size(loaded, asked, request.steps);
  const Readings readings = readings_of(scene, request.steps);
  request.probes = every_so_often(readings.probes, request.steps);
  request.energy_steps = every_so_often(readings.energies, request.steps);
  request.energies = request.totals = request.until = true;
  request.watch = !scene.loading;  // it looks for what goes wrong in motion
  request.cycles = asked.options.cycles;
  request.hash_every = hashes_every(asked.engine, asked.options);
  request.frames = asked.keep_every ? every_so_often(*asked.keep_every, request.steps)
                                    : std::vector<uint64_t>{request.steps};
  std::optional<RunState> last;
  result.shown =
      std::make_shared<Shown>(Shown{sources, asked.engine, asked.options.is_real(asked.engine), {}, {}});
  request.keep = [&](const RunState& frame) {
    if (!asked.leave.empty()) last = frame;
    result.shown->states.push_back(frame);
    if (const State* state = std::get_if<State>(&frame)) {
      result.kept.push_back({state->step, to_real(*state, plan.rule, plan.lattice, plan.origin), {}});
    } else {
      const RealFrame& real = std::get<RealFrame>(frame);
      result.kept.push_back(
          {real.step, Body{real.x, real.v, {}, scene.body.type, nullptr}, shown_by(scene.rule, real)});
    }
  };
  const Scratch scratch;
  const Input input = write_sources(sources, scratch);
  const CatchForHost catching;
  const uint64_t steps = request.steps;
  result.recorded = unless_interrupted([&] {
    return EngineRun(asked.engine, input, loaded, asked.options, std::move(request),
                     scratch.path(asked.engine + ".h5"), true)
        .finish();
  });
  if (!result.recorded.trouble.empty()) throw InputError(result.recorded.trouble);
  result.recorded.trace.asked = steps;
  note_start(result.recorded.trace, loaded, asked.options.is_real(asked.engine));
  Items summary = summarise(loaded, result.recorded, asked.options.is_real(asked.engine));
  add_end(summary, result.recorded.trace);
  if (last && !result.recorded.trace.stop)
    leave_state(asked.leave, head_of(loaded, asked.options.is_real(asked.engine), false), *last,
                result.recorded.trace);
  result.shown->trace = result.recorded.trace;
  result.summary = summary.json();
  result.scene = std::make_shared<const Scene>(std::move(loaded.scene));
  return result;
}

Comparison crosscheck(const Sources& sources, const std::vector<std::string>& engines,
                      const EngineOptions& options, std::optional<uint64_t> steps, const std::string& leave) {
  for (const std::string& engine : engines) engine_row(engine, true);
  if (std::set(engines.begin(), engines.end()).size() != engines.size() || engines.size() < 2)
    throw InputError("a crosscheck needs two or more different engines", "engines=[\"golden\", \"lattice\"]");
  options.check(engines, {});
  const Loaded loaded = load_plan(sources, false, strictest(engines));
  const Plan& plan = loaded.setup.plan;
  for (const std::string& engine : engines) check_runs(loaded.scene, plan.arch, engine);
  const bool text = plan.program != nullptr;
  const Scratch scratch;
  const Input input = write_sources(sources, scratch);
  const CatchForHost catching;
  RunRequest request;
  request.steps = steps.value_or(loaded.scene.steps);
  if (loaded.scene.until) request.until = true, request.probes = probe_steps_of(loaded.scene, request.steps);
  if (!leave.empty()) request.frames = {request.steps};
  std::optional<RunState> last;  // of a rule of text, whose fields no State of a trace has
  if (text) request.keep = [&](const RunState& frame) { last = frame; };
  std::vector<Trace> traces = unless_interrupted([&] {
    return run_all({input, options, loaded, scratch.path("")}, engines, request);
  });
  Comparison result;
  for (size_t a = 0; a < traces.size(); ++a)
    for (size_t b = a + 1; b < traces.size(); ++b) {
      const auto mismatch = compare(traces[a], traces[b]);
      if (!mismatch) continue;
      const std::string &first = engines[a], &second = engines[b];
      result.text = "mismatch: " + mismatch->text(first, second, plan.lattice);
      result.engines = {first, second};
      if (mismatch->kind == Mismatch::Kind::state || mismatch->kind == Mismatch::Kind::cycles)
        result.step = mismatch->step;
      if (mismatch->kind == Mismatch::Kind::state) {
        const Scratch again;
        result.text +=
            "\nfirst difference: " + unless_interrupted([&] {
              return explain({input, options, loaded, again.path("")}, first, second, mismatch->step);
            });
      }
      return result;
    }
  result.matched = true;
  result.steps = traces[0].steps();
  result.updates = updates_compared(traces[0], plan.particles);
  result.text = fmt::format("matched {} updates over {} steps in {} engines", result.updates, result.steps,
                            traces.size());
  if (traces[0].stop) {
    result.stopped = true;
    result.text += "\nall stopped: " + traces[0].stop->text;
  }
  if (traces[0].reached) {
    result.reached = true;
    result.text += "\nall ended " + reached_text(traces[0]);
  }
  if (!leave.empty() && !traces[0].stop) {
    if (!text) last = std::move(traces[0].frames.back());
    traces[0].frames.clear();
    leave_state(leave, head_of(loaded, text, false), *last, traces[0]);
  }
  return result;
}

}  // namespace cuboct::python
