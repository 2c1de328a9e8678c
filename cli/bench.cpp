// SPDX-License-Identifier: MIT
// How fast the engines are. Each benchmark makes its engine once, steps it a little to warm up, then times
// some steps per repetition.
#include <fmt/format.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <numeric>

#include "cli/bench_gpu.h"
#include "cli/bench_report.h"
#include "cli/bench_scene.h"
#include "cli/command.h"
#include "cli/engine_run.h"
#include "emu/lattice/engine.h"
#include "emu/lattice/program.h"
#include "emu/lattice/timing.h"
#include "gpu_ref/bench_rows.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/base/resources.h"
#include "model/base/spelling.h"
#include "model/contract/golden.h"
#include "model/real/reference.h"

namespace cuboct {
namespace {

using Clock = std::chrono::steady_clock;

struct Options {
  std::string name;
  bool list = false;
  int threads = 0;  // 0: every core
  int repeats = 5;
  double seconds = 0.5;  // per repetition
};

struct Entry {
  std::string name, what;
  std::function<void(benchmark::State&)> run;
  bool once = false;  // a run of given length: three repetitions at most
  bool gpu = false;   // repeats by itself
};

double since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

// Times `step` for about so many seconds in each repetition; answers the steps of one. The number is found in
// the first, which warms up, and then stays.
class Timed {
 public:
  explicit Timed(double seconds) : seconds_(seconds) {}

  void run(benchmark::State& state, const std::function<void()>& step) {
    if (steps_ == 0) {
      for (int k = 0; k < 3; ++k) step();  // memory is touched, lists are made
      const auto begin = Clock::now();
      uint64_t warm = 0;
      for (; warm < 1 || (since(begin) < 0.3 * seconds_ && warm < 1000); ++warm) step();
      steps_ =
          std::max<uint64_t>(1, static_cast<uint64_t>(seconds_ * static_cast<double>(warm) / since(begin)));
    }
    for (auto _ : state) {
      const auto begin = Clock::now();
      for (uint64_t k = 0; k < steps_; ++k) step();
      state.SetIterationTime(since(begin));
    }
  }
  uint64_t steps() const { return steps_; }

