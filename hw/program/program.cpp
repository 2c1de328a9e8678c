// SPDX-License-Identifier: MIT
#include "hw/program/program.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "hw/plan/real_plan.h"
#include "hw/plan/setup.h"
#include "hw/program/command_line.h"
#include "hw/program/error_file.h"
#include "hw/program/frame_files.h"
#include "hw/program/options.h"
#include "model/analysis/meter.h"
#include "model/base/error_parts.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/steps.h"
#include "model/base/text.h"
#include "model/config/config.h"
#include "model/rules/rounds_rule.h"
#include "model/run/start.h"
#include "model/scene/readings.h"
#include "model/trace/trace_file.h"

namespace cuboct {
namespace {

// What is parsed and then settled.
struct Parsed {
  ProgramOptions options;
  std::string scene_path, frames_file, frame_files, begun, interval, error, log;
  bool frames_given = false, unpacked = false, keeps_checkpoint = false;
};

void settle(const EngineProgram& program, Parsed& parsed, const Scene& scene) {
  ProgramOptions& options = parsed.options;
  RunRequest& run = options.run;
  run.steps = options.steps.value_or(scene.steps);
  if (run.steps > program.abilities.steps)
    throw InputError(
        fmt::format("{} steps: the machine counts at most {}", run.steps, program.abilities.steps))
        .about(options.steps ? std::vector<std::string>()
                             : std::vector<std::string>{"run.steps", "run.duration"});
  if (!parsed.frames_file.empty()) run.frames = read_steps(parsed.frames_file);
  put_in_order(run.frames);
  std::erase_if(run.frames, [&](uint64_t step) { return step > run.steps; });
  if (!parsed.frames_given && !options.bench) run.frames = {0, run.steps};
  if (run.watch) run.energies = true;
  // Energies are read at the first and the last step too.
  const Readings readings = readings_of(scene, run.steps);
  run.probes = run.energies ? every_so_often(readings.probes, run.steps) : probe_steps_of(scene, run.steps);
  if (run.energies) run.energy_steps = every_so_often(readings.energies, run.steps);
  run.totals = !options.bench;
  run.cycles |= program.abilities.always_cycles;
  // A benchmark times steps: its one hash is the last state's.
  if (options.bench) run.hash_every = std::max<uint64_t>(run.steps, 1);
}

void check(const Parsed& parsed) {
  const ProgramOptions& options = parsed.options;
  const RunRequest& run = options.run;
  if (options.scene.empty()) throw InputError("a scene is required");
  if (options.out.empty() && !options.bench) throw InputError("--out is required");
  if (run.checkpoint.path.empty() && (run.checkpoint.resume || !parsed.interval.empty()))
    throw InputError("--resume and --checkpoint-every need --checkpoint FILE");
}

int tell(EngineProgram& program, const Parsed& parsed, const Scene& scene, const Plan& plan,
         const Recorded& run) {
  const Trace& trace = run.trace;
  if (!program.silent) {
    if (parsed.options.bench)
      program.print_bench(scene, plan, run);
    else
      program.print_end(plan, trace);
    for (const Finding& finding : trace.findings) fmt::print("warning: {}\n", line_text(finding.text));
    if (run.interrupted && !trace.stop)
      fmt::print("interrupted after step {}{}\n", trace.steps(),
                 run.left_checkpoint ? "; the same command with --resume goes on" : "");
  }
  if (trace.stop && parsed.error.empty())
    fmt::print(stderr, "{}: {}\n", line_text(parsed.options.scene), line_text(trace.stop->text));
  return run.interrupted || trace.stop || !trace.findings.empty() ? 1 : 0;
}

int run_scene(EngineProgram& program, Parsed& parsed, Scene& scene, const Arch& arch) {
  ProgramOptions& options = parsed.options;
  const bool leads = program.leads();
  const RoundsRule* rounds = scene.rule.rounds.get();
  const bool text = program.abilities.text && rounds != nullptr && rounds->text() != nullptr;
  const CellForm form = program.abilities.any_cells ? CellForm::any : CellForm::cubes;
  const Plan plan = !text                         ? plan_of(scene, arch, form)
                    : program.abilities.real_text ? real_plan_of(scene, arch)
                                                  : program_plan_of(scene, arch, form);
  settle(program, parsed, scene);

  std::optional<TraceWriter> writer;
  std::optional<FrameSender> sender;
  std::string trouble;
  if (!options.out.empty() && leads) {
    writer.emplace(options.out, temporary_beside(options.out), !parsed.unpacked);
    if (!parsed.frame_files.empty()) {
      sender.emplace(parsed.frame_files);
      options.run.read = [&sender](const std::vector<Curve>& of, uint64_t step, Values values) {
        sender->read(of, step, values);
      };
    }
    options.run.keep = [&](const RunState& frame) {
      std::visit(
          [&](const auto& state) {
            try {
              if (sender)
                sender->send(frame);
              else
                writer->add(state);
            } catch (const InputError& error) {
              if (trouble.empty())
                trouble = fmt::format("{}; frames are left out from step {} on", parts_of(error).message,
                                      state.step);
            }
          },
          frame);
    };
  }
  EngineKind kind = program.kind(scene, plan, options);
  if (leads && !parsed.begun.empty())
    kind.make = [&parsed, make = kind.make](CheckpointReader* from, bool cycles) {
      auto engine = make(from, cycles);
      write_text(parsed.begun, "");
      return engine;
    };
  catch_interrupts();
  Recorded result = record(scene, kind, options.run);
  if (!leads) return result.trace.stop || result.interrupted ? 1 : 0;
  if (options.run.totals) put_totals(result);
  if (writer) writer->finish(result.trace);
  const int code = tell(program, parsed, scene, plan, result);
  if (!trouble.empty()) throw InputError(trouble);
  if (!result.interrupted && !parsed.keeps_checkpoint) remove_checkpoint(options.run.checkpoint.path);
  return code;
}

int run(EngineProgram& program, Parsed& parsed) {
  ProgramOptions& options = parsed.options;
  if (program.prepare(options)) return 0;
  check(parsed);
  if (!options.out.empty() && program.leads()) check_writable(options.out);
  if (!parsed.interval.empty()) read_interval(parsed.interval, options.run.checkpoint);
  const std::string& path = parsed.scene_path.empty() ? options.scene : parsed.scene_path;
  Scene scene = load_scene(read_config_text(options.scene), path, {options.stage, options.from});
  program.begin(scene);
  const Arch arch = read_arch(options.arch);
  return with_places(scene, arch, [&] { return run_scene(program, parsed, scene, arch); });
}

LogRows rows_of(const std::string& name) {
  for (const LogRows rows : {LogRows::quiet, LogRows::seconds, LogRows::parts})
    if (name == to_string(rows)) return rows;
  return LogRows::off;
}

void add_options(Command& app, EngineProgram& program, Parsed& parsed) {
  ProgramOptions& options = parsed.options;
  RunRequest& run = options.run;
  const ProgramAbilities& can = program.abilities;
  app.option("scene", options.scene, "Scene file (TOML)");
  app.option("--scene-path", parsed.scene_path,
             "The scene's own path, where a copy is read: what it names lies beside it, and errors tell it",
             "FILE");
  app.option("--arch", options.arch, "Machine description (TOML); the defaults without one");
  app.option("--stage", options.stage, "Of a scene with [[stage]]: the one to run");
  app.option("--from", options.from, "Directory of a run: this one begins with its last state");
  app.option("--steps", options.steps, "Steps to run; the scene's own number without it");
  app.option("--out", options.out, "Trace file to write (HDF5); --bench does without");
  app.flag("--keep-checkpoint", parsed.keeps_checkpoint,
           "Leave the checkpoint at the end: who started this removes it, once all is written");
  app.flag("--unpacked", parsed.unpacked, "Do not compress the trace: larger, and written in less time");
  app.option("--error", parsed.error, "File that takes an error, in place of standard error");
  app.option("--frame-files", parsed.frame_files,
             "Each state that is kept goes into a file PREFIX.0, PREFIX.1, ... as it comes, none into "
             "the trace, for a reader "
             "who removes them: the program waits while 16 are there",
             "PREFIX");
  app.option("--begun", parsed.begun, "File that is made when the steps begin");
  app.flag("--energies", run.energies, "Measure energies with the probes, and at the last state");
  app.flag("--watch", run.watch, "Look for what makes a run wrong; energies are measured with it");
  app.flag("--until", run.until, "End where the scene's 'until' holds");
  app.option("--hash-every", run.hash_every, "Steps between two hashes of the state; 0: none")
      .show_default()
      .given(options.hashes_given);
  if (can.cycles) app.flag("--cycles", run.cycles, "Count the machine's cycles with the timing model");
  if (can.text)
    app.flag("--integers", run.integers, "Frames of a rule of text hold its integers, for comparisons");
  if (can.forces) app.flag("--forces", run.forces, "Frames in real numbers hold the pair forces too");
  if (can.checkpoints) {
    app.option("--checkpoint", run.checkpoint.path, "File that the run can go on from; gone when it ends");
    app.option("--checkpoint-every", parsed.interval, "'1000 steps', '30 s', '5 min' or '2 h'");
    app.flag("--resume", run.checkpoint.resume, "Go on from the checkpoint");
  }
  app.flag("--bench", options.bench, "Print 'name value unit' lines; no trace unless --out asks for one");
  app.option("--log", parsed.log,
             "A table on standard error, a row each two 'seconds' or twenty as 'parts' of the run; 'off': a "
             "line in place on a terminal; 'quiet': not even that",
             "ROWS")
      .one_of({"off", "quiet", "seconds", "parts"});
  program.add_options(app);
}

}  // namespace

void EngineProgram::print_bench(const Scene&, const Plan& plan, const Recorded& run) {
  const Trace& trace = run.trace;
  const double seconds = std::max(trace.seconds, 1e-9);
  const auto steps = static_cast<double>(trace.steps() - run.resumed_at);
  fmt::print("{}.particle_steps {:.6g} 1/s\n", trace.engine, steps * plan.particles / seconds);
  for (const auto& [counter, value] : trace.counters)
    if (counter == "cycles" && !trace.cycles.empty())
      fmt::print("{}.node_cycles {:.6g} 1/s\n", trace.engine,
                 value * static_cast<double>(trace.nodes) / seconds);
  for (const auto& [counter, value] : trace.counters)
    fmt::print("{}.{} {:.15g} 1\n", trace.engine, counter, value);
  fmt::print("{}.seconds {:.6g} s\n", trace.engine, trace.seconds);
}

void EngineProgram::print_end(const Plan& plan, const Trace& trace) {
  fmt::print("{} steps of {} particles on {} nodes, {:.3g} particle-steps/s\n", trace.steps(), plan.particles,
             trace.nodes,
             static_cast<double>(trace.steps()) * plan.particles / std::max(trace.seconds, 1e-9));
}

int run_program(int argc, char** argv, EngineProgram& program) {
  Parsed parsed;
  Command app(program.name, program.description);
  add_options(app, program, parsed);
  const Option frames = app.option("--frames", parsed.options.run.frames,
                                   "Steps whose states are kept; the first and the last without it")
                            .delimiter(',')
                            .given(parsed.frames_given);
  app.option("--frames-file", parsed.frames_file, "The same from a file, one step per line")
      .excludes(frames)
      .given(parsed.frames_given);
  if (const std::optional<int> ended = parse_command_line(app, argc, argv)) return *ended;
  parsed.options.run.log = rows_of(parsed.log);
  // Bad input is the same in all processes of a run: in a file it is told by whoever comes first, else once.
  const auto told = [&](const InputError& error, const std::string& text, int code) {
    bool written = false;
    try {
      if (!parsed.error.empty()) write_error(parsed.error, error), written = true;
    } catch (const std::exception&) {  // a full disk, say
    }
    if (!written && (code == 1 || program.leads())) fmt::print(stderr, "{}\n", text);
    program.give_up(code);
    return code;
  };
  try {
    return run(program, parsed);
  } catch (const InputError& e) {
    return told(e, e.told(), 2);
  } catch (const std::exception& e) {
    if (const auto refusal = path_error(e)) return told(*refusal, refusal->told(), 2);
    const std::string text = fmt::format("{}: {}", program.name, failure_text(e));
    return told(InputError(text), text, 1);
  }
}

std::vector<std::string> program_arguments(const std::string& scene, const std::string& arch,
                                           const RunRequest& request, const std::string& out,
                                           const std::string& steps_file) {
  std::vector<std::string> words{scene, "--steps",      std::to_string(request.steps),     "--out",
                                 out,   "--hash-every", std::to_string(request.hash_every)};
  const auto add = [&](bool wanted, std::initializer_list<std::string> more) {
    if (wanted) words.insert(words.end(), more);
  };
  add(!arch.empty(), {"--arch", arch});
  // A few on the command line, where they can be read; it holds no more than some ten thousand. An empty list
  // in a file asks for none.
  constexpr size_t kListed = 1000;
  if (request.frames.empty() || request.frames.size() > kListed) {
    write_text(steps_file, fmt::format("{}\n", fmt::join(request.frames, "\n")));
    add(true, {"--frames-file", steps_file});
  } else {
    add(true, {"--frames", fmt::format("{}", fmt::join(request.frames, ","))});
  }
  const CheckpointPlan& checkpoint = request.checkpoint;
  add(request.energies, {"--energies"});
  add(request.watch, {"--watch"});
  add(request.until, {"--until"});
  add(request.cycles, {"--cycles"});
  add(request.forces, {"--forces"});
  add(request.integers, {"--integers"});
  add(!checkpoint.path.empty(), {"--checkpoint", checkpoint.path});
  add(checkpoint.every_steps > 0, {"--checkpoint-every", fmt::format("{} steps", checkpoint.every_steps)});
  add(checkpoint.every_seconds > 0, {"--checkpoint-every", fmt::format("{} s", checkpoint.every_seconds)});
  add(checkpoint.resume, {"--resume"});
  add(request.log != LogRows::off, {"--log", to_string(request.log)});
  return words;
}

}  // namespace cuboct
