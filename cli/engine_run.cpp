// SPDX-License-Identifier: MIT
#include "cli/engine_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>

#include "cli/engines.h"
#include "cli/estimate.h"
#include "emu/lattice/program.h"
#include "emu/lattice/run.h"
#include "hw/engine_kind.h"
#include "hw/program/program.h"
#include "model/base/interrupt.h"
#include "model/base/process.h"
#include "model/trace/trace_file.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

// What an engine alone has on its program's command line.
std::vector<std::string> own_arguments(const EngineRow& row, const Input& input,
                                       const EngineOptions& options) {
  std::vector<std::string> words;
  const auto add = [&](bool wanted, std::initializer_list<std::string> more) {
    if (wanted) words.insert(words.end(), more);
  };
  add(row.links && input.stall_rate > 0, {"--stall-rate", fmt::format("{}", input.stall_rate), "--stall-seed",
                                          std::to_string(input.stall_seed)});
  add(row.links && !input.faults.empty(),
      {"--inject-faults", input.faults, "--fault-seed", std::to_string(input.fault_seed)});
  if (row.name == "lattice") add(options.threads > 0, {"--threads", std::to_string(options.threads)});
  if (row.name == "gpu") {
    add(!options.precision.empty(), {"--precision", options.precision});
    add(options.gpus > 0, {"--gpus", std::to_string(options.gpus)});
    add(!options.devices.empty(), {"--devices", fmt::format("{}", fmt::join(options.devices, ","))});
    add(options.joules, {"--joules"});
  }
  if (row.name == "fpga") {
    add(true, {"--port", options.port});
    add(options.baud > 0, {"--baud", std::to_string(options.baud)});
    add(options.timeout > 0, {"--timeout", fmt::format("{}", options.timeout)});
  }
  return words;
}

// The lattice engine's program where several processes share a scene, else the row's own.
std::string program_of(const EngineRow& row, const EngineOptions& options) {
  const bool ranks = row.name == "lattice" && options.ranks > 1;
  const std::string name = ranks ? "cuboct-lattice" : row.program;
  if (name.empty()) return name;
  const std::string path = program_directory() + "/" + name;
  if (access(path.c_str(), X_OK) == 0) return path;
  if (ranks)
    throw InputError(fmt::format("--ranks {}: no program cuboct-lattice beside cuboct", options.ranks));
  throw InputError(fmt::format("the {} engine is not built: no program {} beside cuboct", row.name, name),
                   row.needs);
}

}  // namespace

struct EngineRun::Impl {
  const EngineRow& row;
  const Loaded& loaded;
  const EngineOptions& options;
  RunRequest request;
  std::string path, steps_file, begun;
  std::string program;
  std::optional<Process> process;
  bool told_trouble = false;

  bool over_mpi() const { return row.program.empty(); }
  void start(const Input& input, bool passes);
  std::vector<std::string> under_mpirun(const std::vector<std::string>& arguments);
  void wait();
  Recorded read();
  Recorded run_here();
};

void EngineRun::Impl::start(const Input& input, bool passes) {
  steps_file = path + ".steps";
  begun = path + ".begun";
  RunRequest asked = request;
  asked.cycles &= row.counts_if_asked;
  std::vector<std::string> arguments = program_arguments(input.scene, input.arch, asked, path, steps_file);
  const std::vector<std::string> own = own_arguments(row, input, options);
  arguments.insert(arguments.end(), own.begin(), own.end());
  // Packing millions of particles takes longer than many of its steps.
  if (passes && row.name == "gpu") arguments.push_back("--unpacked");
  fs::remove(path);  // what is found there afterwards is this run's
  if (over_mpi())
    process.emplace("mpirun", under_mpirun(arguments), true);
  else
    process.emplace(program, arguments);
}

