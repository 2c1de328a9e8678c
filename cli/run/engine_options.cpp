// SPDX-License-Identifier: MIT
#include "cli/run/engine_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "hw/engine/engines.h"
#include "hw/program/bounds.h"
#include "hw/program/options.h"
#include "model/base/error.h"
#include "model/base/spelling.h"

namespace cuboct {
namespace {

// "the lattice and the reference engine"
std::string the_engines(const std::vector<std::string>& names) {
  std::string text;
  for (size_t k = 0; k < names.size(); ++k)
    text += fmt::format("{}the {}", k == 0 ? "" : k + 1 == names.size() ? " and " : ", ", names[k]);
  return text + " engine";
}

}  // namespace

void EngineOptions::add_machines(Command& command) {
  command
      .option("--threads", threads,
              "threads of lattice, systemc, rtl or reference; default: as many as suit the scene", "N")
      .range(1, 4096);
  command.option("--ranks", ranks, "processes of lattice, over MPI", "N").range(1, 65536);
  const Option list = command
                          .option("--devices", devices,
                                  "devices of gpu by CUDA's ordinals, one per part of the scene", "A,B,...")
                          .delimiter(',')
                          .range(0, 1023);
  command.option("--gpus", gpus, "the first N devices of gpu; default: one", "N").range(1, 64).excludes(list);
  command.option("--port", port, "serial port of fpga's board, e.g. /dev/ttyUSB0", "P");
  command.option("--baud", baud, "bits per second on it; default: 1000000", "N").range(300, 12000000);
  command
      .option("--port-timeout", timeout,
              "seconds without an answer after which fpga asks the board again; default: 0.3", "T")
      .range(0.001, 60.0);
  command
      .option(
          "--rule-code", rule_code,
          "how lattice or gpu runs a rule of text: interpreted; of lattice, compiled before the first step; "
          "automatic (default): lattice compiles once the run has lasted, unless the rule ships, gpu where "
          "CUDA's "
          "compiler is found")
      .one_of({"automatic", "interpreted", "compiled"});
  add_anyway_to(command, anyway);
}

void EngineOptions::add_numbers(Command& command) {
  command
      .option(
          "--precision", precision,
          "the numbers of reference, double (default) or float, and of gpu, fixed (default), float or double")
      .one_of({"fixed", "float", "double"});
  command
      .option("--integrator", integrator, "euler (semi-implicit, as the fixed rule) or verlet, of reference")
      .one_of({"euler", "verlet"})
      .show_default();
}

void EngineOptions::add_run(Command& command) {
  command.flag("--joules", joules, "measure the energy of gpu's devices, which rest for two seconds first");
  command
      .option("--hash-every", hash_every,
              "steps between two hashes of the state; default: 100 of lattice and gpu, none of fpga, else 1",
              "K")
      .range(uint64_t{1}, uint64_t{1} << 62)
      .given(hashes_given);
  command.flag("--cycles", cycles, "count the machine's cycles in lattice");
  command.option("--checkpoint-every", checkpoint_every,
                 "'1000 steps', '30 s', '5 min' or '2 h': how often an engine other than systemc and rtl "
                 "leaves a checkpoint in DIR",
                 "T");
  command.flag("--resume", resume, "go on from the checkpoint in DIR");
}

void EngineOptions::check(const std::vector<std::string>& engines, const Input& input) const {
  const auto some = [&](auto has) {
    return std::ranges::any_of(engines, [&](auto& engine) { return has(engine_row(engine)); });
  };
  const auto refuse = [&](bool given, const char* option, auto has, const std::string& why = {}) {
    if (given && !some(has))
      throw InputError(fmt::format("{} is an option of {}, not of {}", option, the_engines(engines_that(has)),
                                   fmt::join(engines, ",")),
                       why);
  };
  const auto links = [](auto& row) { return row.links; };
  refuse(input.stall_rate > 0, "--stall-rate", links);
  refuse(input.stall_seed != 1, "--stall-seed", links);
  refuse(threads > 0, "--threads", [](auto& row) { return row.cost.threads; });
  refuse(ranks > 1, "--ranks", [](auto& row) { return !row.ranks.empty(); });
  refuse(cycles, "--cycles", [](auto& row) { return row.counts_if_asked; });
  const auto saves = [](auto& row) { return row.unsaved.empty(); };
  const std::string& unsaved = engine_row(engines.front()).unsaved;
  refuse(!checkpoint_every.empty(), "--checkpoint-every", saves, unsaved);
  refuse(resume, "--resume", saves, unsaved);
  refuse(gpus > 0, "--gpus", [](auto& row) { return row.devices; });
  refuse(!devices.empty(), "--devices", [](auto& row) { return row.devices; });
  refuse(joules, "--joules", [](auto& row) { return row.devices; });
  refuse(!port.empty(), "--port", [](auto& row) { return row.port; });
  refuse(baud > 0, "--baud", [](auto& row) { return row.port; });
  refuse(timeout > 0, "--port-timeout", [](auto& row) { return row.port; });
  refuse(!precision.empty(), "--precision", [](auto& row) { return row.real; });
  refuse(integrator != "euler", "--integrator", [](auto& row) { return row.integrators; });
  const std::string code = "--rule-code " + rule_code;
  refuse(!rule_code.empty(), code.c_str(),
         [&](auto& row) { return std::ranges::find(row.rule_codes, rule_code) != row.rule_codes.end(); });
  refuse(hashes_given, "--hash-every", [](auto& row) { return row.bits; });
  for (const std::string& engine : engines)
    if (precision == "fixed" && !engine_row(engine).bits)
      throw InputError(fmt::format("--precision fixed: the {} engine computes in doubles or floats", engine),
                       "lattice, golden and gpu compute in the fixed rule's integers");
  if (hashes_given && std::ranges::all_of(engines, [&](auto& engine) { return is_real(engine); }))
    throw InputError("--hash-every goes with --precision fixed", "states in real numbers have no hash");
  for (const std::string& engine : engines)
    if (engine_row(engine).port && port.empty())
      throw InputError(fmt::format("the {} engine needs --port, where the board is", engine),
                       "--port /dev/ttyUSB0, or what cuboct-board-sim prints");
  if (input.faults.empty()) return;
  read_fault_share(input.faults);
  if (!some(links))
    throw InputError("--inject-faults needs an engine that has links", list_of(engines_that(links)));
}

void EngineOptions::check(const Plan& plan) const {
  if (!rule_code.empty() && plan.program == nullptr)
    throw InputError("--rule-code is of a [rule] of text with rounds of its own",
                     "the pair law is compiled already");
}

bool EngineOptions::is_real(const std::string& engine) const {
  if (engine.empty()) return false;
  const EngineRow& row = engine_row(engine);
  return !row.bits || (row.real && !precision.empty() && precision != "fixed");
}

RealOptions EngineOptions::real_options() const {
  return {
      .integrator = integrator == "verlet" ? Integrator::velocity_verlet : Integrator::semi_implicit_euler,
      .precision = precision == "float" ? Precision::float32 : Precision::float64};
}

}  // namespace cuboct
