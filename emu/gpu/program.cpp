// SPDX-License-Identifier: MIT
#include "emu/gpu/program.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <csignal>
#include <mutex>
#include <optional>
#include <shared_mutex>

#include "emu/gpu/bench/power.h"
#include "emu/gpu/rates.h"
#include "emu/gpu/run.h"
#include "emu/gpu/start.h"
#include "hw/program/options.h"
#include "hw/program/program.h"

namespace cuboct::gpu {
namespace {

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

// The devices of the run, one after another. Fills in Options::devices. `gpus`: the first so many; 0: as
// the options say, else the first.
std::vector<Device> choose_devices(int gpus, bool given, Options& options) {
  const std::vector<Device> found = devices_here();
  if (gpus > static_cast<int>(found.size()))
    throw InputError(fmt::format("--gpus {}: this machine has {} CUDA device{}", gpus, found.size(),
                                 found.size() == 1 ? "" : "s"),
                     "--devices 0,0 puts two parts of a scene on one");
  if (gpus > 0) {
    options.devices.clear();
    for (int k = 0; k < gpus; ++k) options.devices.push_back(found[k].ordinal);
  } else if (!given) {
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

// Measures the energy of a run's devices.
class Joules {
 public:
  Joules(const std::vector<Device>& devices, uint64_t particles)
      : power_(buses_of(devices)), meter_(power_), particles_(particles) {}
  Joules(const Joules&) = delete;
  Joules& operator=(const Joules&) = delete;

  Hooks hooks() {
    return {[this] { meter_.idle(); }, [this](uint64_t steps) { meter_.did(steps); },
            [this](cuboct::Counters& counters, Notes& notes) {
              std::string why;
              if (const auto energy = meter_.finish(&why)) {
                const auto of_energy = energy->counters(particles_);
                counters.insert(counters.end(), of_energy.begin(), of_energy.end());
                notes.emplace_back("energy by", energy->method);
              } else {
                notes.emplace_back("energy", "not measured: " + why);
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

class GpuProgram : public EngineProgram {
 public:
  explicit GpuProgram(bool among_many) : among_many_(among_many) {
    silent = among_many;
    name = "cuboct-gpu";
    description = "Runs a scene on NVIDIA GPUs, with the bits of the golden engine or in real numbers";
    abilities.forces = abilities.checkpoints = abilities.text = abilities.any_cells = true;
  }

  void add_options(Command& app) override {
    app.option("--start", start_,
               "Trace with a state in real numbers; its last one is where the run starts, not the scene's");
    app.option("--precision", precision_, "fixed (golden's bits), float or double")
        .one_of({"fixed", "float", "double"})
        .show_default();
    const Option devices =
        app.option("--devices", choice_.engine.devices,
                   "CUDA's ordinals, one per slab of the scene; the first device without it")
            .delimiter(',')
            .given(devices_given_);
    app.option("--gpus", gpus_, "The first N devices").range(1, 64).excludes(devices);
    app.option("--block", choice_.engine.block, "Threads of a block").show_default();
    app.flag("--joules", joules_,
             "Measure the devices' energy, by the driver: they rest for two seconds first");
    app.option("--repeats", repeats_,
               "With --bench: then steps per second of whole runs, measured so many times")
        .range(1, 1000);
    app.option("--seconds", seconds_, "Of each of --repeats, at least").range(1e-3, 1e4).show_default();
    app.option("--rule-code", rule_code_,
               "How a rule of text runs: interpreted, or automatic: compiled where CUDA's compiler is found")
        .one_of({"automatic", "interpreted"})
        .show_default();
    app.option("--pause-after", pause_after_,
               "End after so many steps of this run as an interrupt ends it: with --checkpoint the next one "
               "goes on from there",
               "N");
    app.flag("--list", list_, "Print the devices, and no more");
  }

  bool prepare(ProgramOptions& options) override;
  void begin(Scene& scene) override {
    found_ = choose_devices(gpus_, devices_given_, choice_.engine);
    for (const Device& device : found_) names_.push_back(device.name);
    if (among_many_) take_room(scene);
    if (!start_.empty()) start_from(start_, scene);
  }
  EngineKind kind(Scene& scene, const Plan& plan, const ProgramOptions&) override;
  void print_bench(const Scene& scene, const Plan& plan, const Recorded& run) override;
  void print_end(const Plan& plan, const Trace& trace) override {
    fmt::print("{} steps of {} particles on {}, {:.3g} particle-steps/s\n", trace.steps(), plan.particles,
               fmt::join(names_, ", "),
               static_cast<double>(trace.steps()) * plan.particles / std::max(trace.seconds, 1e-9));
    for (const auto& [name, text] : trace.notes)
      if (name == "kernels") fmt::print("the rule's kernels are {}\n", text);
  }

 private:
  void take_room(const Scene& scene);

  bool among_many_;
  std::shared_lock<std::shared_mutex> beside_others_;
  std::unique_lock<std::shared_mutex> alone_;
  std::string start_, precision_ = "fixed", rule_code_ = "automatic";
  GpuChoice choice_;
  int gpus_ = 0, repeats_ = 0;
  uint64_t pause_after_ = 0;
  double seconds_ = 0.3;
  bool joules_ = false, list_ = false, devices_given_ = false;
  std::vector<Device> found_;
  std::vector<std::string> names_;
  std::optional<Joules> meter_;
};

// What a run of many scenes cannot have.
void refuse_among_many(const std::string& option) {
  throw InputError(option + " is of a run by itself, not of one among many");
}

void GpuProgram::take_room(const Scene& scene) {
  static std::shared_mutex room;
  if (scene.body.size() <= kMostTogether && scene.rule.rounds == nullptr)
    beside_others_ = std::shared_lock(room);
  else
    alone_ = std::unique_lock(room);
}

bool GpuProgram::prepare(ProgramOptions& options) {
  if (among_many_) {
    const bool several = gpus_ > 1 || choice_.engine.devices.size() > 1;
    for (const auto& [given, option] : {std::pair{list_, "--list"},
                                        {options.bench, "--bench"},
                                        {joules_, "--joules"},
                                        {pause_after_ > 0, "--pause-after"},
                                        {several, "more than one device"}})
      if (given) refuse_among_many(option);
    if (options.run.log == LogRows::off) options.run.log = LogRows::quiet;
  }
  if (list_) {
    for (const Device& device : devices_here()) fmt::print("{} {}\n", device.ordinal, device.name);
    return true;
  }
  if (repeats_ > 0 && !options.bench) throw InputError("--repeats goes with --bench");
  const int block = choice_.engine.block;
  if (block % 32 != 0 || block < 32 || block > 256)
    throw InputError(fmt::format("--block {}: not a multiple of 32 from 32 to 256", block));
  if (precision_ == "fixed" && options.run.forces)
    throw InputError("--forces goes with --precision float or double", "fixed states determine their forces");
  if (precision_ != "fixed" && options.hashes_given && options.run.hash_every > 0)
    throw InputError("--hash-every goes with --precision fixed", "states in real numbers have no hash");
  if (options.run.forces && !options.run.checkpoint.path.empty())
    throw InputError("--forces goes without --checkpoint", "a checkpoint's frames hold no forces");
  if (pause_after_ > 0) {
    if (options.run.checkpoint.path.empty()) throw InputError("--pause-after goes with --checkpoint FILE");
    options.run.checkpoint.every_steps = pause_after_;  // a batch ends there
  }
  choice_.arithmetic = arithmetic_of(precision_);
  choice_.interpret = rule_code_ == "interpreted";
  if (choice_.interpret && precision_ != "fixed")
    throw InputError("--rule-code interpreted goes with --precision fixed",
                     "a rule of text in real numbers is compiled for the device");
  abilities.real_text = precision_ != "fixed";
  return false;
}

EngineKind GpuProgram::kind(Scene& scene, const Plan& plan, const ProgramOptions&) {
  if (joules_) {
    meter_.emplace(found_, plan.particles);
    choice_.hooks = meter_->hooks();
  }
  if (pause_after_ > 0)
    choice_.hooks.did = [this, did = choice_.hooks.did](uint64_t steps) {
      if (did) did(steps);
      if (pause_after_ > 0 && steps >= pause_after_) std::raise(SIGTERM);
      pause_after_ -= std::min(steps, pause_after_);
    };
  const auto finish = choice_.hooks.finish;
  choice_.hooks.finish = [this, finish](cuboct::Counters& counters, Notes& notes) {
    if (finish) finish(counters, notes);
    for (size_t k = 0; k < names_.size(); ++k) notes.emplace_back(fmt::format("device {}", k), names_[k]);
  };
  return gpu_kind(scene, plan, choice_);
}

// Rates of whole runs; a run that stops is told by the trace of one run.
void GpuProgram::print_bench(const Scene& scene, const Plan& plan, const Recorded& run) {
  const RateRequest rates{choice_.arithmetic, run.trace.steps(), repeats_,
                          seconds_,           choice_.engine,    choice_.interpret};
  if (repeats_ > 0 && !run.trace.stop && !run.interrupted)
    for (const double rate : step_rates(scene, plan, rates))
      fmt::print("gpu.steps_per_second {:.15g} 1/s\n", rate);
  EngineProgram::print_bench(scene, plan, run);
}

}  // namespace

int run_gpu_program(int argc, char** argv) {
  GpuProgram program(false);
  return run_program(argc, argv, program);
}

int run_among_many(int argc, char** argv) {
  GpuProgram program(true);
  return run_program(argc, argv, program);
}

}  // namespace cuboct::gpu
