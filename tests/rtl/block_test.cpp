// SPDX-License-Identifier: MIT
// The arithmetic of a node by itself: cuboct_pipe, cuboct_pair_table and cuboct_update, Verilated, driven
// every cycle and compared, stage by stage and port by port, with model/contract/fixed_rule.h.
#include <dlfcn.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>

#include "emu/verilated/compile.h"
#include "emu/verilated/sources.h"
#include "hw/rtl/rtl_emit.h"
#include "model/base/fixed_math.h"
#include "model/base/output.h"
#include "model/contract/law.h"
#include "tests/rtl/block_lanes.h"
#include "tests/rtl/block_stimuli.h"
#include "tests/support/block.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

using InLanes = std::array<uint64_t, in::count>;
using OutLanes = std::array<uint64_t, out::count>;

// --- Plans -------------------------------------------------------------------------------------------------

// One type, undamped, a uniform table of lines; the cutoff inside the cell.
Plan plain() {
  Arch arch;
  arch.cell_edge = 1.72;
  arch.widths.sum_bits = 24;
  arch.widths.velocity_bits = 28;
  arch.table = {.shape = TableChoice::Shape::uniform, .degree = 1, .index_bits = 9};
  return make_setup(block_scene({}), arch).plan;
}

Scene rich_scene() {
  Scene scene = block_scene({.damping = 40, .two_materials = true, .force_held = true, .gravity = true});
  scene.rule.other_laws = {std::make_shared<BondLaw>(0.6, 1.3), std::make_shared<BondLaw>(0.8, 1.45)};
  scene.rule.law_index = {{0, 2}, {2, 1}};
  scene.rule.contact = {{0, 1}, {1, 0}};
  scene.rule.contact_distance = push_end(*scene.rule.law);
  scene.rule.masses = {1, 2.7};
  auto& types = scene.rule.types;
  types[0].imposed = {true, false, true};
  types[0].velocity = Vec3(0.02, 0, -0.01);
  types.push_back({.name = "both",
                   .material = 1,
                   .imposed = {false, true, false},
                   .velocity = Vec3(0.005, 0.01, 0),
                   .gravity = Vec3(1e-3, -2e-3, 3e-3),
                   .pd = true,
                   .kp = 2.5,
                   .kd = 0.4});
  return scene;
}

// Every feature, narrow formats, tables of parabolas by octaves.
Plan rich() {
  Arch arch;
  arch.cell_edge = 1.85;
  arch.widths.velocity_bits = 27;
  arch.widths.relative_velocity_bits = 17;
  arch.widths.sum_bits = 24;
  arch.widths.displacement_bits = 28;
  arch.widths.strength_bits = 22;  // more, for the weakest law, would leave no half of c2 t to meet
  arch.table = {.shape = TableChoice::Shape::octaves, .degree = 2, .index_bits = 7};
  return make_setup(rich_scene(), arch).plan;
}

// Damped, scaled and weighted, uniform tables of parabolas, the cutoff at the cell's edge.
Plan mixed() {
  Arch arch;
  arch.widths.sum_bits = 24;
  arch.widths.velocity_bits = 28;
  arch.table = {.shape = TableChoice::Shape::uniform, .degree = 2, .index_bits = 6};
  return make_setup(block_scene({.damping = 40, .two_materials = true, .masses = true, .held = true}), arch)
      .plan;
}

Plan plan_of(const std::string& name) {
  return name == "plain" ? plain() : name == "rich" ? rich() : mixed();
}

// As cuboct_node_core derives it: kicks of so many bits, 27 nodes full of them.
int exact_sum_bits(const Plan& plan) {
  const FixedRule& r = plan.rule;
  int64_t largest = 0;
  for (uint64_t bin = 0; bin < r.force.c0.size(); ++bin)
    largest = std::max<int64_t>(largest, std::abs(int64_t{r.force.c0[bin]}));
  int s = r.widths.strength_bits;
  if (!r.damped)
    for (s = 1; !fits(largest, s) || !fits(-largest, s);) ++s;
  const int kick = s + r.widths.difference_frac + 1 - r.kick_shift;
  int bits = kick;
  for (int64_t n = 1; n < 27 * plan.arch.capacity; n *= 2) ++bits;
  return bits;
}

