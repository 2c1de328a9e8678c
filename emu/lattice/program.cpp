// SPDX-License-Identifier: MIT
#include "emu/lattice/program.h"

#include <fmt/format.h>
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <utility>

#include "emu/lattice/run.h"
#include "hw/setup.h"
#include "model/analysis/state_meter.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/steps.h"
#include "model/base/text.h"
#include "model/trace/trace_file.h"

namespace cuboct::emu {
namespace {

struct Request {
  std::string scene, arch, out, frames_file, begun, interval;
  std::optional<uint64_t> steps;
  std::vector<uint64_t> frames;
  bool frames_given = false, no_quiescence = false, bench = false;
  LatticeRun run;
};

void print_bench(const LatticeResult& result, uint32_t particles) {
  const Trace& trace = result.trace;
  const double seconds = std::max(trace.seconds, 1e-9);
  const auto steps = static_cast<double>(trace.steps() - result.resumed_at);
  fmt::print("lattice.particle_steps {:.6g} 1/s\n", steps * particles / seconds);
  if (!trace.cycles.empty())
    fmt::print("lattice.node_cycles {:.6g} 1/s\n",
               trace.counters.front().second * static_cast<double>(trace.nodes) / seconds);
  for (const auto& [name, value] : trace.counters) fmt::print("lattice.{} {:.15g} 1\n", name, value);
  fmt::print("lattice.seconds {:.6g} s\n", trace.seconds);
}

int run(Request request) {
  const bool leads = !request.run.engine.ranks || request.run.engine.ranks->rank() == 0;
  LatticeRun& run = request.run;
  if (request.out.empty() && !request.bench) throw InputError("--out is required");
  if (!request.out.empty() && leads) check_writable(request.out);
  if (!request.interval.empty()) read_interval(request.interval, run.checkpoint);
  if (run.checkpoint.path.empty() && (run.checkpoint.resume || !request.interval.empty()))
    throw InputError("--resume and --checkpoint-every need --checkpoint FILE");
  if (run.hash_every == 0) throw InputError("--hash-every: 0 is not a number of steps");
  if (!request.frames_file.empty()) request.frames = read_steps(request.frames_file);
  // Blocks of this size go back to the system when they are freed, as a body of millions does.
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  Scene scene = read_scene(request.scene);
  const Plan plan = plan_of(scene, read_arch(request.arch));
  run.spare = &scene.body;
  run.body_again = [&] { return read_scene(request.scene).body; };
  run.steps = request.steps.value_or(scene.steps);
  run.frames = std::move(request.frames);
  put_in_order(run.frames);
  if (!request.frames_given && !request.bench) run.frames = {0, run.steps};
  // Energies are read at the first and the last step too.
  run.probes = run.energies ? every_so_often(scene.probe_every, run.steps) : probe_steps_of(scene, run.steps);
  run.engine.quiescence = !request.no_quiescence;
  // A benchmark times steps: its one hash is the last state's.
  if (request.bench) run.hash_every = std::max<uint64_t>(run.steps, 1);

  std::optional<TraceWriter> writer;
  std::string trouble;
  if (!request.out.empty() && leads) {
    writer.emplace(request.out, temporary_beside(request.out));
    run.keep = [&](const State& frame) {
      if (!request.begun.empty()) write_text(std::exchange(request.begun, {}), "");
      try {
        writer->add(frame);
      } catch (const InputError& error) {
        if (trouble.empty())
          trouble = fmt::format("{}; frames are left out from step {} on", error.what(), frame.step);
      }
    };
  }
  catch_interrupts();
  const LatticeResult result = run_lattice(scene, plan, run);
  const Trace& trace = result.trace;
  if (!leads) return trace.stop || result.interrupted ? 1 : 0;
  if (writer) writer->finish(trace);
  if (request.bench)
    print_bench(result, plan.particles);
  else
    fmt::print("{} steps of {} particles on {} nodes, {:.3g} particle-steps/s\n", trace.steps(),
               plan.particles, trace.nodes,
               static_cast<double>(trace.steps()) * plan.particles / std::max(trace.seconds, 1e-9));
  if (!trouble.empty()) throw InputError(trouble);
  if (result.interrupted) {
    fmt::print("interrupted after step {}{}\n", trace.steps(),
               !result.left_checkpoint ? "" : "; the same command with --resume goes on");
    return 1;
  }
  remove_checkpoint(run.checkpoint.path);
  if (!trace.stop) return 0;
  fmt::print(stderr, "{}: {}\n", line_text(request.scene), line_text(trace.stop->text));
  return 1;
}

}  // namespace

bool lattice_has_mpi() {
#ifdef CUBOCT_LATTICE_MPI
  return true;
#else
  return false;
#endif
}

int run_lattice_program(int argc, char** argv, Ranks* ranks) {
  survive_file_limit();
  Request request;
  request.run.engine.ranks = ranks;
  LatticeRun& run = request.run;
  CLI::App app{"Runs a scene on vector units and threads, with the bits of the golden engine",
               "cuboct-lattice"};
  app.add_option("scene", request.scene, "Scene file (TOML)")->required();
  app.add_option("--arch", request.arch, "Machine description (TOML); the defaults without one");
  app.add_option("--steps", request.steps, "Steps to run; the scene's own number without it");
  app.add_option("--out", request.out, "Trace file to write (HDF5)");
  auto* frames = app.add_option("--frames", request.frames,
                                "Steps whose states are kept; the first and the last without it")
                     ->delimiter(',');
  auto* frames_file =
      app.add_option("--frames-file", request.frames_file, "The same from a file, one step per line")
          ->excludes(frames);
  app.add_option("--begun", request.begun, "File that is made when the steps begin");
  app.add_option("--threads", run.engine.threads, "Threads; one per core without it")
      ->check(CLI::Range(1, 4096));
  app.add_flag("--no-quiescence", request.no_quiescence, "Do not skip cells at rest; no bit changes");
  app.add_option("--simd", run.engine.simd, "Vector units: avx512, avx2 or portable; the widest without it");
  app.add_option("--cut", run.engine.cut, "How ranks share the cells: bricks, or slabs along x, y or z")
      ->check(CLI::IsMember({"bricks", "x", "y", "z"}))
      ->capture_default_str();
  app.add_flag("--cycles", run.cycles, "Count the machine's cycles with the timing model");
  auto* energies =
      app.add_flag("--energies", run.energies, "Measure energies with the probes, and at the last state");
  app.add_flag("--watch", run.watch,
               "Look for what makes a run wrong where energies are measured, and at the last state")
      ->needs(energies);
  app.add_option("--hash-every", run.hash_every, "The state's hash each so many steps")
      ->capture_default_str();
  app.add_option("--checkpoint", run.checkpoint.path, "File that the run can go on from; gone when it ends");
  app.add_option("--checkpoint-every", request.interval, "'1000 steps', '30 s', '5 min' or '2 h'");
  app.add_flag("--resume", run.checkpoint.resume, "Go on from the checkpoint");
  app.add_flag("--bench", request.bench, "Print 'name value unit' lines; no trace unless --out asks for one");
  app.add_flag("--progress", run.progress, "A line per second on standard error");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  request.frames_given = frames->count() > 0 || frames_file->count() > 0;
  try {
    return cuboct::emu::run(std::move(request));
  } catch (const InputError& e) {
    if (!ranks || ranks->rank() == 0) fmt::print(stderr, "{}\n", e.what());
    return 2;
  } catch (const std::exception& e) {
    fmt::print(stderr, "cuboct-lattice: {}\n", block_text(e.what()));
    return 1;
  }
}

}  // namespace cuboct::emu
