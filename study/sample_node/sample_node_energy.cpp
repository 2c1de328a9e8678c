// SPDX-License-Identifier: MIT
#include <cmath>
#include <stdexcept>

#include "hw/cost/energy_sheet.h"
#include "hw/cost/node_area.h"
#include "study/sample_node/sample_node.h"

namespace cuboct {
namespace {

// Flip-flops of synthesised nodes over those that their datapath needs: docs/reference/energy.md.
constexpr Band kRegisters{1.9, 3.2};

double real(uint64_t count) { return static_cast<double>(count); }

// Bits that a node holds, and the operators that its stages are made of.
struct Parts {
  double width, products, adders, tables, memories, operators;
};

// One operator for each operation that a bond, or a pair, takes in a stage; likewise the sweep that moves
// atoms has nine products and twelve sums.
Parts parts_of(const SampleNode& node) {
  Parts out{};
  out.width = node.width;
  for (size_t s = 0; s < kDatapathStages; ++s) {
    const bool of_pairs =
        s == static_cast<size_t>(DatapathStage::angles) || s == static_cast<size_t>(DatapathStage::turns);
    const double items = real(of_pairs ? node.pairs : node.bonds);
    out.products += real(node.stages[s].products) / items, out.adders += real(node.stages[s].adds) / items;
  }
  constexpr double kSweepProducts = 9, kSweepAdders = 12;
  out.operators = out.products + out.adders + kSweepProducts + kSweepAdders;
  out.products += kSweepProducts, out.adders += kSweepAdders;
  const double words =
      7 * real(node.bond_words) + 2 * real(node.angle_words + node.stretch_words + node.order_words);
  out.tables = DatapathTable::kCoefficients * out.width * words;
  // Positions, forces, last forces; of a bond its other atom and image: the index and 27 shifts.
  out.memories =
      9 * out.width * real(node.atoms) + real(node.bonds) * (std::ceil(std::log2(real(node.atoms))) + 5);
  return out;
}

Band transistors_of(const Parts& p) {
  return exact(kBitProduct * p.width * p.width * p.products + kAdderBit * p.width * p.adders);
}

void add_operations(Sheet& sheet, const SampleNode& node) {
  const OperationCounts& all = node.relaxation;
  const double width = node.width;
  sheet.add("products", real(all.products), "products", Constant::multiply_bit2, exact(width * width));
  // A division is as many subtractions as there are bits.
  sheet.add("adders", real(all.adds) + real(all.divisions) * width, "sums", Constant::add_bit, exact(width));
  sheet.add("registers", real(all.products + all.adds + all.lookups), "results", Constant::register_bit,
            width * kRegisters);
}

// Reads of a table's words, by evaluation; and of the sample's own memories.
double add_memories(Sheet& sheet, const SampleNode& node) {
  const double width = node.width, entry = DatapathTable::kCoefficients * width, times = node.evaluations,
               bonds = real(node.bonds), pairs = real(node.pairs), atoms = real(node.atoms),
               triple = 3 * width;
  double bits = 0;
  const auto read = [&](const char* term, double events, double words, double of) {
    sheet.memory(term, events, Constant::memory_read, words, of);
    bits += events * of;
  };
  const auto write = [&](const char* term, double events, double words, double of) {
    sheet.memory(term, events, Constant::memory_write, words, of);
    bits += events * of;
  };
  read("read tables of bonds", 7 * bonds * times, real(node.bond_words), entry);
  read("read tables of cosines", 2 * pairs * times, real(node.angle_words), entry);
  if (node.stretch_words > 0)
    read("read tables of stretches", 4 * pairs * times, real(node.stretch_words), entry);
  read("read tables of orders", 2 * bonds * times, real(node.order_words), entry);
  read("read bonds", bonds * times, bonds, std::ceil(std::log2(atoms)) + 5);
  // A bond: its other atom; an atom: itself, and each to be moved.
  read("read positions", (bonds + 2 * atoms) * times, atoms, triple);
  write("write positions", atoms * times, atoms, triple);
  read("read forces", (bonds + 2 * atoms) * times, atoms, triple);
  write("write forces", (bonds + atoms) * times, atoms, triple);
  return bits;
}

void add_idle(Sheet& sheet, const SampleNode& node, const Parts& parts, double clock) {
  const double cycles = node.cycles(), seconds = cycles / clock;
  sheet.add("clock of registers", cycles, "cycles", Constant::clock_bit,
            parts.operators * parts.width * kRegisters);
  sheet.add("leakage of logic", seconds, "s", Constant::leakage_transistor, transistors_of(parts));
  sheet.add("leakage of memories", seconds, "s", Constant::leakage_memory_bit,
            exact(parts.tables + parts.memories));
}

}  // namespace

Energy energy_of(const SampleNode& node, double clock, const Technology& technology) {
  if (!(clock > 0) || !std::isfinite(clock)) throw std::invalid_argument("the clock must be above 0 Hz");
  Energy energy;
  Sheet sheet(technology, energy);
  const Parts parts = parts_of(node);
  add_operations(sheet, node);
  const double bits = add_memories(sheet, node);
  const Band area = area_of(node, technology);
  if (area.high > 0)
    sheet.add("wires within the node", bits, "bits", Constant::wire_bit_mm,
              0.5 * Band{std::sqrt(area.low), std::sqrt(area.high)});
  else
    energy.missing.emplace_back("wires within the node: its area is not known in " + technology.name);
  add_idle(sheet, node, parts, clock);
  for (const char* always :
       {"vertices: deformation gradients in, forces out, and their links to neighbours",
        "control: sequencers, counters, multiplexers", "clock tree above the registers' own pins",
        "leakage of registers: no figure of one apart from its energy",
        "glitches and wires of a placed circuit beyond the figures' own", "making the list of bonds anew"})
    energy.missing.emplace_back(always);
  return energy;
}

Band area_of(const SampleNode& node, const Technology& technology) {
  const auto &transistor = technology.at(Constant::transistor_area),
             &bit = technology.at(Constant::memory_bit_area), &flop = technology.at(Constant::register_area);
  if (!transistor || !bit || !flop) return {};
  const Parts parts = parts_of(node);
  Band um2 = transistors_of(parts) * transistor->band;
  um2 += parts.operators * parts.width * (kRegisters * flop->band);
  um2 += parts.memories * bit->band;
  // A table may be a ROM, of a transistor a bit.
  um2 += parts.tables * Band{std::min(transistor->band.low, bit->band.low), bit->band.high};
  return kMm2 * um2;
}

}  // namespace cuboct
