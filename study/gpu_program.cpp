// SPDX-License-Identifier: MIT
#include "study/gpu_program.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "study/interrupted.h"

namespace cuboct::study {
namespace {

std::string program() { return program_directory() + "/cuboct-gpu"; }

std::string text_in(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string without(std::string text, const std::string& part) {
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part))
    text.erase(at, part.size());
  while (text.ends_with('\n')) text.pop_back();
  return text;
}

// The program at work in a directory of its own. What it says is kept from the terminal.
class Job {
 public:
  // The exit code. A text of exit code 2 is an InputError's.
  int run(const std::vector<std::string>& arguments) {
    if (access(program().c_str(), X_OK) != 0) throw InputError("no program cuboct-gpu beside this one");
    const int code = Process(program(), arguments, false, {path("said"), path("errors")}).wait();
    if (interrupted()) throw Interrupted();
    if (code == 2) throw InputError(errors());
    return code;
  }
  std::string path(const std::string& name) const { return scratch_.path(name); }
  std::string said() const { return text_in(path("said")); }
  // Names of our files are of no use to others.
  std::string errors() const { return without(text_in(path("errors")), scratch_.path("")); }
  [[noreturn]] void fail(int code) const {
    const std::string text = errors();
    throw std::runtime_error(text.empty() && code < 0 ? fmt::format("cuboct-gpu was ended by signal {} ({})",
                                                                    -code, strsignal(-code))
                             : text.empty() ? fmt::format("cuboct-gpu ended with exit code {}", code)
                                            : text);
  }

 private:
  Scratch scratch_;
};

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
                       {"run.frame_every", "0"}});
}

const char* precision_of(Arithmetic arithmetic) {
  return arithmetic == Arithmetic::fixed ? "fixed" : arithmetic == Arithmetic::float32 ? "float" : "double";
}

// Files and options that every run has.
std::vector<std::string> arguments_of(const Case& c, const Body& start, const GpuRequest& request,
                                      const Job& job) {
  write_text(job.path("scene.toml"), scene_text(c, request));
  write_text(job.path("arch.toml"), c.arch_text);
  Trace body;
  body.engine = "study";
  body.bodies.push_back({0, start.x, start.v, {}});
  write_trace(job.path("start.h5"), body);
  return {job.path("scene.toml"),
          "--arch",
          job.path("arch.toml"),
          "--start",
          job.path("start.h5"),
          "--precision",
          precision_of(c.settings.arithmetic),
          "--steps",
          std::to_string(request.steps)};
}

}  // namespace

std::string find_gpu(std::string& why) {
  try {
    Job job;
    if (const int code = job.run({"--list"}); code != 0) job.fail(code);
    std::istringstream lines(job.said());
    std::string name;
    std::getline(lines, name);
    return name.substr(name.find(' ') + 1);  // behind the ordinal
  } catch (const Interrupted&) {
    throw;
  } catch (const std::runtime_error& error) {
    why = error.what();
    std::ranges::replace(why, '\n', ' ');
    return "";
  }
}

Trace run_gpu(const Case& c, const Body& start, const GpuRequest& request) {
  Job job;
  std::vector<std::string> arguments = arguments_of(c, start, request, job);
  const std::string out = job.path("trace.h5");
  write_text(job.path("keep"), fmt::format("{}\n", fmt::join(request.keep, "\n")));
  for (const std::string& word : {std::string("--frames-file"), job.path("keep"), std::string("--out"), out})
    arguments.push_back(word);
  // Hashes are work that nobody reads here.
  if (c.settings.arithmetic == Arithmetic::fixed)
    for (const std::string& word : {std::string("--hash-every"), std::to_string(request.steps + 1)})
      arguments.push_back(word);
  if (request.energies) arguments.emplace_back("--energies");
  if (request.forces) arguments.emplace_back("--forces");
  const int code = job.run(arguments);
  // Exit code 1 with a trace: the run had to stop, and the trace says why.
  if ((code != 0 && code != 1) || !std::filesystem::exists(out)) job.fail(code);
  return read_trace(out);
}

std::vector<Vec3> gpu_forces(const Case& c, const Body& body) {
  GpuRequest request;
  request.dt = c.scene.rule.dt;
  request.scene_steps = c.scene.steps;
  request.forces = true;
  request.keep = {0};
  const Trace trace = run_gpu(c, body, request);
  if (trace.stop) throw std::runtime_error(trace.stop->text);
  return trace.bodies.at(0).force;
}

std::vector<double> gpu_rates(const Case& c, const Body& start, const GpuRequest& request, int repeats,
                              double seconds) {
  Job job;
  std::vector<std::string> arguments = arguments_of(c, start, request, job);
  for (const std::string& word :
       {std::string("--bench"), std::string("--repeats"), std::to_string(repeats), std::string("--seconds"),
        fmt::format("{}", seconds), std::string("--out"), job.path("trace.h5")})
    arguments.push_back(word);
  const int code = job.run(arguments);
  std::vector<double> rates;
  if (code == 1 && std::filesystem::exists(job.path("trace.h5"))) return rates;
  if (code != 0) job.fail(code);
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
