// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "cli/answer.h"
#include "cli/machine/boards.h"
#include "cli/machine/one_synthesis.h"
#include "hw/rtl/rtl_emit.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/program/integer_program.h"
#include "synth/fit_model.h"
#include "synth/target.h"

namespace cuboct {
namespace {

// Two nodes of the plan, side by side.
Plan two_nodes(const Plan& plan) {
  const Cell& brick = plan.bricks.shape();
  std::vector<Cell> cells;
  for (int32_t z = 0; z < brick[2]; ++z)
    for (int32_t y = 0; y < brick[1]; ++y)
      for (int32_t x = 0; x < 2 * brick[0]; ++x) cells.push_back({x, y, z});
  return on_machine(plan, plan.arch, Lattice(std::move(cells), {}));
}

synth::Measured measure(const Plan& plan, const synth::Target& target) {
  catch_interrupts();
  try {
    const Plan pair = two_nodes(plan);
    State one{0, {Particle{}}};  // for the project's bench; no RTL depends on it
    if (plan.program != nullptr) one.fields.resize(static_cast<size_t>(plan.program->program.numbers()));
    return one_synthesis("boards", target,
                         [&](const std::string& directory) { emit_rtl(pair, one, directory); });
  } catch (const synth::Interrupted&) {
    throw Failed("interrupted");
  }
}

}  // namespace

DeviceRoom device_room(const Plan& plan, const std::string& name) {
  const synth::Target& target = synth::target_of(name);
  if (target.family == synth::Family::asic)
    throw InputError(fmt::format("--device {}: standard cells have no limit", name),
                     "an FPGA, such as --device ecp5-85; or --nodes N");
  if (plan.words.bonds > 0)
    throw InputError(fmt::format("--device {}: nodes of a rule with bonds are not built here", name),
                     "--nodes N: 'cuboct synth' of an emitted project tells how many a device holds");
  const synth::Measured measured = measure(plan, target);
  const FitAmounts node = synth::amounts_of(measured.node), around = synth::amounts_of(measured.around),
                   room = synth::room_of(target);
  DeviceRoom found{UINT64_MAX, ""};
  for (size_t r = 0; r < node.size(); ++r) {
    const uint64_t each = node[r] + around[r] / measured.nodes;
    if (each == 0 || room[r] / each >= found.nodes) continue;
    found.nodes = room[r] / each;
    found.why = fmt::format("{}: {} of {} for each", synth::to_string(synth::kFitted[r]), each, room[r]);
  }
  if (found.nodes == 0)
    throw InputError(fmt::format("--device {}: has no room for a node ({})", name, found.why),
                     "fewer lanes and pipes, shared multipliers, or narrow memories");
  return found;
}

}  // namespace cuboct
