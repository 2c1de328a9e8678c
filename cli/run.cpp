// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <memory>
#include <optional>
#include <system_error>

#include "cli/command.h"
#include "cli/engines.h"
#include "cli/estimate.h"
#include "cli/recorder.h"
#include "cli/run_fpga.h"
#include "cli/run_gpu.h"
#include "cli/run_lattice.h"
#include "cli/run_reference.h"
#include "cli/summary.h"
#include "model/base/interrupt.h"
#include "model/base/process.h"
#include "model/base/progress.h"
#include "model/base/steps.h"

namespace cuboct {
namespace {

struct Options {
  Input input;
  std::string engine = "lattice";
  LatticeChoice lattice;
  RealChoice real;
  GpuChoice gpu;
  FpgaChoice fpga;
  std::string out;
  uint64_t steps = 0;
  uint64_t frames_every = 0;
  uint32_t raster = 800;
  bool steps_given = false, frames_given = false, hashes_given = false, json = false, no_watch = false,
       no_states = false, si = false, raster_given = false, force = false, anyway = false;

  // Options of what is kept say nothing where nothing is.
  void check_kept() const {
    const auto needs_out = [&](bool given, const char* option) {
      if (given && out.empty())
        throw InputError(fmt::format("{} needs --out DIR: without it nothing of the run is kept", option));
    };
    needs_out(frames_given, "--frames-every");
    needs_out(raster_given, "--raster");
    needs_out(no_states, "--no-states");
    needs_out(si, "--si");
  }
};

// Bytes of a trace besides its frames, at most.
uint64_t rest_of(const Options& options, const Loaded& loaded, uint64_t steps, uint64_t samples) {
  const bool lattice = options.engine == "lattice" || options.engine == "gpu" || options.engine == "fpga";
  const uint64_t hashes =
      options.engine == "reference" ? 0 : steps / (lattice ? options.lattice.hash_every : 1) + 2;
  const bool cycles = options.lattice.cycles || options.engine == "systemc" || options.engine == "rtl";
  const uint64_t spans = cycles ? steps * loaded.setup.plan.nodes() * kPhases : 0;
  const uint64_t curves = 6 + 3 * loaded.scene.probes.size();
  return 16 * (hashes + spans + curves * (samples + (1 << 10)));
}

// A run of the lattice engine measures itself: the states in between stay where they are.
RunFacts run_by_lattice(const Options& options, const Loaded& loaded, emu::LatticeRun request, Trace& trace,
                        bool& left_checkpoint, std::string& trouble) {
  if (options.out.empty() && options.lattice.keeps_checkpoints())
    throw InputError(fmt::format("{} needs --out DIR, where the checkpoint lies",
                                 options.lattice.resume ? "--resume" : "--checkpoint-every"));
  // Ranks leave their figures in the trace alone: two states tell the rest.
  if (options.out.empty() && options.lattice.ranks <= 1) request.frames.clear();
  if (options.lattice.keeps_checkpoints()) request.checkpoint.path = options.out + "/checkpoint";
  request.energies = true;
  request.watch = !options.no_watch;
  request.cycles = options.lattice.cycles;
  request.hash_every = options.lattice.hash_every;
  LatticeAnswer result =
      run_on_lattice(options.input, loaded.scene, loaded.setup.plan, options.lattice, std::move(request));
  trace = std::move(result.trace);
  left_checkpoint = result.left_checkpoint;
  trouble = std::move(result.trouble);
  return {result.momentum_before,    result.momentum_after, result.largest_speed, trace.curves,
          trace.watched.has_value(), trace.findings,        trace.watched};
}

// Before the first step: what this machine cannot hold.
void check_size(const Options& options, const Loaded& loaded, uint64_t steps, uint64_t frame_every) {
  const LatticeChoice& lattice = options.lattice;
  check_workers(lattice.threads, lattice.ranks, loaded.setup.plan);
  if (options.anyway) return;
  RunSize size = run_size(loaded.scene);
  size.engine = options.engine;
  size.steps = steps;
  size.frame_every = frame_every;
  size.hash_every = lattice.hash_every;
  size.cycles = lattice.cycles;
  size.states = !options.no_states;
  size.raster = options.raster;
  size.threads = lattice.threads;
  size.ranks = lattice.ranks;
  check_lists(loaded.scene, size, options.frames_given);
  check_fits(loaded.scene, size, estimate(loaded.scene, loaded.setup.plan, size), options.out);
}

int run(Options options) {
  options.check_kept();
  std::vector<std::string> allowed = fixed_engines();
  allowed.push_back("reference");
  check_engine(options.engine, allowed);
  const bool lattice = options.engine == "lattice";
  const bool reference = options.engine == "reference";
  const bool gpu = options.engine == "gpu";
  if (!lattice) options.lattice.check_unused(options.engine);
  if (!gpu) options.gpu.check_unused(options.engine);
  const bool fpga = options.engine == "fpga";
  if (fpga)
    options.fpga.check_used();
  else
    options.fpga.check_unused(options.engine);
  options.real.check_used(options.engine);
  check_faults(options.input, {options.engine});
  const Loaded loaded = lattice || gpu ? load_plan(options.input) : load(options.input);
  catch_interrupts();
  const Scene& scene = loaded.scene;
  const uint64_t steps = options.steps_given ? options.steps : scene.steps;
  const uint64_t every = options.frames_given ? options.frames_every : scene.frame_every;
  check_size(options, loaded, steps, every);
  const std::vector<uint64_t> frame_steps = every_so_often(every, steps);
  const std::vector<uint64_t> probe_steps = every_so_often(scene.probe_every, steps);
  std::optional<Recorder> recorder;
  if (!options.out.empty())
    recorder.emplace(
        RecorderOptions{options.out,
                        {options.input.scene, options.input.arch, options.engine},
                        options.lattice.resume,
                        options.force,
                        options.no_states,
                        options.raster,
                        options.real.is_real(options.engine),
                        options.si,
                        options.lattice.cycles || options.engine == "systemc" || options.engine == "rtl",
                        rest_of(options, loaded, steps, probe_steps.size())},
        loaded);
  const auto keep = [&](const State& state) {
    if (recorder) recorder->keep(state);
  };

  Trace trace;
  Items summary;
  std::string trouble;  // what could not be written, but for the recorder's
  bool left_checkpoint = false;
  bool failed = false;  // in the sense of model/analysis/watch.h
  if (reference) {
    RealOptions real = options.real.options();
    real.threads = options.lattice.threads;
    ReferenceRun run = run_reference(loaded, real, steps, frame_steps, probe_steps, !options.no_watch,
                                     recorder ? &*recorder : nullptr);
    failed = run.failed;
    trace = std::move(run.trace);
    summary = std::move(run.summary);
  } else if (gpu) {
    GpuRequest request;
    request.steps = steps;
    if (!options.out.empty()) request.frames = frame_steps;
    request.precision = options.real.precision.empty() ? "fixed" : options.real.precision;
    request.watch = !options.no_watch;
    request.passes = true;
    if (options.hashes_given || request.precision == "fixed") request.hash_every = options.lattice.hash_every;
    GpuAnswer answer =
        run_on_gpu(options.input, loaded, options.gpu, request, recorder ? &*recorder : nullptr);
    failed = answer.failed;
    trace = std::move(answer.trace);
    summary = std::move(answer.summary);
  } else if (lattice) {
    emu::LatticeRun request;
    request.steps = steps;
    request.frames = frame_steps;
    request.probes = probe_steps;
    request.keep = keep;
    const RunFacts facts =
        run_by_lattice(options, loaded, std::move(request), trace, left_checkpoint, trouble);
    summary = summarise(loaded, trace, facts);
    failed = !facts.findings.empty();
  } else {
    // Engines know nothing of probes: they record states, and one meter reads them.
    Request request{steps, frame_steps};
    RunMeter meter(loaded, probe_steps, !options.no_watch);
    if (options.engine == "golden") {
      trace = run_golden(
          loaded.setup, request, [&](const State& state) { meter.see(state); }, keep);
    } else {
      request.frames.clear();
      std::set_union(frame_steps.begin(), frame_steps.end(), probe_steps.begin(), probe_steps.end(),
                     std::back_inserter(request.frames));
      const Scratch scratch;
      const std::string path = scratch.path(options.engine + ".h5");
      RunningEngine engine =
          fpga ? start_fpga(options.input, options.fpga, request,
                            options.hashes_given ? options.lattice.hash_every : 0, path, stderr_is_terminal())
               : RunningEngine(options.engine, options.input, request, path, stderr_is_terminal());
      const auto reader = engine.finish_reading();
      trace = reader->rest();
      reader->frames([&](const State& state) {
        meter.see(state);
        if (state.step == trace.steps() ||
            std::binary_search(frame_steps.begin(), frame_steps.end(), state.step))
          keep(state);
      });
    }
    const RunFacts facts = meter.finish();
    trace.curves = facts.curves;
    trace.findings = facts.findings;
    trace.watched = facts.watched;
    summary = summarise(loaded, trace, facts);
    failed = !facts.findings.empty();
  }
  trace.asked = steps;
  add_end(summary, trace);
  // Run to its end, or to a fault, it has nothing left to do.
  const bool unfinished = interrupted() && !trace.stop && trace.steps() < steps;
  const char* state = !trouble.empty() ? "incomplete"
                      : trace.stop     ? "stopped"
                      : unfinished     ? "interrupted"
                                       : "finished";
  if (recorder)
    std::signal(SIGPIPE, SIG_IGN);  // a reader that went away costs the summary's lines, not the files
  try {
    fmt::print("{}", options.json ? summary.json() : summary.text());
    if (std::fflush(stdout) != 0) throw std::system_error(errno, std::generic_category());
  } catch (const std::system_error& error) {
    if (trouble.empty()) trouble = fmt::format("cannot print the summary: {}", error.code().message());
  }
  if (recorder) {
    recorder->finish(trace, summary, state);
    if (!recorder->trouble().empty()) trouble = recorder->trouble();
  }
  if (unfinished)
    fmt::print(stderr, "interrupted{}\n",
               left_checkpoint
                   ? fmt::format("; the same command with --resume goes on at step {}", trace.steps())
                   : "");
  else if (options.lattice.keeps_checkpoints() &&
           trouble.empty())  // else it is what writes all of it once more
    emu::remove_checkpoint(options.out + "/checkpoint");
  if (!trouble.empty()) throw InputError(trouble);
  return trace.stop || failed || unfinished ? 1 : 0;
}

}  // namespace

void add_run(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("run", "run a scene and end with a summary");
  options->input.add_to(*command);
  options->input.add_stalls_to(*command);
  command
      ->add_option("--engine", options->engine,
                   "lattice, golden, systemc, rtl, fpga, gpu or reference (doubles or floats)")
      ->capture_default_str();
  auto* steps = command->add_option("--steps", options->steps, "steps; default: the scene's")
                    ->check(whole_number())
                    ->type_name("N");
  auto* frames = command
                     ->add_option("--frames-every", options->frames_every,
                                  "keep every K-th state; default: the scene's; 0: first and last")
                     ->check(whole_number())
                     ->type_name("K");
  LatticeChoice& lattice = options->lattice;
  lattice.add_to(*command);
  options->real.add_to(*command);
  options->gpu.add_to(*command);
  options->fpga.add_to(*command);
  command->add_flag("--joules", options->gpu.joules,
                    "measure the energy of gpu's devices, which rest for two seconds first");
  auto* hashes = command
                     ->add_option("--hash-every", lattice.hash_every,
                                  "steps between two hashes of lattice's, gpu's or fpga's state")
                     ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 62))
                     ->capture_default_str()
                     ->type_name("K");
  command->add_flag("--cycles", lattice.cycles, "count the machine's cycles in lattice");
  command
      ->add_option("--checkpoint-every", lattice.checkpoint_every,
                   "'1000 steps', '30 s', '5 min' or '2 h': how often lattice leaves a checkpoint in DIR")
      ->type_name("T");
  command->add_flag("--resume", lattice.resume, "go on from the checkpoint in DIR");
  command->add_option("--out", options->out, "directory for trace, frames, plan and summary")
      ->type_name("DIR");
  command->add_flag("--force", options->force, "begin anew in a DIR whose run did not end, in its place");
  auto* raster = command
                     ->add_option("--raster", options->raster,
                                  "pixels along the body of the pictures that DIR keeps of its frames")
                     ->check(CLI::Range(16u, 16384u))
                     ->capture_default_str()
                     ->type_name("PX");
  command->add_flag("--no-states", options->no_states,
                    "of the frames, DIR keeps rasters.h5 alone: for bodies of millions of particles");
  command->add_flag("--si", options->si,
                    "the trace in DIR holds positions and velocities in m and m/s as well");
  command->add_flag("--no-watch", options->no_watch,
                    "do not look for what makes a run wrong (docs/reference/failures.md)");
  command->add_flag("--anyway", options->anyway, "run although it needs more memory or disk than is free");
  command->add_flag("--json", options->json, "print the summary as JSON");
  command->callback([options, steps, frames, hashes, raster, &exit_code] {
    options->hashes_given = hashes->count() > 0;
    options->steps_given = steps->count() > 0;
    options->raster_given = raster->count() > 0;
    options->frames_given = frames->count() > 0;
    exit_code = run(*options);
  });
}

}  // namespace cuboct
