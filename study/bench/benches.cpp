// SPDX-License-Identifier: MIT
// How fast the engines are. Each benchmark makes its engine once, steps it a little to warm up, then times
// some steps per repetition.
#include "study/bench/benches.h"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <numeric>

#include "emu/gpu/bench/bench_rows.h"
#include "emu/lattice/kernel.h"
#include "emu/lattice/program.h"
#include "emu/lattice/run.h"
#include "hw/engine/engine_kind.h"
#include "hw/engine/scene_engine.h"
#include "hw/program/remote.h"
#include "model/base/output.h"
#include "model/base/resources.h"
#include "model/real/reference.h"
#include "study/bench/bench_gpu.h"
#include "study/bench/bench_report.h"
#include "study/bench/bench_scene.h"
#include "study/bench/bench_tersoff.h"
#include "study/bench/timed.h"

namespace cuboct {
namespace {

std::string counted(int threads) { return fmt::format("{} thread{}", threads, threads == 1 ? "" : "s"); }

benchmark::Counter rate(double amount) { return benchmark::Counter(amount, benchmark::Counter::kIsRate); }

bool too_large(benchmark::State& state, uint64_t particles) {
  if (fits_in_memory(particles)) return false;
  state.SkipWithError(
      fmt::format("{}{} particles do not fit into the free memory", kSkipped, particles).c_str());
  return true;
}

emu::LatticeOptions on_threads(int threads, bool quiescence = true) {
  emu::LatticeOptions options;
  options.threads = threads;
  options.quiescence = quiescence;
  return options;
}

using Make = std::function<std::unique_ptr<Engine>(const BenchCase&)>;

Make lattice_of(const emu::LatticeOptions& options, bool cycles = false) {
  return [=](const BenchCase& made) {
    const emu::LatticeChoice choice{.engine = options};
    return emu::lattice_kind(made.scene, made.plan, choice).make(nullptr, cycles);
  };
}

double count_of(Engine& engine, const std::string& name) {
  for (const auto& [of, count] : engine.counters())
    if (of == name) return count;
  return 0;
}

// One benchmark's objects; they live until the next benchmark begins.
struct Bed {
  std::shared_ptr<const BenchCase> made;
  std::unique_ptr<Engine> engine;
  std::optional<Timed> timed;
};
Bed& bed_of(const std::string& name) {
  static std::string owner;
  static std::unique_ptr<Bed> bed;
  if (owner != name) {
    bed.reset();
    bed = std::make_unique<Bed>();
    owner = name;
  }
  return *bed;
}

// `how`: what a label says between the particles and the steps: nodes, threads, vector units.
void run_block(benchmark::State& state, const std::string& name, const BenchScene& scene, double seconds,
               const Make& make, const std::function<std::string(const Bed&)>& how) {
  if (too_large(state, scene.particles())) return;
  Bed& bed = bed_of(name);
  if (!bed.engine) {
    bed.made = make_case(scene);
    bed.engine = make(*bed.made);
    bed.timed.emplace(seconds);
  }
  // The clocks of the nodes, where the engine has them.
  const auto node_cycles = [&] {
    const std::vector<uint64_t> clocks = bed.engine->memory().own;
    return std::accumulate(clocks.begin(), clocks.end(), 0.0);
  };
  const double before = node_cycles();
  const uint64_t first = bed.engine->step_count();
  bed.timed->run(state, [&] {
    bed.engine->advance(1);
    bed.engine->phase_times();  // else they would pile up
  });
  const auto done = static_cast<double>(bed.timed->steps());
  // Cycles of all steps, those that warmed up included, scaled to the timed ones.
  const double share = done / static_cast<double>(bed.engine->step_count() - first);
  state.counters["particle_steps"] = rate(done * static_cast<double>(scene.particles()));
  if (const double after = node_cycles(); after > 0)
    state.counters["node_cycles"] = rate((after - before) * share);
  state.SetLabel(
      fmt::format("{} particles{}, {} steps per repeat", scene.particles(), how(bed), bed.timed->steps()));
}

std::string lattice_label(const Bed& bed) {
  const Plan& plan = bed.made->plan;
  return fmt::format(" on {} nodes, {}, {}", plan.nodes(),
                     counted(static_cast<int>(count_of(*bed.engine, "threads"))),
                     emu::kernels_here(emu::kernel_rule(plan.rule, plan.arch.capacity)).front().name);
}

// The scene in a program of its own.
RemoteRun remote(const std::string& program, const BenchScene& scene, const Scratch& scratch) {
  RemoteRun run{program, scratch.path("block.toml"), "", scratch.path("trace.h5")};
  write_text(run.scene, scene.text());
  return run;
}

// Its own program tells how long the clock ran.
void run_systemc_block(benchmark::State& state, const BenchScene& scene, uint64_t steps) {
  const std::string program = beside("cuboct-systemc");
  if (program.empty()) {
    state.SkipWithError(fmt::format("{}no program cuboct-systemc beside cuboct", kSkipped).c_str());
    return;
  }
  const Scratch scratch;
  RemoteRun run = remote(program, scene, scratch);
  run.request.steps = steps;
  double node_cycles = 0;
  for (auto _ : state) {
    const Trace trace = Remote(run).finish().trace;
    for (const auto& [name, value] : trace.counters)
      if (name == "cycles") node_cycles = value * static_cast<double>(trace.nodes);
    state.SetIterationTime(trace.seconds);
  }
  state.counters["node_cycles"] = rate(node_cycles);
  state.counters["particle_steps"] = rate(static_cast<double>(steps * scene.particles()));
  state.SetLabel(fmt::format("{} particles, 1 thread, {} steps per repeat", scene.particles(), steps));
}

// Runs of one `group` must end in one state. False, and the benchmark is told, if they do not.
bool same_state(benchmark::State& state, const std::string& group, uint64_t hash) {
  static std::map<std::string, uint64_t> hashes;
  const uint64_t expected = hashes.try_emplace(group, hash).first->second;
  if (hash == expected) return true;
  state.SkipWithError(
      fmt::format("wrong: its state hash is {:016x}, another run's {:016x}", hash, expected).c_str());
  return false;
}

// A run of given length from its start.
void run_whole(benchmark::State& state, const std::string& group, const BenchScene& scene,
               const emu::LatticeOptions& options, uint64_t steps) {
  bed_of("");  // of the benchmark before: its memory is needed
  if (too_large(state, scene.particles())) return;
  const auto made = make_case(scene);
  const auto engine = lattice_of(options)(*made);
  for (auto _ : state) {
    const auto begin = Clock::now();
    engine->advance(steps);
    state.SetIterationTime(seconds_since(begin));
  }
  const uint64_t hash = engine->hash();
  if (!same_state(state, group, hash)) return;
  state.counters["particle_steps"] = rate(static_cast<double>(steps * scene.particles()));
  state.SetLabel(
      fmt::format("{} particles, {}, {} steps, {:.0f} % of the node-steps quiet, state hash {:016x}",
                  scene.particles(), counted(static_cast<int>(count_of(*engine, "threads"))), steps,
                  100 * count_of(*engine, "quiet_node_steps") / count_of(*engine, "node_steps"), hash));
}

// The same over MPI, a thread per rank, by the program's own clock.
void run_ranks(benchmark::State& state, const std::string& group, const BenchScene& scene, int ranks,
               uint64_t steps) {
  bed_of("");
  const std::string program = beside("cuboct-lattice");
  if (!emu::lattice_has_mpi() || !in_path("mpirun") || program.empty()) {
    state.SkipWithError(fmt::format("{}no MPI here", kSkipped).c_str());
    return;
  }
  const Scratch scratch;
  RemoteRun run = remote(program, scene, scratch);
  run.own = {"--threads", "1"};
  run.ranks = ranks;
  run.request.steps = run.request.hash_every = steps;
  Trace trace;
  for (auto _ : state) {
    trace = Remote(run).finish().trace;
    state.SetIterationTime(trace.seconds);
  }
  if (!same_state(state, group, trace.state_hash.back())) return;
  state.counters["particle_steps"] = rate(static_cast<double>(steps * scene.particles()));
  state.SetLabel(fmt::format("{} particles, {} x 1 thread, {} steps, state hash {:016x}", scene.particles(),
                             ranks == 1 ? "1 rank" : fmt::format("{} ranks", ranks), steps,
                             trace.state_hash.back()));
}

}  // namespace

std::vector<Bench> benches(const BenchLength& length, int threads) {
  const int all = threads > 0 ? threads : usable_cores();
  const double seconds = length.seconds;
  std::vector<Bench> list;
  const auto add = [&](const std::string& name, const std::string& what,
                       std::function<void(benchmark::State&)> run, bool once = false) {
    list.push_back({name, what, std::move(run), once});
  };
  const std::pair<const char*, int> sizes[] = {{"32k", 20}, {"256k", 40}, {"2m", 80}};
  for (const auto& [size, cells] : sizes)
    for (const bool damped : {false, true})
      for (const bool cores : {false, true}) {
        const std::string name = fmt::format("lattice.{}_{}.{}", damped ? "damped" : "block", size,
                                             cores ? "all_cores" : "1_thread");
        const BenchScene scene{.cells = cells, .damped = damped};
        add(name,
            fmt::format("the lattice engine, {} particles{}, {}", scene.particles(), damped ? ", damped" : "",
                        cores ? "a thread per core" : "one thread"),
            [=](benchmark::State& s) {
              run_block(s, name, scene, seconds, lattice_of(on_threads(cores ? all : 1)), lattice_label);
            });
      }
  for (const bool cores : {false, true}) {
    const std::string name = fmt::format("lattice.cycles_32k.{}", cores ? "all_cores" : "1_thread");
    add(name,
        fmt::format("the same with the timing model, 32000 particles, {}",
                    cores ? "a thread per core" : "one thread"),
        [=](auto& s) {
          run_block(s, name, {}, seconds, lattice_of(on_threads(cores ? all : 1), true), lattice_label);
        });
  }
  for (const auto& [size, cells] : {sizes[0], sizes[1]})
    for (const bool damped : {false, true})
      for (const Precision precision : {Precision::float64, Precision::float32})
        for (const bool cores : {false, true}) {
          const char* const number = precision == Precision::float32 ? "float" : "double";
          const std::string name = fmt::format("real.{}_{}_{}.{}", number, damped ? "damped" : "block", size,
                                               cores ? "all_cores" : "1_thread");
          const BenchScene scene{.cells = cells, .damped = damped};
          add(name,
              fmt::format("the reference engine in {}s, {} particles{}, {}", number, scene.particles(),
                          damped ? ", damped" : "", cores ? "a thread per core" : "one thread"),
              [=](benchmark::State& s) {
                const RealOptions options{.precision = precision, .threads = cores ? all : 1};
                run_block(
                    s, name, scene, seconds,
                    [&](const BenchCase& made) {
                      return scene_reference_kind(made.scene, made.plan, options).make(nullptr, false);
                    },
                    [&](const Bed&) { return ", " + counted(options.threads) + ", " + Reference::simd(); });
              });
        }
  add("golden.block_4k", "the golden engine, 4000 particles", [=](auto& s) {
    const auto make = [](const BenchCase& made) {
      return golden_kind(made.scene, made.plan).make(nullptr, false);
    };
    run_block(s, "golden.block_4k", {.cells = 10}, seconds, make, [](const Bed&) { return ", 1 thread"; });
  });
  add("systemc.block_2k", "the clocked engine, 2048 particles, 10 steps",
      [](auto& s) { run_systemc_block(s, {.cells = 8}, 10); });
  for (Bench& bench : tersoff_benches(seconds, all)) list.push_back(std::move(bench));
  for (const bool on : {true, false})
    add(
        fmt::format("impact.quiescence_{}", on ? "on" : "off"),
        "a corner of 1000188 particles at rest is hit: 500 steps",
        [=](auto& s) { run_whole(s, "impact", {.cells = 63, .impact = true}, on_threads(all, on), 500); },
        true);
  for (int count = 1; count <= all; ++count)
    add(
        fmt::format("scaling.threads_{}", count), "256000 particles, 100 steps",
        [=](auto& s) { run_whole(s, "scaling", {.cells = 40}, on_threads(count), 100); }, true);
  for (int ranks = 1; ranks <= all; ++ranks)
    add(
        fmt::format("scaling.ranks_{}", ranks), "256000 particles, 100 steps, over MPI",
        [=](auto& s) { run_ranks(s, "scaling", {.cells = 40}, ranks, 100); }, true);
  for (const gpu::BenchRow& row : gpu::bench_rows())
    list.push_back({"gpu." + row.name, "the GPU engine, " + row.what,
                    [=](auto& s) { run_gpu_row(s, row.name, length.repeats, seconds); }, false, true});
  return list;
}

}  // namespace cuboct