// --- The compiled blocks -----------------------------------------------------------------------------------

// In a file of rtl/: `from`, once, becomes `to`.
struct Edit {
  std::string file, from, to;
};

class Blocks {
 public:
  explicit Blocks(const Plan& plan, const std::vector<Edit>& edits = {}) {
    emu::Build build;
    build.top = "cuboct_blocks";
    build.verilator_flags = "--cc";
    build.compiler_flags = "-O0";
    for (const auto& source : emu::shim_sources())
      if (source.first.ends_with(".h")) build.sources.push_back(source);
    build.sources.emplace_back("block_shim.cpp", read_text(CUBOCT_SOURCE_DIR "/tests/rtl/block_shim.cpp"));
    build.emit = [&](const std::string& dir) {
      emit_node(plan, dir);
      std::ofstream(fs::path(dir) / "rtl/cuboct_blocks.sv") << print_blocks(plan);
      std::ofstream(fs::path(dir) / "files.f", std::ios::app) << "rtl/cuboct_blocks.sv\n";
      for (const Edit& e : edits) {
        const fs::path path = fs::path(dir) / "rtl" / e.file;
        std::string text = read_text(path);
        const size_t at = text.find(e.from);
        if (at == std::string::npos || text.find(e.from, at + 1) != std::string::npos)
          throw std::logic_error("not once in " + e.file + ": " + e.from);
        std::ofstream(path) << text.replace(at, e.from.size(), e.to);
      }
    };
    handle_ = dlopen(emu::compile(build, CUBOCT_TEST_CACHE).c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle_ == nullptr) throw std::runtime_error(dlerror());
    const auto find = [this](const char* name) { return dlsym(handle_, name); };
    clock_ = reinterpret_cast<decltype(clock_)>(find("blocks_clock"));
    destroy_ = reinterpret_cast<decltype(destroy_)>(find("blocks_destroy"));
    model_ = reinterpret_cast<void* (*)()>(find("blocks_create"))();
  }
  ~Blocks() {
    destroy_(model_);
    dlclose(handle_);
  }
  Blocks(const Blocks&) = delete;
  Blocks& operator=(const Blocks&) = delete;

  OutLanes clock(bool reset_n, const InLanes& lanes) {
    OutLanes shown{};
    clock_(model_, reset_n, lanes.data(), shown.data());
    return shown;
  }

 private:
  void* handle_ = nullptr;
  void* model_ = nullptr;
  void (*clock_)(void*, bool, const uint64_t*, uint64_t*) = nullptr;
  void (*destroy_)(void*) = nullptr;
};

// --- Drive and compare -------------------------------------------------------------------------------------

constexpr size_t kNothing = ~size_t{0};
using Schedule = std::vector<size_t>;  // by cycle: which stimulus, or nothing

Schedule every_cycle(size_t n) {
  Schedule s(n);
  for (size_t k = 0; k < n; ++k) s[k] = k;
  return s;
}

// The first `n`, with pauses of random length.
Schedule with_pauses(size_t n, uint64_t seed) {
  std::mt19937_64 random(seed);
  Schedule s;
  for (size_t k = 0; k < n;)
    if (random() % 8 < 5)
      s.push_back(k++);
    else
      s.push_back(kNothing);
  return s;
}

struct Stimuli {
  PairStimuli pairs;
  UpdateStimuli updates;
  std::vector<uint64_t> force, damp;  // r2 for the tables alone
};

Stimuli stimuli_for(const Plan& plan, uint64_t seed) {
  return {pair_stimuli(plan.rule, seed), update_stimuli(plan.rule, exact_sum_bits(plan), seed + 1),
          table_stimuli(plan.rule.force, seed + 2),
          plan.rule.damped ? table_stimuli(plan.rule.damp, seed + 3) : std::vector<uint64_t>{}};
}

