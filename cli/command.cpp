// SPDX-License-Identifier: MIT
#include "cli/command.h"

#include <fmt/format.h>

#include <charconv>

#include "hw/engine/scene_engine.h"
#include "hw/program/options.h"
#include "model/run/start.h"

namespace cuboct {

void Input::add_to(Command& command) {
  command.option("scene", scene, "scene file (TOML)", "SCENE").required();
  command.option("--arch", arch, "machine description (TOML)", "FILE");
}

void Input::add_start_to(Command& command) {
  command.option("--stage", stage, "of a scene with [[stage]]: the one to take", "NAME");
  command.option("--from", from, "directory of a run: begin with the last state that it left", "DIR");
}

void Input::add_stalls_to(Command& command) {
  command
      .option("--stall-rate", stall_rate,
              "share of cycles in which a link of systemc or rtl passes nothing: cycles change, bits do not",
              "R")
      .range(0.0, 0.99);
  command.option("--stall-seed", stall_seed, "seed of the stalls", "N").check(whole_number);
  command.option("--inject-faults", faults,
                 "change, lose or repeat beats on the links of systemc or rtl: their share, or their number",
                 "X");
  command.option("--fault-seed", fault_seed, "seed of the faults", "N").check(whole_number);
}

std::string whole_number(const std::string& text) {
  int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size() && value >= 0 && text[0] != '-';
  return whole ? std::string() : fmt::format("'{}' is not a whole number below 2^63", text);
}

Loaded load(const Input& input) {
  Loaded loaded{load_scene(input.scene, {input.stage, input.from, input.looks_only}), {}};
  loaded.setup = make_setup(loaded.scene, read_arch(input.arch));
  return loaded;
}

Loaded load_machine(const Input& input) {
  Loaded loaded{load_scene(input.scene, {input.stage, input.from, input.looks_only}), {}};
  loaded.setup = machine_setup(loaded.scene, read_arch(input.arch));
  return loaded;
}

void check_machine(const Loaded& loaded) {
  const Plan& plan = loaded.setup.plan;
  with_places(loaded.scene, plan.arch, [&] {
    if (const std::string why = machine_refusal(plan); !why.empty())
      throw InputError("the scene has no machine: " + why)
          .about({"box.size", "box.cells", "box", "particles.file", "rule.file", "rule"});
  });
}

Loaded load_plan(const Input& input, const std::string& engine, bool real) {
  Loaded loaded{load_scene(input.scene, {input.stage, input.from, input.looks_only}), {}};
  loaded.setup.plan = scene_plan_of(loaded.scene, read_arch(input.arch), engine, real);
  return loaded;
}

}  // namespace cuboct
