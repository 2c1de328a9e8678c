// SPDX-License-Identifier: MIT
#include "hw/cost/node_memories.h"

#include <algorithm>

#include "hw/cost/rule_work.h"
#include "hw/rtl/rtl_design.h"
#include "model/base/fixed_math.h"
#include "model/base/integer_math.h"

namespace cuboct {
namespace {

// As cuboct_node_core has it: bits of a pipe's exact sum of one axis.
int sum_bits(const FixedRule& rule, int capacity) {
  int force_bits = 1;
  const ValueRange range = table_range(rule.force);
  while (!fits(range.low, force_bits) || !fits(range.high, force_bits)) ++force_bits;
  const int s_bits = rule.damped ? rule.widths.strength_bits : force_bits;
  return std::max(2, s_bits + rule.widths.difference_frac + 1 - rule.kick_shift) +
         ceil_log2((rule.axes == 3 ? 27u : 9u) * static_cast<uint64_t>(capacity));
}

}  // namespace

NodeMemories::NodeMemories(const FixedRule& rule, const Arch& arch, uint32_t particles)
    : rule_(rule), arch_(arch), particles_(particles), sum_bits_(sum_bits(rule, arch.capacity)) {
  rule_.force = rule_.damp = {};
}

std::vector<NodeMemory> NodeMemories::of(const Cell& brick, int lanes, int pipes) const {
  const FixedRule& rule = rule_;
  Arch arch = arch_;
  arch.brick = brick;
  const Words words = words_of(rule, arch, particles_);
  const auto capacity = static_cast<uint64_t>(arch.capacity);
  const uint64_t cells = cells_of(brick);
  const BrickGrid grid(brick);
  const int own_bits = words.particle_bits + 2;  // and where it goes along x
  const int position = rule.axes * rule.widths.position_frac;
  const bool more = rule.damped || (rule.scaled && rule.type_bits > 0);
  // What others see of a particle: its position, or all below its id.
  const int seen =
      more ? position + 2 * (rule.axes - 1) + rule.axes * rule.widths.velocity_bits + rule.type_bits
           : position;
  const int candidate = rule.axes * (rule.widths.position_frac + 2) + (rule.scaled ? rule.type_bits : 0) +
                        (rule.damped ? rule.axes * rule.widths.velocity_bits : 0);
  const uint64_t rows = (capacity + static_cast<uint64_t>(lanes) - 1) / static_cast<uint64_t>(lanes);
  using Kind = NodeMemory::Kind;
  std::vector<NodeMemory> memories;
  // cuboct_ram asks for a block above 16 words.
  const auto ram = [&](const char* holds, uint64_t depth, int bits, int copies) {
    memories.push_back({holds, depth, bits, copies, depth > 16 ? Kind::block : Kind::late});
  };
  ram("own particles", cells * capacity, own_bits, 1);
  ram("own particles, for the streamer", cells * capacity, seen, 1);
  ram("own particles, for the pipes", cells * capacity, seen, pipes);
  ram("ids, for the pipes' faults", cells * capacity, words.id_bits, pipes);
  // A candidate with the pairs of its row: one for each pipe at once, the others by the lane.
  const int cell_bits = ceil_log2(cells), slot_bits = std::max(1, ceil_log2(capacity));
  const int queue_bits =
      candidate + cell_bits + std::max(1, ceil_log2(rows)) + lanes + pipes / arch.streamers * (1 + slot_bits);
  memories.push_back(
      {"queue", static_cast<uint64_t>(arch.queue_depth), queue_bits, arch.streamers, Kind::prompt});
  if (cells == 1) {
    memories.push_back({"sums", capacity, rule.axes * sum_bits_, pipes, Kind::prompt});
    for (int a = 0; a < rule.axes; ++a) {
      // One cell's halos are 1, 3, 9 cells.
      const uint64_t depth = (a == 0 ? 1u : a == 1 ? 3u : 9u) * capacity;
      ram("halos from a face", depth, words.halo_bits, 2);
      ram("particles from a face", capacity, words.particle_bits, 2);
      if (a < rule.axes - 1) ram("halos, for the relay", depth, words.halo_bits, 2);
    }
    return memories;
  }
  ram("sums", cells * capacity, rule.axes * sum_bits_, pipes);
  ram("particles between cells", cells * capacity, words.particle_bits, 1);
  memories.push_back({"leading bits of positions", cells * rows,
                      rule.axes * std::min(rule.widths.filter_frac, rule.widths.position_frac), lanes,
                      Kind::late});
  const int count_bits = std::max(1, ceil_log2(capacity)) + 1;
  // Of own cells, and of those that particles go to from below, from above.
  const auto counts = [&](uint64_t depth, int copies, int reads) {
    memories.push_back({"counts", depth, count_bits, copies, Kind::prompt, reads});
  };
  counts(cells, 1, 4);
  counts(cells, 2, 1);
  memories.push_back({"where own particles go", cells * capacity, 2 * rule.axes, 1, Kind::prompt});
  const int halo_bits = words.halo_bits - words.halo_cell_bits;
  for (int a = 0; a < rule.axes; ++a) {
    const uint64_t layer = grid.halo_tags(a), face = grid.migrate_tags(a);
    ram("halos, particles from a face", (layer + face) * capacity, std::max(halo_bits, words.particle_bits),
        2);
    if (a < rule.axes - 1) ram("halos, for the relay", layer * capacity, halo_bits, 2);
    counts(layer, 2, 3);
    counts(face, 2, 2);
  }
  return memories;
}

std::vector<NodeMemory> memories_of(const Plan& plan) {
  if (plan.program != nullptr) return rule_memories(plan);
  const Arch& arch = plan.arch;
  return NodeMemories(plan.rule, arch, plan.particles).of(arch.brick, arch.filter_lanes, arch.force_pipes);
}

}  // namespace cuboct
