// SPDX-License-Identifier: MIT
// cuboct-fpga: a scene on the board behind a serial port.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>

#include "emu/board/session.h"
#include "hw/setup.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/steps.h"
#include "model/base/text.h"

namespace cuboct::emu {
namespace {

struct Request {
  std::string scene, arch, out, port, frames_file;
  int baud = 1000000;
  double timeout = 0.3;
  std::optional<uint64_t> steps;
  std::vector<uint64_t> frames;
  bool frames_given = false;
  BoardRun run;
};

int run(Request request) {
  check_writable(request.out);
  if (!request.frames_file.empty()) request.frames = read_steps(request.frames_file);
  const Scene scene = read_scene(request.scene);
  const Setup setup = make_setup(scene, read_arch(request.arch));
  BoardRun& options = request.run;
  options.steps = request.steps.value_or(scene.steps);
  if (!request.frames_given) request.frames = {0, options.steps};
  put_in_order(request.frames);
  std::erase_if(request.frames, [&](uint64_t step) { return step > options.steps; });
  options.frames = request.frames;
  Host host(request.port, request.baud, request.timeout);
  catch_interrupts();
  const Trace trace = run_on_board(host, setup.plan, setup.initial, options);
  write_trace(request.out, trace);
  const LinkCount& count = host.count();
  fmt::print("{} steps of {} particles on {} nodes in {:.0f} cycles; {} requests, {} sent again\n",
             trace.steps(), setup.plan.particles, trace.nodes, trace.counters.front().second, count.requests,
             count.retries);
  if (!trace.stop) return trace.steps() < options.steps ? 1 : 0;  // interrupted
  fmt::print(stderr, "{}: {}\n", line_text(request.scene), line_text(trace.stop->text));
  return 1;
}

int main_of(int argc, char** argv) {
  survive_file_limit();
  Request request;
  CLI::App app{"Runs a scene on the board behind a serial port", "cuboct-fpga"};
  app.add_option("scene", request.scene, "Scene file (TOML)")->required();
  app.add_option("--arch", request.arch, "Machine description (TOML); the defaults without one");
  app.add_option("--port", request.port, "Serial port of the board, e.g. /dev/ttyUSB0")->required();
  app.add_option("--baud", request.baud, "Bits per second on it")->capture_default_str();
  app.add_option("--timeout", request.timeout, "Seconds of silence after which a request is sent again")
      ->check(CLI::Range(0.001, 60.0))
      ->capture_default_str();
  app.add_option("--steps", request.steps, "Steps to run; the scene's own number without it");
  app.add_option("--out", request.out, "Trace file to write (HDF5)")->required();
  CLI::Option* const frames = app.add_option("--frames", request.frames,
                                             "Steps whose states are kept; the first and the last without it")
                                  ->delimiter(',');
  const CLI::Option* const frames_file =
      app.add_option("--frames-file", request.frames_file, "The same, one step per line of this file")
          ->excludes(frames);
  app.add_option("--hash-every", request.run.hash_every, "Steps between two hashes of the state; 0: none")
      ->capture_default_str();
  app.add_flag("--progress", request.run.progress, "A line per second on standard error");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  request.frames_given = frames->count() > 0 || frames_file->count() > 0;
  try {
    return run(std::move(request));
  } catch (const InputError& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 2;
  } catch (const std::exception& e) {
    fmt::print(stderr, "cuboct-fpga: {}\n", block_text(e.what()));
    return 1;
  }
}

}  // namespace
}  // namespace cuboct::emu

int main(int argc, char** argv) { return cuboct::emu::main_of(argc, argv); }
