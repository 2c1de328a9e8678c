// SPDX-License-Identifier: MIT
#include "synth/board_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hw/cost/node_memories.h"
#include "hw/rtl/rtl_emit.h"
#include "model/base/error.h"
#include "model/base/process.h"
#include "model/base/quantity_text.h"
#include "synth/fit_measure.h"
#include "synth/fit_model.h"

namespace cuboct::synth {
namespace {

// Memories are counted in blocks of which yosys may make registers, where they are small: only so many times
// too many are too many without a synthesis.
constexpr uint64_t kSurely = 20;
// Registers that stand for memories without a block are counted as they are; links that lead nowhere may need
// none.
constexpr uint64_t kSurelyRegisters = 2;
// Most links of so few nodes lead nowhere, and what they lead to is not built: only the whole tells.
constexpr uint32_t kFewNodes = 8;

// The resources of which more is used than there is, those that it has too little of first.
std::string excess(const FitAmounts& uses, const FitAmounts& room) {
  std::vector<size_t> over;
  for (size_t r = 0; r < uses.size(); ++r)
    if (uses[r] > room[r]) over.push_back(r);
  const auto share = [&](size_t r) {
    return room[r] == 0 ? HUGE_VAL : static_cast<double>(uses[r]) / static_cast<double>(room[r]);
  };
  std::ranges::stable_sort(over, [&](size_t a, size_t b) { return share(a) > share(b); });
  std::string text;
  for (const size_t r : over)
    text += fmt::format("{}{} {}/{}", text.empty() ? "" : ", ", to_string(kFitted[r]), uses[r], room[r]);
  return text;
}

struct NodeUse {
  FitAmounts node{}, around{};  // of one node; of all else
  FitAmounts all(uint64_t nodes) const {
    FitAmounts sum = times(node, nodes);
    for (size_t r = 0; r < sum.size(); ++r) sum[r] += around[r];
    return sum;
  }
};

// The most nodes like these that have room; what stands around them grows with their number.
uint64_t nodes_that_fit(const NodeUse& use, const FitAmounts& room, uint64_t nodes) {
  uint64_t most = nodes;
  const auto fits = [&](uint64_t n) {
    NodeUse scaled = use;
    for (uint64_t& amount : scaled.around) amount = amount * n / nodes;
    return has_room(scaled.all(n), room);
  };
  while (most > 0 && !fits(most)) --most;
  return most;
}

InputError no_room(const std::string& scene, const Plan& plan, const Board& board, const NodeUse& use,
                   const FitAmounts& room, bool memories_alone) {
  const uint64_t nodes = plan.nodes(), fitting = nodes_that_fit(use, room, nodes),
                 cells = fitting * cells_of(plan.bricks.shape());
  const std::string what =
      fmt::format("{}: its {} and a host link do not fit the {} ({}): they take {}{}", scene,
                  counted(nodes, "node"), board.name, board.target, excess(use.all(nodes), room),
                  memories_alone ? " for their memories alone" : "");
  const double particles = static_cast<double>(plan.particles) / static_cast<double>(plan.lattice.size());
  std::string hint =
      fitting == 0 ? fmt::format("not one such node fits; ")
                   : fmt::format("about {} like these would fit, {} with some {} of this scene; ",
                                 counted(fitting, "node"), counted(cells, "cell"),
                                 counted(std::max<uint64_t>(1, static_cast<uint64_t>(std::llround(
                                                                   particles * static_cast<double>(cells)))),
                                         "particle"));
  hint += fmt::format("--fit {} looks for a machine that fits, ", board.target);
  hint += "--unchecked writes this one for the simulator";
  return InputError(what, hint);
}

}  // namespace

FitCheck check_board_fit(const std::string& scene, const Plan& plan, const State& initial,
                         const BoardChoice& choice, const Hears& hears) {
  const Board& board = board_of(choice.name);
  const Target& target = target_of(board.target);
  const FitAmounts room = room_of(target);
  if (!plan.arch.narrow_memories) {
    Counts counts;
    for (const NodeMemory& m : memories_of(plan)) counts += memory_counts(target.family, m);
    const NodeUse use{amounts_of(counts), {}};
    FitAmounts surely = times(room, kSurely);
    for (size_t r = 0; r < kFitted.size(); ++r)
      if (kFitted[r] == Resource::ff) surely[r] = times(room, kSurelyRegisters)[r];
    if (!has_room(use.all(plan.nodes()), surely)) throw no_room(scene, plan, board, use, room, true);
  }
  const bool tools = in_path("yosys") && (target.family != Family::ice40 || in_path("nextpnr-ice40"));
  if (!tools) return FitCheck::memories;
  const Meter meter(target, hears);
  const auto measure = [&](Nodes nodes) {
    return meter.measure([&](const std::string& dir) { emit_rtl(plan, initial, dir, {.board = choice}); },
                         true, nodes);
  };
  if (plan.nodes() > kFewNodes) {
    const Measured m = measure(Nodes::apart);
    const NodeUse use{amounts_of(m.node), amounts_of(m.around)};
    const FitAmounts all = use.all(plan.nodes());
    if (has_room(all, room)) return FitCheck::synthesised;
    // Not so much more that the nodes' borders can be all that is too much.
    if (!has_room(all, times(room, 2))) throw no_room(scene, plan, board, use, room, false);
  }
  const FitAmounts whole = amounts_of(measure(Nodes::flat).node);
  if (has_room(whole, room)) return FitCheck::synthesised;
  FitAmounts each = whole;
  for (uint64_t& amount : each) amount = (amount + plan.nodes() - 1) / plan.nodes();
  throw no_room(scene, plan, board, {each, {}}, room, false);
}

}  // namespace cuboct::synth
