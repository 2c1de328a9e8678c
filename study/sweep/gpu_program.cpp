// SPDX-License-Identifier: MIT
#include "study/sweep/gpu_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <sstream>

#include "hw/engine/engines.h"
#include "hw/program/remote.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "study/sweep/interrupted.h"

namespace cuboct::study {
namespace {

// dt to its last bit, and what else of the run is the study's.
std::string scene_text(const Case& c, const GpuRequest& request) {
  const std::string dt = is_reduced({"scene", c.scene_text, "", ""}) ? fmt::format("{}", request.dt)
                                                                     : fmt::format("\"{} s\"", request.dt);
  return with_changes(c.scene_text, "scene",
                      {{"run.dt_safety", ""},
                       {"run.duration", ""},
                       {"run.dt", dt},
                       {"run.steps", std::to_string(request.scene_steps)},
                       {"run.probe_every", std::to_string(request.probe_every)},
                       {"run.energy_every", std::to_string(request.probe_every)},
                       {"run.frame_every", "0"}});
}

const char* precision_of(Arithmetic arithmetic) {
  return arithmetic == Arithmetic::fixed ? "fixed" : arithmetic == Arithmetic::float32 ? "float" : "double";
}

// A run in a directory of its own. What the program says is kept from the terminal.
class Job {
 public:
  Job(const Case& c, const Body& start, const GpuRequest& request, GpuRuns* runs,
      const std::vector<std::string>& more = {}) {
    write_text(path("scene.toml"), scene_text(c, request));
    write_text(path("arch.toml"), c.arch_text);
    Trace body;
    body.engine = "study";
    body.bodies.push_back({0, start.x, start.v, {}, {}});
    write_trace(path("start.h5"), body);
    RemoteRun run{gpu_program(), path("scene.toml"), path("arch.toml"), path("trace.h5")};
    run.scene_path = c.scene.path;  // files that it names lie there
    run.own = {"--start", path("start.h5"), "--precision", precision_of(c.settings.arithmetic)};
    run.own.insert(run.own.end(), more.begin(), more.end());
    run.unpacked = run.quiet = true;
    run.request.steps = request.steps;
    run.request.frames = request.keep;
    run.request.energies = request.energies;
    run.request.forces = request.forces;
    run.request.integers = c.settings.arithmetic == Arithmetic::fixed;
    run.request.hash_every = 0;  // work that nobody reads here
    if (runs) run.elsewhere = [runs](const std::vector<std::string>& words) { return runs->run(words); };
    remote_.emplace(std::move(run));
  }
  Trace finish() try {
    Recorded run = remote_->finish();
    if (interrupted()) throw Interrupted();
    if (run.interrupted) throw std::runtime_error("cuboct-gpu was interrupted");
    return std::move(run.trace);
  } catch (const std::runtime_error&) {
    if (interrupted()) throw Interrupted();
    throw;
  }
  std::string said() const { return remote_->said(); }

 private:
  std::string path(const char* name) const { return scratch_.path(name); }

  Scratch scratch_;
  std::optional<Remote> remote_;
};

}  // namespace

std::string gpu_program() {
  std::string path = beside(std::ranges::find_if(engines(), &EngineRow::devices)->program);
  if (path.empty()) throw InputError("no program cuboct-gpu beside this one");
  return path;
}

std::string find_gpu(std::string& why) {
  try {
    const Scratch scratch;
    const int code =
        Process(gpu_program(), {"--list"}, false, {scratch.path("said"), scratch.path("errors")}).wait();
    if (interrupted()) throw Interrupted();
    if (code != 0) throw std::runtime_error(read_text(scratch.path("errors")));
    const std::string line = read_text(scratch.path("said"));
    return line.substr(line.find(' ') + 1, line.find('\n') - line.find(' ') - 1);  // behind the ordinal
  } catch (const Interrupted&) {
    throw;
  } catch (const std::runtime_error& error) {
    why = error.what();
    while (why.ends_with('\n')) why.pop_back();
    std::ranges::replace(why, '\n', ' ');
    return "";
  }
}

Trace run_gpu(const Case& c, const Body& start, const GpuRequest& request, GpuRuns* runs) {
  return Job(c, start, request, runs).finish();
}

std::vector<Vec3> gpu_forces(const Case& c, const Body& body, GpuRuns* runs) {
  GpuRequest request;
  request.dt = c.scene.rule.dt;
  request.scene_steps = c.scene.steps;
  request.forces = true;
  request.keep = {0};
  const Trace trace = run_gpu(c, body, request, runs);
  if (trace.stop) throw std::runtime_error(trace.stop->text);
  return trace.bodies.at(0).force;
}

std::vector<double> gpu_rates(const Case& c, const Body& start, const GpuRequest& request, int repeats,
                              double seconds) {
  Job job(c, start, request, nullptr,
          {"--bench", "--repeats", std::to_string(repeats), "--seconds", fmt::format("{}", seconds)});
  std::vector<double> rates;
  if (job.finish().stop) return rates;
  std::istringstream lines(job.said());
  for (std::string name, unit; lines >> name;) {
    double value = 0;
    lines >> value >> unit;
    if (name == "gpu.steps_per_second") rates.push_back(value);
  }
  if (rates.size() != static_cast<size_t>(repeats))
    throw std::runtime_error(fmt::format("cuboct-gpu timed {} repeats, not {}", rates.size(), repeats));
  return rates;
}

}  // namespace cuboct::study
