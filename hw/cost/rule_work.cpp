// SPDX-License-Identifier: MIT
#include "hw/cost/rule_work.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "hw/pipeline/print.h"
#include "hw/pipeline/resources.h"
#include "hw/pipeline/sum_bits.h"
#include "model/base/integer_math.h"
#include "model/program/integer_program.h"

namespace cuboct {
namespace {

// Transistors of a choice of one of two bits over those of an adder's bit: 12 and 28, of static gates.
constexpr double kChoice = 12.0 / 28;

// A graph as hardware.
struct Built {
  pipeline::Schedule schedule;
  pipeline::Resources resources;
  double inputs = 0;  // bits
};

Built built(const graph::Graph& graph, const std::vector<int>& outputs) {
  Built b{pipeline::schedule_of(graph, outputs), {}};
  b.resources = pipeline::resources_of(graph, b.schedule);
  for (const pipeline::Port& port : b.schedule.steps.inputs)
    b.inputs += b.schedule.steps.steps[static_cast<size_t>(port.step)].bits;
  return b;
}

// A pipeline and the registers of its inputs.
void add(Work& work, const Built& of) {
  const pipeline::Resources& r = of.resources;
  for (const pipeline::Factors& f : r.products) work.products.push_back({f.a, f.b, 1});
  work.adder_bits += static_cast<double>(r.adder_bits) + kChoice * static_cast<double>(r.choice_bits);
  for (const pipeline::Rom& rom : r.roms)
    work.tables.push_back({static_cast<uint64_t>(rom.words), rom.bits, 1});
  work.register_bits += static_cast<double>(r.register_bits) + of.inputs;
}

struct Rounds {
  explicit Rounds(const Plan& of) : plan(of), program(of.program->program) {
    for (const graph::Round& round : program.rounds) {
      pairs.push_back(built(round.pair, pipeline::pair_pipeline(round).nodes));
      finishes.push_back(built(round.finish, pipeline::finish_pipeline(program, round).nodes));
    }
    for (const PlanRound& round : of.rounds) sending += round.beats > 0;
  }

  int slot_bits() const { return std::max(1, ceil_log2(static_cast<uint64_t>(plan.arch.capacity))); }
  int own_bits() const { return plan.words.particle_bits + 2; }  // and where it goes along x
  // What a candidate is: as RuleWords (hw/rtl/rule_words.h) has it.
  int candidate_bits() const {
    int bits = plan.rule.axes * (plan.rule.widths.position_frac + 2);
    for (const PlanRound& round : plan.rounds)
      for (const WordField& f : round.record)
        if (f.kind != FieldKind::position) bits += f.bits;
    return bits;
  }
  // Of an own particle: what others or its pairs see.
  int seen_bits() const {
    if (plan.words.bonds > 0) return plan.words.particle_bits;
    const auto id = std::ranges::find(plan.words.particle, FieldKind::id, &WordField::kind);
    return id->lsb + id->bits;
  }
  // Bits of a bond's kind and numbers.
  int bond_bits() const {
    int bits = 0;
    for (const WordField& f : plan.words.particle)
      if (f.place == 0 && f.kind != FieldKind::bond_other) bits += f.bits;
    return bits;
  }
  // Of a pipe's sum, all components.
  int bits_of_sum(size_t k, int sum) const {
    const graph::Round& round = program.rounds[k];
    return pipeline::sum_bits(program, round, pairs[k].schedule, sum) *
           static_cast<int>(round.sums[static_cast<size_t>(sum)].terms.size());
  }
  int sums(size_t k) const { return static_cast<int>(program.rounds[k].sums.size()); }

