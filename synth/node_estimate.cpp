// SPDX-License-Identifier: MIT
#include "synth/node_estimate.h"

#include <algorithm>
#include <cmath>

#include "hw/cost/energy.h"
#include "hw/cost/node_memories.h"
#include "hw/cost/pair_work.h"
#include "synth/fit_model.h"

namespace cuboct::synth {
namespace {

// LUTs that are no memories over logic_bits: 2.00 to 2.71 of five nodes (docs/measured/synth.md), and a tenth
// on either side.
constexpr Band kLutsOfBit{1.8, 3.0};
// Of the products of a flat plan yosys leaves some to LUTs: of sheet.toml five of fourteen.
constexpr double kLeastOfFlat = 0.6;

double pieces(double a, double b) { return std::ceil(a / b); }

// A product of a by b bits in multipliers of 18 by 18.
double dsps(const Product& p) { return p.count * pieces(p.a, 18) * pieces(p.b, 18); }

Counts memories_of(const Plan& plan, Family family) {
  Counts counts;
  for (const NodeMemory& m : cuboct::memories_of(plan)) counts += memory_counts(family, m);
  if (plan.program != nullptr) return counts;
  for (const TableWords& t : datapath_work(plan).pair.tables) {
    Counts table = memory_counts(family, {"table", t.words, t.bits, 1, NodeMemory::Kind::block, 1});
    for (int pipe = 0; pipe < plan.arch.force_pipes; ++pipe) counts += table;
  }
  return counts;
}

}  // namespace

double logic_bits(const Plan& plan) {
  const DatapathWork work = datapath_work(plan);
  const Arch& arch = plan.arch;
  double pipe = work.pair.adder_bits;
  if (arch.multipliers == Multipliers::serial)
    for (const Product& p : work.pair.products) pipe += p.count * (p.a + p.b);
  const double faces = 2 * plan.rule.axes;
  return arch.force_pipes * pipe + arch.streamers * arch.filter_lanes * work.lane.adder_bits +
         work.update.adder_bits + (arch.halos == Halos::arrival ? faces * work.cull.adder_bits : 0) +
         2 * faces * plan.words.link_bits;
}

std::optional<NodeEstimate> estimate_node(const Plan& plan, const Target& target) {
  if (target.family != Family::ecp5 || plan.arch.narrow_memories) return std::nullopt;
  const DatapathWork work = datapath_work(plan);
  const Counts memories = memories_of(plan, target.family);
  double pipe = 0, update = 0;
  if (plan.arch.multipliers != Multipliers::serial)
    for (const Product& p : work.pair.products) pipe += dsps(p);
  for (const Product& p : work.update.products) update += dsps(p);
  const auto of = [&](Resource r) { return static_cast<double>(memories[r]); };
  NodeEstimate node;
  node.lut = logic_bits(plan) * kLutsOfBit;
  node.lut += Band{of(Resource::lut), of(Resource::lut)};
  node.ff = register_bits(plan);
  const double dsp = plan.arch.force_pipes * pipe + update;
  node.dsp = {plan.rule.axes == 2 ? kLeastOfFlat * dsp : dsp, dsp};
  node.bram = {of(Resource::bram), of(Resource::bram)};
  return node;
}

Band share_of_room(const NodeEstimate& node, double nodes, const Target& target) {
  const auto share = [&](double lut, double ff, double dsp, double bram) {
    double most = 0;
    const auto add = [&](Resource r, double used) {
      const double room = planned_share(target, r) * static_cast<double>(target.holds[r]);
      most = std::max(most, used * nodes / room);
    };
    add(Resource::lut, lut), add(Resource::ff, ff), add(Resource::dsp, dsp), add(Resource::bram, bram);
    return most;
  };
  return {share(node.lut.low, node.ff.low, node.dsp.low, node.bram.low),
          share(node.lut.high, node.ff.high, node.dsp.high, node.bram.high)};
}

}  // namespace cuboct::synth