struct Outcome {
  uint64_t pairs = 0, kicks = 0, pair_faults = 0, updates = 0, update_faults = 0, values = 0;
  std::string difference;  // the first of each block, one per line; empty where all is equal
};

uint64_t slot_of(size_t k) { return k * 7 % (1u << kSlotBits); }

// Bits that nobody may read.
uint64_t noise(uint64_t& state) {
  state = state * 6364136223846793005u + 1442695040888963407u;
  return state ^ state >> 29;
}

std::vector<OutLanes> drive(Blocks& blocks, const Stimuli& s, const std::vector<uint64_t>& r2,
                            const Schedule& pairs, const Schedule& updates, size_t tail) {
  std::vector<OutLanes> trace;
  uint64_t state = 1;
  for (int k = 0; k < 3; ++k) blocks.clock(false, {});
  const size_t cycles = std::max({pairs.size(), updates.size(), r2.size()}) + tail;
  for (size_t c = 0; c < cycles; ++c) {
    InLanes lanes;
    for (uint64_t& lane : lanes) lane = noise(state);
    const auto put = [&lanes](int lane, const Int3& value) {
      for (size_t a = 0; a < 3; ++a) lanes[static_cast<size_t>(lane) + a] = static_cast<uint64_t>(value[a]);
    };
    lanes[in::pipe_valid] = c < pairs.size() && pairs[c] != kNothing;
    if (lanes[in::pipe_valid]) {
      const PairStimulus& p = s.pairs.list[pairs[c]];
      lanes[in::pipe_slot] = slot_of(pairs[c]);
      put(in::own_x, p.x_i), put(in::own_v, p.v_i), put(in::other_x, p.x_j), put(in::other_v, p.v_j);
      lanes[in::own_type] = static_cast<uint64_t>(p.type_i);
      lanes[in::other_type] = static_cast<uint64_t>(p.type_j);
    }
    lanes[in::update_valid] = c < updates.size() && updates[c] != kNothing;
    if (lanes[in::update_valid]) {
      const UpdateStimulus& u = s.updates.list[updates[c]];
      lanes[in::update_slot] = slot_of(updates[c]);
      lanes[in::id] = updates[c];
      put(in::sum, u.sum), put(in::x, u.seen), put(in::residue, u.x), put(in::v, u.v), put(in::u, u.u);
      lanes[in::type] = static_cast<uint64_t>(u.type);
    }
    if (c < r2.size()) lanes[in::r2] = r2[c];
    trace.push_back(blocks.clock(true, lanes));
  }
  return trace;
}

class Comparison {
 public:
  Comparison(const std::vector<OutLanes>& trace, std::string& difference) : trace_(trace), out_(difference) {}
  // Whether lane `lane` is `expected` in `cycle`; notes the first that is not.
  bool lane(const std::string& what, const std::string& field, size_t cycle, int lane, int64_t expected) {
    const auto got = static_cast<int64_t>(trace_[cycle][static_cast<size_t>(lane)]);
    if (got == expected) return true;
    if (!told_)
      out_ += fmt::format("{} is {} in cycle {}, the model has {}: {}\n", field, got, cycle, expected, what);
    told_ = true;
    return false;
  }
  void axes(const std::string& what, const std::string& field, size_t cycle, int first,
            const Int3& expected) {
    for (int a = 0; a < 3; ++a)
      lane(what, fmt::format("{}.{}", field, "xyz"[a]), cycle, first + a, expected[static_cast<size_t>(a)]);
  }

 private:
  const std::vector<OutLanes>& trace_;
  std::string& out_;
  bool told_ = false;
};

