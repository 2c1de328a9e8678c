// SPDX-License-Identifier: MIT
// How fast the GPU engines are and what energy that takes: the benchmark of `cuboct-gpu bench`, row by row.
// docs/reference/gpu.md, "Benchmark".
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "emu/gpu/bench/bench_rows.h"
#include "emu/gpu/bench/power.h"
#include "emu/gpu/engine.h"
#include "hw/plan/setup.h"

namespace cuboct::gpu {

// What a device's own copy in its memory moves, bytes read plus bytes written per second (2 * size / time):
// the best of several series of copies of an array far larger than its caches: 1 GiB, or a quarter of what is
// free. Beside it a row's rate tells how near it is to what the machine can do. Implemented with the engines.
double copy_bandwidth(int device);

// `cuboct-gpu bench ...`: argv[0] is "bench". Exit code: 0, 1 where a row failed or an interrupt came, 2 for
// bad arguments or without a device.
int run_bench(int argc, char** argv);

// What the benchmark runs on: engine.h's functions of these names and copy_bandwidth.
struct BenchMachine {
  std::function<std::vector<Device>(std::string*)> devices;
  std::function<std::unique_ptr<Engine>(const Scene&, const Plan&, const State&, const Options&)> fixed;
  std::function<std::unique_ptr<Engine>(const Scene&, const Body&, Arithmetic, const Options&)> real;
  std::function<double(int)> copy_bandwidth;
  std::string nvml = kNvmlLibrary;
  MeterClock* clock = &steady_clock();
};
int run_bench(int argc, char** argv, const BenchMachine& machine);

struct BenchOptions {
  int repeats = 5;
  double seconds = 0.3;  // of a repeat, at least
  bool energy = true;
  std::optional<uint64_t> settle;  // steps before the timing; the scene's own number without
  EnergyTimes times;
  Options engine;
};

struct RowResult {
  uint64_t particles = 0;
  uint64_t steps = 0;           // of a repeat
  std::vector<double> seconds;  // of the repeats
  Counters before, after;       // the repeats
  std::optional<Energy> energy;
  std::string no_energy;  // why, if there is none

  double median_seconds() const;
  double rate() const;  // particle-steps/s, by the median
  double mean_rate()
      const;              // of all repeats together: where lists are made in few of them, their share is here
  double spread() const;  // standard deviation of the repeats' rates over their mean; 0 of a single one
};

double median(std::vector<double> values);  // of at least one

// A scene of the benchmark, with what the fixed rule needs once somebody asks for it.
class BenchBody {
 public:
  explicit BenchBody(const BenchScene& scene);
  const BenchScene& of() const { return of_; }
  const Scene& scene() const { return scene_; }
  const Setup& setup();  // InputError

 private:
  BenchScene of_;
  Scene scene_;
  std::optional<Setup> setup_;
};

// Makes the engine, measures the idle device, warms up, lets the scene settle, finds the number of steps that
// take `seconds`, times the repeats, and goes on until the energy's window is long enough: it begins with
// the first repeat after a second of work. Nothing where an interrupt came. Throws what the engine throws.
std::optional<RowResult> measure_row(const BenchRow& row, BenchBody& body, const BenchOptions& options,
                                     const BenchMachine& machine, PowerMeter& power);

}  // namespace cuboct::gpu
