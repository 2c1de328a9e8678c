// SPDX-License-Identifier: MIT
#include "hw/cost/energy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "hw/cost/energy_sheet.h"
#include "hw/cost/node_area.h"
#include "hw/cost/node_memories.h"
#include "hw/cost/pair_work.h"
#include "hw/cost/rule_work.h"

namespace cuboct {
namespace {

double faces(const Plan& plan) { return 2 * plan.rule.axes; }
// A beat's payload and its end flag.
double beat_bits(const Plan& plan) { return plan.words.link_bits + 1; }

// In what a run of so many cycles can do at most; each bound follows from "one a cycle" of
// docs/reference/node.md.
void check_counts(const Plan& plan, const MachineEvents& e, std::span<const MemoryTraffic> traffic,
                  double cycles) {
  const double slots = cycles * plan.nodes(), streams = slots * plan.arch.streamers;
  const auto check = [&](const char* name, double count, double most) {
    if (count > most)
      throw std::invalid_argument(fmt::format("{} {:.0f} in {:.0f} cycles of {} nodes: at most {:.0f}", name,
                                              count, cycles, plan.nodes(), most));
  };
  const auto of = [](uint64_t count) { return static_cast<double>(count); };
  const double links = slots * faces(plan);
  check("steps", of(e.steps), slots);
  check("updates", of(e.updates), slots);
  check("candidates", of(e.candidates), streams);
  check("candidates of links", of(e.candidates_x) + of(e.candidates_y) + of(e.candidates_z),
        of(e.candidates));
  check("entries", of(e.entries), of(e.candidates));
  check("issues", of(e.issues), streams);
  check("pairs", of(e.pairs), slots * plan.arch.force_pipes);
  check("kicks", of(e.kicks), of(e.pairs));
  check("queue_stalls", of(e.queue_stalls), streams);
  check("relayed", of(e.relayed), slots);
  check("relayed_own", of(e.relayed_own), of(e.relayed));
  const double halos = of(e.halos_x) + of(e.halos_y) + of(e.halos_z);
  check("halos", halos, links);
  check("tested", of(e.tested), plan.arch.halos == Halos::arrival ? halos : 0);
  check("culled", of(e.culled_x) + of(e.culled_y) + of(e.culled_z), of(e.tested));
  check("moved", of(e.moved), links);
  check("scanned", of(e.scanned), slots);
  check("left", of(e.left), of(e.scanned));
  check("inner", of(e.inner), slots);
  check("beats", of(e.beats), links);
  for (uint64_t phase : e.phase_cycles) check("phase cycles", of(phase), slots);
  // Four ports to read, two to write in each copy are more than any memory has.
  for (const MemoryTraffic& m : traffic) {
    if (m.words == 0 || m.bits < 1 || m.copies < 1)
      throw std::invalid_argument(fmt::format("the memory of {} has no words, bits or copies", m.holds));
    const std::string name = "of " + m.holds;
    check(("words read " + name).c_str(), of(m.reads), 4 * slots * m.copies);
    check(("words written " + name).c_str(), of(m.writes), 2 * slots * m.copies);
  }
}

void add_datapath(Sheet& sheet, const Plan& plan, const MachineEvents& e) {
  const DatapathWork work = datapath_work(plan);
  // The work is one pair's and one particle's, of all rounds together.
  const auto rounds = static_cast<double>(plan.rounds.size());
  const auto pairs = static_cast<double>(e.pairs) / rounds, updates = static_cast<double>(e.updates) / rounds,
             tests = static_cast<double>(e.candidates) * plan.arch.filter_lanes;
  const Work &pair = work.pair, &kick = work.kick;
  sheet.add("pairs: products", pairs, "pairs", Constant::multiply_bit2,
            exact(pair.bit_products() - kick.bit_products()));
  sheet.add("pairs: adders", pairs, "pairs", Constant::add_bit, exact(pair.adder_bits - kick.adder_bits));
  sheet.add("pairs: registers", pairs, "pairs", Constant::register_bit,
            exact(pair.register_bits - kick.register_bits));
  if (plan.program == nullptr) {
    const auto kicks = static_cast<double>(e.kicks);
    sheet.add("kicks: products", kicks, "kicks", Constant::multiply_bit2, exact(kick.bit_products()));
    sheet.add("kicks: adders", kicks, "kicks", Constant::add_bit, exact(kick.adder_bits));
    sheet.add("kicks: registers", kicks, "kicks", Constant::register_bit, exact(kick.register_bits));
  }
  sheet.add("filter: adders", tests, "tests", Constant::add_bit, exact(work.lane.adder_bits));
  sheet.add("filter: registers", tests, "tests", Constant::register_bit, exact(work.lane.register_bits));
  if (e.tested > 0) {
    const auto tested = static_cast<double>(e.tested);
    sheet.add("cull: adders", tested, "records", Constant::add_bit, exact(work.cull.adder_bits));
    sheet.add("cull: registers", tested, "records", Constant::register_bit, exact(work.cull.register_bits));
  }
  if (!work.update.products.empty())
    sheet.add("update: products", updates, "particles", Constant::multiply_bit2,
              exact(work.update.bit_products()));
  sheet.add("update: adders", updates, "particles", Constant::add_bit, exact(work.update.adder_bits));
  sheet.add("update: registers", updates, "particles", Constant::register_bit,
            exact(work.update.register_bits));
}

void add_memories(Sheet& sheet, std::span<const MemoryTraffic> traffic, Energy& energy) {
  if (traffic.empty()) energy.missing.emplace_back("memories: their reads and writes were not counted");
  for (const MemoryTraffic& m : traffic) {
    if (!m.counted) {
      energy.missing.push_back(fmt::format("memory of {}: no event tells its reads and writes", m.holds));
      continue;
    }
    const auto words = static_cast<double>(m.words);
    if (m.reads > 0)
      sheet.memory("read " + m.holds, static_cast<double>(m.reads), Constant::memory_read, words, m.bits);
    if (m.writes > 0)
      sheet.memory("write " + m.holds, static_cast<double>(m.writes), Constant::memory_write, words, m.bits);
  }
}

// Beats over links of a node's side, or of a kind between chips; words half a side to or from their memory.
void add_wires(Sheet& sheet, const Plan& plan, const MachineEvents& e, std::span<const MemoryTraffic> traffic,
               const Technology& technology, const Band& side, Energy& energy) {
  const auto beats = static_cast<double>(e.beats);
  sheet.add("links: registers", beats, "beats", Constant::register_bit, exact(beat_bits(plan)));
  if (technology.at(Constant::link_bit))
    sheet.add("links", beats, "beats", Constant::link_bit, exact(beat_bits(plan)));
  double bits = 0;
  for (const MemoryTraffic& m : traffic) bits += static_cast<double>(m.reads + m.writes) * m.bits;
  if (side.high > 0) {
    if (!technology.at(Constant::link_bit))
      sheet.add("links: wires", beats, "beats", Constant::wire_bit_mm, beat_bits(plan) * side);
    if (bits > 0) sheet.add("wires within nodes", bits, "bits", Constant::wire_bit_mm, 0.5 * side);
    return;
  }
  if (!technology.at(Constant::link_bit))
    energy.missing.push_back(
        fmt::format("links: wires: the area of a node is not known in {}", technology.name));
  energy.missing.push_back(
      fmt::format("wires within nodes: the area of a node is not known in {}", technology.name));
}

// Bits of a node's memories but for its tables, which have `tables`; words of narrow memories fill one.
double stored_bits(const Plan& plan, double tables) {
  const Arch& arch = plan.arch;
  if (plan.program == nullptr && arch.narrow_memories) {
    const double link = plan.words.link_bits;
    return (std::floor(memory_bits(plan) / link) + 1) * link;
  }
  double bits = 0;
  for (const NodeMemory& m : memories_of(plan)) bits += static_cast<double>(m.words) * m.bits * m.copies;
  return plan.program != nullptr ? bits - tables : bits;
}

struct NodeBits {
  double memories = 0, tables = 0;  // bits
  Band transistors;                 // of logic
  Band registers;                   // bits
};

// A product that is made a bit a cycle takes an adder of its operands at least.
Band transistors_of(const Plan& plan) {
  DatapathWork work = datapath_work(plan);
  Arch arch = plan.arch;
  arch.filter_lanes *= arch.streamers;  // each has a filter of its own
  work.update.adder_bits += faces(plan) * work.cull.adder_bits;
  Band band;
  const NodeArea parallel = logic_of(work, arch);
  band.high = parallel.multipliers + parallel.adders;
  for (Product& p : work.pair.products) {
    if (plan.arch.multipliers == Multipliers::shared) p.count = 1;
    if (plan.arch.multipliers == Multipliers::serial)
      work.pair.adder_bits += p.count * (p.a + p.b), p.count = 0;
  }
  const NodeArea least = logic_of(work, arch);
  band.low = std::min(band.high, least.multipliers + least.adders);
  return band;
}

NodeBits node_bits(const Plan& plan) {
  NodeBits node;
  const DatapathWork work = datapath_work(plan);
  node.tables = plan.arch.force_pipes * work.pair.table_bits() + work.update.table_bits();
  node.memories = stored_bits(plan, node.tables);
  node.transistors = transistors_of(plan);
  node.registers = register_bits(plan);
  return node;
}

// Registers have enables, and a gate before the clock of those with one enable: they are clocked where they
// load. An FPGA's enable does not stop the clock's net, and the pipelines of rules have none within.
void add_clock(Sheet& sheet, const Plan& plan, const MachineEvents& e, double cycles, const Band& registers,
               const Technology& technology) {
  // Of synthesised nodes with their own traffic (docs/measured/energy.md): loads of registers over those that
  // the work lists have, 1.28 to 1.9, as values also wait in registers; gates, registers without one and
  // control, 0.062 to 0.10 of all registers in each cycle, also of a node without particles. Bricks and
  // narrow memories have ports that answer in each cycle: 0.15 to 0.23, as the others had before theirs
  // rested.
  constexpr Band kLoads{1.2, 1.9}, kRests{0.05, 0.11}, kAnswers{0.12, 0.25};
  const Band always = plan.arch.narrow_memories || !plan.bricks.one_cell() ? kAnswers : kRests;
  const auto each = static_cast<double>(plan.nodes()) * cycles;
  if (plan.program != nullptr || technology.at(Constant::clock_device)) {
    sheet.add("clock of registers", each, "cycles", Constant::clock_bit, registers);
    return;
  }
  const DatapathWork work = datapath_work(plan);
  const auto loads = [&](const char* what, uint64_t count, const char* unit, double bits) {
    if (count > 0) sheet.add(what, static_cast<double>(count), unit, Constant::clock_bit, bits * kLoads);
  };
  loads("clock: pairs", e.pairs, "pairs", work.pair.register_bits - work.kick.register_bits);
  loads("clock: kicks", e.kicks, "kicks", work.kick.register_bits);
  loads("clock: filter", e.candidates, "candidates", plan.arch.filter_lanes * work.lane.register_bits);
  loads("clock: cull", e.tested, "records", work.cull.register_bits);
  loads("clock: update", e.updates, "particles", work.update.register_bits);
  loads("clock: links", e.beats, "beats", beat_bits(plan));
  sheet.add("clock: gates and control", each, "cycles", Constant::clock_bit, registers * always);
}

void add_idle(Sheet& sheet, const Plan& plan, double cycles, double clock, const Technology& technology,
              Energy& energy) {
  const NodeBits node = node_bits(plan);
  const double nodes = plan.nodes(), seconds = cycles / clock;
  if (technology.at(Constant::clock_device) || technology.at(Constant::static_device)) {
    // How many nodes a device holds is a matter of synthesis: all, or one.
    const Band devices{1, nodes};
    sheet.add("clock of devices", cycles, "cycles", Constant::clock_device, devices);
    sheet.add("devices at rest", seconds * 1e9, "ns", Constant::static_device, devices);  // mW ns is pJ
    return;
  }
  sheet.add("leakage of logic", seconds, "s", Constant::leakage_transistor, nodes * node.transistors);
  sheet.add("leakage of memories", seconds, "s", Constant::leakage_memory_bit,
            exact(nodes * (node.memories + node.tables)));
  energy.missing.emplace_back("leakage of registers: no figure of one apart from its energy");
}

}  // namespace

// What synthesised nodes have of flip-flops over what their datapath and links need at least: with wide
// memories 2.0 to 3.0 times, with narrow ones, which have neither filter nor queue, 1.2 and 1.5; both widened
// (docs/measured/energy.md). The rest is delays, control, ports of memories. Nodes of rules of text, whose
// pipelines count all their delays and whose receivers count too, have 1.13 to 2.2 times
// (docs/measured/synth.md).
Band register_bits(const Plan& plan) {
  constexpr Band kWide{1.9, 3.2}, kNarrow{1.1, 1.6}, kRounds{1.05, 2.4};
  const DatapathWork work = datapath_work(plan);
  const Arch& arch = plan.arch;
  const double bits = arch.force_pipes * work.pair.register_bits +
                      arch.streamers * arch.filter_lanes * work.lane.register_bits +
                      faces(plan) * work.cull.register_bits + work.update.register_bits +
                      2 * faces(plan) * (beat_bits(plan) + 1);
  if (plan.program != nullptr)
    return (bits + faces(plan) * received_bits(plan) + bond_register_bits(plan)) * kRounds;
  return bits * (arch.narrow_memories ? kNarrow : kWide);
}

Band memory_bit_energy(const TechnologyFigure& figure, const TechnologyFigure& exponent, double words) {
  const double ratio = words / figure.words;
  const double a = std::pow(ratio, exponent.band.low), b = std::pow(ratio, exponent.band.high);
  return {figure.band.low * std::min(a, b), figure.band.high * std::max(a, b)};
}

Energy energy_of(const Plan& plan, const MachineEvents& events, std::span<const MemoryTraffic> traffic,
                 uint64_t cycles, double clock, const Technology& technology) {
  if (!(clock > 0) || !std::isfinite(clock)) throw std::invalid_argument("the clock must be above 0 Hz");
  check_counts(plan, events, traffic, static_cast<double>(cycles));
  Energy energy;
  Sheet sheet(technology, energy);
  add_datapath(sheet, plan, events);
  add_memories(sheet, traffic, energy);
  add_wires(sheet, plan, events, traffic, technology, area_of(plan, technology).side, energy);
  add_clock(sheet, plan, events, static_cast<double>(cycles), register_bits(plan), technology);
  add_idle(sheet, plan, static_cast<double>(cycles), clock, technology, energy);
  for (const char* always :
       {"control: sequencers, counters, multiplexers", "clock tree above the registers' own pins",
        "glitches and wires of a placed circuit beyond the figures' own", "host link"})
    energy.missing.emplace_back(always);
  return energy;
}

Area area_of(const Plan& plan, const Technology& technology) {
  Area area;
  const NodeBits node = node_bits(plan);
  const double nodes = plan.nodes();
  bool whole = true;
  const auto add = [&](const char* part, const Band& count, Constant constant) {
    const auto& figure = technology.at(constant);
    if (!figure) {
      area.missing.push_back(fmt::format("{}: no '{}' in {}", part, name_of(constant), technology.name));
      whole = false;
      return;
    }
    area.rows.push_back({part, nodes * kMm2 * (count * figure->band), figure->source});
    area.sum += area.rows.back().mm2;
  };
  add("memories", exact(node.memories), Constant::memory_bit_area);
  add("tables", exact(node.tables), Constant::memory_bit_area);
  // At least one transistor a bit, as a table may be a ROM.
  if (const auto& transistor = technology.at(Constant::transistor_area); whole && transistor) {
    Band& tables = area.rows.back().mm2;
    const double least = std::min(tables.low, nodes * kMm2 * node.tables * transistor->band.low);
    area.sum.low += least - tables.low;
    tables.low = least;
  }
  add("logic", node.transistors, Constant::transistor_area);
  add("registers", node.registers, Constant::register_area);
  if (whole) {
    const auto side = [&](double mm2) { return std::sqrt(mm2 / nodes); };
    area.side = {side(area.sum.low), side(area.sum.high)};
    // Each face's beat with valid and ready, a side long: above the cells, or on a layer beside them.
    constexpr double kMmOfUm = 1e-3;
    if (const auto& pitch = technology.at(Constant::wire_pitch)) {
      const double wires = nodes * faces(plan) * (beat_bits(plan) + 2);
      area.rows.push_back(
          {"wires of links", {0, wires * pitch->band.high * kMmOfUm * area.side.high}, pitch->source});
      area.sum += area.rows.back().mm2;
    } else {
      area.missing.push_back(fmt::format("wires of links: no 'wire_pitch' in {}", technology.name));
    }
  }
  area.missing.emplace_back("control, input and output cells, spare area of a placed circuit");
  return area;
}

std::vector<Sensitivity> sensitivity_of(const Plan& plan, const MachineEvents& events,
                                        std::span<const MemoryTraffic> traffic, uint64_t cycles, double clock,
                                        const Technology& technology) {
  Technology middle = technology;
  for (auto& figure : middle.figures)
    if (figure) figure->band = exact(figure->band.middle());
  const auto sum = [&](const Technology& t) {
    return energy_of(plan, events, traffic, cycles, clock, t).sum.middle();
  };
  std::vector<Sensitivity> bars;
  for (size_t k = 0; k < kConstants; ++k) {
    if (!technology.figures[k]) continue;
    const Band band = technology.figures[k]->band;
    Sensitivity bar{static_cast<Constant>(k)};
    auto& figure = middle.figures[k];
    figure->band = exact(band.low), bar.low = sum(middle);
    figure->band = exact(band.high), bar.high = sum(middle);
    figure->band = exact(band.middle());
    if (bar.low != bar.high) bars.push_back(bar);
  }
  std::ranges::stable_sort(bars, {}, [](const Sensitivity& s) { return -std::abs(s.high - s.low); });
  return bars;
}

}  // namespace cuboct