void compare_pairs(const Plan& plan, const Stimuli& s, const Schedule& schedule,
                   const std::vector<OutLanes>& trace, Outcome& outcome) {
  const FixedRule& rule = plan.rule;
  // A kick is at the pipe's outputs in the cycle before it is in the sum.
  const int last = plan.latency.pipe - 1, strength = last - 2, damped = strength - (rule.scaled ? 2 : 0),
            force = damped - (rule.damped ? 2 : 0);
  Comparison compare(trace, outcome.difference);
  const auto given = [&](size_t c) { return c < schedule.size() && schedule[c] != kNothing; };
  for (size_t c = 0; c + static_cast<size_t>(last) < trace.size(); ++c) {
    const auto at = [c](int stage) { return c + static_cast<size_t>(stage); };
    bool busy = false;
    for (size_t k = 1; k <= static_cast<size_t>(last) && k <= c; ++k) busy = busy || given(c - k);
    const std::string place = given(c) ? fmt::format("pair {}", schedule[c]) : "no pair";
    compare.lane(place, "pipe: busy", c, out::pipe_busy, busy);
    if (!given(c)) {
      compare.lane(place, "pipe: valid", at(last), out::pipe_valid, 0);
      continue;
    }
    const PairStimulus& p = s.pairs.list[schedule[c]];
    ++outcome.pairs;
    compare.axes(place, "pipe: stage 2, d", at(2), out::d, p.d);
    compare.lane(place, "pipe: stage 4, r2", at(4), out::r2, static_cast<int64_t>(p.r2));
    if (p.result.inside) {
      const auto stage = [&](int k, const char* name, int lane, int64_t value) {
        compare.lane(place, fmt::format("pipe: stage {}, {}", k, name), at(k), lane, value);
      };
      if (rule.damped) stage(5, "q", out::q, p.q);
      stage(force, "force", out::force, p.force);
      stage(damped, "s after damping", out::damped, p.damped);
      stage(strength, "s", out::s, p.s);
    }
    compare.lane(place, "pipe: valid", at(last), out::pipe_valid, p.result.inside);
    if (!p.result.inside) continue;
    ++outcome.kicks;
    compare.lane(place, "pipe: slot", at(last), out::pipe_slot, static_cast<int64_t>(slot_of(schedule[c])));
    compare.axes(place, fmt::format("pipe: stage {}, kick", last), at(last), out::kick, p.result.kick);
    const bool fault = p.result.fault != Fault::none;
    compare.lane(place, "pipe: fault", at(last), out::pipe_fault, fault);
    if (!fault) continue;
    ++outcome.pair_faults;
    compare.lane(place, "pipe: fault is of s", at(last), out::pipe_strength,
                 p.result.fault == Fault::strength);
    compare.lane(place, "pipe: fault number", at(last), out::pipe_number, p.result.number);
  }
}

void compare_updates(const Plan& plan, const Stimuli& s, const Schedule& schedule,
                     const std::vector<OutLanes>& trace, Outcome& outcome) {
  // UPDATE ends a cycle after the last particle is written, which is a cycle after it is at the outputs. With
  // types held by force a fault is told a cycle later than the particle is there.
  const auto last = static_cast<size_t>(plan.latency.update - 2);
  const size_t told = last + (plan.rule.pd ? 1 : 0);
  const Widths& w = plan.rule.widths;
  const int64_t cell = int64_t{1} << w.velocity_frac(), below = int64_t{1} << w.guard;
  Comparison compare(trace, outcome.difference);
  for (size_t c = 0; c + told < trace.size(); ++c) {
    if (c >= schedule.size() || schedule[c] == kNothing) {
      compare.lane("no particle", "update: valid", c + last, out::update_valid, 0);
      compare.lane("no particle", "update: fault", c + told, out::fault, 0);
      continue;
    }
    const size_t k = schedule[c], at = c + last;
    const UpdateStimulus& u = s.updates.list[k];
    const std::string place = fmt::format("particle {}", k);
    ++outcome.updates;
    compare.lane(place, "update: valid", at, out::update_valid, 1);
    compare.lane(place, "update: slot", at, out::update_slot, static_cast<int64_t>(slot_of(k)));
    const int64_t id = static_cast<int64_t>(k) & ((int64_t{1} << plan.words.id_bits) - 1);
    compare.lane(place, "update: id", at, out::id, id);
    compare.lane(place, "update: type", at, out::type, u.type);
    Int3 x = u.result.x, residue{}, away{};
    for (size_t a = 0; a < 3; ++a) {
      away[a] = x[a] < 0 ? -1 : x[a] >= cell ? 1 : 0;
      x[a] -= away[a] * cell;
      residue[a] = x[a] % below;
      x[a] /= below;
    }
    compare.axes(place, "update: v", at, out::v, u.result.v);
    compare.axes(place, "update: x", at, out::x, x);
    compare.axes(place, "update: residue", at, out::residue, residue);
    compare.axes(place, "update: away", at, out::away, away);
    if (plan.rule.pd) compare.axes(place, "update: u", at, out::u, u.result.u);
    const bool fault = u.result.fault != Fault::none;
    compare.lane(place, "update: fault", c + told, out::fault, fault);
    if (!fault) continue;
    ++outcome.update_faults;
    compare.lane(place, "update: fault code", c + told, out::code, static_cast<int64_t>(u.result.fault));
    compare.lane(place, "update: fault id", c + told, out::fault_id, id);
    compare.lane(place, "update: fault number", c + told, out::number, u.result.number);
  }
}

