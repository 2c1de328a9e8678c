// SPDX-License-Identifier: MIT
#include "cli/run_lattice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <filesystem>

#include "cli/engines.h"
#include "cli/estimate.h"
#include "emu/lattice/program.h"
#include "model/analysis/measure.h"
#include "model/base/interrupt.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/base/progress.h"
#include "model/trace/trace_file.h"

namespace cuboct {
namespace {

LatticeAnswer run_over_mpi(const Input& input, const Plan& plan, const LatticeChoice& choice,
                           const emu::LatticeRun& request) {
  if (access((program_directory() + "/cuboct-lattice").c_str(), X_OK) != 0)
    throw InputError(fmt::format("--ranks {}: no program cuboct-lattice beside cuboct", choice.ranks));
  if (!emu::lattice_has_mpi())
    throw InputError(fmt::format("--ranks {}: the lattice engine was built without MPI", choice.ranks),
                     "--threads uses the cores of this machine");
  if (!in_path("mpirun"))
    throw InputError(fmt::format("--ranks {}: no program mpirun", choice.ranks), "install openmpi-bin");
  const Scratch scratch;
  const std::string out = scratch.path("lattice.h5"), frames = scratch.path("frames"),
                    begun = scratch.path("begun");
  write_text(frames, fmt::format("{}\n", fmt::join(request.frames, "\n")));
  std::vector<std::string> arguments{"--quiet",
                                     "--oversubscribe",
                                     "--bind-to",
                                     "none",
                                     "-n",
                                     std::to_string(choice.ranks),
                                     program_directory() + "/cuboct-lattice",
                                     input.scene,
                                     "--steps",
                                     std::to_string(request.steps),
                                     "--hash-every",
                                     std::to_string(request.hash_every),
                                     "--frames-file",
                                     frames,
                                     "--out",
                                     out,
                                     "--begun",
                                     begun};
  const auto add = [&](bool wanted, std::initializer_list<std::string> words) {
    if (wanted) arguments.insert(arguments.end(), words);
  };
  const emu::CheckpointPlan& checkpoint = request.checkpoint;
  add(!input.arch.empty(), {"--arch", input.arch});
  add(choice.threads > 0, {"--threads", std::to_string(choice.threads)});
  add(request.cycles, {"--cycles"});
  add(request.energies, {"--energies"});
  add(request.watch, {"--watch"});
  add(!checkpoint.path.empty(), {"--checkpoint", checkpoint.path});
  add(!choice.checkpoint_every.empty(), {"--checkpoint-every", choice.checkpoint_every});
  add(checkpoint.resume, {"--resume"});
  add(stderr_is_terminal(), {"--progress"});
  // Open MPI warns root, who in a container is everyone.
  if (geteuid() == 0) arguments.insert(arguments.begin(), "--allow-run-as-root");
  LatticeAnswer result;
  Process process("mpirun", arguments, true);
  const int code = process.wait([&] { return std::filesystem::exists(begun); });
  if (!std::filesystem::exists(out)) {
    if (code == 2) throw AlreadyTold(2);
    if (interrupted()) throw std::runtime_error("interrupted before the ranks began");
    throw std::runtime_error(code < 0 ? fmt::format("mpirun was ended by signal {}", -code)
                                      : fmt::format("mpirun ended with exit code {}", code));
  }
  if (code == 2) result.trouble = "the ranks could not write all of it";  // they said more
  const TraceReader reader(out);
  result.trace = reader.rest();
  result.interrupted = result.trace.steps() < request.steps && !result.trace.stop;
  result.left_checkpoint = result.interrupted && std::filesystem::exists(checkpoint.path);
  reader.frames([&](State state) {
    if (state.step == 0) result.momentum_before = momentum(state);
    result.momentum_after = momentum(state);
    result.largest_speed = std::max(result.largest_speed, largest_speed(plan.rule, state));
    if (request.keep)
      request.keep(state);
    else
      result.trace.frames.push_back(std::move(state));
  });
  return result;
}

}  // namespace

void LatticeChoice::add_to(CLI::App& command) {
  command
      .add_option("--threads", threads, "threads of lattice or reference; default: as many as suit the scene")
      ->check(CLI::Range(1, 4096))
      ->type_name("N");
  command.add_option("--ranks", ranks, "processes of lattice, over MPI")
      ->check(CLI::Range(1, 65536))
      ->type_name("N");
}

void LatticeChoice::check_unused(const std::string& engine) const {
  const auto refuse = [&](bool given, const char* option) {
    if (given)
      throw InputError(fmt::format("{} is an option of the lattice engine, not of {}", option, engine));
  };
  if (threads > 0 && engine != "reference")
    throw InputError(
        fmt::format("--threads is an option of the lattice and the reference engine, not of {}", engine));
  refuse(ranks > 1, "--ranks");
  refuse(cycles, "--cycles");
  refuse(!checkpoint_every.empty(), "--checkpoint-every");
  refuse(resume, "--resume");
}

LatticeAnswer run_on_lattice(const Input& input, const Scene& scene, const Plan& plan,
                             const LatticeChoice& choice, emu::LatticeRun request) {
  check_workers(choice.threads, choice.ranks, plan);
  request.engine.threads = choice.threads;
  if (!choice.checkpoint_every.empty()) emu::read_interval(choice.checkpoint_every, request.checkpoint);
  request.checkpoint.resume = choice.resume;
  if (choice.ranks > 1) return run_over_mpi(input, plan, choice, request);
  return {emu::run_lattice(scene, plan, request), {}};
}

}  // namespace cuboct
