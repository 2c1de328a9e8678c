// SPDX-License-Identifier: MIT
#include "emu/board/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>
#include <set>
#include <thread>
#include <tuple>

#include "emu/machine/collector.h"
#include "emu/machine/words.h"
#include "hw/board.h"
#include "model/base/interrupt.h"
#include "model/base/progress.h"

namespace cuboct::emu {
namespace {

using Clock = std::chrono::steady_clock;

class Session {
 public:
  Session(Host& host, const Plan& plan) : host_(host), plan_(plan), info_(host.info()) {
    const bool settable = info_.moved_types > 0 && info_.machine_hash == machine_hash(plan);
    if (info_.plan_hash != plan.hash && !settable)
      throw InputError(
          fmt::format("port {}: the board holds plan {:016x}, the scene is plan {:016x}", host.port(),
                      info_.plan_hash, plan.hash),
          "emit the scene with --board, build and flash it; or run the scene that the board was made from");
    if (info_.nodes != static_cast<int>(plan.nodes()) || info_.particle_bits != word_bits())
      throw std::runtime_error(fmt::format("port {}: {} nodes, {} bits per particle do not fit plan {:016x}",
                                           host.port(), info_.nodes, info_.particle_bits, plan.hash));
    check_words(plan);
  }

  // Makes `state` the board's.
  void load(const State& state) {
    host_.reset();
    base_ = state.step;
    cycles_before_ += cycles_;
    cycles_ = 0;
    if (info_.plan_hash != plan_.hash) set_velocities();
    const auto nodes = by_node(plan_, state);
    uint16_t index = 0;
    for (uint32_t n = 0; n < nodes.size(); ++n)
      for (const Particle& p : nodes[n]) {
        Bits word = load_word(plan_, p);
        word.put(plan_.words.particle_bits, plan_.bricks.cell_bits(), plan_.local_of(p.cell));
        host_.load(index++, static_cast<uint16_t>(n), word, word_bits());
      }
  }

  // Waits for the end. False: some node met a fault.
  bool run(uint64_t from, uint64_t steps) {
    host_.run(static_cast<uint32_t>(from - base_), static_cast<uint32_t>(steps));
    for (int pause = 0;; pause = std::min(20, 2 * pause + 1)) {
      const BoardState state = host_.status();
      if (!state.busy) {
        if (!state.fault) cycles_ = state.cycles;
        return !state.fault;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(pause));
    }
  }

  State read(uint64_t step) {
    State state;
    state.step = step;
    for (uint32_t n = 0; n < plan_.nodes(); ++n)
      for (const Bits& word : host_.read(static_cast<uint16_t>(n), word_bits())) {
        const Slot slot = unpack_particle(plan_, word);
        Particle p;
        p.id = slot.id;
        p.type = slot.body.type;
        p.cell = cell_of(n, word.get(plan_.words.particle_bits, plan_.bricks.cell_bits()));
        p.x = position_of(plan_.rule.widths, slot);
        p.v = slot.body.v;
        p.u = slot.u;
        state.particles.push_back(p);
      }
    std::sort(state.particles.begin(), state.particles.end(),
              [](const Particle& a, const Particle& b) { return a.id < b.id; });
    for (size_t k = 0; k < state.particles.size(); ++k)
      if (state.particles[k].id != k || state.particles.size() != plan_.particles)
        throw std::runtime_error(
            fmt::format("port {}: after step {} the board holds {} particles of {}, or one twice",
                        host_.port(), step, state.particles.size(), plan_.particles));
    return state;
  }

  // The least fault of the one step that the board has run since it held a state after `step`.
  StopReason stop(uint64_t step) {
    StopReason least;
    // Above the particle's id is the cell.
    const int id_bits = plan_.words.id_bits;
    for (uint32_t n = 0; n < plan_.nodes(); ++n) {
      const BoardFault found = host_.fault(static_cast<uint16_t>(n));
      if (found.fault == Fault::none) continue;
      const uint64_t told = found.particle;
      const StopReason reason{found.fault,
                              step,
                              faulty_cell(n, found.fault, told >> id_bits),
                              static_cast<uint32_t>(told & ((uint64_t{1} << id_bits) - 1)),
                              found.number,
                              {}};
      const auto key = [](const StopReason& r) { return std::tie(r.fault, r.particle, r.number); };
      if (least.fault == Fault::none || key(reason) < key(least)) least = reason;
    }
    const Cell& c = plan_.lattice.cell(least.cell);
    least.text = RunError(least.fault, step, least.cell, least.particle, least.number,
                          fmt::format(" at ({}, {}, {})", c[0], c[1], c[2]))
                     .what();
    return least;
  }

  // `known` is the state before the first fault; afterwards it is the last without one.
  StopReason find_fault(State& known, uint64_t high) {
    load(known);
    while (high - known.step > 1) {
      const uint64_t middle = known.step + (high - known.step) / 2;
      if (run(known.step, middle - known.step)) {
        known = read(middle);
      } else {
        high = middle;
        load(known);
      }
    }
    if (run(known.step, 1))
      throw std::runtime_error(
          fmt::format("port {}: a fault of step {} is gone when run again", host_.port(), known.step));
    return stop(known.step);
  }