void compare_table(const char* name, const FixedTable& table, int lane, const std::vector<uint64_t>& r2,
                   const std::vector<OutLanes>& trace, Outcome& outcome) {
  const size_t latency = 4 + (table.shape == TableShape::octaves ? 1 : 0) + (table.degree == 2 ? 2 : 0);
  Comparison compare(trace, outcome.difference);
  for (size_t c = 0; c < r2.size(); ++c, ++outcome.values)
    compare.lane(fmt::format("r2 = {}", r2[c]),
                 fmt::format("{} table: entry {}", name, table.address(r2[c]).index), c + latency, lane,
                 table.at(r2[c]));
}

Outcome run(const Plan& plan, Blocks& blocks, const Stimuli& s, const Schedule& pairs,
            const Schedule& updates) {
  Outcome outcome;
  const size_t tail = static_cast<size_t>(plan.latency.pipe) + 4;
  const auto trace = drive(blocks, s, s.force, pairs, updates, tail);
  compare_table("force", plan.rule.force, out::force_table, s.force, trace, outcome);
  compare_pairs(plan, s, pairs, trace, outcome);
  compare_updates(plan, s, updates, trace, outcome);
  if (plan.rule.damped)
    compare_table("damping", plan.rule.damp, out::damp_table, s.damp, drive(blocks, s, s.damp, {}, {}, tail),
                  outcome);
  return outcome;
}

// --- Tests -------------------------------------------------------------------------------------------------

class RtlBlocks : public testing::TestWithParam<std::string> {};

