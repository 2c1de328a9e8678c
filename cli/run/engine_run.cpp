// SPDX-License-Identifier: MIT
#include "cli/run/engine_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "cli/run/estimate.h"
#include "emu/lattice/program.h"
#include "emu/lattice/run.h"
#include "hw/engine/engine_kind.h"
#include "hw/engine/engines.h"
#include "hw/engine/scene_engine.h"

namespace cuboct {
namespace {

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
  add(row.cost.threads && options.threads > 0, {"--threads", std::to_string(options.threads)});
  add(row.real && !options.precision.empty(), {"--precision", options.precision});
  add(options.gpus > 0 && row.devices, {"--gpus", std::to_string(options.gpus)});
  add(!options.devices.empty() && row.devices,
      {"--devices", fmt::format("{}", fmt::join(options.devices, ","))});
  add(options.joules && row.devices, {"--joules"});
  add(options.pause_after > 0 && row.devices, {"--pause-after", std::to_string(options.pause_after)});
  add(std::ranges::find(row.rule_codes, options.rule_code) != row.rule_codes.end(),
      {"--rule-code", options.rule_code});
  add(row.port, {"--port", options.port});
  add(row.port && options.baud > 0, {"--baud", std::to_string(options.baud)});
  add(row.port && options.timeout > 0, {"--timeout", fmt::format("{}", options.timeout)});
  return words;
}

// The path of the program in which the engine runs; empty: here.
std::string program_of(const EngineRow& row, const EngineOptions& options) {
  const bool ranks = !row.ranks.empty() && options.ranks > 1;
  std::string name = ranks ? row.ranks : row.program;
  if (name.empty()) return name;
  std::string path = beside(name);
  if (ranks && path.empty())
    throw InputError(fmt::format("--ranks {}: no program {} beside cuboct", options.ranks, name));
  if (path.empty())
    throw InputError(fmt::format("the {} engine is not built: no program {} beside cuboct", row.name, name),
                     row.needs);
  if (ranks && !emu::lattice_has_mpi())
    throw InputError(fmt::format("--ranks {}: the {} engine was built without MPI", options.ranks, row.name),
                     "--threads uses the cores of this machine");
  return path;
}

Recorded run_here(const EngineRow& row, const Loaded& loaded, const EngineOptions& options,
                  const RunRequest& request) {
  const Scene& scene = loaded.scene;
  const Plan& plan = loaded.setup.plan;
  if (row.here == Here::golden) return record(scene, golden_kind(scene, plan), request);
  if (row.here == Here::reference) {
    RealOptions real = options.real_options();
    real.threads = options.threads > 0 ? options.threads : reference_threads(scene.body.size());
    return record(scene, scene_reference_kind(scene, plan, real), request);
  }
  emu::LatticeRun run{request, {}};
  run.engine.threads = options.threads;
  run.engine.rule_code = emu::rule_code_of(options.rule_code);
  return emu::run_lattice(scene, plan, run);
}

}  // namespace

EngineRun::EngineRun(const std::string& engine, const Input& input, const Loaded& loaded,
                     const EngineOptions& options, RunRequest request, const std::string& path, bool once) {
  const EngineRow& row = engine_row(engine);
  check_runs(loaded.scene, loaded.setup.plan.arch, engine);
  options.check(loaded.setup.plan);
  if (row.cost.threads) check_workers(options.threads, options.ranks, options.anyway, loaded.setup.plan);
  if (!options.checkpoint_every.empty()) read_interval(options.checkpoint_every, request.checkpoint);
  request.checkpoint.resume = options.resume;
  const std::string program = program_of(row, options);
  if (program.empty()) {
    here_ = [&row, &loaded, &options, request] {
      return with_places(loaded.scene, loaded.setup.plan.arch,
                         [&] { return run_here(row, loaded, options, request); });
    };
    return;
  }
  request.cycles &= row.counts_if_asked;
  remote_.emplace(RemoteRun{program, input.scene, input.arch, path, own_arguments(row, input, options),
                            row.ranks.empty() ? 1 : options.ranks, once && row.devices, input.stage,
                            input.from, input.scene_path, options.quiet, std::move(request)});
}

Recorded EngineRun::finish() { return remote_ ? remote_->finish() : here_(); }

uint64_t hashes_every(const std::string& engine, const EngineOptions& options) {
  if (options.is_real(engine)) return 0;
  return options.hashes_given ? options.hash_every : engine_row(engine).hash_every;
}

}  // namespace cuboct
