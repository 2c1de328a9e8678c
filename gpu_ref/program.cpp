// SPDX-License-Identifier: MIT
#include "gpu_ref/program.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <numeric>
#include <optional>

#include "gpu_ref/power.h"
#include "gpu_ref/rates.h"
#include "gpu_ref/run.h"
#include "gpu_ref/start.h"
#include "hw/setup.h"
#include "model/analysis/state_meter.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/steps.h"
#include "model/base/text.h"

namespace cuboct::gpu {
namespace {

struct Request {
  std::string scene, arch, start, out, frames_file, precision = "fixed";
  std::optional<uint64_t> steps;
  std::vector<uint64_t> frames;
  int gpus = 0;
  bool frames_given = false, devices_given = false, hashes_given = false, bench = false, unpacked = false,
       joules = false;
  bool list = false;
  int repeats = 0;
  double seconds = 0.3;
  GpuRun run;
};

Arithmetic arithmetic_of(const std::string& name) {
  for (const Arithmetic arithmetic : {Arithmetic::float32, Arithmetic::float64})
    if (name == to_string(arithmetic)) return arithmetic;
  return Arithmetic::fixed;
}

std::vector<Device> devices_here() {
  std::string why;
  std::vector<Device> found = find_devices(&why);
  if (found.empty()) throw InputError("the gpu engine needs a CUDA device: " + why);
  return found;
}

// The devices of the run, one after another. Fills in Options::devices.
std::vector<Device> choose_devices(const Request& request, Options& options) {
  const std::vector<Device> found = devices_here();
  if (request.gpus > static_cast<int>(found.size()))
    throw InputError(fmt::format("--gpus {}: this machine has {} CUDA device{}", request.gpus, found.size(),
                                 found.size() == 1 ? "" : "s"),
                     "--devices 0,0 puts two parts of a scene on one");
  if (request.gpus > 0) {
    options.devices.clear();
    for (int k = 0; k < request.gpus; ++k) options.devices.push_back(found[k].ordinal);
  } else if (!request.devices_given) {
    options.devices = {found.front().ordinal};
  }
  std::vector<Device> chosen;
  for (const int ordinal : options.devices) {
    const auto at = std::find_if(found.begin(), found.end(), [&](auto& d) { return d.ordinal == ordinal; });
    if (at == found.end()) {
      std::vector<int> ordinals;
      for (const Device& device : found) ordinals.push_back(device.ordinal);
      throw InputError(fmt::format("--devices: there is no CUDA device {}", ordinal),
                       fmt::format("one of {}", fmt::join(ordinals, ", ")));
    }
    chosen.push_back(*at);
  }
  return chosen;
}

int list_devices() {
  for (const Device& device : devices_here()) fmt::print("{} {}\n", device.ordinal, device.name);
  return 0;
}

void check(const Request& request) {
  if (request.scene.empty()) throw InputError("a scene is required");
  if (request.repeats > 0 && !request.bench) throw InputError("--repeats goes with --bench");
  if (request.out.empty() && !request.bench) throw InputError("--out is required");
  if (!request.out.empty()) check_writable(request.out);
  if (request.run.hash_every == 0) throw InputError("--hash-every: 0 is not a number of steps");
  if (request.run.engine.block % 32 != 0 || request.run.engine.block < 32 || request.run.engine.block > 256)
    throw InputError(
        fmt::format("--block {}: not a multiple of 32 from 32 to 256", request.run.engine.block));
  if (request.precision == "fixed" && request.run.forces)
    throw InputError("--forces goes with --precision float or double", "fixed states determine their forces");
  if (request.precision != "fixed" && request.hashes_given)
    throw InputError("--hash-every goes with --precision fixed", "states in real numbers have no hash");
}

void print_bench(const Trace& trace, uint64_t particles) {
  const double seconds = std::max(trace.seconds, 1e-9);
  fmt::print("gpu.particle_steps {:.6g} 1/s\n",
             static_cast<double>(trace.steps()) * static_cast<double>(particles) / seconds);
  for (const auto& [name, value] : trace.counters) fmt::print("gpu.{} {:.15g} 1\n", name, value);
  fmt::print("gpu.seconds {:.6g} s\n", trace.seconds);
}

// Rates of whole runs; a run that stops is told by the trace of one run.
void print_rates(const Scene& scene, const Plan& plan, const Request& request) {
  const GpuRun& run = request.run;
  for (const double rate :
       step_rates(scene, plan, {run.arithmetic, run.steps, request.repeats, request.seconds, run.engine}))
    fmt::print("gpu.steps_per_second {:.15g} 1/s\n", rate);
}

// Measures the energy of a run's devices.
class Joules {
 public:
  Joules(const std::vector<Device>& devices, uint64_t particles)
      : power_(buses_of(devices)), meter_(power_), particles_(particles) {}
  Joules(const Joules&) = delete;
  Joules& operator=(const Joules&) = delete;

  Hooks hooks() {
    return {[this] { meter_.idle(); }, [this](uint64_t steps) { meter_.did(steps); },
            [this](Trace& trace) {
              std::string why;
              if (const auto energy = meter_.finish(&why)) {
                const auto counters = energy->counters(particles_);
                trace.counters.insert(trace.counters.end(), counters.begin(), counters.end());
                trace.notes.emplace_back("energy by", energy->method);
              } else {
                trace.notes.emplace_back("energy", "not measured: " + why);
              }
            }};
  }