 private:
  double seconds_;
  uint64_t steps_ = 0;
};

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

std::unique_ptr<emu::LatticeEngine> lattice_engine(const Loaded& loaded, const emu::LatticeOptions& options) {
  const Plan& plan = loaded.setup.plan;
  return std::make_unique<emu::LatticeEngine>(
      plan, 0, plan.particles,
      [&](uint32_t id) {
        return fixed_particle(loaded.scene.body, id, plan.rule, plan.lattice, plan.origin);
      },
      options);
}

// One benchmark's objects; they live until the next benchmark begins.
struct Bed {
  std::shared_ptr<const Loaded> loaded;
  std::unique_ptr<emu::LatticeEngine> lattice;
  std::unique_ptr<emu::TimingModel> timing;
  std::unique_ptr<Golden> golden;
  std::unique_ptr<Reference> real;
  emu::CellSlots slots;
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

void run_lattice_block(benchmark::State& state, const std::string& name, const BenchScene& scene, int threads,
                       bool cycles, double seconds) {
  if (too_large(state, scene.particles())) return;
  Bed& bed = bed_of(name);
  if (!bed.lattice) {
    bed.loaded = load_bench(scene);
    bed.lattice = lattice_engine(*bed.loaded, on_threads(threads));
    if (cycles) bed.timing = std::make_unique<emu::TimingModel>(bed.loaded->setup.plan, threads);
    bed.timed.emplace(seconds);
  }
  const auto node_cycles = [&] {
    if (!bed.timing) return 0.0;
    const std::vector<uint64_t>& starts = bed.timing->starts();
    return std::accumulate(starts.begin(), starts.end(), 0.0);
  };
  double before = node_cycles();
  const uint64_t first = bed.lattice->step_count();
  bed.timed->run(state, [&] {
    if (bed.timing) bed.lattice->slots(bed.slots);
    bed.lattice->step();
    if (bed.timing) bed.timing->step(bed.slots, bed.lattice->leaving(), {});
  });
  const auto done = static_cast<double>(bed.timed->steps());
  // Cycles of all steps, those that warmed up included, scaled to the timed ones.
  const double share = done / static_cast<double>(bed.lattice->step_count() - first);
  state.counters["particle_steps"] = rate(done * bed.lattice->size());
  if (bed.timing) state.counters["node_cycles"] = rate((node_cycles() - before) * share);
  state.SetLabel(fmt::format("{} particles on {} nodes, {}, {}, {} steps per repeat", scene.particles(),
                             bed.loaded->setup.plan.nodes(), counted(bed.lattice->threads()),
                             bed.lattice->simd(), bed.timed->steps()));
}

void run_golden_block(benchmark::State& state, const std::string& name, const BenchScene& scene,
                      double seconds) {
  Bed& bed = bed_of(name);
  if (!bed.golden) {
    bed.loaded = load_bench(scene);
    const Plan& plan = bed.loaded->setup.plan;
    bed.golden =
        std::make_unique<Golden>(plan.rule, plan.lattice, plan.arch.capacity,
                                 to_fixed(bed.loaded->scene.body, plan.rule, plan.lattice, plan.origin));
    bed.timed.emplace(seconds);
  }
  bed.timed->run(state, [&] { bed.golden->step(); });
  state.counters["particle_steps"] =
      rate(static_cast<double>(bed.timed->steps()) * bed.loaded->setup.plan.particles);
  state.SetLabel(
      fmt::format("{} particles, 1 thread, {} steps per repeat", scene.particles(), bed.timed->steps()));
}

void run_real_block(benchmark::State& state, const std::string& name, const BenchScene& scene,
                    const RealOptions& options, double seconds) {
  if (too_large(state, scene.particles())) return;
  Bed& bed = bed_of(name);
  if (!bed.real) {
    bed.loaded = load_bench(scene);
    const Scene& s = bed.loaded->scene;
    bed.real = std::make_unique<Reference>(s.rule, s.body, s.periodic, options);
    bed.timed.emplace(seconds);
  }
  bed.timed->run(state, [&] { bed.real->step(); });
  state.counters["particle_steps"] =
      rate(static_cast<double>(bed.timed->steps()) * static_cast<double>(scene.particles()));
  state.SetLabel(fmt::format("{} particles, {}, {}, {} steps per repeat", scene.particles(),
                             counted(options.threads), Reference::simd(), bed.timed->steps()));
}

// Its own program tells how long the clock ran.
void run_systemc_block(benchmark::State& state, const BenchScene& scene, uint64_t steps) {
  if (access((program_directory() + "/cuboct-systemc").c_str(), X_OK) != 0) {
    state.SkipWithError(fmt::format("{}no program cuboct-systemc beside cuboct", kSkipped).c_str());
    return;
  }
  const Scratch scratch;
  const std::string path = scratch.path("block.toml");
  write_text(path, scene.text());
  Input input;
  input.scene = path;
  const auto loaded = load_bench(scene);
  RunRequest request;
  request.steps = steps;
  double node_cycles = 0;
  for (auto _ : state) {
    const Trace trace =
        EngineRun("systemc", input, *loaded, {}, request, scratch.path("trace.h5"), true).finish().trace;
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
  const auto loaded = load_bench(scene);
  const auto engine = lattice_engine(*loaded, options);
  for (auto _ : state) {
    const auto begin = Clock::now();
    for (uint64_t k = 0; k < steps; ++k) engine->step();
    state.SetIterationTime(since(begin));
  }
  const uint64_t hash = engine->hash();
  if (!same_state(state, group, hash)) return;
  state.counters["particle_steps"] = rate(static_cast<double>(steps * scene.particles()));
  const emu::LatticeCounters& counters = engine->counters();
  state.SetLabel(fmt::format(
      "{} particles, {}, {} steps, {:.0f} % of the node-steps quiet, state hash {:016x}", scene.particles(),
      counted(engine->threads()), steps,
      100 * static_cast<double>(counters.quiet_node_steps) / static_cast<double>(counters.node_steps), hash));
}

// The same over MPI, a thread per rank, by the program's own clock.
void run_ranks(benchmark::State& state, const std::string& group, const BenchScene& scene, int ranks,
               uint64_t steps) {
  bed_of("");
  if (!emu::lattice_has_mpi() || !in_path("mpirun")) {
    state.SkipWithError(fmt::format("{}no MPI here", kSkipped).c_str());
    return;
  }
  const Scratch scratch;
  Input input;
  input.scene = scratch.path("block.toml");
  write_text(input.scene, scene.text());
  const auto loaded = load_bench(scene);
  EngineOptions choice;
  choice.threads = 1;
  choice.ranks = ranks;
  RunRequest request;
  request.steps = request.hash_every = steps;
  Trace trace;
  for (auto _ : state) {
    trace =
        EngineRun("lattice", input, *loaded, choice, request, scratch.path("trace.h5"), true).finish().trace;
    state.SetIterationTime(trace.seconds);
  }
  if (!same_state(state, group, trace.state_hash.back())) return;
  state.counters["particle_steps"] = rate(static_cast<double>(steps * scene.particles()));
  state.SetLabel(fmt::format("{} particles, {} x 1 thread, {} steps, state hash {:016x}", scene.particles(),
                             ranks == 1 ? "1 rank" : fmt::format("{} ranks", ranks), steps,
                             trace.state_hash.back()));
}

std::vector<Entry> entries(const Options& options) {
  const int all = options.threads > 0 ? options.threads : usable_cores();
  const double seconds = options.seconds;
  std::vector<Entry> list;
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
            [=](benchmark::State& s) { run_lattice_block(s, name, scene, cores ? all : 1, false, seconds); });
      }
  for (const bool cores : {false, true}) {
    const std::string name = fmt::format("lattice.cycles_32k.{}", cores ? "all_cores" : "1_thread");
    add(name,
        fmt::format("the same with the timing model, 32000 particles, {}",
                    cores ? "a thread per core" : "one thread"),
        [=](auto& s) { run_lattice_block(s, name, {}, cores ? all : 1, true, seconds); });
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
                run_real_block(s, name, scene, {.precision = precision, .threads = cores ? all : 1}, seconds);
              });
        }
  add("golden.block_4k", "the golden engine, 4000 particles",
      [=](auto& s) { run_golden_block(s, "golden.block_4k", {.cells = 10}, seconds); });
  add("systemc.block_2k", "the clocked engine, 2048 particles, 10 steps",
      [](auto& s) { run_systemc_block(s, {.cells = 8}, 10); });
  for (const bool on : {true, false})
    add(
        fmt::format("impact.quiescence_{}", on ? "on" : "off"),
        "a corner of 1000188 particles at rest is hit: 500 steps",
        [=](auto& s) { run_whole(s, "impact", {.cells = 63, .impact = true}, on_threads(all, on), 500); },
        true);
  for (int threads = 1; threads <= all; ++threads)
    add(
        fmt::format("scaling.threads_{}", threads), "256000 particles, 100 steps",
        [=](auto& s) { run_whole(s, "scaling", {.cells = 40}, on_threads(threads), 100); }, true);
  for (int ranks = 1; ranks <= all; ++ranks)
    add(
        fmt::format("scaling.ranks_{}", ranks), "256000 particles, 100 steps, over MPI",
        [=](auto& s) { run_ranks(s, "scaling", {.cells = 40}, ranks, 100); }, true);
  for (const gpu::BenchRow& row : gpu::bench_rows())
    list.push_back({"gpu." + row.name, "the GPU engine, " + row.what,
                    [=](auto& s) { run_gpu_row(s, row.name, options.repeats, seconds); }, false, true});
  return list;
}

