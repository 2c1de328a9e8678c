// SPDX-License-Identifier: MIT
// `cuboct view`: a run in a browser.
#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <optional>

#include "cli/answer.h"
#include "cli/command.h"
#include "cli/programs.h"
#include "cli/run/engine_options.h"
#include "cli/run/stages.h"
#include "cli/view/saved_page.h"
#include "cli/view/watch_run.h"
#include "hw/engine/engines.h"
#include "hw/engine/scene_engine.h"
#include "hw/program/options.h"
#include "model/base/directory_lock.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

struct ViewOptions {
  std::string what, save, with;
  uint64_t every = 1, particles = std::numeric_limits<uint32_t>::max(), limit = 100;
  uint32_t port = 0;
  bool no_open = false, while_run = false, limit_given = false, port_given = false, particles_given = false;
  // Of a run that is started.
  std::string arch, engine, out, steps, frame_every;
  bool force = false, cycles = false, steer = false;
  Answer answer;
};

// `difference`: of two runs, as a line and as JSON.
void tell_saved(const ViewOptions& options, const StoredRun& run, size_t bytes,
                const std::pair<std::string, std::string>& difference) {
  const std::string left = run.left_out();
  const size_t shown = run.form().shown();
  options.answer.say(
      "{}\n  {:<10} {}{}\n  {:<10} {}{}\n  {:<10} {:.3g} MB\n{}", line_text(options.save), "frames",
      run.frames(), left.empty() ? "" : " " + left, "particles", shown,
      shown < run.particles() ? fmt::format(" of {}", run.particles()) : "", "size",
      1e-6 * static_cast<double>(bytes),
      difference.first.empty() ? "" : fmt::format("  {:<10} {}\n", "difference", difference.first));
  options.answer.close(json_object({{"file", json(options.save)},
                                    {"frames", std::to_string(run.frames())},
                                    {"particles", std::to_string(shown)},
                                    {"bytes", std::to_string(bytes)},
                                    {"difference", difference.second}}));
}

void save(const ViewOptions& options) {
  check_writable(options.save);
  const size_t limit = options.limit * 1000000;
  if (options.with.empty()) {
    const StoredRun run(options.what, options.every, options.particles);
    const std::string page = saved_page(run, limit, options.every);
    write_text(options.save, page);
    tell_saved(options, run, page.size(), {"", "null"});
    return;
  }
  const ComparedRuns runs(options.what, options.with, options.every, options.particles);
  const std::string page = saved_page(runs, limit, options.every);
  write_text(options.save, page);
  const StoredRun& run = runs.first();
  tell_saved(options, run, page.size(),
             {verdict(runs.difference(), run.frames(), run.particles()), runs.difference().json()});
}

// --with is of two directories whose runs are over.
void check_with(const ViewOptions& options) {
  if (options.with.empty()) return;
  for (const std::string& one : {options.what, options.with}) {
    const std::string hint =
        fmt::format("cuboct run SCENE --out DIR leaves one; then cuboct view {} --with {}",
                    one == options.what ? "DIR" : options.what, one == options.what ? options.with : "DIR");
    if (!std::filesystem::is_directory(one))
      throw InputError(fmt::format("--with is of two runs that are over, and {} is no directory", one), hint);
    if (is_locked(one))
      throw InputError(fmt::format("--with is of two runs that are over, and that in {} goes on", one),
                       "it can be compared once it has ended");
  }
}

// The command line of `cuboct run`.
std::vector<std::string> run_words(const ViewOptions& options, const std::string& out) {
  std::vector<std::string> words{"run", options.what, "--out", out};
  for (const auto& [name, value] : {std::pair{"--arch", options.arch},
                                    {"--engine", options.engine},
                                    {"--steps", options.steps},
                                    {"--frame-every", options.frame_every}})
    if (!value.empty()) words.emplace_back(name), words.push_back(value);
  if (options.force) words.emplace_back("--force");
  if (options.cycles) words.emplace_back("--cycles");
  return words;
}

// A scene whose page changes it; `asked` but for its directory.
int steer(const ViewOptions& options, WatchAsked asked) {
  if (options.out.empty())
    throw InputError("--steer needs --out DIR, where the scene of stages lies that the page makes");
  asked.directory = options.out;
  const std::string engine = options.engine.empty() ? engine_for(read_scene(options.what)) : options.engine;
  if (std::filesystem::exists(options.out + "/scene.toml") && !options.force)
    throw InputError(fmt::format("{} holds a scene.toml", line_text(options.out)),
                     "another --out keeps it; --force puts that of this run in its place");
  const uint64_t steps = options.steps.empty() ? 0 : std::stoull(options.steps);
  SteeredScene scene({.scene = options.what, .arch = options.arch}, engine, engine_row(engine).real,
                     options.out, steps);
  std::vector<std::string> words{"run",
                                 scene.path(),
                                 "--out",
                                 options.out,
                                 "--engine",
                                 engine,
                                 "--frame-every",
                                 options.frame_every.empty()
                                     ? std::to_string(std::max<uint64_t>(1, scene.steps() / 40))
                                     : options.frame_every};
  if (!options.arch.empty()) words.insert(words.end(), {"--arch", options.arch});
  if (options.force) words.emplace_back("--force");
  if (options.cycles) words.emplace_back("--cycles");
  return watch_steered(asked, scene, words);
}

