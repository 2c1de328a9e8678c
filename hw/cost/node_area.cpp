// SPDX-License-Identifier: MIT
#include "hw/cost/node_area.h"

#include <bit>

namespace cuboct {
namespace {

// Slots, a FIFO of arrivals per face, halos of C, C, 3C, 3C, 9C, 9C records, the queue of candidates, and a
// sum per slot and pipe; or those of a brick. A halo record lies where its cell is: without the cell's
// number.
double particle_memory(const Arch& arch, const HeldWords& held, double particle_bits, double halo_bits,
                       double sum_bits) {
  const double capacity = arch.capacity;
  return kMemoryBit * (held.particles * capacity * particle_bits + held.halos * capacity * halo_bits +
                       arch.queue_depth * (halo_bits + arch.filter_lanes) +
                       arch.force_pipes * held.sums * capacity * 3 * sum_bits);
}

}  // namespace

NodeArea logic_of(const DatapathWork& work, const Arch& arch) {
  NodeArea area;
  area.multipliers = kBitProduct * (arch.force_pipes * work.pair.bit_products() + work.update.bit_products());
  area.tables = kMemoryBit * arch.force_pipes * work.pair.table_bits();
  area.adders = kAdderBit * (arch.force_pipes * work.pair.adder_bits +
                             arch.filter_lanes * work.lane.adder_bits + work.update.adder_bits);
  return area;
}

NodeArea area_of(const Plan& plan) {
  const Arch& arch = plan.arch;
  const DatapathWork work = datapath_work(plan, WorkOf::cost);
  const double sum = kick_bits(plan.rule) + std::bit_width(27u * static_cast<unsigned>(arch.capacity) - 1);
  NodeArea area = logic_of(work, arch);
  area.particles =
      particle_memory(arch, held_words(arch.brick, plan.bricks.one_cell() ? 3 : plan.rule.axes),
                      plan.words.particle_bits, plan.words.halo_bits - plan.words.halo_cell_bits, sum);
  return area;
}

double memory_bits(const Plan& plan) { return area_of(plan).particles / kMemoryBit; }

NodeArea area_of(const Rule& rule, const Arch& arch, int mantissa, int bits) {
  const bool damped = rule.damping.coefficient > 0;
  // r2, root, division, cubic by Horner, kick; w.d, the damping's two squares and its product with w.d.
  double products = 3 + 1 + 1 + 3 + 3, adders = 3 + 2 + 3 + 3;
  if (damped) products += 3 + 2 + 1, adders += 3 + 2 + 2;
  const double lane = 3 + 4 + 7, update = 3 * 3;
  NodeArea area;
  area.multipliers = kBitProduct * arch.force_pipes * products * mantissa * mantissa;
  area.adders = kAdderBit * 3 * mantissa * (arch.force_pipes * adders + arch.filter_lanes * lane + update);
  area.particles =
      particle_memory(arch, held_words(arch.brick, 3), 6.0 * bits, (damped ? 6.0 : 3.0) * bits, bits);
  return area;
}

}  // namespace cuboct
