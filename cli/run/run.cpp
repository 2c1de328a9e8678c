// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include "cli/answer.h"
#include "cli/command.h"
#include "cli/programs.h"
#include "cli/run/engine_run.h"
#include "cli/run/estimate.h"
#include "cli/run/frame_feed.h"
#include "cli/run/recorder.h"
#include "cli/run/stages.h"
#include "cli/run/summary.h"
#include "cli/run/view.h"
#include "hw/engine/engines.h"
#include "hw/engine/scene_engine.h"
#include "hw/program/options.h"
#include "model/base/interrupt.h"
#include "model/base/process.h"
#include "model/base/progress.h"
#include "model/base/steps.h"
#include "model/scene/readings.h"

namespace cuboct {
namespace {

struct RunOptions {
  Input input;
  std::string engine;  // empty: lattice, or the one that relaxes where the scene's loading is static
  EngineOptions engines;
  std::string out;
  uint64_t steps = 0;
  uint64_t frame_every = 0;
  std::vector<std::string> frames{"xyz", "vtp"};
  uint32_t raster = 800;
  bool in_stages = false;  // one run of several, which are summed up together
  Answer answer;
  bool steps_given = false, frames_given = false, formats_given = false, no_watch = false, no_states = false,
       si = false, raster_given = false, force = false, quiet = false, verbose = false, view = false,
       opens = true, csv = false;

  // Of the frames' files.
  std::vector<std::string> formats() const {
    if (std::ranges::count(frames, "none") == 0) return frames;
    if (frames.size() > 1) throw InputError("--frames: none goes with no other format");
    return {};
  }

  // Options of what is kept say nothing where nothing is.
  void check_kept() const {
    const auto needs_out = [&](bool given, const char* option) {
      if (given && out.empty())
        throw InputError(fmt::format("{} needs --out DIR: without it nothing of the run is kept", option));
    };
    needs_out(frames_given, "--frame-every");
    needs_out(formats_given, "--frames");
    needs_out(raster_given, "--raster");
    needs_out(no_states, "--no-states");
    needs_out(si, "--si");
    needs_out(view, "--view");
    needs_out(csv, "--csv");
    if (out.empty() && engines.keeps_checkpoints())
      throw InputError(fmt::format("{} needs --out DIR, where the checkpoint lies",
                                   engines.resume ? "--resume" : "--checkpoint-every"));
  }
};

bool counts_cycles(const RunOptions& options) {
  return engine_row(options.engine).cycles || options.engines.cycles;
}

// Bytes of a trace besides its frames, at most.
uint64_t rest_of(const RunOptions& options, const Loaded& loaded, uint64_t steps, uint64_t samples) {
  const uint64_t every = hashes_every(options.engine, options.engines);
  const uint64_t hashes = every > 0 ? steps / every + 2 : 0;
  const uint64_t spans = counts_cycles(options) ? steps * spans_of_step(loaded.setup.plan) : 0;
  const uint64_t curves = 6 + 3 * loaded.scene.probes.size();
  return 16 * (hashes + spans + curves * (samples + (1 << 10)));
}

// Before the first step: what this machine cannot hold.
void check_size(const RunOptions& options, const Loaded& loaded, uint64_t steps, uint64_t frame_every) {
  const EngineOptions& engines = options.engines;
  check_workers(engines.threads, engines.ranks, engines.anyway, loaded.setup.plan);
  RunSize size = run_size(loaded.scene, steps);
  size.engine = options.engine;
  size.frame_every = frame_every;
  size.hash_every = hashes_every(options.engine, engines);
  size.cycles = engines.cycles;
  size.states = !options.no_states;
  size.raster = options.raster;
  size.threads = engines.threads;
  size.ranks = engines.ranks;
  size.checkpoints = engines.keeps_checkpoints();
  check_lists(loaded.scene, size, options.frames_given);
  if (engines.anyway) return;
  check_fits(loaded.scene, size, estimate(loaded.scene, loaded.setup.plan, size), options.out);
}

// What --verbose says: where the engine runs, what it computes, and why what the arch file leaves to cuboct
// is as it is.
std::string plan_text(const RunOptions& options, const Plan& plan) {
  const EngineRow& row = engine_row(options.engine);
  const std::string program = options.engines.ranks > 1 ? row.ranks : row.program;
  std::string text = fmt::format("  {:<22} {}, {}\n", "engine", row.name,
                                 program.empty() ? "in this process" : "the program " + program);
  if (options.engines.is_real(options.engine)) return text;
  text += describe(plan);
  for (const WidthReason& reason : plan.reasons)
    text += fmt::format("  {:<22} {}: {}\n", reason.key, reason.bits,
                        reason.asked ? "by the arch file" : reason.why);
  for (const std::string& warning : plan.warnings) text += fmt::format("  {:<22} {}\n", "warning", warning);
  return text;
}

// Frames of a run that is viewed and of which nobody says how many.
constexpr uint64_t kViewed = 40;

// Of a run, or of each stage.
struct Pages {
  std::vector<std::unique_ptr<RunPage>> all;
  bool ended_run = false;  // one of them has asked for that

