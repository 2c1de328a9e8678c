// SPDX-License-Identifier: MIT
#include "emu/machine/program.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

#include "emu/machine/bench.h"
#include "hw/setup.h"
#include "model/analysis/state_meter.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/steps.h"
#include "model/base/text.h"

namespace cuboct::emu {
namespace {

struct Request {
  std::string scene, arch, out, frames_file, faults;
  std::optional<uint64_t> steps;
  std::vector<uint64_t> frames;
  bool frames_given = false, bench = false;
  RunOptions run;
};

// Curves from the kept states; then only the frames that were asked for stay. Both lists ascend.
void measure(const Scene& scene, const Setup& setup, const std::vector<uint64_t>& probes,
             const std::vector<uint64_t>& frames, Trace& trace) {
  const Plan& plan = setup.plan;
  const auto in = [](const std::vector<uint64_t>& list, uint64_t step) {
    return std::binary_search(list.begin(), list.end(), step);
  };
  if (!probes.empty()) {
    StateMeter meter(
        scene, plan.rule, plan.lattice, plan.origin, [&](uint32_t id) { return setup.initial.particles[id]; },
        false);
    for (const State& s : trace.frames)
      if (in(probes, s.step)) meter.add(s);
    trace.curves = meter.curves();
  }
  std::erase_if(trace.frames, [&](const State& s) { return !in(frames, s.step); });
}

int run(const Program& program, Request request) {
  if (!request.out.empty()) check_writable(request.out);
  if (!request.frames_file.empty()) request.frames = read_steps(request.frames_file);
  const Scene scene = read_scene(request.scene);
  const Arch arch = read_arch(request.arch);
  const Setup setup = make_setup(scene, arch);
  RunOptions& options = request.run;
  if (!request.faults.empty()) {
    const FaultShare share = read_fault_share(request.faults);
    options.faults.rate = share.rate;
    options.faults.count = share.count;
  }
  options.steps = request.steps.value_or(scene.steps);
  if (options.steps > std::numeric_limits<uint32_t>::max())
    throw InputError(fmt::format("{} steps: a node counts at most {}", options.steps,
                                 std::numeric_limits<uint32_t>::max()));
  if (!request.frames_given) request.frames = {0, options.steps};
  put_in_order(request.frames);
  const std::vector<uint64_t> probes = probe_steps_of(scene, options.steps);
  options.frames = request.frames;
  options.frames.insert(options.frames.end(), probes.begin(), probes.end());
  std::sort(options.frames.begin(), options.frames.end());

  Bench bench("bench", setup.plan, setup.initial, options, program.nodes(setup.plan), program.engine);
  catch_interrupts();
  simulate({&bench});
  Trace trace = bench.take_result().trace;
  measure(scene, setup, probes, request.frames, trace);
  if (!request.out.empty()) write_trace(request.out, trace);
  const double cycles = trace.counters.front().second;
  const double node_cycles =
      cycles * static_cast<double>(trace.nodes) / std::max(trace.seconds, 1e-9);  // per s
  if (request.bench)
    fmt::print("{}.node_cycles {:.4g} 1/s\n", program.engine, node_cycles);
  else
    fmt::print("{} steps of {} particles on {} nodes{} in {:.0f} cycles, {:.3g} node-cycles/s\n",
               trace.steps(), setup.plan.particles, trace.nodes,
               setup.plan.bricks.cells() == 1
                   ? std::string()
                   : fmt::format(" of {} cells", fmt::join(setup.plan.bricks.shape(), " x ")),
               cycles, node_cycles);
  if (!trace.stop && trace.steps() < options.steps) {
    fmt::print("interrupted after step {}\n", trace.steps());
    return 1;
  }
  if (!trace.stop) return 0;
  fmt::print(stderr, "{}: {}\n", line_text(request.scene), line_text(trace.stop->text));
  return 1;
}

}  // namespace

int run_program(int argc, char** argv, const Program& program) {
  survive_file_limit();
  Request request;
  CLI::App app{program.description, program.name};
  app.add_option("scene", request.scene, "Scene file (TOML)")->required();
  app.add_option("--arch", request.arch, "Machine description (TOML); the defaults without one");
  app.add_option("--steps", request.steps, "Steps to run; the scene's own number without it");
  app.add_option("--out", request.out, "Trace file to write (HDF5); --bench does without");
  CLI::Option* const frames = app.add_option("--frames", request.frames,
                                             "Steps whose states are kept; the first and the last without it")
                                  ->delimiter(',');
  const CLI::Option* const frames_file =
      app.add_option("--frames-file", request.frames_file, "The same, one step per line of this file")
          ->excludes(frames);
  app.add_option("--stall-rate", request.run.stall_rate, "Share of cycles in which a link passes nothing")
      ->check(CLI::Range(0.0, 0.99));
  app.add_option("--stall-seed", request.run.stall_seed, "Seed of the stalls")->capture_default_str();
  app.add_option("--inject-faults", request.faults,
                 "Faults on the wires: their share of all beats, or their number in the run");
  app.add_option("--fault-seed", request.run.faults.seed, "Seed of the faults")->capture_default_str();
  app.add_flag("--progress", request.run.progress, "A line per second on standard error");
  app.add_flag("--bench", request.bench, "Print the speed of the simulation alone, as 'name value unit'");
  program.add_options(app);
  try {
    app.parse(argc, argv);
    if (request.out.empty() && !request.bench) throw CLI::RequiredError("--out");
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  request.frames_given = frames->count() > 0 || frames_file->count() > 0;
  try {
    return run(program, std::move(request));
  } catch (const InputError& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 2;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}: {}\n", program.name, block_text(e.what()));
    return 1;
  }
}

}  // namespace cuboct::emu