// One stimulus per cycle, then with pauses.
TEST_P(RtlBlocks, EqualTheModel) {
  const Plan plan = plan_of(GetParam());
  const Stimuli s = stimuli_for(plan, 11);
  ASSERT_GT(exact_sum_bits(plan), plan.rule.widths.sum_bits);
  for (const auto& [name, n] : s.pairs.count) EXPECT_GT(n, 0u) << name;
  for (const auto& [name, n] : s.updates.count) EXPECT_GT(n, 0u) << name;
  for (size_t k = 0; k < s.pairs.force_bins.size(); ++k)
    EXPECT_GT(s.pairs.force_bins[k], 0u) << "force entry " << k;
  for (size_t k = 0; k < s.pairs.damp_bins.size(); ++k)
    EXPECT_GT(s.pairs.damp_bins[k], 0u) << "damping entry " << k;
  const auto inside = static_cast<uint64_t>(
      std::count_if(s.pairs.list.begin(), s.pairs.list.end(), [](const auto& p) { return p.result.inside; }));

  Blocks blocks(plan);
  const Outcome full =
      run(plan, blocks, s, every_cycle(s.pairs.list.size()), every_cycle(s.updates.list.size()));
  EXPECT_EQ(full.difference, "");
  EXPECT_GT(full.pairs, 5000u);
  EXPECT_EQ(full.pairs, s.pairs.list.size());
  EXPECT_EQ(full.kicks, inside);
  EXPECT_EQ(full.pair_faults > 0, plan.rule.damped);
  EXPECT_GT(full.updates, 5000u);
  EXPECT_EQ(full.updates, s.updates.list.size());
  EXPECT_GT(full.update_faults, 0u);
  EXPECT_EQ(full.values, s.force.size() + s.damp.size());

  const Outcome paused = run(plan, blocks, s, with_pauses(5000, 3), with_pauses(5000, 4));
  EXPECT_EQ(paused.difference, "");
  EXPECT_EQ(paused.pairs, 5000u);
  EXPECT_EQ(paused.updates, 5000u);
  RecordProperty("pairs", static_cast<int>(full.pairs));
  RecordProperty("updates", static_cast<int>(full.updates));
  fmt::print("{}: {} pairs ({} kicks, {} faults), {} updates ({} faults), {} table values\n", GetParam(),
             full.pairs, full.kicks, full.pair_faults, full.updates, full.update_faults, full.values);
}

INSTANTIATE_TEST_SUITE_P(Plans, RtlBlocks, testing::Values("plain", "rich", "mixed"),
                         [](const auto& p) { return p.param; });

// Both edges of the cutoff exist as sums of three squares in the first two plans, so both were driven there.
TEST(RtlBlocksPlans, HaveBothEdgesOfTheCutoff) {
  for (const Plan& plan : {plain(), rich()}) {
    EXPECT_TRUE(three_squares(plan.rule.cutoff2)) << plan.rule.cutoff2;
    EXPECT_TRUE(three_squares(plan.rule.cutoff2 - 1)) << plan.rule.cutoff2;
  }
}

// A defect in the RTL must be seen, at its place.
struct Mutation {
  std::string name, plan;
  std::vector<Edit> edits;
  std::string tells;  // how the first difference begins; one of them, where several blocks tell
  friend void PrintTo(const Mutation& m, std::ostream* out) { *out << m.name; }
};

// Round down where the RTL rounds to nearest.
Edit truncate(const std::string& file, const std::string& parameters, const std::string& instance) {
  const std::string from = "cuboct_round_odd #(" + parameters + ") " + instance + " (";
  return {file, from, "cuboct_round_down #(" + parameters + ") " + instance + " ("};
}
const Edit kRoundDown{
    "cuboct_resize.sv", "// SPDX-License-Identifier: MIT\n",
    "module cuboct_round_down #(\n"
    "  parameter int InBits = 8, parameter int Shift = 1, parameter int OutBits = 8\n"
    ") (\n"
    "  input  logic signed [InBits-1:0]  a_i,\n"
    "  output logic signed [OutBits-1:0] y_o\n"
    ");\n"
    "  logic signed [InBits-1:0] down;\n"
    "  assign down = a_i >>> Shift;\n"
    "  cuboct_resize #(.InBits(InBits), .OutBits(OutBits)) u_resize (.a_i(down), .y_o(y_o));\n"
    "endmodule\n"};

