// SPDX-License-Identifier: MIT
#include "tests/backend/clocked_timing.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <random>

#include "emu/systemc/node.h"
#include "emu/timing/kicks.h"
#include "emu/timing/timing.h"
#include "tests/backend/engines.h"

namespace cuboct::test {
namespace {

// Where each particle is, by id: cell and slot.
std::map<uint32_t, std::pair<uint32_t, uint32_t>> places_of(const Golden& golden) {
  std::map<uint32_t, std::pair<uint32_t, uint32_t>> places;
  for (uint32_t n = 0; n < golden.cells().size(); ++n)
    for (uint32_t k = 0; k < golden.cells()[n].size(); ++k) places[golden.cells()[n][k].id] = {n, k};
  return places;
}

std::vector<emu::Leaving> leaving_between(const Lattice& lattice,
                                          const std::map<uint32_t, std::pair<uint32_t, uint32_t>>& before,
                                          const std::map<uint32_t, std::pair<uint32_t, uint32_t>>& after) {
  std::vector<emu::Leaving> leaving;
  for (const auto& [id, from] : before) {
    const uint32_t to = after.at(id).first;
    if (to == from.first) continue;
    emu::Leaving l{from.first, from.second, {}};
    for (size_t a = 0; a < 3; ++a) {
      int way = lattice.cell(to)[a] - lattice.cell(from.first)[a];
      if (lattice.period()[a] > 0 && std::abs(way) > 1) way = way > 0 ? -1 : 1;
      l.away[a] = static_cast<int8_t>(way);
    }
    leaving.push_back(l);
  }
  return leaving;  // by id: in no order that the model could rely on
}

void note(Seen& seen, const Plan& plan, const Golden& golden, const std::vector<emu::Leaving>& leaving) {
  const auto& arch = plan.arch;
  for (const auto& cell : golden.cells()) {
    seen.multi_pass += static_cast<int>(cell.size()) > arch.filter_lanes;
    seen.empty_cells += cell.empty();
    seen.full_cells += static_cast<int>(cell.size()) == arch.capacity;
  }
  std::map<uint32_t, uint32_t> from;
  for (const auto& l : leaving) {
    const int axes = (l.away[0] != 0) + (l.away[1] != 0) + (l.away[2] != 0);
    ++seen.leave;
    seen.leave_twice += axes == 2;
    seen.leave_thrice += axes == 3;
    seen.crowds += ++from[l.cell] == 2;
  }
  for (const auto& [cell, count] : from) seen.emptied += count == golden.cells()[cell].size();
  seen.multi_beat += plan.words.halo_beats > 1 || plan.words.migrate_beats > 1;
}

// The first event that the model counts otherwise than the clocked nodes of a run without a stop.
std::string other_events(const MachineEvents& events, const Trace& trace, bool text, Seen& seen) {
  for (const auto& [name, count] : event_names()) {
    // How many pairs of a rule of text count, golden does not tell.
    if (std::string(name) == "steps" || (text && count == &MachineEvents::kicks)) continue;
    const auto found = std::ranges::find(trace.counters, name, &std::pair<std::string, double>::first);
    if (found == trace.counters.end()) return fmt::format("no counter of {}", name);
    if (static_cast<double>(events.*count) != found->second)
      return fmt::format("{} {}, expected {}", events.*count, name, found->second);
    seen.events[name] += events.*count;
  }
  std::array<uint64_t, kPhases> cycles{};
  for (size_t k = 0; k < trace.cycles.size(); ++k)
    cycles[static_cast<size_t>(phase_at(static_cast<int>(k % trace.phases()), trace.rounds).kind)] +=
        trace.cycles[k].end + 1 - trace.cycles[k].start;
  if (cycles != events.phase_cycles) return "other cycles of phases";
  if (events.steps != trace.steps() * trace.nodes) return "other steps of nodes";
  return {};
}

void count_work(Seen& seen, const emu::TimingModel& model) {
  seen.busy += model.counters().busy;
  seen.filtered += model.counters().filtered;
  seen.walked += model.counters().walked;
}

// The most particles that a cell holds in the case's steps.
int crowd_of(const Case& c) {
  size_t most = 1;
  for (const auto& step : run_golden(c.setup, c.steps).order)
    for (const auto& cell : step) most = std::max(most, cell.size());
  return static_cast<int>(most);
}

}  // namespace

emu::CellSlots slots_of(const FixedRule& rule, const Golden& golden) {
  emu::CellSlots slots;
  for (const auto& cell : golden.cells()) {
    slots.first.push_back(static_cast<uint32_t>(slots.x[0].size()));
    for (const Particle& p : cell) {
      const Int3 x = visible(rule, p.x);
      for (size_t a = 0; a < 3; ++a) slots.x[a].push_back(static_cast<int32_t>(x[a]));
      slots.id.push_back(p.id);
    }
  }
  slots.first.push_back(static_cast<uint32_t>(slots.x[0].size()));
  return slots;
}

std::string difference(const Case& c, Seen& seen, int threads) {
  const Plan& plan = c.setup.plan;
  emu::RunOptions options;
  options.steps = c.steps;
  const Trace trace = run_loop_bench(plan, c.setup.initial, options, emu::native_nodes(plan), "plain").trace;
  const uint32_t nodes = plan.nodes();

  Golden golden = golden_of(c.setup);
  auto model = std::make_unique<emu::TimingModel>(plan, threads);
  std::vector<PhaseSpan> spans(spans_of_step(plan));
  MachineEvents events;
  emu::KickCounter kicks(plan, threads);
  std::vector<MachineEvents> kicked(nodes);
  for (uint64_t step = 0; step < trace.steps(); ++step) {
    const auto slots = slots_of(plan.rule, golden);
    const auto before = places_of(golden);
    const Golden old = golden;
    if (!plan.program) kicks.add(golden.state().particles, kicked);
    golden.step();
    const auto leaving = leaving_between(plan.lattice, before, places_of(golden));
    note(seen, plan, old, leaving);
    // A model that is made anew and told where it was goes on alike.
    if (step == trace.steps() / 2) {
      count_work(seen, *model);
      events += sum(model->events());
      auto other = std::make_unique<emu::TimingModel>(plan, threads);
      other->resume(model->starts());
      model = std::move(other);
    }
    model->step(slots, leaving, spans);
    for (size_t k = 0; k < spans.size(); ++k, ++seen.spans) {
      const PhaseSpan expected = trace.cycles[step * spans.size() + k];
      if (spans[k] == expected) continue;
      return fmt::format("{}, step {}, node {}, {}: cycles {} to {}, expected {} to {}", c.name, step,
                         k / trace.phases(), phase_name(static_cast<int>(k % trace.phases()), trace.rounds),
                         spans[k].start, spans[k].end, expected.start, expected.end);
    }
  }
  if (!trace.stop) {
    const auto counted = static_cast<uint64_t>(trace.counters.at(0).second);
    const uint64_t cycles = model->cycles(slots_of(plan.rule, golden));
    if (cycles != counted) return fmt::format("{}: {} cycles, expected {}", c.name, cycles, counted);
    events += sum(model->events());
    events += sum(kicked);
    const std::string other = other_events(events, trace, plan.program != nullptr, seen);
    if (!other.empty()) return fmt::format("{}: {}", c.name, other);
  }
  count_work(seen, *model);
  ++seen.runs;
  seen.faults += trace.stop.has_value();
  for (const auto& [name, value] : trace.counters)
    if (name == "queue_stalls") seen.stalls += static_cast<uint64_t>(value);
  seen.no_overlap += !plan.arch.overlap;
  seen.checked += plan.link.checked();
  seen.queue_of_one += plan.arch.queue_depth == 1;
  seen.pipes += plan.arch.force_pipes > 1;
  seen.shared += plan.arch.multipliers == Multipliers::shared;
  seen.serial += plan.arch.multipliers == Multipliers::serial;
  seen.narrow += plan.arch.narrow_memories;
  seen.bricks += plan.bricks.cells() > 1;
  seen.arrival += plan.arch.halos == Halos::arrival;
  seen.streamers += plan.arch.streamers > 1;
  seen.boards += plan.arch.boards.several();
  for (const uint8_t faces : plan.cut) seen.cut += static_cast<uint64_t>(std::popcount(faces));
  seen.serial_links += plan.arch.boards.several() && plan.arch.boards.interval > 1;
  seen.late_links += plan.arch.boards.several() && plan.arch.boards.latency > 1;
  seen.coarse += plan.rule.widths.filter_frac != Widths{}.filter_frac;
  seen.pd += plan.rule.pd;
  seen.weighted += plan.rule.weighted && !plan.rule.pd;
  seen.damped += plan.rule.damped;
  const Cell& period = plan.lattice.period();
  seen.rings_of_3 += period[0] == 3 || period[1] == 3 || period[2] == 3;
  seen.lone_nodes += nodes == 1;
  seen.flat += plan.rule.axes == 2;
  return {};
}

Case rebuilt(Case c, uint64_t seed) {
  std::mt19937_64 random(seed * 7919);
  const auto draw = [&random](int low, int high) {
    return low + static_cast<int>(random() % static_cast<uint64_t>(high - low + 1));
  };
  Plan& plan = c.setup.plan;
  Arch arch = plan.arch;
  arch.filter_lanes = std::array{draw(1, 4), draw(5, 20), draw(21, 64)}[static_cast<size_t>(draw(0, 2))];
  arch.force_pipes = draw(1, std::min(arch.filter_lanes, draw(1, 8)));
  arch.queue_depth = std::array{1, draw(2, 4), draw(5, 30), 1024}[static_cast<size_t>(draw(0, 3))];
  arch.multipliers = static_cast<Multipliers>(draw(0, 2));
  arch.overlap = draw(0, 3) > 0;
  arch.narrow_memories = draw(0, 3) == 0;
  arch.halos = Halos::phases;
  arch.streamers = 1;
  if (arch.narrow_memories)
    arch.filter_lanes = arch.force_pipes = 1, arch.overlap = false, arch.brick = {1, 1, 1};
  arch.link_bits = std::array{0, draw(1, 8), draw(9, 200), 1024}[static_cast<size_t>(draw(0, 3))];
  if (draw(0, 2) == 0) arch.capacity = crowd_of(c);
  if (draw(0, 2) == 0 && !arch.narrow_memories) {
    const std::vector<Cell> bricks = bricks_for(plan.lattice);
    if (!bricks.empty())
      arch.brick = bricks[static_cast<size_t>(draw(0, static_cast<int>(bricks.size()) - 1))];
  }
  // The clocked node holds checked beats of 512 bits.
  arch.link_check = arch.link_bits <= 200 ? static_cast<LinkCheck>(draw(0, 2)) : LinkCheck::none;
  if (!arch.narrow_memories && cells_of(arch.brick) == 1 && draw(0, 2) == 0) {
    arch.halos = Halos::arrival;
    arch.overlap = true;
    arch.streamers = arch.filter_lanes > 1 ? draw(1, 2) : 1;
    arch.force_pipes = arch.streamers * draw(1, std::min(arch.filter_lanes / arch.streamers, 3));
  }
  plan = make_plan(plan.rule, arch, plan.lattice, plan.origin, plan.particles);
  c.name += " rebuilt";
  return c;
}

Case on_boards(Case c, uint64_t seed) {
  std::mt19937_64 random(seed * 104729);
  const auto draw = [&random](int low, int high) {
    return low + static_cast<int>(random() % static_cast<uint64_t>(high - low + 1));
  };
  DeviceCut boards;
  for (int a = 0; a < 3; ++a) boards.nodes[a] = draw(1, 3);
  boards.latency = std::array{1, draw(2, 9), draw(10, 80)}[static_cast<size_t>(draw(0, 2))];
  boards.interval = std::array{1, draw(2, 4), draw(5, 40)}[static_cast<size_t>(draw(0, 2))];
  c = with_boards(std::move(c), boards);
  c.name += fmt::format(" on boards of {} x {} x {}, latency {}, interval {}", boards.nodes[0],
                        boards.nodes[1], boards.nodes[2], boards.latency, boards.interval);
  return c;
}

}  // namespace cuboct::test
