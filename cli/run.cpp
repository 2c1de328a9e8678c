// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "cli/command.h"
#include "cli/engines.h"
#include "model/interrupt.h"
#include "cli/outputs.h"
#include "cli/run_reference.h"
#include "cli/summary.h"
#include "model/output.h"

namespace cuboct {
namespace {

struct Options {
  Input input;
  std::string engine = "golden";
  std::string out;
  uint64_t steps = 0;
  uint64_t frames_every = 0;
  bool steps_given = false, frames_given = false, json = false;
};

void write_outputs(const Options& options, const Loaded& loaded, const Trace& trace,
                   const std::vector<Frame>& frames, const Items& summary) {
  const std::string& out = options.out;
  const FrameStyle style = frame_style(loaded.scene);
  write_trace(out + "/trace.h5", trace);
  write_extended_xyz(out + "/frames.xyz", frames, style);
  write_vtk(out + "/frames", frames, style);
  write_text(out + "/plan.txt", describe(loaded.setup.plan));
  write_text(out + "/summary.json", summary.json());
  write_record(out, {options.input.scene, options.input.arch, options.engine});
}

int run(Options options) {
  std::vector<std::string> allowed = fixed_engines();
  allowed.push_back("reference");
  check_engine(options.engine, allowed);
  const Loaded loaded = load(options.input);
  catch_interrupts();
  if (!options.out.empty()) prepare_directory(options.out);
  const Scene& scene = loaded.scene;
  const uint64_t steps = options.steps_given ? options.steps : scene.steps;
  const uint64_t every = options.frames_given ? options.frames_every : scene.frame_every;
  const std::vector<uint64_t> frame_steps = every_so_often(every, steps);
  const std::vector<uint64_t> probe_steps = every_so_often(scene.probe_every, steps);

  Trace trace;
  std::vector<Frame> frames;
  Items summary;
  if (options.engine == "reference") {
    ReferenceRun reference = run_reference(loaded, steps, frame_steps, probe_steps);
    trace = std::move(reference.trace);
    frames = std::move(reference.frames);
    summary = std::move(reference.summary);
  } else {
    // Engines know nothing of probes: they record states, and one meter reads them.
    Request request{steps, {}};
    std::set_union(frame_steps.begin(), frame_steps.end(), probe_steps.begin(), probe_steps.end(),
                   std::back_inserter(request.frames));
    if (options.engine == "golden") request.frames = frame_steps;
    RunMeter meter(loaded, probe_steps);
    trace = run_fixed(options.engine, options.input, loaded.setup, request,
                      [&](const State& state) { meter.see(state); });
    const RunFacts facts = meter.finish();
    trace.curves = facts.curves;
    std::erase_if(trace.frames, [&](const State& frame) {
      return frame.step != trace.steps() &&
             !std::binary_search(frame_steps.begin(), frame_steps.end(), frame.step);
    });
    summary = summarise(loaded, trace, facts);
    if (!options.out.empty()) frames = real_frames(loaded, trace.frames);
  }
  if (!options.out.empty()) write_outputs(options, loaded, trace, frames, summary);
  fmt::print("{}", options.json ? summary.json() : summary.text());
  if (interrupted()) fmt::print(stderr, "interrupted\n");
  return trace.stop || interrupted() ? 1 : 0;
}

}  // namespace

void add_run(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("run", "run a scene and end with a summary");
  options->input.add_to(*command);
  options->input.add_stalls_to(*command);
  command->add_option("--engine", options->engine, "golden, systemc, rtl or reference (doubles)")
      ->capture_default_str();
  auto* steps = command->add_option("--steps", options->steps, "steps; default: the scene's")
                    ->check(whole_number())
                    ->type_name("N");
  auto* frames = command
                     ->add_option("--frames-every", options->frames_every,
                                  "keep every K-th state; default: the scene's; 0: first and last")
                     ->check(whole_number())
                     ->type_name("K");
  command->add_option("--out", options->out, "directory for trace, frames, plan and summary")
      ->type_name("DIR");
  command->add_flag("--json", options->json, "print the summary as JSON");
  command->callback([options, steps, frames, &exit_code] {
    options->steps_given = steps->count() > 0;
    options->frames_given = frames->count() > 0;
    exit_code = run(*options);
  });
}

}  // namespace cuboct
