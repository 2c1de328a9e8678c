// SPDX-License-Identifier: MIT
#include "cli/run/check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <memory>

#include "cli/answer.h"
#include "cli/programs.h"
#include "cli/run/estimate.h"
#include "cli/run/packing_text.h"
#include "cli/run/plan_text.h"
#include "cli/run/probe_lines.h"
#include "cli/run/rule_integers.h"
#include "cli/run/stages.h"
#include "cli/run/summary.h"
#include "hw/cost/cycles.h"
#include "hw/cost/node_area.h"
#include "hw/plan/reach_cost.h"
#include "hw/plan/spared.h"
#include "hw/program/options.h"
#include "model/analysis/motion.h"
#include "model/analysis/synopsis.h"
#include "model/base/quantity_text.h"
#include "model/base/resources.h"
#include "model/real/reference.h"
#include "model/rules/rounds_rule.h"
#include "model/run/start.h"

namespace cuboct {
namespace {

void add_table(Items& items, const std::string& name, const FixedTable& table, const std::string& why) {
  const std::string shape = table.shape == TableShape::uniform
                                ? "uniform in r^2"
                                : fmt::format("octaves of r^2, {} bins each", uint64_t{1} << table.bin_bits);
  items.add(name,
            fmt::format("{}, degree {}, {} entries, {} fractional bits", shape, table.degree, table.c0.size(),
                        table.value_frac),
            why);
}

// What the plan leaves out, each with what its records would be longer by. Pair scales are
// counted with the types that they need.
void add_not_built(Items& items, const Plan& plan) {
  // In the order of Carry.
  static constexpr std::array<const char*, Carry::kCount> kNames{
      "damping", "pair scales", "types", "PD controllers", "masses", "third axis", "empty nodes"};
  static constexpr std::array<const char*, Carry::kCount - 1> kBesides{
      "velocities, a table, 2 cycles of the pipe",
      "types, a table, 2 cycles of the pipe",
      "types",
      "displacements, 3 cycles of the update",
      "a product per axis, 2 cycles of the update",
      "2 of 8 phases, and all that works along z"};
  const Spared left = spared(plan);
  std::vector<std::string> names;
  for (const Spared::Part& part : left.parts) {
    names.emplace_back(kNames[part.index]);
    if (part.index == 0) names.back() += ", velocity in the halo record";
  }
  if (left.missing > 0) names.emplace_back(kNames.back());
  items.add("not built", names.empty() ? "nothing is left out" : fmt::format("{}", fmt::join(names, ", ")));
  for (const Spared::Part& part : left.parts)
    items.add(fmt::format("not built {}", kNames[part.index]), part.halo_bits, "bit",
              fmt::format("of a halo record, {} of a particle record; {}", part.particle_bits,
                          kBesides[part.index]));
  if (left.missing > 0)
    items.add(fmt::format("not built {}", kNames.back()), left.missing, "cells",
              fmt::format("of {} cells of the bounding box are not in the lattice", left.box));
  items.add("halo record with everything", left.all.halo_bits, "bit",
            fmt::format("{} as built", plan.words.halo_bits));
  items.add("particle record with everything", left.all.particle_bits, "bit",
            fmt::format("{} as built", plan.words.particle_bits));
}

// Why a format is what it is.
std::string reason_of(const Plan& plan, const std::string& key) {
  for (const WidthReason& reason : plan.reasons)
    if (reason.key == key)
      return !reason.asked ? reason.why
             : reason.wanted != reason.bits
                 ? fmt::format("by the arch file; \"auto\": {}, {}", reason.wanted, reason.why)
                 : "by the arch file";
  return {};
}

// Multipliers of FPGAs take 18 bits; a strength beyond them costs a second one and an adder.
std::string strength_reason(const Plan& plan) {
  constexpr int kMultiplier = 18;
  const FixedRule& rule = plan.rule;
  const Widths& w = rule.widths;
  if (std::string why = reason_of(plan, "strength_bits"); !why.empty()) return why;
  const int more = w.strength_bits - kMultiplier;
  if (more <= 0) return "one multiplier of an FPGA takes them";
  const bool kicks = rule.force.value_frac - more + w.difference_frac < w.velocity_frac();
  return fmt::format("more than the {} of an FPGA's multiplier: {}", kMultiplier,
                     kicks ? "with fewer a kick would lack bits of the velocities"
                           : "with fewer, forces would be rounded to more than the accuracy allows");
}

void add_looser(Items& items, const Scene& scene, const Plan& plan) {
  const auto looser = looser_formats(scene, plan);
  if (!looser) return;
  const auto& [accuracy, widths, words] = *looser;
  items.add(fmt::format("with accuracy {:.2g}", accuracy), words.halo_bits, "bit",
            fmt::format(
                "of a halo record, {} of a particle record; differences {}, strength {}, velocities {} bits",
                words.particle_bits, widths.difference_frac, widths.strength_bits, widths.velocity_bits));
}

Items physics(const Loaded& loaded);

// Those of a run, and of a lattice that is larger than the motion asks for.
std::vector<std::string> check_warnings(const Loaded& loaded, bool real) {
  std::vector<std::string> warnings = warnings_of(loaded, real);
  if (loaded.scene.steps == 0) warnings.emplace_back("the run makes no step: 'steps' is 0");
  if (real) return warnings;
  if (std::string wide = reach_warning(loaded.scene, loaded.setup.plan); !wide.empty())
    warnings.push_back(std::move(wide));
  return warnings;
}

void add_reach(Items& items, const Loaded& loaded) {
  if (const std::string reach = reach_line(loaded.scene, loaded.setup.plan); !reach.empty())
    items.add("reach", reach);
}

}  // namespace

Items resolve(const Loaded& loaded) {
  // No node runs a rule of text, or has a cell that is no cube.
  if (!has_machine(loaded.setup.plan) || loaded.setup.plan.program != nullptr ||
      !loaded.setup.plan.rule.cubic())
    return physics(loaded);
  const Scene& scene = loaded.scene;
  const Plan& plan = loaded.setup.plan;
  const FixedRule& rule = plan.rule;
  const Widths& w = rule.widths;
  Items items;
  items.add("scene", scene.path);
  if (!scene.title.empty()) items.add("title", scene.title);
  items.add("arch", plan.arch.name);
  items.add("particles", plan.particles);
  items.add("particle types", static_cast<uint64_t>(rule.types.size()));
  items.add("nodes", plan.nodes());
  if (plan.bricks.cells() > 1)
    items.add(
        "cells per node", cells_of(plan.bricks.shape()), "",
        fmt::format("bricks of {}; {} cells", fmt::join(plan.bricks.shape(), " x "), plan.lattice.size()));
  items.add("cells with matter", cells_with_matter(scene, plan), "cells",
            fmt::format("at the start, of {}", plan.lattice.size()));
  add_reach(items, loaded);
  items.add("capacity", plan.arch.capacity, "particles/cell");
  items.add("steps", scene.steps);
  if (scene.pitch > 0) items.add("pitch", scene.pitch, "m");
  add_packing_numbers(items, scene);
  items.add("cutoff", scene.rule.cutoff(), "m");
  items.add("cell edge", rule.cell_edge, "m");
  items.add("mass", rule.mass, "kg", rule.weighted ? "of the lightest particles" : "");
  if (rule.weighted) items.add("heaviest mass", scene.rule.heaviest(), "kg");
  items.add("dt", rule.dt, "s");
  if (scene.dt_limit > 0) {
    items.add("dt limit", scene.dt_limit, "s", "largest stable step of " + scene.dt_limit_of);
    items.add("dt safety", scene.dt_safety, "", "dt over its limit");
  }
  items.add("accuracy", scene.accuracy, "", "of imposed velocities, gravity, gains and the expected strain");
  if (const Motion motion = motion_of(scene); motion.strain > 0)
    items.add("expected strain", motion.strain, "", "by " + motion.strain_of);
  items.add("position bits", w.position_frac, "", reason_of(plan, "position_frac"));
  items.add("guard bits", w.guard, "", reason_of(plan, "guard"));
  items.add("difference bits", w.difference_frac, "", reason_of(plan, "difference_frac"));
  items.add("velocity bits", w.velocity_bits, "", reason_of(plan, "velocity_bits"));
  items.add("strength bits", w.strength_bits, "", strength_reason(plan));
  items.add("sum bits", w.sum_bits, "", reason_of(plan, "sum_bits"));
  add_table(items, "force table", rule.force, reason_of(plan, "index_bits"));
  if (rule.damped) {
    add_table(items, "damping table", rule.damp, {});
    items.add("relative velocity bits", w.relative_velocity_bits, "",
              reason_of(plan, "relative_velocity_bits"));
    items.add("relative velocity fraction", w.relative_velocity_frac, "",
              reason_of(plan, "relative_velocity_frac"));
  }
  items.add("worst force error", rule.error().worst_force, "N",
            fmt::format("at {:.4g} m; {:.2g} of the largest force", rule.error().at, rule.error().relative));
  for (size_t n = 0; rule.errors.size() > 1 && n < rule.errors.size(); ++n)
    items.add(
        fmt::format("of law {}", n + 1), rule.errors[n].worst_force, "N",
        fmt::format("at {:.4g} m; {:.2g} of its largest force", rule.errors[n].at, rule.errors[n].relative));
  add_looser(items, scene, plan);
  add_probe_errors(items, scene, plan);
  if (const auto warnings = check_warnings(loaded, false); !warnings.empty())
    add_warnings(items, warnings, {});
  const auto beats = [](int count) { return fmt::format("{} beat{}", count, count == 1 ? "" : "s"); };
  items.add("halo record", plan.words.halo_bits, "bit", beats(plan.words.halo_beats));
  items.add("particle record", plan.words.particle_bits, "bit", beats(plan.words.migrate_beats));
  items.add("link", plan.words.link_bits, "bit");
  if (plan.bricks.cells() > 1) {
    const double bits = memory_bits(plan), cells = plan.bricks.cells();
    items.add("node memory", bits, "bit",
              fmt::format("particles, halos, queue, sums; {:.0f} per cell", bits / cells));
  }
  items.add("filter lanes", plan.arch.filter_lanes);
  items.add("force pipes", plan.arch.force_pipes);
  items.add("filter latency", plan.latency.filter, "cycles");
  items.add("pipe latency", plan.latency.pipe, "cycles");
  items.add("update latency", plan.latency.update, "cycles",
            plan.rule.weighted ? "with a multiplier per axis, as masses differ" : "");
  const ExpectedCycles cycles = expected_cycles(plan, loaded.setup.initial);
  items.add("expected cycles", cycles.step, "cycles/step",
            fmt::format("at the start; filter lanes and force pipes alone: {}", cycles.ideal));
  add_estimate(items, estimate(scene, plan, run_size(scene, scene.steps)));
  add_not_built(items, plan);
  items.add("plan hash", fmt::format("{:016x}", plan.hash));
  return items;
}

namespace {

std::string work_text(const Estimate& cost) {
  std::string time;
  if (cost.seconds > 0)
    time = fmt::format("{} on {} thread{}", waiting_text(cost.seconds), cost.threads,
                       cost.threads == 1 ? "" : "s");
  if (cost.load_steps == 0)
    return fmt::format("{} particle-steps{}{}", count_text(cost.particle_steps), time.empty() ? "" : ", ",
                       time);
  return fmt::format("{} load step{}, each as many evaluations of forces as bring the body to rest{}{}",
                     count_text(static_cast<double>(cost.load_steps)), cost.load_steps == 1 ? "" : "s",
                     time.empty() ? "" : ", of ", time);
}

// Their share is of the processors' time: the steps' is that of all threads.
std::string readings_text(uint64_t every, double of_readings, const Estimate& cost) {
  const double readings = cost.probing + cost.energies,
               all = (cost.seconds - readings) * cost.threads + readings;
  const std::string when = every > 0 ? fmt::format("one every {} step{}", every, every == 1 ? "" : "s")
                                     : std::string("the first and the last");
  const double share = 100 * of_readings / all;
  return fmt::format("{}, {} of the processor time", when,
                     share < 1 ? "less than 1 %" : fmt::format("about {:.0f} %", share));
}

// With what one costs, by which the interval is chosen that a scene leaves to cuboct.
std::string energies_text(const Scene& scene, const Estimate& cost) {
  const double all = (cost.seconds - cost.probing - cost.energies) * cost.threads;
  const double step = all / static_cast<double>(scene.steps);
  return fmt::format("{}: one costs about {:.2g} steps",
                     readings_text(scene.energy_every, cost.energies, cost),
                     cost.energies / cost.energy_readings / step);
}

// What the bonds of a state to go on from are, of which a run would refuse others.
void check_bonds(const Scene& scene) {
  if (!scene.body.bonds || scene.body.bonds->kept.empty()) return;
  try {
    const Reference bound(scene.rule, scene.body, scene.periodic, RealOptions{.threads = usable_cores()});
  } catch (const InputError& error) {
    throw scene.places.placed(error);
  }
}

// What the scene is, and what a run of it does and takes.
Items physics(const Loaded& loaded) {
  const Scene& scene = loaded.scene;
  const Plan& plan = loaded.setup.plan;
  Items items;
  items.add("scene", scene.path);
  if (!scene.title.empty()) items.add("title", scene.title);
  for (const SynopsisLine& line : synopsis_of(scene)) items.add(line.name, line.text, line.note);
  add_packing(items, scene);
  if (scene.began) items.add("begins at", start_text(scene, &plan.rule, plan.origin));
  const Estimate cost = estimate(scene, plan, run_size(scene, scene.steps));
  add_rounds(items, scene);
  add_integers(items, scene, plan.arch);
  items.add("work", fmt::format("{}, {} of memory", work_text(cost), in_bytes(cost.memory)));
  if (cost.probing > 0) items.add("probes", readings_text(scene.probe_every, cost.probing, cost));
  if (cost.energies > 0) items.add("energy", energies_text(scene, cost));
  add_probe_errors(items, scene, plan);
  items.add("disk", fmt::format("{} with --out, {} frame{}", in_bytes(cost.disk), times_text(cost.frames),
                                cost.frames == 1 ? "" : "s"));
  const bool real = !has_machine(plan);
  const std::vector<std::string> warnings = check_warnings(loaded, real);
  if (real) {
    if (scene.deforms())
      items.add("machine", "none: the cells of a machine keep their size, and the box deforms");
    else if (scene.rule.rounds == nullptr)
      items.add("machine", std::string(kNoFormats));
    if (!warnings.empty()) add_warnings(items, warnings, {});
    return items;
  }
  add_reach(items, loaded);
  if (plan.program != nullptr) {
    // add_integers has told it.
  } else if (!plan.rule.cubic()) {
    items.add("machine", "none: nodes have cubic cells, and no cube divides the periodic box");
  } else {
    items.add("machine", fmt::format("{} node{}; --machine tells formats, records and cycles", plan.nodes(),
                                     plan.nodes() == 1 ? "" : "s"));
  }
  if (!warnings.empty()) add_warnings(items, warnings, {});
  return items;
}

// Of a scene with stages all are told, parts in one line, and the first looked at unless another is chosen.
Items stages_in(Input& input) {
  Items items;
  const std::vector<StageName> names = stages_of(input.scene);
  for (size_t k = 0; k < names.size(); k += names[k].parts) {
    const std::string text = stage_synopsis(load_scene(input.scene, {names[k].name, {}, true}));
    if (names[k].parts == 1)
      items.add("stage " + stage_title(names, k), text);
    else
      items.add(
          fmt::format("stages {} to {}", stage_title(names, k), stage_title(names, k + names[k].parts - 1)),
          fmt::format("{} parts, each {}", names[k].parts, text));
  }
  if (!names.empty()) {
    const StageRange taken = stages_to_take(input.scene, names, input.stage);
    if (input.stage.empty() || taken.end - taken.first > 1) input.stage = names[taken.first].name;
  }
  input.looks_only = true;
  return items;
}

}  // namespace

void add_check(Command& app, int&) {
  struct Options {
    Input input;
    bool machine = false;
    Answer answer;
  };
  auto options = std::make_shared<Options>();
  Command command = add_command(app, "check");
  options->input.add_to(command);
  options->input.add_start_to(command);
  command.flag("--machine", options->machine, "print what would be built: formats, records, cycles");
  options->answer.add_to(command);
  command.callback([options] {
    const Items stages = stages_in(options->input);
    const Loaded loaded = options->machine ? load_machine(options->input) : load_plan(options->input);
    check_bonds(loaded.scene);
    Items items = options->answer.json || options->machine ? resolve(loaded) : physics(loaded);
    for (const Items::Item& stage : stages.all()) items.add(stage.name, stage.text);
    options->answer.close(items);
  });
}

}  // namespace cuboct