  uint64_t cycles() const { return cycles_before_ + cycles_; }
  const BoardInfo& info() const { return info_; }

 private:
  // A particle on the line: its word, and above it the number of its cell in the node.
  int word_bits() const { return plan_.words.particle_bits + plan_.bricks.cell_bits(); }

  uint32_t cell_of(uint32_t node, uint64_t local) const {
    const uint32_t cell =
        local < plan_.bricks.cells() ? plan_.cell_of(node, static_cast<uint32_t>(local)) : kNoCell;
    if (cell == kNoCell)
      throw std::runtime_error(
          fmt::format("port {}: node {} tells of a cell {} that it has not", host_.port(), node, local));
    return cell;
  }

  // A link's fault is told with the number 0: of a brick without that cell it is the first one that it has.
  uint32_t faulty_cell(uint32_t node, Fault fault, uint64_t local) const {
    return is_of_link(fault) ? plan_.first_cell_of(node) : cell_of(node, local);
  }

  void set_velocities() {
    const std::vector<int> moved = moved_types(plan_.rule);
    for (size_t k = 0; k < moved.size(); ++k)
      for (int a = 0; a < plan_.rule.axes; ++a)
        host_.set_velocity(static_cast<uint8_t>(k), static_cast<uint8_t>(a),
                           plan_.rule.types[static_cast<size_t>(moved[k])].velocity[static_cast<size_t>(a)]);
  }

  Host& host_;
  const Plan& plan_;
  BoardInfo info_;
  uint64_t base_ = 0;                        // step of the state that was loaded
  uint64_t cycles_before_ = 0, cycles_ = 0;  // of runs without a fault
};

}  // namespace

Trace run_on_board(Host& host, const Plan& plan, const State& initial, const BoardRun& run) {
  if (run.steps > std::numeric_limits<uint32_t>::max())
    throw InputError(
        fmt::format("{} steps: a board counts at most {}", run.steps, std::numeric_limits<uint32_t>::max()));
  Session session(host, plan);
  Trace trace;
  trace.engine = "fpga";
  trace.plan_hash = plan.hash;
  trace.nodes = plan.nodes();
  trace.hash_every = std::max<uint64_t>(1, run.hash_every);

  std::set<uint64_t> stops(run.frames.begin(), run.frames.end());
  if (run.hash_every > 0)
    for (uint64_t step = 0; step < run.steps; step += run.hash_every) stops.insert(step);
  if (run.hash_every > 0 || !run.frames.empty()) stops.insert(run.steps);
  const auto record = [&](const State& state) {
    if (run.hash_every > 0 && trace.hashes(state.step, run.steps))
      trace.state_hash.push_back(hash_of(plan.lattice, state));
    if (std::binary_search(run.frames.begin(), run.frames.end(), state.step)) trace.frames.push_back(state);
  };

  Progress progress("fpga", run.steps, plan.particles, 0, run.progress);
  session.load(initial);
  State known = initial;  // the last that was read
  if (stops.contains(0)) record(known = session.read(0));
  uint64_t at = 0, chunk = 1;
  const auto begin = Clock::now();
  while (at < run.steps && !interrupted()) {
    const auto next = stops.upper_bound(at);
    const uint64_t stop = next == stops.end() ? run.steps : *next, end = std::min(stop, at + chunk);
    const auto start = Clock::now();
    if (!session.run(at, end - at)) {
      trace.stop = session.find_fault(known, end);
      break;
    }
    // Half a second at once: long enough to spare the line, short enough for Ctrl-C.
    if (Clock::now() - start < std::chrono::milliseconds(500)) chunk *= 2;
    at = end;
    if (stops.contains(at)) record(known = session.read(at));
    progress.at(at);
  }
  trace.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  trace.steps_done = trace.stop ? known.step : at;
  // What a run that ended early ends with.
  if (trace.steps_done < run.steps && (run.hash_every > 0 || !run.frames.empty())) {
    if (known.step != trace.steps_done) known = session.read(trace.steps_done);
    if (run.hash_every > 1 && known.step % run.hash_every != 0)
      trace.state_hash.push_back(hash_of(plan.lattice, known));
    if (!run.frames.empty() && trace.frames.back().step != known.step) trace.frames.push_back(known);
  }
  const LinkCount& count = host.count();
  trace.counters = {{"cycles", static_cast<double>(session.cycles())},
                    {"requests", static_cast<double>(count.requests)},
                    {"retries", static_cast<double>(count.retries)},
                    {"bytes on the line", static_cast<double>(count.bytes)}};
  trace.notes = {{"port", host.port()},
                 {"board clock", fmt::format("{} MHz", session.info().clock_hz / 1e6)}};
  return trace;
}

}  // namespace cuboct::emu
