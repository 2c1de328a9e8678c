// SPDX-License-Identifier: MIT
#include "cli/engines.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/base/progress.h"
#include "model/base/spelling.h"

namespace cuboct {

const std::vector<std::string>& fixed_engines() {
  static const std::vector<std::string> names{"golden", "lattice", "systemc", "rtl", "fpga", "gpu"};
  return names;
}

void check_engine(const std::string& name, const std::vector<std::string>& allowed) {
  if (std::find(allowed.begin(), allowed.end(), name) != allowed.end()) return;
  const std::string near = did_you_mean(name, allowed);
  throw InputError(fmt::format("unknown engine '{}'", name),
                   near.empty() ? "one of " + list_of(allowed) : near);
}

void check_faults(const Input& input, const std::vector<std::string>& engines) {
  if (input.faults.empty()) return;
  read_fault_share(input.faults);
  const auto has_links = [](const std::string& engine) { return engine == "systemc" || engine == "rtl"; };
  if (std::none_of(engines.begin(), engines.end(), has_links))
    throw InputError("--inject-faults needs an engine that has links", "systemc or rtl");
}

struct RunningEngine::State {
  std::string program;
  std::string path;
  Process process;
};

RunningEngine::RunningEngine(const std::string& engine, const Input& input, const Request& request,
                             std::string path, bool progress, const std::vector<std::string>& more) {
  const std::string program = program_directory() + "/cuboct-" + engine;
  if (access(program.c_str(), X_OK) != 0)
    throw InputError(
        fmt::format("the {} engine is not built: no program cuboct-{} beside cuboct", engine, engine),
        engine == "systemc" ? "install libsystemc-dev and build again"
        : engine == "fpga"  ? "install zlib1g-dev and build again"
        : engine == "gpu"   ? "install the CUDA toolkit (nvcc), configure and build again"
                            : "install verilator and libsystemc-dev and build again");
  std::vector<std::string> arguments{input.scene, "--steps", std::to_string(request.steps), "--out", path};
  if (!input.arch.empty()) arguments.insert(arguments.end(), {"--arch", input.arch});
  // A few on the command line, where they can be read; it holds no more than some ten thousand.
  constexpr size_t kListed = 1000;
  // An empty list in a file asks for none, as the list of no program does.
  const bool none_by_file = engine == "gpu" || engine == "fpga";
  if (request.frames.size() > kListed || (request.frames.empty() && none_by_file)) {
    write_text(path + ".steps", fmt::format("{}\n", fmt::join(request.frames, "\n")));
    arguments.insert(arguments.end(), {"--frames-file", path + ".steps"});
  } else if (!request.frames.empty()) {
    arguments.insert(arguments.end(), {"--frames", fmt::format("{}", fmt::join(request.frames, ","))});
  }
  if (input.stall_rate > 0 && engine != "gpu" && engine != "fpga")  // they have no links that could stall
    arguments.insert(arguments.end(), {"--stall-rate", fmt::format("{}", input.stall_rate), "--stall-seed",
                                       std::to_string(input.stall_seed)});
  if (!input.faults.empty() && engine != "gpu")
    arguments.insert(arguments.end(),
                     {"--inject-faults", input.faults, "--fault-seed", std::to_string(input.fault_seed)});
  if (progress) arguments.push_back("--progress");
  arguments.insert(arguments.end(), more.begin(), more.end());
  std::filesystem::remove(path);  // what is found there afterwards is this run's
  state_ = std::make_shared<State>(State{program, std::move(path), Process(program, arguments)});
}

Trace RunningEngine::finish() {
  wait();
  return read_trace(state_->path);
}

std::unique_ptr<TraceReader> RunningEngine::finish_reading() {
  wait();
  return std::make_unique<TraceReader>(state_->path);
}

void RunningEngine::wait() {
  const int code = state_->process.wait();
  std::filesystem::remove(state_->path + ".steps");
  const std::string name = std::filesystem::path(state_->program).filename().string();
  if (code == 2) throw AlreadyTold(2);
  // Exit code 1 with a trace: the run had to stop, and the trace says why.
  if (code == 1 && std::filesystem::exists(state_->path)) return;
  if (code < 0 && interrupted()) throw std::runtime_error(fmt::format("interrupted before {} began", name));
  if (code < 0)
    throw std::runtime_error(fmt::format("{} was ended by signal {} ({})", name, -code, strsignal(-code)));
  if (code != 0) throw std::runtime_error(fmt::format("{} ended with exit code {}", name, code));
}

}  // namespace cuboct