std::vector<std::string> EngineRun::Impl::under_mpirun(const std::vector<std::string>& arguments) {
  if (!emu::lattice_has_mpi())
    throw InputError(fmt::format("--ranks {}: the lattice engine was built without MPI", options.ranks),
                     "--threads uses the cores of this machine");
  if (!in_path("mpirun"))
    throw InputError(fmt::format("--ranks {}: no program mpirun", options.ranks), "install openmpi-bin");
  std::vector<std::string> words{
      "--quiet", "--oversubscribe", "--bind-to", "none", "-n", std::to_string(options.ranks), program};
  // Open MPI warns root, who in a container is everyone.
  if (geteuid() == 0) words.insert(words.begin(), "--allow-run-as-root");
  words.insert(words.end(), arguments.begin(), arguments.end());
  words.insert(words.end(), {"--begun", begun});
  return words;
}

void EngineRun::Impl::wait() {
  const int code = over_mpi() ? process->wait([&] { return fs::exists(begun); }) : process->wait();
  const std::string name = over_mpi() ? "mpirun" : fs::path(program).filename().string();
  fs::remove(steps_file);
  fs::remove(begun);
  // Ranks that could not write all of it have told so, and leave what they have.
  const bool left = fs::exists(path);
  if (code == 2 && !(over_mpi() && left)) throw AlreadyTold(2);
  told_trouble = code == 2;
  // Exit code 1 with a trace: the run had to stop or found something wrong, and the trace says what.
  if (code == 0 || (code > 0 && left)) return;
  if (interrupted() && (code < 0 || over_mpi()))
    throw std::runtime_error(fmt::format("interrupted before {} began", over_mpi() ? "the ranks" : name));
  if (code < 0)
    throw std::runtime_error(fmt::format("{} was ended by signal {} ({})", name, -code, strsignal(-code)));
  throw std::runtime_error(fmt::format("{} ended with exit code {}", name, code));
}

Recorded EngineRun::Impl::read() {
  const TraceReader reader(path);
  Recorded run;
  run.trace = reader.rest();
  take_totals(run);
  run.interrupted = run.trace.steps() < request.steps && !run.trace.stop;
  if (told_trouble) run.trouble = "the ranks could not write all of it";
  run.left_checkpoint = run.interrupted && fs::exists(request.checkpoint.path);
  reader.frames([&](State state) { give(request, std::move(state), run.trace); });
  reader.bodies([&](RealFrame frame) { give(request, std::move(frame), run.trace); });
  return run;
}

Recorded EngineRun::Impl::run_here() {
  const Scene& scene = loaded.scene;
  const Plan& plan = loaded.setup.plan;
  if (row.name == "golden") return record(scene, golden_kind(scene, plan), request);
  if (row.name == "reference") {
    RealOptions real = options.real_options();
    real.threads = options.threads > 0 ? options.threads : reference_threads(scene.body.size());
    return record(scene, reference_kind(scene, plan, real), request);
  }
  emu::LatticeRun run{request, {}};
  run.engine.threads = options.threads;
  return emu::run_lattice(scene, plan, run);
}

EngineRun::EngineRun(const std::string& engine, const Input& input, const Loaded& loaded,
                     const EngineOptions& options, RunRequest request, const std::string& path, bool passes) {
  const EngineRow& row = engine_row(engine);
  if (row.name == "lattice") check_workers(options.threads, options.ranks, loaded.setup.plan);
  if (!options.checkpoint_every.empty()) read_interval(options.checkpoint_every, request.checkpoint);
  request.checkpoint.resume = options.resume;
  impl_ = std::make_unique<Impl>(
      Impl{row, loaded, options, std::move(request), path, "", "", program_of(row, options), {}});
  if (!impl_->program.empty()) impl_->start(input, passes);
}

EngineRun::~EngineRun() = default;
EngineRun::EngineRun(EngineRun&&) noexcept = default;

Recorded EngineRun::finish() {
  if (impl_->program.empty()) return impl_->run_here();
  impl_->wait();
  return impl_->read();
}

uint64_t hashes_every(const std::string& engine, const EngineOptions& options) {
  if (options.is_real(engine)) return 0;
  return options.hashes_given ? options.hash_every : engine_row(engine).hash_every;
}

}  // namespace cuboct
