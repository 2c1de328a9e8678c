// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "hw/rtl/rtl_design.h"
#include "model/base/fixed_math.h"
#include "model/base/integer_math.h"

namespace cuboct {
namespace {

// Bits of two's complement that hold both ends.
int bits_of_range(const ValueRange& range) {
  int bits = 1;
  while (!fits(range.low, bits) || !fits(range.high, bits)) ++bits;
  return bits;
}

// A sized literal, the first bit last.
std::string binary(const std::vector<bool>& bits) {
  std::string text;
  for (const bool bit : bits) text.insert(text.begin(), bit ? '1' : '0');
  return fmt::format("{}'b{}", bits.size(), text);
}

void add_table(RtlDesign& design, const std::string& module, const FixedTable& table, int entry_bits,
               int law_bits) {
  design.tables.push_back({module, entry_bits, table.index_bits + law_bits, table.c0, table.c1, table.c2});
}

}  // namespace

ValueRange table_range(const FixedTable& table) {
  // t lies in [0, 2^T), and round_odd(slope * t, T) is monotonic in both, so its ends are those of the
  // slopes' range.
  const int T = table.fraction_bits;
  const int64_t t_max = (int64_t{1} << T) - 1;
  const auto reach = [&](int64_t low, int64_t high) {
    return ValueRange{std::min<int64_t>(0, round_odd(low * t_max, T)),
                      std::max<int64_t>(0, round_odd(high * t_max, T))};
  };
  ValueRange all;
  for (size_t k = 0; k < table.c0.size(); ++k) {
    ValueRange slope{table.c1[k], table.c1[k]};
    if (table.degree == 2) {
      const ValueRange curve = reach(table.c2[k], table.c2[k]);
      slope = {slope.low + curve.low, slope.high + curve.high};
    }
    const ValueRange rise = reach(slope.low, slope.high);
    all.low = std::min(all.low, table.c0[k] + rise.low);
    all.high = std::max(all.high, table.c0[k] + rise.high);
  }
  return all;
}

namespace {

// The constants and tables of cuboct_node_core, or of cuboct_brick_core.
void add_pair_law(const Plan& plan, RtlDesign& design) {
  const FixedRule& rule = plan.rule;
  const Widths& w = rule.widths;
  const Arch& arch = plan.arch;
  const bool bricks = !plan.bricks.one_cell();
  const auto constant = [&](const char* name, int64_t value, const char* comment) {
    design.constants.push_back({name, value, false, true, comment});
  };
  const auto wide = [&](const char* name, uint64_t value, const char* comment) {
    design.constants.push_back({name, static_cast<int64_t>(value), true, true, comment});
  };
  constant("Axes", rule.axes, "3, or 2 where nothing happens along z");
  if (bricks)
    for (size_t a = 0; a < 3; ++a)
      constant(std::array{"BrickX", "BrickY", "BrickZ"}[a], arch.brick[static_cast<int>(a)],
               a == 0 ? "cells of a node" : "");
  constant("Capacity", arch.capacity, bricks ? "particles per cell" : "particles per node");
  constant("FilterLanes", arch.filter_lanes, "own particles that a candidate meets per cycle");
  constant("ForcePipes", arch.force_pipes, "pairs per cycle");
  constant("Shared", arch.multipliers == Multipliers::shared, "1: one multiplier serves the axes in turn");
  constant("Product", plan.latency.product, "cycles of a multiplier");
  constant("Interval", plan.latency.interval, "cycles from one pair to the next");
  constant("QueueDepth", arch.queue_depth, "entries between filter and pipes");
  constant("Overlap", arch.overlap, "1: the force engine starts with the exchange");
  if (!bricks) {
    constant("Arrival", arch.halos == Halos::arrival, "1: halos are used as they come");
    constant("Streamers", arch.streamers, "candidates per cycle");
  }
  if (!bricks) constant("Narrow", arch.narrow_memories, "1: memories of words of LinkBits, one port to read");
  constant("LinkBits", plan.words.link_bits, "payload of a beat");
  constant("IdBits", plan.words.id_bits, "");
  constant("TypeBits", rule.type_bits, "0 with one type");
  constant("PositionFrac", w.position_frac, "fractional bits of x that forces and links see");
  constant("Guard", w.guard, "v and the owner's x have PositionFrac + Guard fractional bits");
  constant("VelocityBits", w.velocity_bits, "");
  constant("RelativeVelocityBits", w.relative_velocity_bits, "");
  constant("StrengthBits", w.strength_bits, "s, and the entries of the tables");
  constant("SumBits", w.sum_bits, "a particle's summed kick");
  constant("DisplacementBits", w.displacement_bits, "");
  constant("ScaleFrac", w.scale_frac, "fractional bits of the pair scales");
  constant("GainFrac", w.gain_frac, "fractional bits of kp, kd");
  constant("GainBits", 18, "");
  constant("ScaleBits", 18, "");
  constant("ConstantBits", w.velocity_bits, "imposed velocities and gravity");
  constant("FilterFrac", w.filter_frac, "leading bits of a position that the filter tests");
  constant("DifferenceShift", rule.difference_shift, "");
  constant("WShift", rule.w_shift, "");
  constant("QShift", rule.q_shift, "");
  constant("DampShift", rule.damp_shift, "");
  constant("KickShift", rule.kick_shift, "");
  wide("Cutoff2", rule.cutoff2, "in units of r2");
  wide("Contact2", rule.contact2, "as Cutoff2, of types that only touch; 0: no two do");
  wide("PlanarOne", static_cast<uint64_t>(rule.planar[0]), "FilterFrac fractional bits");
  wide("PlanarTwo", static_cast<uint64_t>(rule.planar[1]), "");
  wide("PlanarThree", static_cast<uint64_t>(rule.planar[2]), "");
  const auto table = [&](const std::string& prefix, const FixedTable& t, const char* what) {
    const auto name = [&](const char* field) { return prefix + field; };
    const auto put = [&](const std::string& field, int64_t value, const char* comment) {
      design.constants.push_back({field, value, false, true, comment});
    };
    put(name("Octaves"), t.shape == TableShape::octaves, what);
    put(name("Degree"), t.degree, "");
    put(name("IndexBits"), t.index_bits, "");
    put(name("BinBits"), t.bin_bits, "");
    put(name("FirstOctave"), t.first_octave, "");
    put(name("FractionBits"), t.fraction_bits, "");
  };
  const int force_bits = bits_of_range(table_range(rule.force));
  table("", rule.force, "force table: 0 uniform, 1 by octaves");
  constant("ForceBits", force_bits, "that hold every value of the force table");
  constant("Damped", rule.damped, "");
  if (rule.damped) {
    table("Damp", rule.damp, "damping table");
    constant("DampBits", bits_of_range(table_range(rule.damp)), "that hold every value of the damping table");
  }
  constant("Scaled", rule.scaled, "pairs of types differ");
  constant("Weighted", rule.weighted, "masses of types differ");
  constant("LawBits", rule.law_bits, "of the law of a pair of types; 0: all have one");
  constant("Pd", rule.pd, "some type is held by force");
  add_table(design, "cuboct_force_rom", rule.force, w.strength_bits, rule.law_bits);
  if (rule.damped) add_table(design, "cuboct_damp_rom", rule.damp, w.strength_bits, 0);
  const int s_bits = rule.damped ? w.strength_bits : force_bits;
  const int kick_bits = std::max(2, s_bits + w.difference_frac + 1 - rule.kick_shift);
  design.pair_sum_bits =
      kick_bits + ceil_log2((rule.axes == 3 ? 27u : 9u) * static_cast<uint64_t>(arch.capacity));
}

}  // namespace

RtlDesign decide(const Plan& plan) {
  const FixedRule& rule = plan.rule;
  const Widths& w = rule.widths;
  const Arch& arch = plan.arch;
  const bool bricks = !plan.bricks.one_cell();
  RtlDesign design;
  design.maker = fmt::format("Made by cuboct emit from plan {:016x}; do not edit.", plan.hash);

  const auto constant = [&](const char* name, int64_t value, const char* comment) {
    design.constants.push_back({name, value, false, true, comment});
  };
  const auto wide = [&](const char* name, uint64_t value, const char* comment) {
    design.constants.push_back({name, static_cast<int64_t>(value), true, true, comment});
  };
  if (plan.program) {
    constant("Axes", rule.axes, "3, or 2 where nothing happens along z");
    constant("Capacity", arch.capacity, "particles per node");
    constant("FilterLanes", arch.filter_lanes, "own particles that a candidate meets per cycle");
    constant("ForcePipes", arch.force_pipes, "pairs per cycle");
    constant("QueueDepth", arch.queue_depth, "entries between filter and pipes");
    constant("Overlap", arch.overlap, "1: the force engine starts with the exchange");
    constant("LinkBits", plan.words.link_bits, "payload of a beat");
    constant("IdBits", plan.words.id_bits, "");
    constant("PositionFrac", w.position_frac, "fractional bits of x that pairs and links see");
    constant("FilterFrac", w.filter_frac, "leading bits of a position that the filter tests");
    wide("PlanarOne", static_cast<uint64_t>(rule.planar[0]), "FilterFrac fractional bits");
    wide("PlanarTwo", static_cast<uint64_t>(rule.planar[1]), "");
    wide("PlanarThree", static_cast<uint64_t>(rule.planar[2]), "");
  } else {
    add_pair_law(plan, design);
  }
  design.constants.push_back({"ParticleBits", plan.words.particle_bits, false, plan.program != nullptr,
                              "of the words to load and observe"});
  if (const LinkCode& code = plan.link; code.checked()) {
    const auto guard = [&](const char* name, int64_t value, const char* comment, bool wide_one = false) {
      design.constants.push_back({name, value, wide_one, false, comment});
    };
    guard("LinkRetry", code.check == LinkCheck::retry, "1: lost beats are sent again; 0: they are a fault");
    guard("LinkSequence", code.sequence_bits, "bits of a beat's number");
    guard("LinkWindow", code.window, "beats that may be unacknowledged");
    guard("LinkPatience", code.patience, "cycles without an acknowledgement");
    guard("LinkCrc", code.beat.width, "bits of a beat's check");
    guard("LinkPolynomial", code.beat.polynomial, "", true);
    guard("LinkStart", code.beat.start, "", true);
    guard("AckCrc", code.ack.width, "bits of an acknowledgement's check");
    guard("AckPolynomial", code.ack.polynomial, "", true);
    guard("AckStart", code.ack.start, "", true);
    guard("WireBits", code.wire_bits, "of link_data");
    guard("AckBits", code.ack_bits, "of link_ack");
    design.checked = true;
  }

  design.rounds = static_cast<int>(plan.rounds.size());
  design.text = plan.program != nullptr;
  design.types = rule.types;
  if (rule.scaled) design.scale = rule.scale;
  design.law_bits = rule.law_bits;
  design.law = rule.law;
  design.axes = rule.axes;
  design.streamers = arch.streamers;
  design.pipes = arch.force_pipes;
  design.arrival = arch.halos == Halos::arrival;
  design.type_bits = rule.type_bits;
  design.velocity_bits = w.velocity_bits;
  design.particle_bits = plan.words.particle_bits;
  design.link_bits = plan.words.link_bits;
  for (uint32_t n = 0; n < plan.nodes(); ++n) {
    design.cells.push_back(plan.low_of(n));
    auto& faces = design.neighbour.emplace_back();
    for (int f = 0; f < kFaces; ++f) faces[f] = plan.neighbour(n, f);
    if (!bricks) continue;
    design.extents.push_back(binary(extent_bits(plan, n)));
    design.exits.push_back(binary(exit_bits(plan, n)));
  }
  design.cell_bits = plan.bricks.cell_bits();
  if (bricks)
    design.constants.push_back(
        {"CellBits", design.cell_bits, false, false, "of a cell's number in its node"});
  return design;
}

std::vector<bool> extent_bits(const Plan& plan, uint32_t node) {
  const Cell &brick = plan.bricks.shape(), extent = plan.bricks.extent(node);
  const int width = ceil_log2(static_cast<uint64_t>(std::max({brick[0], brick[1], brick[2]})) + 2);
  std::vector<bool> bits;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < width; ++b) bits.push_back(extent[a] >> b & 1);
  return bits;
}

