// SPDX-License-Identifier: MIT
#include "emu/machine/collector.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <tuple>

#include "model/program/integer_program.h"

namespace cuboct::emu {
namespace {

std::string place_of(const Lattice& lattice, uint32_t cell) {
  const Cell& c = lattice.cell(cell);
  return fmt::format(" at ({}, {}, {})", c[0], c[1], c[2]);
}

// The particle's row as packed, with the numbers that `state` has of its bonds.
void fill_row(const Plan& plan, const State& state, Slot& slot) {
  const graph::BondRows& rows = *plan.program->rows;
  const graph::FixedProgram& program = plan.program->program;
  const auto numbers = static_cast<size_t>(program.bond_numbers());
  const uint32_t id = slot.body.id;
  slot.bonds.assign(static_cast<size_t>(plan.words.bonds), {id, 0});
  slot.bond_numbers.assign(slot.bonds.size() * numbers, 0);
  const std::vector<int64_t> beginning = beginning_of(program.bonds);
  for (uint64_t b = rows.first[id]; b < rows.first[id + 1]; ++b) {
    const size_t place = b - rows.first[id];
    slot.bonds[place] = {rows.other[b], rows.kind[b]};
    std::copy_n(
        state.bonds.empty() ? beginning.begin() : state.bonds.begin() + static_cast<ptrdiff_t>(b * numbers),
        numbers, slot.bond_numbers.begin() + static_cast<ptrdiff_t>(place * numbers));
  }
}

// Of particle number `k` of the state.
Word load_word(const Plan& plan, const State& state, size_t k) {
  const Particle& particle = state.particles[k];
  const size_t numbers = state.fields.size() / state.particles.size();
  const auto fields = std::span(state.fields).subspan(k * numbers, numbers);
  Slot slot;
  put_position(plan.rule.widths, particle.x, slot);
  slot.body.v = particle.v;
  slot.body.type = particle.type;
  slot.body.id = particle.id;
  slot.body.fields.assign(fields.begin(), fields.end());
  if (plan.program && fields.empty()) slot.body.fields = beginning_of(plan.program->program.fields);
  slot.u = particle.u;
  if (plan.program && plan.program->rows) fill_row(plan, state, slot);
  Word word;
  pack_particle(plan, slot, word);
  return word;
}

}  // namespace

uint64_t patience_of(const Plan& plan, double stall_rate) {
  // The longest phase is FORCE, where each of the 27 C candidates passes ceil(C / L) times and each of its 27
  // C^2 pairs may take a cycle; an exchange sends at most 9 C records and waits for a neighbour that may be a
  // step behind.
  // A brick does so for each of its cells, and sends no more than all that it and those around hold.
  const uint64_t c = static_cast<uint64_t>(plan.arch.capacity), cells = cells_of(plan.arch.brick);
  const uint64_t force = cells * 27 * c * (c + 1) + 1000;
  const uint64_t beats =
      16 * c * cells * static_cast<uint64_t>(std::max(plan.words.halo_beats, plan.words.migrate_beats));
  // Between devices a beat takes longer, and the next one waits; each of six phases ends with one.
  const DeviceCut& boards = plan.arch.boards;
  const uint64_t slow = boards.several() ? static_cast<uint64_t>(boards.interval) : 1;
  const uint64_t far = boards.several() ? 64 * static_cast<uint64_t>(boards.latency) : 0;
  return 4 * force + far +
         slow * static_cast<uint64_t>(64.0 * static_cast<double>(beats) / (1.0 - stall_rate));
}

std::vector<std::vector<Loaded>> by_node(const Plan& plan, const State& initial) {
  std::vector<std::vector<Loaded>> cells(plan.lattice.size());
  const Particle* first = nullptr;  // that found its cell full; `initial` ascends in id
  for (size_t k = 0; k < initial.particles.size(); ++k) {
    const Particle& p = initial.particles[k];
    if (static_cast<int>(cells[p.cell].size()) < plan.arch.capacity)
      cells[p.cell].push_back({load_word(plan, initial, k), plan.local_of(p.cell)});
    else if (first == nullptr)
      first = &p;
  }
  if (first != nullptr)
    throw RunError(Fault::full_x, initial.step, first->cell, first->id, plan.arch.capacity,
                   place_of(plan.lattice, first->cell));
  std::vector<std::vector<Loaded>> nodes(plan.nodes());
  for (uint32_t n = 0; n < plan.nodes(); ++n)
    for (uint32_t local = 0; local < plan.bricks.cells(); ++local)
      if (const uint32_t cell = plan.cell_of(n, local); cell != kNoCell)
        nodes[n].insert(nodes[n].end(), cells[cell].begin(), cells[cell].end());
  return nodes;
}

void load(const std::vector<Loaded>& particles, size_t k, Control& control) {
  control.load_valid = k < particles.size();
  control.load_data = control.load_valid ? particles[k].word : Word{};
  control.load_cell = control.load_valid ? particles[k].cell : 0;
}

Collector::Collector(const Plan& plan, const RunOptions& options)
    : plan_(plan),
      options_(options),
      reader_(plan),
      nodes_(plan.nodes()),
      rounds_(static_cast<int>(plan.rounds.size())),
      phases_(static_cast<size_t>(phases_of(rounds_))),
      shown_phase_(static_cast<int>(plan.bricks.one_cell() ? Phase::exchange_x : Phase::update)),
      last_phase_(phase_index(last_phase(plan.rule.axes), 0, rounds_)),
      step_(nodes_),
      stopped_(nodes_) {
  std::sort(options_.frames.begin(), options_.frames.end());
  trace_.plan_hash = plan.hash;
  trace_.nodes = nodes_;
  trace_.rounds = rounds_;
}

Collector::Snapshot& Collector::snapshot(uint64_t step) {
  const auto [at, is_new] = open_.try_emplace(step);
  if (is_new) at->second.kept = std::binary_search(options_.frames.begin(), options_.frames.end(), step);
  return at->second;
}

// The lattice's cell; a brick's first one where a damaged word names a cell that is not there.
uint32_t Collector::cell_of(uint32_t node, uint32_t local) const {
  const uint32_t cell = plan_.cell_of(node, local);
  return cell != kNoCell ? cell : plan_.first_cell_of(node);
}

void Collector::observe(uint32_t node, const NodeOutputs& out) {
  const uint64_t step = step_[node];
  const Shown shown = reader_.read(out.observe_data, cell_of(node, out.observe_cell), step);
  Snapshot& s = snapshot(step);
  s.hash += reader_.hash(shown);
  if (s.kept || options_.keep_last) reader_.add(shown, s.state);
  if (options_.keep_order) {
    if (order_.size() <= step)
      order_.resize(step + 1, std::vector<std::vector<uint32_t>>(plan_.lattice.size()));
    order_[step][shown.particle.cell].push_back(shown.particle.id);
  }
}

void Collector::complete(uint64_t step) {
  Snapshot& s = snapshot(step);
  if (++s.complete < nodes_) return;
  trace_.state_hash.push_back(s.hash);
  s.state.step = step;
  if (s.kept) {
    keep(std::move(s.state));
  } else if (options_.keep_last) {
    // A fault's step ends a few steps behind the nodes that are ahead.
    constexpr size_t kAhead = 4;
    recent_.push_back(std::move(s.state));
    if (recent_.size() > kAhead) recent_.pop_front();
  }
  open_.erase(step);
}

void Collector::keep(State state) {
  sort_by_id(state);
  if (options_.take)
    options_.take(std::move(state));
  else
    trace_.frames.push_back(std::move(state));
}

void Collector::close(uint64_t cycle) {
  done_ = true;
  last_cycle_ = cycle;
}

void Collector::break_off(uint64_t cycle) {
  if (done_) return;
  stop_ = {};  // a fault that some nodes may yet precede
  close(cycle);
}

void Collector::collect(uint32_t node, uint64_t cycle, const NodeOutputs& out) {
  if (done_) return;
  const uint64_t step = step_[node];
  // The nodes around a link that failed wait for ever; the node that tells may be idle already.
  if (out.fault && is_of_link(static_cast<Fault>(out.fault_code))) {
    stop_ = {static_cast<Fault>(out.fault_code), step, cell_of(node, 0), out.fault_id, out.fault_number, {}};
    close(cycle);
    return;
  }
  if (stopped_[node]) return;
  last_event_ = cycle;
  const auto span = [&](int phase) -> PhaseSpan& {
    return trace_.cycles[(step * nodes_ + node) * phases_ + static_cast<size_t>(phase)];
  };
  if (out.phase_start != 0 && trace_.cycles.size() < (step + 1) * nodes_ * phases_)
    trace_.cycles.resize((step + 1) * nodes_ * phases_);
  const int phases = static_cast<int>(phases_);
  for (int p = 0; p < phases; ++p)
    if (out.phase_start >> p & 1) span(p).start = cycle;
  if (out.observe) observe(node, out);
  for (int p = 0; p < phases; ++p)
    if (out.phase_end >> p & 1) span(p).end = cycle;
  // What a flat plan does not have lies, empty, after what comes before it.
  if (plan_.rule.axes == 2)
    for (int p = 0; p < phases; ++p) {
      const Phase kind = phase_at(p, rounds_).kind;
      if ((kind == Phase::exchange_y || kind == Phase::migrate_y) && (out.phase_end >> p & 1) != 0)
        span(p + 1) = {cycle + 1, cycle};
    }
  if (out.phase_end & 1u << shown_phase_) complete(step);
  if (out.fault) {
    const StopReason found{static_cast<Fault>(out.fault_code),
                           step,
                           cell_of(node, out.fault_cell),
                           out.fault_id,
                           out.fault_number,
                           {}};
    const auto key = [](const StopReason& r, int stage) {
      return std::tuple(r.step, stage, r.fault, r.particle, r.number);
    };
    if (stop_.fault == Fault::none || key(found, out.fault_stage) < key(stop_, stop_stage_))
      stop_ = found, stop_stage_ = out.fault_stage;
  }
  if (out.phase_end & 1u << last_phase_) {
    ++step_[node];
    ++finished_[step];
  }
  if (out.idle) {
    stopped_[node] = true;
    complete(options_.steps);
  }
  // No fault of an earlier step can come once all nodes have finished this one.
  if (stop_.fault != Fault::none ? finished_[stop_.step] == nodes_
                                 : trace_.state_hash.size() == options_.steps + 1)
    close(cycle);
}

void Collector::add_last() {
  for (State& state : recent_)
    if (state.step == steps_done()) keep(std::move(state));
}

Trace Collector::take_trace() {
  if (stop_.fault != Fault::none) {
    stop_.text = RunError(stop_.fault, stop_.step, stop_.cell, stop_.particle, stop_.number,
                          place_of(plan_.lattice, stop_.cell))
                     .what();
    trace_.stop = stop_;
    // Where a link failed, not every node may have come so far.
    if (trace_.state_hash.size() > stop_.step + 1) trace_.state_hash.resize(stop_.step + 1);
    if (options_.keep_order) order_.resize(trace_.state_hash.size());
    std::erase_if(trace_.frames, [&](const State& s) { return s.step > stop_.step; });
  }
  add_last();
  trace_.cycles.resize(steps_done() * nodes_ * phases_);
  return std::move(trace_);
}

}  // namespace cuboct::emu