 private:
  static std::vector<std::string> buses_of(const std::vector<Device>& devices) {
    std::vector<std::string> buses;
    for (const Device& device : devices) buses.push_back(device.bus);
    return buses;
  }
  PowerMeter power_;
  EnergyMeter meter_;
  uint64_t particles_;
};

int run(Request request) {
  if (request.list) return list_devices();
  GpuRun& run = request.run;
  check(request);
  const std::vector<Device> devices = choose_devices(request, run.engine);
  std::vector<std::string> names;
  for (const Device& device : devices) names.push_back(device.name);
  if (!request.frames_file.empty()) request.frames = read_steps(request.frames_file);
  Scene scene = read_scene(request.scene);
  if (!request.start.empty()) start_from(request.start, scene);
  const Plan plan = plan_of(scene, read_arch(request.arch));
  run.arithmetic = arithmetic_of(request.precision);
  run.steps = request.steps.value_or(scene.steps);
  run.frames = std::move(request.frames);
  put_in_order(run.frames);
  if (!request.frames_given && !request.bench) run.frames = {0, run.steps};
  if (run.watch) run.energies = true;
  // Energies are read at the first and the last step too.
  run.probes = run.energies ? every_so_often(scene.probe_every, run.steps) : probe_steps_of(scene, run.steps);
  run.totals = !request.bench;
  // A benchmark times steps: its one hash is the last state's.
  if (request.bench) run.hash_every = std::max<uint64_t>(run.steps, 1);

  std::optional<Joules> joules;
  if (request.joules) {
    joules.emplace(devices, plan.particles);
    run.hooks = joules->hooks();
  }

  catch_interrupts();
  GpuResult result = run_gpu(scene, plan, run);
  Trace& trace = result.trace;
  for (size_t k = 0; k < names.size(); ++k) trace.notes.emplace_back(fmt::format("device {}", k), names[k]);
  if (!request.out.empty()) write_trace(request.out, trace, !request.unpacked);
  if (request.bench && request.repeats > 0 && !trace.stop && !result.interrupted)
    print_rates(scene, plan, request);
  if (request.bench)
    print_bench(trace, plan.particles);
  else
    fmt::print("{} steps of {} particles on {}, {:.3g} particle-steps/s\n", trace.steps(), plan.particles,
               fmt::join(names, ", "),
               static_cast<double>(trace.steps()) * plan.particles / std::max(trace.seconds, 1e-9));
  for (const Finding& finding : trace.findings) fmt::print("warning: {}\n", line_text(finding.text));
  if (result.interrupted && !trace.stop) fmt::print("interrupted after step {}\n", trace.steps());
  if (trace.stop) fmt::print(stderr, "{}: {}\n", line_text(request.scene), line_text(trace.stop->text));
  return result.interrupted || trace.stop || !trace.findings.empty() ? 1 : 0;
}

}  // namespace

int run_gpu_program(int argc, char** argv) {
  survive_file_limit();
  Request request;
  GpuRun& run = request.run;
  CLI::App app{"Runs a scene on NVIDIA GPUs, with the bits of the golden engine or in real numbers",
               "cuboct-gpu"};
  app.add_option("scene", request.scene, "Scene file (TOML)");
  app.add_option("--arch", request.arch, "Machine description (TOML); the defaults without one");
  app.add_option("--start", request.start,
                 "Trace with a state in real numbers; its last one is where the run starts, not the scene's");
  app.add_option("--steps", request.steps, "Steps to run; the scene's own number without it");
  app.add_option("--precision", request.precision, "fixed (golden's bits), float or double")
      ->check(CLI::IsMember({"fixed", "float", "double"}))
      ->capture_default_str();
  auto* devices = app.add_option("--devices", run.engine.devices,
                                 "CUDA's ordinals, one per slab of the scene; the first device without it")
                      ->delimiter(',');
  app.add_option("--gpus", request.gpus, "The first N devices")->check(CLI::Range(1, 64))->excludes(devices);
  app.add_option("--block", run.engine.block, "Threads of a block")->capture_default_str();
  app.add_option("--out", request.out, "Trace file to write (HDF5)");
  app.add_flag("--unpacked", request.unpacked, "Do not compress the trace: larger, and written in less time");
  auto* frames = app.add_option("--frames", request.frames,
                                "Steps whose states are kept; the first and the last without it")
                     ->delimiter(',');
  auto* frames_file =
      app.add_option("--frames-file", request.frames_file, "The same from a file, one step per line")
          ->excludes(frames);
  app.add_flag("--forces", run.forces, "Frames in real numbers hold the pair forces too");
  app.add_flag("--energies", run.energies, "Measure energies with the probes, and at the last state");
  app.add_flag("--watch", run.watch, "Look for what makes a run wrong; energies are measured with it");
  app.add_flag("--joules", request.joules,
               "Measure the devices' energy, by the driver: they rest for two seconds first");
  auto* hashes = app.add_option("--hash-every", run.hash_every, "The state's hash each so many steps")
                     ->capture_default_str();
  app.add_flag("--bench", request.bench, "Print 'name value unit' lines; no trace unless --out asks for one");
  app.add_option("--repeats", request.repeats,
                 "With --bench: then steps per second of whole runs, measured so many times")
      ->check(CLI::Range(1, 1000));
  app.add_option("--seconds", request.seconds, "Of each of --repeats, at least")
      ->check(CLI::Range(1e-3, 1e4))
      ->capture_default_str();
  app.add_flag("--list", request.list, "Print the devices, and no more");
  app.add_flag("--progress", run.progress, "A line per second on standard error");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  request.frames_given = frames->count() > 0 || frames_file->count() > 0;
  request.devices_given = devices->count() > 0;
  request.hashes_given = hashes->count() > 0;
  try {
    return cuboct::gpu::run(std::move(request));
  } catch (const InputError& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 2;
  } catch (const std::exception& e) {
    fmt::print(stderr, "cuboct-gpu: {}\n", block_text(e.what()));
    return 1;
  }
}

}  // namespace cuboct::gpu