  void wait() {
    for (const auto& page : all) page->wait(ended_run);
  }
};

// How a run ended.
struct Ended {
  int code = 0;
  bool whole = false;  // it has a last state that the next stage can begin with
};

// With the engine that the scene asks for, where the command line names none.
RunOptions for_scene(RunOptions options, const Scene& scene) {
  if (options.engine.empty()) options.engine = engine_for(scene);
  options.engines.check({options.engine}, options.input);
  options.steps = whole_steps(scene, options.steps);
  options.frame_every = whole_steps(scene, options.frame_every);
  if (scene.loading) options.no_watch = true;  // it looks for what goes wrong in motion
  return options;
}

Ended run_once(const RunOptions& given, Pages& pages) {
  const Loaded loaded = load_plan(given.input, given.engine, given.engines.is_real(given.engine));
  const RunOptions options = for_scene(given, loaded.scene);
  if (options.verbose) fmt::print(stderr, "{}", plan_text(options, loaded.setup.plan));
  catch_interrupts();
  const Scene& scene = loaded.scene;
  const bool real = options.engines.is_real(options.engine);
  RunRequest request;
  request.steps = options.steps_given ? options.steps : scene.steps;
  uint64_t every = options.frames_given ? options.frame_every : scene.frame_every;
  if (every == 0 && (options.view || is_viewed(options.out)))
    every = std::max<uint64_t>(1, request.steps / kViewed);
  check_size(options, loaded, request.steps, every);
  const Readings readings = readings_of(scene, request.steps);
  request.probes = every_so_often(readings.probes, request.steps);
  request.energy_steps = every_so_often(readings.energies, request.steps);
  request.energies = request.totals = true;
  request.watch = !options.no_watch;
  request.until = true;
  request.cycles = options.engines.cycles;
  request.hash_every = hashes_every(options.engine, options.engines);
  request.log = options.quiet ? LogRows::quiet : stderr_is_terminal() ? LogRows::seconds : LogRows::parts;
  if (options.engines.keeps_checkpoints()) request.checkpoint.path = options.out + "/checkpoint";
  const std::string checkpoint = request.checkpoint.path;
  std::optional<Recorder> recorder;
  const TraceHead head = head_of(loaded, real, false);
  std::optional<FrameFeed> feed;  // until the directory is whole: its page then reads that
  if (!options.out.empty()) {
    request.frames = every_so_often(every, request.steps);
    RecorderOptions kept;
    kept.directory = options.out;
    kept.record = {options.input.scene, options.input.arch,  options.engine,
                   "running",           options.input.stage, options.input.from};
    kept.resume = options.engines.resume;
    kept.force = options.force;
    kept.no_states = options.no_states;
    kept.frames = options.formats();
    kept.raster = options.raster;
    kept.real = real;
    kept.si = options.si;
    kept.csv = options.csv;
    kept.cycles = counts_cycles(options);
    kept.rest = rest_of(options, loaded, request.steps, request.probes.size());
    kept.see = [&, last = request.steps](const Frame& frame, const State* state) {
      feed->show(frame, state, frame.step == last || interrupted());
    };
    recorder.emplace(std::move(kept), loaded);
    feed.emplace(options.out, head, frame_style(scene), loaded.setup.plan.particles, options.engine);
    if (options.view) pages.all.push_back(std::make_unique<RunPage>(options.out, options.opens));
    request.read = [&](const std::vector<Curve>& of, uint64_t step, Values values) {
      feed->read(of, step, values);
    };
    request.keep = [&](const RunState& frame) {
      std::visit([&](const auto& state) { recorder->keep(state); }, frame);
    };
  }

  const Scratch scratch;
  const uint64_t steps = request.steps;
  Recorded run = EngineRun(options.engine, options.input, loaded, options.engines, std::move(request),
                           scratch.path(options.engine + ".h5"), true)
                     .finish();
  Trace& trace = run.trace;
  const bool cut = run.interrupted && feed && feed->is_cut();
  trace.asked = cut ? trace.steps() : steps;
  note_start(trace, loaded, real);
  Items summary = summarise(loaded, run, real);
  add_end(summary, trace);
  // Run to its end, or to a fault, it has nothing left to do.
  const bool unfinished = run.interrupted && !trace.stop && !cut;
  std::string trouble = run.trouble;
  const char* state = !trouble.empty() ? "incomplete"
                      : trace.stop     ? "stopped"
                      : unfinished     ? "interrupted"
                                       : "finished";
  if (!options.in_stages || !options.answer.json) options.answer.close(summary);
  std::fflush(stdout);
  if (recorder) {
    recorder->finish(trace, summary, state);
    if (!recorder->trouble().empty()) trouble = recorder->trouble();
  }
  if (options.view) pages.all.back()->report();
  if (feed) pages.ended_run |= feed->has_ended();
  feed.reset();
  if (unfinished)
    fmt::print(stderr, "interrupted{}\n",
               run.left_checkpoint
                   ? fmt::format("; the same command with --resume goes on at step {}", trace.steps())
                   : "");
  else if (trouble.empty())  // else it is what writes all of it once more
    remove_checkpoint(checkpoint);
  if (!trouble.empty()) throw InputError(trouble);
  return {trace.stop || !trace.findings.empty() || unfinished ? 1 : 0, !trace.stop && !unfinished};
}

int run(RunOptions options) {
  if (!options.engine.empty()) options.engines.check({engine_row(options.engine).name}, options.input);
  options.check_kept();
  static_cast<void>(options.formats());
  const std::vector<StageName> names = stages_of(options.input.scene);
  Pages pages;
  if (names.empty()) {
    const int code = run_once(options, pages).code;
    pages.wait();
    return code;
  }
  if (options.out.empty())
    throw InputError(
        "a scene of stages needs --out DIR, where each keeps the state that the next one begins with");
  if (options.no_states) throw InputError("--no-states keeps no state with which the next stage could begin");
  const StageRange taken = stages_to_take(options.input.scene, names, options.input.stage);
  if (options.steps_given && (options.input.stage.empty() || taken.end - taken.first > 1))
    throw InputError("--steps goes with --stage NAME: each stage has its own steps");
  StageRun request{
      options.input.scene,    names,         options.input.stage, options.input.from, options.out,
      options.engines.resume, options.force, options.answer.json};
  bool opens = true;  // one tab is enough
  const int code = run_stages(request, [&](const StageDirectory& stage) {
    RunOptions one = options;
    one.in_stages = true;
    one.opens = std::exchange(opens, false);
    one.input.stage = stage.name;
    one.input.from = stage.from;
    one.out = stage.path;
    one.engines.resume = stage.resume;
    one.force = stage.force;
    const Ended ended = run_once(one, pages);
    return std::pair{ended.code, ended.whole};
  });
  pages.wait();
  return code;
}

}  // namespace

void add_run(Command& app, int& exit_code) {
  auto [command, options] = add_command<RunOptions>(app, "run", exit_code, run);
  options->input.add_to(command);
  options->input.add_start_to(command);
  options->input.add_stalls_to(command);
  command
      .option(
          "--engine", options->engine,
          "lattice, golden, systemc, rtl, fpga, gpu or reference (doubles or floats); default: lattice, for "
          "static loading reference")
      .proposed(engines_that([](auto&) { return true; }));
  command.option("--steps", options->steps, "steps; default: the scene's", "N")
      .check(whole_number)
      .given(options->steps_given);
  command
      .option("--frame-every", options->frame_every,
              "keep every K-th state; default: the scene's; 0: first and last", "K")
      .check(whole_number)
      .given(options->frames_given);
  command
      .option("--frames", options->frames,
              "formats of the frames in DIR, written as they come: xyz, xyz.gz, ase "
              "(frames.ase.xyz), vtp, lammps (frames.dump.gz), or none; default: xyz,vtp",
              "A,B,...")
      .delimiter(',')
      .one_word()
      .one_of({"xyz", "xyz.gz", "ase", "vtp", "lammps", "none"})
      .given(options->formats_given);
  options->engines.add_machines(command);
  options->engines.add_numbers(command);
  options->engines.add_run(command);
  command.option("--out", options->out, "directory for trace, frames, plan and summary", "DIR");
  command.flag("--force", options->force, "begin anew in a DIR whose run did not end, in its place");
  command
      .option("--raster", options->raster,
              "pixels along the body of the pictures that DIR keeps of its frames", "PX")
      .range(16u, 16384u)
      .show_default()
      .given(options->raster_given);
  command.flag("--no-states", options->no_states,
               "of the frames, DIR keeps rasters.h5 alone: for bodies of millions of particles");
  command.flag("--csv", options->csv, "DIR holds the curves as comma-separated values too: curves.csv");
  command.flag("--si", options->si, "the trace in DIR holds positions and velocities in m and m/s as well");
  command.flag("--no-watch", options->no_watch,
               "do not look for what makes a run wrong (docs/reference/failures.md)");
  command.flag("--view", options->view,
               "show the run while it goes, as 'cuboct view' does, in a browser where there is a display; "
               "keeps 40 frames unless scene or --frame-every say otherwise, and leaves DIR/report.html");
  const Option quiet = command.flag("-q,--quiet", options->quiet,
                                    "nothing on stderr but errors: no table of the run as it goes");
  command.flag("-v,--verbose", options->verbose, "say what runs before it does: engine, plan, reasons")
      .excludes(quiet);
  options->answer.add_to(command);
}

}  // namespace cuboct