  const Plan& plan;
  const graph::FixedProgram& program;
  std::vector<Built> pairs, finishes;
  unsigned sending = 0;  // rounds that send anything
};

Work pair_of(const Rounds& rounds, size_t k) {
  const Plan& plan = rounds.plan;
  const int cycles = rounds.pairs[k].resources.cycles, bonds = plan.words.bonds;
  Work work;
  add(work, rounds.pairs[k]);
  // Differences of positions; sums. The candidate and the slot wait, and the pair's age.
  work.adder_bits += plan.rule.axes * (plan.rule.widths.position_frac + 3);
  for (int s = 0; s < rounds.sums(k); ++s) work.adder_bits += rounds.bits_of_sum(k, s);
  work.register_bits += rounds.candidate_bits() + (cycles + 1) * (rounds.slot_bits() + 1);
  // Each place of the row against the candidate's id; its kind and numbers are chosen, and wait.
  work.adder_bits += bonds * (plan.words.id_bits + kChoice * rounds.bond_bits());
  if (bonds > 0) work.register_bits += (cycles + 1) * (bonds + rounds.bond_bits());
  return work;
}

Work finish_of(const Rounds& rounds, size_t k) {
  const Plan& plan = rounds.plan;
  const Built& of = rounds.finishes[k];
  Work work;
  add(work, of);
  if (k + 1 == plan.rounds.size())
    work.adder_bits += plan.rule.axes * (plan.rule.widths.position_frac + plan.rule.widths.guard + 2);
  double total = 0;
  for (int s = 0; s < rounds.sums(k); ++s) total += rounds.bits_of_sum(k, s);
  work.adder_bits += (plan.arch.force_pipes - 1) * total;
  work.register_bits += total + rounds.own_bits() + (of.resources.cycles + 2) * rounds.slot_bits();
  if (plan.words.bonds == 0) return work;
  // Whether the bonds that were not met lead elsewhere, and count.
  work.adder_bits += plan.words.bonds * plan.words.id_bits;
  work.register_bits += plan.words.bonds;
  if (rounds.program.broken_at >= 0) {
    const Built broken = built(rounds.program.broken, {rounds.program.broken_at});
    Work one;
    add(one, broken);
    work.adder_bits += plan.words.bonds * one.adder_bits;
    work.register_bits += plan.words.bonds * one.register_bits + broken.resources.cycles * rounds.own_bits();
  }
  return work;
}

Work& operator+=(Work& sum, const Work& more) {
  sum.products.insert(sum.products.end(), more.products.begin(), more.products.end());
  sum.tables.insert(sum.tables.end(), more.tables.begin(), more.tables.end());
  sum.adder_bits += more.adder_bits;
  sum.register_bits += more.register_bits;
  return sum;
}

}  // namespace

DatapathWork rule_work(const Plan& plan) {
  const Rounds rounds(plan);
  DatapathWork work;
  for (size_t k = 0; k < plan.rounds.size(); ++k) {
    work.pair += pair_of(rounds, k);
    work.update += finish_of(rounds, k);
  }
  if (plan.words.bonds > 0) work.lane.adder_bits = plan.words.bonds * plan.words.id_bits;
  return work;
}

double bond_register_bits(const Plan& plan) {
  int numbers = 0;
  for (const WordField& f : plan.words.particle)
    if (f.place == 0 && f.kind == FieldKind::bond_field) numbers += f.bits;
  return static_cast<double>(plan.arch.capacity) * plan.words.bonds * (1 + numbers);
}

namespace {

struct Memory {
  NodeMemory node;
  uint64_t reads = 0, writes = 0;
};

std::vector<Memory> memories_of(const Plan& plan, const MachineEvents& e) {
  using Kind = NodeMemory::Kind;
  const Rounds rounds(plan);
  const Arch& arch = plan.arch;
  const auto capacity = static_cast<uint64_t>(arch.capacity), pipes = static_cast<uint64_t>(arch.force_pipes),
             count = static_cast<uint64_t>(plan.rounds.size());
  const int axes = plan.rule.axes, seen = rounds.seen_bits();
  const uint64_t written = e.updates + e.scanned - e.left + e.moved;
  const uint64_t own_met = e.candidates - e.candidates_x - e.candidates_y - e.candidates_z;
  const uint64_t pairs = e.pairs / count, updates = e.updates / count;  // of each round
  std::vector<Memory> all;
  const auto put = [&](Kind kind, std::string holds, uint64_t words, int bits, int copies, uint64_t reads,
                       uint64_t writes) {
    all.push_back({{std::move(holds), words, bits, copies, kind}, reads, writes});
  };
  // cuboct_ram asks for a block above 16 words.
  const auto ram = [&](std::string holds, uint64_t words, int bits, int copies, uint64_t reads,
                       uint64_t writes) {
    put(words > 16 ? Kind::block : Kind::late, std::move(holds), words, bits, copies, reads, writes);
  };
  ram("own particles", capacity, rounds.own_bits(), 1, e.relayed_own + e.updates + e.scanned, written);
  ram("own particles, for the streamer", capacity, seen, 1, own_met, written);
  ram("own particles, for the pipes", capacity, seen, arch.force_pipes, e.pairs, written * pipes);
  ram("ids, for the pipes' faults", capacity, plan.words.id_bits, arch.force_pipes, e.pairs, written * pipes);
  const int rows = ceil_div(arch.capacity, arch.filter_lanes);
  put(Kind::prompt, "queue", static_cast<uint64_t>(arch.queue_depth),
      rounds.candidate_bits() + std::max(1, ceil_log2(static_cast<uint64_t>(rows))) + arch.filter_lanes +
          arch.force_pipes * (1 + rounds.slot_bits()),
      1, e.entries, e.entries);
  for (size_t k = 0; k < plan.rounds.size(); ++k) {
    for (int s = 0; s < rounds.sums(k); ++s)
      put(Kind::prompt, fmt::format("sum {} of round {}", s + 1, k + 1), capacity, rounds.bits_of_sum(k, s),
          arch.force_pipes, pairs + updates * pipes, pairs);
    const int waits = rounds.finishes[k].resources.cycles + 1;
    if (waits >= 2)
      put(Kind::late, fmt::format("particles in the finish of round {}", k + 1),
          std::bit_ceil(static_cast<uint64_t>(waits)), rounds.own_bits(), 1, updates, updates);
  }
  const bool moves = graph::moves(plan.program->program);
  MachineEvents along = e;
  for (int a = 0; a < axes; ++a) {
    const uint64_t depth = (a == 0 ? 1u : a == 1 ? 3u : 9u) * capacity;
    const uint64_t met = candidates_along(along, a), came = halos_along(along, a) / rounds.sending;
    const auto later = static_cast<uint64_t>(axes - 1 - a);
    for (size_t k = 0; k < plan.rounds.size(); ++k) {
      if (plan.rounds[k].beats == 0) continue;
      const int bits = k == 0 ? plan.words.halo_bits : bits_of(plan.rounds[k].record);
      const std::string of = k == 0 ? "halos" : fmt::format("numbers of round {}", k + 1);
      ram(of + " from a face", depth, bits, 2, met * (count - k) / count, came);
      if (later > 0) ram(of + ", for the relay", depth, bits, 2, came * later, came);
    }
    // Which axis a particle came along no event tells: it is told of the last one.
    const uint64_t moved = a + 1 == axes ? e.moved : 0;
    if (moves) ram("particles from a face", capacity, plan.words.particle_bits, 2, moved, moved);
  }
  for (size_t k = 0; k < plan.rounds.size(); ++k) {
    for (const pipeline::Rom& rom : rounds.pairs[k].resources.roms)
      put(Kind::block, fmt::format("table of round {}", k + 1), static_cast<uint64_t>(rom.words), rom.bits,
          arch.force_pipes, pairs, 0);
    for (const pipeline::Rom& rom : rounds.finishes[k].resources.roms)
      put(Kind::block, fmt::format("table of the finish of round {}", k + 1),
          static_cast<uint64_t>(rom.words), rom.bits, 1, updates, 0);
  }
  return all;
}

}  // namespace

int received_bits(const Plan& plan) {
  int most = graph::moves(plan.program->program) ? plan.words.particle_bits : 1;
  for (const PlanRound& round : plan.rounds) most = std::max(most, bits_of(round.record));
  return most;
}

std::vector<NodeMemory> rule_memories(const Plan& plan) {
  std::vector<NodeMemory> memories;
  for (Memory& m : memories_of(plan, {})) memories.push_back(std::move(m.node));
  return memories;
}

std::vector<MemoryTraffic> rule_traffic(const Plan& plan, const MachineEvents& events) {
  std::vector<MemoryTraffic> traffic;
  for (Memory& m : memories_of(plan, events))
    traffic.push_back(
        {std::move(m.node.holds), m.node.words, m.node.bits, m.node.copies, m.reads, m.writes, true});
  return traffic;
}

}  // namespace cuboct