std::vector<Mutation> mutations() {
  const Plan p = plain();
  const int e = p.rule.widths.strength_bits;
  const auto word = [&](int32_t c) {
    return fmt::format("{}'h{:x}", e, static_cast<uint32_t>(c) & ((1u << e) - 1));
  };
  const std::string line = fmt::format("mem[100] = {{{}, ", word(p.rule.force.c1[100]));
  return {
      {"table_word",
       "plain",
       {{"cuboct_force_rom.sv", line + word(p.rule.force.c0[100]), line + word(p.rule.force.c0[100] ^ 1)}},
       "force table: entry 100 is "},
      {"kick_truncated",
       "plain",
       {kRoundDown, truncate("cuboct_pipe.sv",
                             ".InBits(SBits + DBits), .Shift(KickShift), .OutBits(KickBits)", "u_round")},
       "pipe: stage 10, kick."},
      {"q_truncated",
       "rich",
       {kRoundDown, truncate("cuboct_pipe.sv",
                             ".InBits(WdBits + 2), .Shift(QShift), .OutBits(RelativeVelocityBits)", "u_q")},
       "pipe: stage 5, q is "},
      {"pull_truncated",
       "rich",
       {{"cuboct_update.sv", "carry = pull_sum_q[GainFrac-1] &&",
         "carry = 1'b0 && pull_sum_q[GainFrac-1] &&"}},
       "update: v."},
      {"drift_truncated",
       "plain",
       {{"cuboct_update.sv", "residue_last[a*Guard +: Guard]}) + drift;",
         "residue_last[a*Guard +: Guard]}) + $signed({drift[MovedBits-1:Guard], {Guard{1'b0}}});"}},
       "update: x."},
      {"residue_stays",
       "rich",
       {{"cuboct_update.sv", "= moved[Guard-1:0];", "= residue_last[a*Guard +: Guard];"}},
       "update: residue."},
      {"negative_half",
       "plain",
       {{"cuboct_round_odd.sv", "(!full[FullBits-1] || rest)",
         "(!full[FullBits-1] || full[FullBits-1] || rest)"}},
       "pipe: stage 2, d."},
      {"every_second_pair",
       "plain",
       {{"cuboct_pipe.sv", "{valid_q[Stages-1:1], valid_i}",
         "{valid_q[Stages-1:1], valid_i && !valid_q[1]}"}},
       "pipe: stage 2, d."},
      {"cutoff_included",
       "plain",
       {{"cuboct_pipe.sv", "(r2_q < reach2", "(r2_q <= reach2"}},
       "pipe: valid is 1"},
      {"contact_as_cutoff",
       "rich",
       {{"cuboct_pipe.sv", "touch ? Contact2", "touch ? Cutoff2"}},
       "pipe: valid is 1"},
      {"masses_alike",
       "mixed",
       {{"cuboct_update.sv", "weight_1 = $signed(weight)", "weight_1 = $signed(18'h10000)"}},
       "update: v."},
      {"weighed_sum_rounded_down",
       "mixed",
       {{"cuboct_update.sv", ".a_i(product), .y_o(dv_2)",
         ".a_i({product[ProductBits-1:1], 1'b1}), .y_o(dv_2)"}},
       "update: v."},
      {"weighed_a_cycle_late",
       "rich",
       {{"cuboct_update.sv", "Delay * (VStage - 1 - Kick)", "Delay * (VStage - Kick)"}},
       "update: v."},
      {"all_only_touch",
       "rich",
       {{"cuboct_pipe.sv", "touch ? Contact2", "1'b1 ? Contact2"}},
       "pipe: stage 13, s after damping"},
      {"law_of_the_first",
       "rich",
       {{"cuboct_pipe.sv", "assign address = {law, index}", "assign address = {{LawWidth{1'b0}}, index}"}},
       "pipe: stage 11, force"},
  };
}

class RtlBlocksMutation : public testing::TestWithParam<Mutation> {};

TEST_P(RtlBlocksMutation, IsSeenAtItsPlace) {
  const Mutation& m = GetParam();
  const Plan plan = plan_of(m.plan);
  const Stimuli s = stimuli_for(plan, 11);
  Blocks blocks(plan, m.edits);
  const Outcome outcome =
      run(plan, blocks, s, every_cycle(s.pairs.list.size()), every_cycle(s.updates.list.size()));
  EXPECT_NE(("\n" + outcome.difference).find("\n" + m.tells), std::string::npos) << outcome.difference;
}

INSTANTIATE_TEST_SUITE_P(Defects, RtlBlocksMutation, testing::ValuesIn(mutations()),
                         [](const auto& p) { return p.param.name; });

}  // namespace
}  // namespace cuboct::test