int view(const ViewOptions& options) {
  if (!has_view_page())
    throw InputError("this cuboct was built without the page of a run: cli/view/web/node_modules was missing",
                     "run tools/setup, or npm ci --ignore-scripts in cli/view/web, and build anew");
  const bool directory = std::filesystem::is_directory(options.what);
  const auto of_scene = [&](bool given, const char* option) {
    if (given && directory)
      throw InputError(
          fmt::format("{} is of a run that is started, and {} is a directory", option, options.what),
          "cuboct view SCENE starts one");
  };
  for (const auto& [option, value] : {std::pair{"--arch", &options.arch},
                                      {"--engine", &options.engine},
                                      {"--steps", &options.steps},
                                      {"--frame-every", &options.frame_every},
                                      {"--out", &options.out}})
    of_scene(!value->empty(), option);
  of_scene(options.force, "--force");
  of_scene(options.cycles, "--cycles");
  of_scene(options.steer, "--steer");
  check_with(options);
  if (!options.save.empty()) {
    if (!directory)
      throw InputError(
          fmt::format("--save is of a run that is over, and {} is no directory", options.what),
          fmt::format("cuboct run {} --out DIR, then cuboct view DIR --save {}", options.what, options.save));
    for (const auto& [given, option] : {std::pair{options.port_given, "--port"},
                                        {options.no_open, "--no-open"},
                                        {options.while_run, "--while-run"}})
      if (given)
        throw InputError(fmt::format("{} is of a page that is served, and --save serves none", option));
    save(options);
    return 0;
  }
  if (options.while_run && (!directory || !is_locked(options.what) || !options.with.empty()))
    throw InputError(fmt::format("--while-run is of a run that goes, and {} holds none", options.what),
                     "without it the page stays until Ctrl-C");
  if (options.limit_given) throw InputError("--limit is of a saved page: it goes with --save FILE.html");
  WatchAsked asked{options.what,
                   options.every,
                   options.particles,
                   static_cast<uint16_t>(options.port),
                   options.particles_given,
                   !options.no_open,
                   options.while_run,
                   options.answer};
  if (!options.with.empty()) return watch_two(asked, options.with);
  if (directory) return watch_directory(asked);
  if (const std::vector<StageName> stages = stages_of(options.what); !stages.empty())
    throw InputError(fmt::format("{} is a scene of stages, each with a directory of its own", options.what),
                     fmt::format("cuboct run {} --out DIR, and meanwhile cuboct view DIR/{}", options.what,
                                 stage_title(stages, 0)));
  if (options.steer) return steer(options, asked);
  std::optional<Scratch> scratch;
  asked.directory = options.out;
  if (options.out.empty()) asked.directory = scratch.emplace().path("run");
  std::vector<std::string> words = run_words(options, asked.directory);
  if (options.out.empty()) words.insert(words.end(), {"--frames", "none"});  // which nobody could read
  return watch_run(asked, words);
}

}  // namespace

void add_view(Command& app, int& exit_code) {
  auto [command, options] = add_command<ViewOptions>(app, "view", exit_code, view);
  command
      .option("run", options->what, "a scene to run, or what 'cuboct run --out' wrote or writes", "SCENE|DIR")
      .required();
  command.option("--save", options->save,
                 "write the page as one file that needs no server and no network; of a DIR", "FILE.html");
  command.option(
      "--with", options->with,
      "of a DIR: beside this run of the same body, with one camera and one time line, and where the two "
      "first differ",
      "DIR");
  command
      .option("--every", options->every,
              "keep each N-th frame of those that the run kept, and the last; default: all", "N")
      .range(uint64_t{1}, uint64_t{1} << 40);
  command
      .option("--particles", options->particles,
              "at most N particles of each frame, spread evenly over the ids; default: all", "N")
      .range(uint64_t{1}, uint64_t{1} << 32)
      .given(options->particles_given);
  command.option("--limit", options->limit, "MB that a saved page may have", "MB")
      .range(uint64_t{1}, uint64_t{kMostMegabytes})
      .given(options->limit_given)
      .show_default();
  command.option("--port", options->port, "port of 127.0.0.1; default: a free one", "N")
      .range(0u, 65535u)
      .given(options->port_given);
  command.flag("--no-open", options->no_open, "print the address, and open no browser");
  command.flag("--while-run", options->while_run,
               "of a DIR: end with its run, unless somebody has opened the page");
  command.option("--arch", options->arch, "of a SCENE: arch file (TOML); default: the defaults", "FILE");
  command.option("--engine", options->engine, "of a SCENE: the engine of its run, as of 'cuboct run'")
      .proposed(engines_that([](auto&) { return true; }));
  command.option("--steps", options->steps, "of a SCENE: steps; default: the scene's", "N")
      .check(whole_number);
  command
      .option("--frame-every", options->frame_every,
              "of a SCENE: a frame every K steps; default: the scene's, or 40 in all", "K")
      .check(whole_number);
  command.option("--out", options->out,
                 "of a SCENE: keep the run in this directory; default: it goes with the page", "DIR");
  command.flag("--force", options->force,
               "of a SCENE: begin anew in a DIR whose run did not end, in its place");
  command.flag("--cycles", options->cycles,
               "of a SCENE: count the machine's cycles, for the page of the run that is over");
  command.flag("--steer", options->steer,
               "of a SCENE: the page changes imposed velocities, gravity and damping, and the mouse pulls "
               "particles; DIR then holds the scene of stages that gives the same run again");
  options->answer.add_to(command);
}

}  // namespace cuboct
