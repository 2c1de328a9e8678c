// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "cli/answer.h"
#include "cli/command.h"
#include "cli/machine/clock_option.h"
#include "cli/machine/energy_text.h"
#include "cli/machine/machine_cycles.h"
#include "cli/machine/technologies.h"
#include "cli/programs.h"
#include "cli/run/estimate.h"
#include "hw/cost/memory_traffic.h"
#include "hw/program/bounds.h"
#include "hw/program/options.h"
#include "model/base/interrupt.h"
#include "model/base/spelling.h"

namespace cuboct {
namespace {

struct EnergyOptions {
  Input input;
  std::string beside, link, clock = "100 MHz";
  std::vector<std::string> technologies{"cmos45", "cmos7"};
  std::optional<uint64_t> steps;  // empty: as many as take some seconds
  bool json = false, anyway = false;
};

EnergyMachine machine_of(const EnergyOptions& options, const std::string& arch, double clock,
                         const std::vector<Technology>& technologies) {
  Input input = options.input;
  input.arch = arch;
  const Loaded loaded = load_machine(input);
  const Plan& plan = loaded.setup.plan;
  check_held(loaded.scene, plan, options.anyway);
  if (options.steps) check_counted("--steps", "lattice", loaded.scene, plan, *options.steps, options.anyway);
  check_machine(loaded);
  constexpr uint64_t kMostWork = 20'000'000;  // particles times steps
  const uint64_t affordable = std::max<uint64_t>(1, kMostWork / std::max<uint64_t>(1, plan.particles));
  const auto run =
      count_run(plan, loaded.setup.initial, options.steps.value_or(std::min(kCountedSteps, affordable)));
  if (!run && interrupted()) throw Failed("interrupted");
  if (!run) throw Failed("the first step breaks a width or a capacity", "'cuboct run' tells which");
  EnergyMachine m;
  m.arch = plan.arch.name;
  m.nodes = plan.nodes();
  m.steps = run->cycles.steps;
  m.cycles = run->cycles.cycles;
  m.events = sum(run->nodes);
  m.updates = m.events.updates / plan.rounds.size();  // a particle has one in each round
  m.traffic = memory_traffic(plan, m.events);
  for (const Technology& t : technologies)
    m.findings.push_back({t.name, t.title, energy_of(plan, m.events, m.traffic, m.cycles, clock, t),
                          area_of(plan, t), sensitivity_of(plan, m.events, m.traffic, m.cycles, clock, t)});
  return m;
}

int energy(const EnergyOptions& options) {
  catch_interrupts();
  EnergyFindings found;
  found.scene = options.input.scene;
  found.link = options.link;
  found.clock = clock_of(options.clock);
  std::vector<Technology> technologies;
  for (const std::string& name : options.technologies) {
    technologies.push_back(technology_named(name));
    if (!options.link.empty()) technologies.back() = with_link(std::move(technologies.back()), options.link);
  }
  if (options.steps == uint64_t{0}) throw InputError("--steps: no step, no energy", "--steps 200");
  found.machines.push_back(machine_of(options, options.input.arch, found.clock, technologies));
  if (!options.beside.empty())
    found.machines.push_back(machine_of(options, options.beside, found.clock, technologies));
  fmt::print("{}", options.json ? json_of(found) : text_of(found));
  return 0;
}

}  // namespace

void add_energy(Command& app, int& exit_code) {
  auto [command, options] = add_command<EnergyOptions>(app, "energy", exit_code, energy);
  options->input.add_to(command);
  options->input.add_start_to(command);
  command.option("--beside", options->beside, "a second machine description, to compare with the first",
                 "FILE");
  command
      .option("--technology", options->technologies,
              "one or several, with commas: " + list_of(technology_names()) + ", or files", "NAME")
      .delimiter(',')
      .proposed(technology_names())
      .show_default("cmos45,cmos7");
  command
      .option("--link", options->link,
              "links go between chips, by " + list_of(link_names()) + "; default: wires on chip", "KIND")
      .proposed(link_names());
  command.option("--clock", options->clock, "of the machine", "F").show_default();
  command
      .option("--steps", options->steps,
              fmt::format("that are counted; default: {}, fewer of very many particles", kCountedSteps), "N")
      .check(whole_number);
  add_anyway_to(command, options->anyway);
  command.flag("--json", options->json, "print one JSON document instead of lines for people");
}

}  // namespace cuboct