std::vector<bool> exit_bits(const Plan& plan, uint32_t node) {
  std::vector<bool> bits;
  for (uint32_t local = 0; local < cells_of(plan.bricks.shape()); ++local) {
    const uint32_t cell = plan.bricks.cell(node, local);
    for (int f = 0; f < 2 * plan.rule.axes; ++f)
      bits.push_back(cell != kNoCell && plan.lattice.neighbour(cell, f) != kNoCell);
  }
  return bits;
}

void legalise(const RtlDesign& design, bool with_lattice) {
  const auto at_most = [](const char* what, int64_t value, int64_t limit,
                          const std::vector<std::string>& keys) {
    if (value > limit)
      throw InputError(fmt::format("RTL: {} is {}: at most {} can be emitted", what, value, limit))
          .about(keys);
  };
  at_most("the width of a particle's exact sum", design.pair_sum_bits, 64,
          {"widths.strength_bits", "widths.difference_frac", "node.capacity"});
  at_most("the width of a particle", design.particle_bits, design.text ? 2048 : 1024,
          {"widths.velocity_bits", "widths.displacement_bits"});
  for (const RtlTable& t : design.tables) {
    at_most("a table's index width", t.index_bits, 18, {"table.index_bits"});
    for (const auto* column : {&t.c0, &t.c1, &t.c2})
      for (const int32_t c : *column)
        if (!fits(c, t.entry_bits))
          throw InputError(
              fmt::format("RTL: the entry {} of {} does not fit {} bits", c, t.module, t.entry_bits));
  }
  if (!with_lattice) return;
  // Observation ports are one vector over all nodes; simulators limit the width of a vector.
  const auto nodes = static_cast<int64_t>(design.cells.size());
  if (nodes < 1) throw InputError("RTL: the lattice has no node");
  at_most("the width of the lattice's observation port", nodes * design.particle_bits, 1 << 19,
          {"node.brick", "packing", "particle"});
}

}  // namespace cuboct
