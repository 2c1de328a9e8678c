// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "cli/command.h"
#include "cli/machine/emit.h"
#include "cli/machine/machine_cycles.h"
#include "cli/programs.h"
#include "cli/run/estimate.h"
#include "cli/run/stages.h"
#include "hw/program/bounds.h"
#include "hw/program/options.h"
#include "hw/rtl/rtl_emit.h"
#include "hw/rtl/rtl_prefix.h"
#include "model/base/json.h"
#include "model/base/text.h"
#include "model/run/start.h"
#include "model/run/static_engine.h"

namespace cuboct {
namespace {

// For the commands that the project's README names.
std::string text_of(const Arch& arch) { return arch.text.empty() ? "name = \"default\"\n" : arch.text; }

}  // namespace

Items say_emitted(const std::string& out, const Plan& plan, const std::optional<CountedCycles>& counted,
                  const Answer& answer) {
  answer.say("{}: {} nodes, {} particles, plan {:016x}\n", line_text(out), plan.nodes(), plan.particles,
             plan.hash);
  Items items;
  items.add("directory", out);
  items.add("nodes", plan.nodes());
  items.add("particles", plan.particles);
  items.add("cells per node", plan.bricks.cells());
  items.add("filter lanes", plan.arch.filter_lanes);
  items.add("force pipes", plan.arch.force_pipes);
  items.add("plan hash", fmt::format("{:016x}", plan.hash));
  if (counted) {
    items.add("mean cycles per step", counted->mean());
    items.add("most cycles per step", counted->most);
    items.add("counted steps", counted->steps);
  }
  return items;
}

namespace {

struct EmitOptions {
  Input input;
  std::string out, fit;
  Emission emission{.vector_steps = 8};
  bool fixed_velocities = false, unchecked = false, anyway = false;
  Answer answer;
};

// What the project's bench compares with: a line of each particle after each step, which is made in memory.
void check_vectors(const Scene& scene, const Plan& plan, const EmitOptions& options) {
  constexpr double kBitsOfDigit = 4, kBeside = 10;  // digits: of the slot, of the step, the line's end
  const auto steps = static_cast<double>(options.emission.vector_steps);
  const double line = plan.words.particle_bits / kBitsOfDigit + kBeside;
  check_memory(fmt::format("--vector-steps {}", options.emission.vector_steps),
               2 * steps * plan.particles * line,
               fmt::format("--vector-steps {}", EmitOptions().emission.vector_steps), options.anyway);
  check_counted("--vector-steps", "golden", scene, plan, options.emission.vector_steps, options.anyway);
}

Items emit_one(const EmitOptions& options) {
  const Loaded loaded = load_machine(options.input);
  refuse_static(loaded.scene, "hardware");
  const Plan& plan = loaded.setup.plan;
  check_held(loaded.scene, plan, options.anyway);
  check_vectors(loaded.scene, plan, options);
  std::optional<CountedCycles> counted;
  with_places(loaded.scene, plan.arch, [&] {
    check_emit_directory(options.out);
    Emission emission = options.emission;
    check_emission(plan, emission);  // synthesis and the counting of cycles take long
    if (!emission.board.name.empty() && !options.unchecked)
      check_board(options.input, plan, loaded.setup.initial, emission.board);
    emission.arch = text_of(plan.arch);
    emission.counted = counted = count_cycles(plan, loaded.setup.initial, loaded.scene.steps);
    emit_rtl(plan, loaded.setup.initial, options.out, emission);
  });
  return say_emitted(options.out, plan, counted, options.answer);
}

// A machine for each stage, in directories of their names. `from` of the input holds the runs of all.
void emit_stages(const EmitOptions& options, const std::vector<StageName>& names, const StageRange& range) {
  if (options.input.from.empty())
    throw InputError(
        "stages begin where the ones before them ended: --from DIR says where 'cuboct run' left them",
        "--stage NAME takes one");
  std::vector<EmitOptions> all;
  for (size_t k = range.first; k < range.end; ++k) {
    EmitOptions& one = all.emplace_back(options);
    one.input.stage = names[k].name;
    one.input.from = k > 0 ? stage_start(options.input.from, names, k) : "";
    one.out = options.out + "/" + stage_title(names, k);
    load_machine(one.input);  // none is written where one cannot be
    check_emit_directory(one.out);
  }
  std::vector<std::string> told;
  for (const EmitOptions& one : all)
    told.push_back(json_object({{"name", json(one.input.stage)}, {"result", emit_one(one).json()}}));
  options.answer.close(json_object({{"stages", json_array(told)}}));
}

void emit(EmitOptions options) {
  BoardChoice& board = options.emission.board;
  board.velocities = !options.fixed_velocities;
  if (!options.emission.prefix.empty()) check_prefix(options.emission.prefix);
  if (!board.bus.empty() && !board.name.empty())
    throw InputError("--bus and --board are two ways to one lattice", "give one of them");
  if (options.fixed_velocities && board.bus.empty() && board.name.empty())
    throw InputError("--fixed-velocities is of a host's link", "give --board or --bus with it");
  if (!board.name.empty()) bit_clocks16(board_of(board.name), board.baud);
  if (!options.fit.empty()) {
    if (!options.input.stage.empty() || !options.input.from.empty())
      throw InputError("--fit chooses a machine for a scene that begins with its packing",
                       "emit without --fit takes --stage and --from");
    refuse_static(load_scene(options.input.scene, {}), "hardware");
    emit_fitted(options.input, options.fit, options.out, options.emission, options.answer);
    return;
  }
  const std::vector<StageName> names = stages_of(options.input.scene);
  const StageRange range = stages_to_take(options.input.scene, names, options.input.stage);
  if (range.end - range.first > 1) return emit_stages(options, names, range);
  if (names.size() == 1) options.input.stage = names[0].name;
  const Items items = emit_one(options);
  if (options.answer.json) options.answer.close(items);
}

}  // namespace

void add_emit(Command& app, int& exit_code) {
  auto [command, options] = add_command<EmitOptions>(app, "emit", exit_code, emit);
  options->input.add_to(command);
  options->input.add_start_to(command);
  command.option("--out", options->out, "directory, new or of an earlier emission", "DIR").required();
  command
      .option("--vector-steps", options->emission.vector_steps,
              "steps of golden that the project's bench checks", "N")
      .check(whole_number)
      .show_default();
  command
      .option("--fit", options->fit,
              "choose brick, lanes and pipes so that the scene fits this device in the fewest cycles: up5k, "
              "hx8k, ecp5-25, ecp5-85 or xc7; takes minutes, and goes on after Ctrl-C",
              "TARGET")
      .proposed({"up5k", "hx8k", "ecp5-25", "ecp5-85", "xc7"});
  const Option board = command
                           .option("--board", options->emission.board.name,
                                   "add a top module, pins and a host link: icebreaker or ulx3s", "B")
                           .proposed({"icebreaker", "ulx3s"});
  command.option("--baud", options->emission.board.baud, "bits per second of the board's serial line", "N")
      .needs(board)
      .show_default();
  command
      .flag("--unchecked", options->unchecked,
            "do not check whether the board has room: for the simulator, which runs any size")
      .needs(board);
  command
      .option("--bus", options->emission.board.bus,
              "add a wrapper with registers and an interrupt: axi4lite or wishbone", "BUS")
      .proposed({"axi4lite", "wishbone"});
  command.flag(
      "--fixed-velocities", options->fixed_velocities,
      "with --board or --bus: the host cannot set the velocities of held and moved types: less area");
  command.option(
      "--prefix", options->emission.prefix,
      "begin every name of modules, packages and files with NAME_: two machines stand in one design", "NAME");
  add_anyway_to(command, options->anyway);
  options->answer.add_to(command);
}

}  // namespace cuboct