int bench(const Options& options) {
  const std::vector<Entry> list = entries(options);
  if (options.list) {
    for (const Entry& entry : list) fmt::print("{:<32} {}\n", entry.name, entry.what);
    return 0;
  }
  std::vector<const Entry*> chosen;
  std::vector<std::string> names;
  for (const Entry& entry : list) {
    names.push_back(entry.name);
    if (options.name.empty() || entry.name == options.name || entry.name.starts_with(options.name + "."))
      chosen.push_back(&entry);
  }
  if (chosen.empty()) {
    const std::string near = did_you_mean(options.name, names);
    throw InputError(fmt::format("no benchmark '{}'", options.name),
                     near.empty() ? "'cuboct bench --list' names them" : near);
  }
  fmt::print("# {}\n", machine());
  if (std::any_of(chosen.begin(), chosen.end(), [](const Entry* entry) { return entry->gpu; }))
    if (const std::string why = gpu_left_out(); !why.empty()) {
      fmt::print("# gpu: {}{}\n", kSkipped, why);
      std::erase_if(chosen, [](const Entry* entry) { return entry->gpu; });
    }
  if (chosen.empty()) return 0;
  for (const Entry* entry : chosen)
    benchmark::RegisterBenchmark(entry->name.c_str(), entry->run)
        ->Iterations(1)
        ->Repetitions(entry->gpu    ? 1
                      : entry->once ? std::min(options.repeats, 3)
                                    : options.repeats)
        ->UseManualTime();
  int count = 1;
  char name[] = "cuboct";
  char* arguments[] = {name, nullptr};
  benchmark::Initialize(&count, arguments);
  LineReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return reporter.failed() ? 1 : 0;
}

}  // namespace

void add_bench(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("bench", "measure how fast the engines are");
  command->add_option("name", options->name, "a benchmark, or the first words of some; default: all")
      ->type_name("NAME");
  command->add_flag("--list", options->list, "name the benchmarks");
  command->add_option("--threads", options->threads, "threads of 'all cores'; default: every core")
      ->check(CLI::Range(1, 4096))
      ->type_name("N");
  command->add_option("--repeats", options->repeats, "of which the median is told")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--seconds", options->seconds, "length of a repeat, but where steps are given")
      ->check(CLI::Range(1e-3, 1e4))
      ->capture_default_str()
      ->type_name("T");
  command->callback([options, &exit_code] { exit_code = bench(*options); });
}

}  // namespace cuboct
