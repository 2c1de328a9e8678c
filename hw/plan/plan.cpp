// SPDX-License-Identifier: MIT
#include "hw/plan/plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "hw/arch/cell_box.h"
#include "hw/cost/pair_work.h"
#include "model/base/hash.h"
#include "model/base/integer_math.h"
#include "model/trace/trace.h"

namespace cuboct {
namespace {

// Cells of a brick, times slots, times passes of the lanes; 27 times that are a node's items in a step, which
// the timing model counts in 25 bits.
constexpr uint64_t kMostBrickWork = 1 << 20;
// Of docs/reference/numeric.md: 2 since positions keep the guard bits. Bits of another contract are another
// plan's.
constexpr int kNumericContract = 2;

void check_arch(const Arch& arch) {
  const auto positive = [&](const char* what, int value, int high) {
    if (value < 1 || value > high)
      arch.places.fail({fmt::format("node.{}", what)},
                       fmt::format("{} = {} is out of range: 1 to {}", what, value, high));
  };
  positive("capacity", arch.capacity, 256);
  positive("filter_lanes", arch.filter_lanes, 64);
  positive("force_pipes", arch.force_pipes, arch.filter_lanes);
  positive("queue_depth", arch.queue_depth, 1024);
  for (const int32_t cells : arch.brick) positive("brick", cells, kMostBrickCells);
  const uint64_t cells =
      uint64_t{cells_of({arch.brick[0], 1, 1})} * cells_of({1, arch.brick[1], arch.brick[2]});
  if (cells > kMostBrickCells)
    arch.places.fail({"node.brick"}, fmt::format("brick = [{}] has {} cells: a node serves at most {}",
                                                 fmt::join(arch.brick, ", "), cells, kMostBrickCells));
  const uint64_t visits =
      cells * static_cast<uint64_t>(arch.capacity * ceil_div(arch.capacity, arch.filter_lanes));
  if (cells > 1 && visits > kMostBrickWork)
    arch.places.fail({"node.brick"},
                     fmt::format("brick = [{}]: {} cells of {} slots, met by {} lanes in {} passes, are {} "
                                 "visits; a node makes at most {}",
                                 fmt::join(arch.brick, ", "), cells, arch.capacity, arch.filter_lanes,
                                 ceil_div(arch.capacity, arch.filter_lanes), visits, kMostBrickWork),
                     "use a smaller brick or more filter_lanes");
  if (arch.narrow_memories) {
    const auto want = [&](bool is, const char* what) {
      if (!is)
        arch.places.fail({"node.memories"},
                         fmt::format("memories = \"narrow\" have one port to read: set {}", what));
    };
    want(arch.filter_lanes == 1, "filter_lanes = 1");
    want(!arch.overlap, "overlap = false");
    want(cells == 1, "brick = [1, 1, 1]");
  }
  if (arch.halos == Halos::arrival) {
    const auto want = [&](bool is, const char* what) {
      if (!is)
        arch.places.fail({"node.halos"},
                         fmt::format("halos = \"arrival\" are streamed while they come: set {}", what));
    };
    want(!arch.narrow_memories, "memories = \"wide\"");
    want(arch.overlap, "overlap = true");
    want(cells == 1, "brick = [1, 1, 1]");
  } else if (arch.streamers > 1) {
    arch.places.fail({"node.streamers"}, "two streamers share the faces of halos used on arrival",
                     "set halos = \"arrival\", or streamers = 1");
  }
  if (arch.streamers < 1 || arch.streamers > 2 || arch.force_pipes % arch.streamers != 0)
    arch.places.fail({"node.streamers", "node.force_pipes"},
                     fmt::format("streamers = {} with force_pipes = {}: each streamer feeds as many pipes",
                                 arch.streamers, arch.force_pipes),
                     "set force_pipes to a multiple of streamers");
  if (arch.boards.several() && arch.link_check != LinkCheck::none)
    arch.places.fail(
        {"link.check", "boards"},
        fmt::format("check = \"{}\" with [boards]: the window of {} beats and the patience of {} "
                    "cycles are those of a wire",
                    to_string(arch.link_check), link_code(arch.link_check, 1).window,
                    link_code(arch.link_check, 1).patience),
        "leave the check of links between devices to their line code: set check = \"none\"");
  if (arch.link_bits < 0 || arch.link_bits > 1024)
    arch.places.fail({"link.bits"},
                     fmt::format("link bits = {} is out of range: 1 to 1024, or 0 for one record per beat",
                                 arch.link_bits));
}

void add(Hash& hash, const FixedTable& table) {
  hash.add(static_cast<int>(table.shape)).add(table.degree).add(table.difference_frac).add(table.index_bits);
  hash.add(table.bin_bits).add(table.first_octave).add(table.fraction_bits).add(table.value_frac);
  for (const auto* column : {&table.c0, &table.c1, &table.c2})
    for (const int32_t c : *column) hash.add(c);
}

uint64_t hash_of(const Plan& plan) {
  Hash hash;
  hash.add(kNumericContract);
  const FixedRule& rule = plan.rule;
  const Widths& w = rule.widths;
  for (const int value : {w.position_frac, w.guard, w.difference_frac, w.velocity_bits,
                          w.relative_velocity_frac, w.relative_velocity_bits, w.strength_bits, w.sum_bits,
                          w.displacement_bits, w.scale_frac, w.gain_frac})
    hash.add(value);
  hash.add(static_cast<int64_t>(rule.cutoff2)).add(rule.damped).add(rule.scaled).add(rule.pd);
  if (rule.axes != 3) hash.add(rule.axes);
  for (int a = 0; a < 3 && !rule.cubic(); ++a) hash.add(rule.shape_of(a));
  // One that no type needs, but that a plan carries (hw/arch/carry.h), widens the records.
  if (rule.types.size() == 1 && rule.type_bits > 0) hash.add(rule.type_bits);
  add(hash, rule.force);
  if (rule.damped) add(hash, rule.damp);
  if (rule.contact2 > 0) hash.add(static_cast<int64_t>(rule.contact2));
  for (const auto& row : rule.scale)
    for (const int32_t s : row) hash.add(s);
  if (rule.weighted)
    for (const FixedType& type : rule.types) hash.add(type.weight);
  for (const auto& row : rule.law)
    for (const uint8_t law : row) hash.add(law);
  for (const FixedType& type : rule.types) {
    for (int a = 0; a < 3; ++a) hash.add(type.imposed[a]).add(type.velocity[a]).add(type.gravity[a]);
    hash.add(type.pd).add(type.kp).add(type.kd);
  }
  const Arch& arch = plan.arch;
  hash.add(arch.capacity)
      .add(arch.filter_lanes)
      .add(arch.force_pipes)
      .add(arch.queue_depth)
      .add(arch.overlap);
  if (arch.multipliers != Multipliers::parallel) hash.add(plan.latency.interval);
  if (arch.narrow_memories) hash.add(-1);
  if (arch.halos == Halos::arrival) hash.add(-2).add(arch.streamers);
  if (w.filter_frac != Widths{}.filter_frac) hash.add(w.filter_frac);
  hash.add(plan.words.link_bits).add(plan.particles);
  if (plan.link.checked()) hash.add(static_cast<int>(plan.link.check));
  if (!plan.bricks.one_cell())
    for (const int32_t c : arch.brick) hash.add(c);
  if (arch.boards.several()) {
    for (const int32_t n : arch.boards.nodes) hash.add(n);
    hash.add(arch.boards.latency).add(arch.boards.interval);
  }
  for (const int32_t p : plan.lattice.period()) hash.add(p);
  for (uint32_t n = 0; n < plan.lattice.size(); ++n)
    for (const int32_t c : plan.lattice.cell(n)) hash.add(c);
  return hash.value();
}

// A bit of the shorter operand per cycle, after one that loads it: d, t with a sign, q, the pair's scale.
int product_cycles(const FixedRule& r) {
  int bits = std::max(r.widths.difference_frac + 1, r.force.fraction_bits + 1);
  if (r.damped) bits = std::max({bits, r.damp.fraction_bits + 1, r.widths.relative_velocity_bits});
  if (r.scaled) bits = std::max(bits, kScaleBits);
  return bits + 1;
}

}  // namespace

Latency latency_of(const FixedRule& r, const Arch& arch) {
  Latency latency;
  const int table = (r.force.degree == 2 ? 1 : 0), used = (r.damped ? 1 : 0) + (r.scaled ? 1 : 0);
  const bool serial = arch.multipliers == Multipliers::serial,
             shared = arch.multipliers == Multipliers::shared;
  if (serial) latency.product = product_cycles(r);
  // Where cycles are few the multipliers have registers on both sides.
  if (arch.halos == Halos::arrival && arch.multipliers == Multipliers::parallel) latency.product = 2;
  // Squares, slope, kick, and what else is multiplied: each waits for the one before.
  latency.pipe = 8 + (r.force.shape == TableShape::octaves ? 1 : 0) + table + used +
                 latency.product * (3 + table + used) + (shared ? 2 * (r.axes - 1) : 0);
  // A product stays for a cycle in which it is looked at. Beside narrow memories, which bring candidates
  // slowly, a pair that is alone in the pipe needs no registers to wait in.
  latency.interval = serial                 ? latency.product + 1
                     : !shared              ? 1
                     : arch.narrow_memories ? latency.pipe - 2
                                            : r.axes;
  // A product and its rounding come before the sum of v; with gains they stand beside theirs.
  latency.update = r.pd ? 7 : r.weighted ? 6 : 4;
  if (arch.halos == Halos::arrival) {
    ++latency.filter;  // a register behind the halos' memories
    ++latency.update;  // another between the update and the slots' memories
  }
  if (arch.narrow_memories) {
    latency.filter = 2;
    latency.stride = latency.update - 1;
  }
  return latency;
}

uint64_t bounding_cells(const Lattice& lattice) {
  if (lattice.size() == 0) return 0;
  const CellBox box = box_of(lattice, false);
  uint64_t cells = 1;
  for (size_t a = 0; a < 3; ++a) cells *= static_cast<uint64_t>(box.extent(a));
  return cells;
}

Plan on_machine(const Plan& plan, Arch arch, Lattice lattice) {
  Plan other = make_plan(plan.rule, std::move(arch), std::move(lattice), plan.origin, plan.particles);
  if (plan.program != nullptr) set_program(other, plan.program);
  return other;
}

Plan make_plan(FixedRule rule, Arch arch, Lattice lattice, const Vec3& origin, uint32_t particles) {
  check_arch(arch);
  Plan plan;
  plan.rule = std::move(rule);
  plan.arch = std::move(arch);
  plan.lattice = std::move(lattice);
  plan.bricks = Bricks(plan.lattice, plan.arch.brick);
  plan.origin = origin;
  plan.particles = particles;

  plan.words = words_of(plan.rule, plan.arch, particles);
  plan.latency = latency_of(plan.rule, plan.arch);
  plan.rounds = {{plan.words.halo, plan.words.halo_beats, plan.latency.pipe, plan.latency.update}};
  plan.link = link_code(plan.arch.link_check, plan.words.link_bits);
  plan.cut = cut_links(plan.lattice, plan.bricks, plan.arch.boards);
  plan.hash = hash_of(plan);
  return plan;
}

size_t spans_of_step(const Plan& plan) {
  return size_t{plan.nodes()} * static_cast<size_t>(phases_of(static_cast<int>(plan.rounds.size())));
}

std::string describe(const Plan& plan) {
  const FixedRule& r = plan.rule;
  const Widths& w = r.widths;
  const FixedTable& t = r.force;
  std::string text;
  const auto line = [&text](const char* name, const std::string& value) {
    text += fmt::format("  {:<22} {}\n", name, value);
  };
  line("plan hash", fmt::format("{:016x}", plan.hash));
  line("particles",
       fmt::format("{} of {} type{}", plan.particles, r.types.size(), r.types.size() == 1 ? "" : "s"));
  const std::string edges = r.cubic() ? fmt::format("cell edge {:.6g} m", r.cell_edge)
                                      : fmt::format("cell edges {:.6g} x {:.6g} x {:.6g} m", r.edges()[0],
                                                    r.edges()[1], r.edges()[2]);
  const std::string slots = fmt::format("{} slots, {}", plan.arch.capacity, edges);
  if (plan.bricks.cells() == 1)
    line("nodes", fmt::format("{} of {}", plan.nodes(), slots));
  else
    line("nodes", fmt::format("{} with bricks of {} cells; {} cells of {}", plan.nodes(),
                              fmt::join(plan.arch.brick, " x "), plan.lattice.size(), slots));
  line("time step", fmt::format("{:.6g} s", r.dt));
  line("position", fmt::format("{} fractional bits, differences {}", w.position_frac, w.difference_frac));
  line("velocity", fmt::format("{} bits, {} fractional", w.velocity_bits, w.velocity_frac()));
  if (plan.program != nullptr) {
    describe_rounds(plan, line);
  } else {
    line("table",
         fmt::format("{} entries of {} bits, {}, degree {}, scaled by 2^{}", t.c0.size(), w.strength_bits,
                     t.shape == TableShape::uniform ? std::string("uniform in r^2")
                                                    : fmt::format("{} per octave of r^2", 1 << t.bin_bits),
                     t.degree, t.value_frac));
    line("worst force error", fmt::format("{:.3g} N at r = {:.6g} m ({:.3g} of the largest force)",
                                          r.error().worst_force, r.error().at, r.error().relative));
    line("halo record", fmt::format("{} bits in {} beat{} of {}", plan.words.halo_bits, plan.words.halo_beats,
                                    plan.words.halo_beats == 1 ? "" : "s", plan.words.link_bits));
  }
  line("particle word", fmt::format("{} bits in {} beat{}", plan.words.particle_bits,
                                    plan.words.migrate_beats, plan.words.migrate_beats == 1 ? "" : "s"));
  if (const LinkCode& code = plan.link; code.checked())
    line("link check",
         fmt::format("{}: {} bits of sequence and {} of check (0x{:x}, distance {}) per beat, {} cycles more",
                     to_string(code.check), code.sequence_bits, code.beat.width, code.beat.polynomial,
                     code.distance, code.latency));
  if (const DeviceCut& boards = plan.arch.boards; boards.several())
    line("devices", fmt::format("{} of up to {} nodes; links between them: {} cycles, a beat every {}",
                                DeviceMap(plan.lattice, plan.bricks, boards).devices,
                                fmt::join(boards.nodes, " x "), boards.latency, boards.interval));
  line("filter lanes, pipes",
       plan.arch.narrow_memories
           ? "1, 1, narrow memories"
           : fmt::format("{}, {}, queue of {}{}", plan.arch.filter_lanes, plan.arch.force_pipes,
                         plan.arch.queue_depth,
                         plan.arch.halos == Halos::arrival
                             ? fmt::format(", {} streamer{}, halos used on arrival", plan.arch.streamers,
                                           plan.arch.streamers == 1 ? "" : "s")
                         : plan.arch.overlap ? ", force overlaps the exchange"
                                             : ""));
  if (plan.program == nullptr)
    line("latency",
         fmt::format("pipe {}, update {} cycles{}", plan.latency.pipe, plan.latency.update,
                     plan.latency.interval > 1 ? fmt::format(", a pair every {}", plan.latency.interval)
                                               : std::string()));
  std::string out;
  if (plan.program != nullptr) return text;
  for (const auto& [used, name] : {std::pair{r.damped, "damping"}, std::pair{r.scaled, "pair scales"},
                                   std::pair{r.pd, "force-held types"}, std::pair{r.weighted, "masses"},
                                   std::pair{r.type_bits > 0, "types"}, std::pair{r.axes == 3, "third axis"}})
    if (!used) out += (out.empty() ? "" : ", ") + std::string(name);
  line("left out, as unused", out.empty() ? "nothing" : out);
  return text;
}

}  // namespace cuboct
