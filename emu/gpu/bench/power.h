// SPDX-License-Identifier: MIT
// Measured energy of GPUs: what their boards take from the supply (chip, memory, regulators, fan), by NVML's
// counter of millijoules. docs/reference/gpu.md, "Energy".
//
// The counter moves in steps of some 10 to 100 ms. A thread asks for it every few milliseconds and keeps the
// times between which each step came. The mean power between the first and the last step inside a window
// is the counter's difference over the time between them: exact but for
//   - the resolution: each reading is cut to 1 mJ, 1 mJ in a difference;
//   - the times of the two steps, each known to the time between two askings.
// So energy is mean power times window, and its error is bounded by reading alone; assumed is that a step
// follows what it counts after the same delay each time, and that power is steady (Energy::drift shows). The
// sensor's own error comes on top: +-5 %, says NVIDIA of the boards of which it says anything.
//
// A board without the counter: its power readings, integrated by trapezoids.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "emu/gpu/bench/meter_clock.h"
#include "emu/gpu/bench/nvml.h"

namespace cuboct::gpu {

// A value that NVML gives, and when it came: between the asking that still got the one before and the one
// that got it.
struct Update {
  double earliest = 0, latest = 0;  // s
  uint64_t value = 0;               // mJ since the driver was loaded, or mW
};

struct MeanPower {
  double watts = 0, error = 0;  // the error: a bound, of reading alone
  double period = 0;            // s, between updates
};
// Over the part of [begin, end] (s) between the first and last update inside. Nothing where fewer than three
// are inside: a mean over two could hang on one odd step. Throws NvmlError where the counter ran backwards.
std::optional<MeanPower> mean_of_counter(const std::vector<Update>& updates, double begin, double end);
// Readings of power by trapezoids. The error: half a mW, and that at each end the power may have been any of
// those read for the time of an update.
std::optional<MeanPower> mean_of_samples(const std::vector<Update>& updates, double begin, double end);

// Watches boards from start to stop.
class PowerMeter {
 public:
  // By PCI bus ids (Device::bus); one that comes twice counts once. Never throws: where nothing can be
  // measured `why` says it.
  explicit PowerMeter(const std::vector<std::string>& buses, const std::string& library = kNvmlLibrary,
                      MeterClock& clock = steady_clock());
  ~PowerMeter();
  PowerMeter(const PowerMeter&) = delete;
  PowerMeter& operator=(const PowerMeter&) = delete;

  bool works() const;
  const std::string& why() const;     // empty if it works; else one line without a full stop
  const std::string& driver() const;  // version; empty if not known
  const char* method() const;         // "energy counter", "power samples", or of both kinds of boards "mixed"
  int boards() const;

  void start();  // again: forgets what it saw
  void stop();
  MeterClock& clock() const;  // of windows

  struct Window {
    MeanPower power;   // of all boards: sums, and the longest period
    double drift = 0;  // power of the second half over that of the first, minus 1; 0 if too short for halves
    double sm_clock = 0;  // MHz, mean over readings and boards; 0 if not known
  };
  // Throws NvmlError: too few updates, a counter that ran backwards, a call that failed.
  Window between(double begin, double end) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Of a measurement, s. Idle is measured with the program's CUDA context and memory in place, and clocks as
// they then are, once the device has been left alone for `settle`; the work then warms clocks and temperature
// up.
struct EnergyTimes {
  double settle = 1, idle = 1, warm_up = 1;
  double window = 2;  // at least
};

struct Energy {
  std::string method;  // PowerMeter::method
  int boards = 0;
  double seconds = 0;              // of the window
  uint64_t steps = 0;              // done in it
  MeanPower power, idle;           // of all boards, W; `power` includes idle
  double drift = 0, sm_clock = 0;  // as in PowerMeter::Window

  double joules() const { return power.watts * seconds; }                     // of the boards
  double net_joules() const { return (power.watts - idle.watts) * seconds; }  // above idle
  double per_particle_step(uint64_t particles) const;                         // J
  double net_per_particle_step(uint64_t particles) const;

  // For a trace: energy_board, energy_net, energy_error (J), energy_window (s), energy_power,
  // energy_idle_power (W), energy_drift, energy_update_period (s), energy_boards, energy_steps,
  // joules_per_particle_step, joules_per_particle_step_net, and, where it is known, sm_clock (MHz).
  std::vector<std::pair<std::string, double>> counters(uint64_t particles) const;
};

// A measurement along a run:
//   EnergyMeter meter(power);
//   meter.idle();                    // after the engine is made; the device does nothing
//   while (...) meter.did(advance()) // a batch's steps, done when it returns: the first ones warm up
//   meter.finish();
class EnergyMeter {
 public:
  explicit EnergyMeter(PowerMeter& power, const EnergyTimes& times = {}) : power_(power), times_(times) {}
  ~EnergyMeter() { power_.stop(); }

  // Waits settle + idle, less where model/base/interrupt.h says so. Does nothing where the meter does not
  // work.
  void idle();
  // The window begins with the first call after `warm_up` of work and ends with the last one.
  void did(uint64_t steps);
  bool enough() const;  // the window is long enough: a benchmark may stop
  // Where there is no energy, `why` says it in a line: no NVML, too short a run, ...
  std::optional<Energy> finish(std::string* why = nullptr);

 private:
  PowerMeter& power_;
  EnergyTimes times_;
  double idle_begin_ = -1, idle_end_ = -1, begin_ = -1, end_ = -1;
  uint64_t steps_ = 0;
};

}  // namespace cuboct::gpu
