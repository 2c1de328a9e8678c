// SPDX-License-Identifier: MIT
// Energy of made counts against sums by hand; what is missing is named; counts that a plan cannot have.
#include "hw/cost/energy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "hw/cost/node_memories.h"
#include "hw/cost/pair_work.h"
#include "hw/plan/setup.h"

namespace cuboct {
namespace {

Plan plan(const std::string& scene) {
  return plan_of(read_scene(CUBOCT_SOURCE_DIR "/scenes/" + scene + ".toml"), Arch{});
}
const Plan& block() {
  static const Plan p = plan("undamped_block");
  return p;
}

Technology technology(const std::string& name) {
  return read_technology(CUBOCT_SOURCE_DIR "/technologies/" + name + ".toml");
}

constexpr uint64_t kCycles = 1000;
constexpr double kClock = 1e8;

MachineEvents events() {
  MachineEvents e;
  e.steps = 5 * block().nodes();
  e.updates = 2000, e.candidates = 40000, e.entries = 20000, e.issues = 30000, e.pairs = 30000,
  e.kicks = 25000;
  e.relayed = 9000, e.halos_x = 8000, e.beats = 12000;
  return e;
}

std::vector<MemoryTraffic> traffic() {
  return {{"own particles", 16, 160, 1, 4000, 2000, true}, {"sums", 64, 90, 1, 30000, 30000, true}};
}

Energy energy(const MachineEvents& e, const Technology& t) {
  return energy_of(block(), e, traffic(), kCycles, kClock, t);
}

const EnergyRow& row(const Energy& e, const std::string& term) {
  const auto found = std::ranges::find(e.rows, term, &EnergyRow::term);
  EXPECT_NE(found, e.rows.end()) << term;
  return *found;
}

bool lacks(const Energy& e, const std::string& term) {
  return std::ranges::any_of(e.missing, [&](const std::string& m) { return m.starts_with(term + ":"); });
}

// Every constant 1 to 2, but the exponent.
Technology made() {
  Technology t;
  t.name = "made";
  for (auto& figure : t.figures) figure = TechnologyFigure{{1, 2}, 16, "made"};
  t.at(Constant::memory_exponent)->band = {0.5, 1};
  t.at(Constant::clock_device) = t.at(Constant::static_device) = t.at(Constant::link_bit) = std::nullopt;
  return t;
}

TEST(Energy, TermsByHand) {
  const DatapathWork work = datapath_work(block());
  const Energy e = energy(events(), made());
  // Of the pairs 5000 lie beyond the cutoff: they have no kick.
  const double squares = work.pair.bit_products() - work.kick.bit_products();
  EXPECT_GT(squares, 0);
  EXPECT_EQ(row(e, "pairs: products").picojoules, (Band{30000 * squares, 60000 * squares}));
  EXPECT_EQ(row(e, "kicks: products").picojoules.low, 25000 * work.kick.bit_products());
  EXPECT_EQ(row(e, "pairs: adders").picojoules.low, 30000 * (work.pair.adder_bits - work.kick.adder_bits));
  EXPECT_EQ(row(e, "kicks: adders").picojoules.high, 2 * 25000 * work.kick.adder_bits);
  EXPECT_EQ(row(e, "kicks: registers").picojoules.low, 25000 * work.kick.register_bits);
  // Eight lanes meet each candidate.
  ASSERT_EQ(block().arch.filter_lanes, 8);
  EXPECT_EQ(row(e, "filter: adders").picojoules.low, 8.0 * 40000 * work.lane.adder_bits);
  EXPECT_EQ(row(e, "update: adders").picojoules.high, 2.0 * 2000 * work.update.adder_bits);
  // 160 bits of 16 words, the figure's own: no power of their ratio. 64 words: 4^0.5 = 2 to 4^1 = 4.
  EXPECT_EQ(row(e, "read own particles").picojoules, (Band{4000.0 * 160, 2 * 4000.0 * 160}));
  EXPECT_EQ(row(e, "write sums").picojoules, (Band{2 * 30000.0 * 90, 4 * 2 * 30000.0 * 90}));
  EXPECT_EQ(row(e, "links: registers").picojoules.low, 12000.0 * (block().words.link_bits + 1));
  const double nodes = block().nodes();
  // Each load of a register is clocked at least 1.2 times, and of all registers at least 0.05 in every cycle.
  EXPECT_DOUBLE_EQ(row(e, "clock: pairs").picojoules.low,
                   1.2 * 30000 * (work.pair.register_bits - work.kick.register_bits));
  EXPECT_DOUBLE_EQ(row(e, "clock: kicks").picojoules.low, 1.2 * 25000 * work.kick.register_bits);
  EXPECT_DOUBLE_EQ(row(e, "clock: filter").picojoules.low, 1.2 * 8 * 40000 * work.lane.register_bits);
  EXPECT_DOUBLE_EQ(row(e, "clock: update").picojoules.high, 2 * 1.9 * 2000 * work.update.register_bits);
  EXPECT_DOUBLE_EQ(row(e, "clock: links").picojoules.low, 1.2 * 12000 * (block().words.link_bits + 1));
  EXPECT_DOUBLE_EQ(row(e, "clock: gates and control").picojoules.low,
                   0.05 * kCycles * nodes * register_bits(block()).low);
  // 1000 cycles at 100 MHz are 10 us; a pW for a second is a pJ.
  double bits = work.pair.table_bits();
  for (const NodeMemory& m : NodeMemories(block().rule, block().arch, block().particles).of({1, 1, 1}, 8, 1))
    bits += static_cast<double>(m.words) * m.bits * m.copies;
  EXPECT_NEAR(row(e, "leakage of memories").picojoules.low, 1e-5 * nodes * bits, 1e-9 * bits);
}

// Bricks and narrow memories have ports that answer in each cycle; the others' rest.
TEST(Energy, PortsThatAnswerInEachCycleAreClockedInEach) {
  for (const bool narrow : {false, true}) {
    Plan plan = block();
    plan.arch.narrow_memories = narrow;
    const Energy e = energy_of(plan, events(), traffic(), kCycles, kClock, made());
    EXPECT_DOUBLE_EQ(row(e, "clock: gates and control").picojoules.low,
                     (narrow ? 0.12 : 0.05) * kCycles * plan.nodes() * register_bits(plan).low);
  }
}

// The enable of an FPGA's register stops no net of the clock; pipelines of rules have none within.
TEST(Energy, AnFpgasRegistersAreClockedInEachCycle) {
  Technology fpga = made();
  fpga.at(Constant::clock_device) = TechnologyFigure{{1, 2}, 0, "made"};
  const Energy e = energy(events(), fpga);
  EXPECT_DOUBLE_EQ(row(e, "clock of registers").picojoules.low,
                   kCycles * block().nodes() * register_bits(block()).low);
  for (const EnergyRow& r : e.rows) EXPECT_FALSE(r.term.starts_with("clock: ")) << r.term;
}

// Dropping any term from the rows or from the sum turns this red.
TEST(Energy, TheSumIsThatOfAllTerms) {
  const Energy e = energy(events(), made());
  std::vector<std::string> terms;
  Band sum;
  for (const EnergyRow& r : e.rows) {
    terms.push_back(r.term);
    sum += r.picojoules;
    EXPECT_LE(r.picojoules.low, r.picojoules.high) << r.term;
    EXPECT_EQ(r.source, "made") << r.term;
  }
  EXPECT_EQ(e.sum, sum);
  const std::vector<std::string> all{"pairs: products",
                                     "pairs: adders",
                                     "pairs: registers",
                                     "kicks: products",
                                     "kicks: adders",
                                     "kicks: registers",
                                     "filter: adders",
                                     "filter: registers",
                                     "update: adders",
                                     "update: registers",
                                     "read own particles",
                                     "write own particles",
                                     "read sums",
                                     "write sums",
                                     "links: registers",
                                     "links: wires",
                                     "wires within nodes",
                                     "clock: pairs",
                                     "clock: kicks",
                                     "clock: filter",
                                     "clock: update",
                                     "clock: links",
                                     "clock: gates and control",
                                     "leakage of logic",
                                     "leakage of memories"};
  EXPECT_EQ(terms, all);
}

TEST(Energy, EachMissingConstantIsNamed) {
  const Energy whole = energy(events(), made());
  for (size_t k = 0; k < kConstants; ++k) {
    Technology t = made();
    if (!t.figures[k]) continue;
    t.figures[k] = std::nullopt;
    const Energy e = energy(events(), t);
    const bool of_area = Constant(k) == Constant::wire_pitch;
    EXPECT_EQ(e.rows.size() < whole.rows.size(), !of_area) << name_of(Constant(k));
    EXPECT_EQ(e.missing.size() > whole.missing.size(), !of_area) << name_of(Constant(k));
  }
  Technology none;
  none.name = "none";
  const Energy e = energy(events(), none);
  EXPECT_TRUE(e.rows.empty());
  for (const EnergyRow& r : whole.rows) EXPECT_TRUE(lacks(e, r.term)) << r.term;
  EXPECT_TRUE(std::ranges::count(e.missing, "host link"));
}

TEST(Energy, GrowsWithEveryCount) {
  const double before = energy(events(), made()).sum.low;
  for (uint64_t MachineEvents::*count :
       {&MachineEvents::updates, &MachineEvents::candidates, &MachineEvents::pairs, &MachineEvents::beats}) {
    MachineEvents more = events();
    more.*count += 100;
    EXPECT_GT(energy(more, made()).sum.low, before);
  }
  auto words = traffic();
  words[0].reads += 1;
  EXPECT_GT(energy_of(block(), events(), words, kCycles, kClock, made()).sum.low, before);
  EXPECT_GT(energy_of(block(), events(), traffic(), kCycles + 1, kClock, made()).sum.low, before);
  // A slower clock leaks for longer.
  EXPECT_GT(energy_of(block(), events(), traffic(), kCycles, kClock / 2, made()).sum.low, before);
}

TEST(Energy, RecordsThatAreTestedOnArrivalCount) {
  const Plan solid = plan_of(read_scene(CUBOCT_SOURCE_DIR "/scenes/undamped_block.toml"),
                             read_arch(CUBOCT_SOURCE_DIR "/scenes/archs/solid.toml"));
  MachineEvents e = events();
  e.tested = 7000;
  const Energy energy = energy_of(solid, e, traffic(), kCycles, kClock, made());
  EXPECT_EQ(row(energy, "cull: adders").picojoules.low, 7000 * datapath_work(solid).cull.adder_bits);
  EXPECT_EQ(row(energy, "cull: registers").picojoules.low, 7000 * datapath_work(solid).cull.register_bits);
}

TEST(Energy, RefusesCountsThatThePlanCannotHave) {
  const uint64_t slots = kCycles * block().nodes();
  for (const auto& [name, count] : event_names()) {
    MachineEvents e = events();
    e.*count = 7 * slots;
    EXPECT_THROW(energy(e, made()), std::invalid_argument) << name;
    e.*count = UINT64_MAX;  // what a negative count becomes
    EXPECT_THROW(energy(e, made()), std::invalid_argument) << name;
  }
  MachineEvents e = events();
  e.phase_cycles[3] = slots + 1;
  EXPECT_THROW(energy(e, made()), std::invalid_argument);
  e.phase_cycles[3] = slots;
  EXPECT_NO_THROW(energy(e, made()));
  e.pairs = slots + 1;  // one pipe
  EXPECT_THROW(energy(e, made()), std::invalid_argument);
  auto words = traffic();
  words[1].writes = 3 * slots;
  EXPECT_THROW(energy_of(block(), events(), words, kCycles, kClock, made()), std::invalid_argument);
  words = traffic(), words[1].bits = 0;
  EXPECT_THROW(energy_of(block(), events(), words, kCycles, kClock, made()), std::invalid_argument);
  for (double clock : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_THROW(energy_of(block(), events(), traffic(), kCycles, clock, made()), std::invalid_argument);
}

TEST(Energy, WhatNoEventTellsOfAMemoryIsMissing) {
  auto words = traffic();
  words[1].counted = false;
  const Energy e = energy_of(block(), events(), words, kCycles, kClock, made());
  EXPECT_TRUE(lacks(e, "memory of sums"));
  EXPECT_TRUE(std::ranges::none_of(e.rows, [](const EnergyRow& r) { return r.term == "read sums"; }));
  EXPECT_TRUE(lacks(energy_of(block(), events(), {}, kCycles, kClock, made()), "memories"));
}

// A device's clock and rest stand for all nodes in one, or one each.
TEST(Energy, AnFpgaPaysByDevice) {
  const Energy e = energy(events(), technology("ice40"));
  const double nodes = block().nodes();
  EXPECT_DOUBLE_EQ(row(e, "clock of devices").picojoules.low, 52.1 * kCycles);
  EXPECT_DOUBLE_EQ(row(e, "clock of devices").picojoules.high, 53.0 * kCycles * nodes);
  EXPECT_DOUBLE_EQ(row(e, "devices at rest").picojoules.low, 0.1043e9 * 1e-5);
  EXPECT_TRUE(lacks(e, "read own particles"));
  EXPECT_TRUE(lacks(e, "links: wires"));
  EXPECT_FALSE(area_of(block(), technology("ice40")).missing.empty());
  EXPECT_TRUE(area_of(block(), technology("ice40")).rows.empty());
}

TEST(Energy, ALinkBetweenChipsReplacesItsWire) {
  Technology t = made();
  t.at(Constant::link_bit) = TechnologyFigure{{0.25, 0.5}, 0, "made"};
  const Energy e = energy(events(), t);
  EXPECT_EQ(row(e, "links").picojoules.high, 0.5 * 12000 * (block().words.link_bits + 1));
  EXPECT_TRUE(std::ranges::none_of(e.rows, [](const EnergyRow& r) { return r.term == "links: wires"; }));
}

TEST(Energy, SensitivityIsTheSumAtBothEnds) {
  const auto bars = sensitivity_of(block(), events(), traffic(), kCycles, kClock, made());
  ASSERT_FALSE(bars.empty());
  const auto found = std::ranges::find(bars, Constant::add_bit, &Sensitivity::constant);
  ASSERT_NE(found, bars.end());
  const Energy e = energy(events(), made());
  double adders = 0;  // at 1 pJ/bit
  for (const char* term : {"pairs: adders", "kicks: adders", "filter: adders", "update: adders"})
    adders += row(e, term).picojoules.low;
  EXPECT_NEAR(found->high - found->low, adders, 1e-9 * e.sum.high);
  for (size_t k = 1; k < bars.size(); ++k)
    EXPECT_GE(bars[k - 1].high - bars[k - 1].low, bars[k].high - bars[k].low);
}

// Flip-flops of nodes as synthesised for ECP5 (docs/measured/data/energy-registers.tsv).
TEST(Energy, RegistersAreThoseOfSynthesisedNodes) {
  std::ifstream file(CUBOCT_SOURCE_DIR "/docs/measured/data/energy-registers.tsv");
  int nodes = 0;
  for (std::string line; std::getline(file, line);) {
    const size_t tab = line.find('\t'), second = line.find('\t', tab + 1);
    if (line[0] != '`' || tab == std::string::npos) continue;
    const std::string scene = line.substr(1, tab - 2), arch = line.substr(tab + 1, second - tab - 1);
    const double measured = std::stod(line.substr(second + 1));
    const Band band = register_bits(
        plan_of(read_scene(CUBOCT_SOURCE_DIR "/scenes/" + scene + ".toml"),
                read_arch(CUBOCT_SOURCE_DIR "/scenes/archs/" + arch.substr(1, arch.size() - 2) + ".toml")));
    EXPECT_LE(band.low, measured) << line;
    EXPECT_GE(band.high, measured) << line;
    if (std::getenv("CUBOCT_VERBOSE"))
      printf("%s %s %g: %g\n", scene.c_str(), arch.c_str(), measured,
             measured / (band.high / (arch[1] == 'i' ? 1.6 : 3.2)));
    ++nodes;
  }
  EXPECT_GE(nodes, 9);
}

// The pipe of undamped_block as gates, by their activity with a node's own pairs: 119.9 nJ for 64 pairs of a
// step (docs/measured/data/energy-activity-parts.tsv, energy-activity.tsv). No part of the figures is of it.
TEST(Energy, APairIsThatOfThePipesGates) {
  const Technology t = technology("osu018");
  const Work pair = datapath_work(block()).pair;
  Band pipe = pair.bit_products() * t.at(Constant::multiply_bit2)->band;
  pipe += pair.adder_bits * t.at(Constant::add_bit)->band;
  pipe += pair.register_bits * t.at(Constant::register_bit)->band;
  EXPECT_LT(pipe.low, 119.9e3 / 64);
  EXPECT_GT(pipe.high, 119.9e3 / 64);
  EXPECT_NEAR(pipe.middle(), 119.9e3 / 64, 0.25 * 119.9e3 / 64);
}

// The pipe of lj_block as synthesised (docs/measured/data/synth-units.tsv).
TEST(Energy, APipesAreaIsThatOfItsNetlist) {
  const Plan p = plan("lj_block");
  const Technology t = technology("osu018");
  const Work pair = datapath_work(p).pair;
  // 0.790 mm^2: transistors of products and adders, registers at least those counted.
  Band area = (34 * pair.bit_products() + 28 * pair.adder_bits) * t.at(Constant::transistor_area)->band;
  area += Band{pair.register_bits, 3.2 * pair.register_bits} * t.at(Constant::register_area)->band;
  if (std::getenv("CUBOCT_VERBOSE")) printf("pipe %g to %g mm^2\n", 1e-6 * area.low, 1e-6 * area.high);
  EXPECT_LT(area.low, 0.790e6);
  EXPECT_GT(area.high, 0.790e6);
}

TEST(Area, PartsByHandAndSumOfParts) {
  const Technology t = made();
  const Area area = area_of(block(), t);
  const double nodes = block().nodes();
  Band sum;
  for (const AreaRow& r : area.rows) sum += r.mm2;
  EXPECT_DOUBLE_EQ(area.sum.low, sum.low);
  EXPECT_DOUBLE_EQ(area.sum.high, sum.high);
  ASSERT_EQ(area.rows.size(), 5U);
  EXPECT_EQ(area.rows[0].part, "memories");
  EXPECT_DOUBLE_EQ(area.rows[3].mm2.low, nodes * 1e-6 * register_bits(block()).low);
  const DatapathWork work = datapath_work(block());
  EXPECT_DOUBLE_EQ(area.rows[2].mm2.low,
                   nodes * 1e-6 *
                       (34 * work.pair.bit_products() +
                        28 * (work.pair.adder_bits + 8 * work.lane.adder_bits + work.update.adder_bits)));
  EXPECT_NEAR(nodes * area.side.low * area.side.low, area.sum.low, 1e-12);
}

// A table may be a ROM of one transistor a bit, or a memory that is written once.
TEST(Area, ATableIsAtLeastATransistorABit) {
  Technology t = made();
  t.at(Constant::memory_bit_area)->band = {10, 20};
  const Area area = area_of(block(), t);
  const double bits = block().nodes() * datapath_work(block()).pair.table_bits();
  EXPECT_DOUBLE_EQ(area.rows[1].mm2.low, 1e-6 * bits);
  EXPECT_DOUBLE_EQ(area.rows[1].mm2.high, 20e-6 * bits);
  double low = 0;
  for (const AreaRow& r : area.rows) low += r.mm2.low;
  EXPECT_NEAR(area.sum.low, low, 1e-9 * low);
}

TEST(Area, OneMultiplierForTheAxesIsSmaller) {
  Arch shared;
  shared.multipliers = Multipliers::shared;
  const Plan p = plan_of(read_scene(CUBOCT_SOURCE_DIR "/scenes/undamped_block.toml"), shared);
  EXPECT_LT(area_of(p, made()).rows[2].mm2.low, area_of(block(), made()).rows[2].mm2.low);
}

}  // namespace
}  // namespace cuboct
