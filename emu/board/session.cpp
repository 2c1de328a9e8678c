// SPDX-License-Identifier: MIT
#include "emu/board/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <thread>
#include <tuple>

#include "emu/machine/collector.h"
#include "emu/machine/words.h"
#include "hw/rtl/board.h"

namespace cuboct::emu {
namespace {

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
    check_words(plan, Bits::kWidth);  // as an emitted project holds
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
      for (const auto& [loaded, cell] : nodes[n]) {
        Word word = loaded;
        word.put(plan_.words.particle_bits, plan_.bricks.cell_bits(), cell);
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
      for (const Word& word : host_.read(static_cast<uint16_t>(n), word_bits())) {
        const Slot slot = unpack_particle(plan_, word);
        Particle p;
        p.id = slot.body.id;
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

class BoardEngine : public StateEngine {
 public:
  BoardEngine(Host& host, const Scene& scene, const Plan& plan, CheckpointReader* from)
      : StateEngine(setting_of(scene, plan)),
        host_(host),
        session_(host, plan),
        known_(begin_of(scene, plan, from)),
        at_(known_.step),
        cycles_before_(from ? from->head().engine.counters[0] : 0) {
    session_.load(known_);
  }

  uint64_t step_count() const override { return at_; }
  void advance(uint64_t steps, std::vector<uint64_t>*) override {
    if (at_ + steps > std::numeric_limits<uint32_t>::max())
      throw InputError(fmt::format("{} steps: a board counts at most {}", at_ + steps,
                                   std::numeric_limits<uint32_t>::max()));
    if (!session_.run(at_, steps)) {
      const StopReason stop = session_.find_fault(known_, at_ + steps);
      at_ = known_.step;
      throw StepError(stop);
    }
    at_ += steps;
  }
  Counters counters() override {
    const LinkCount& count = host_.count();
    return {{"cycles", static_cast<double>(cycles_before_ + session_.cycles())},
            {"requests", static_cast<double>(count.requests)},
            {"retries", static_cast<double>(count.retries)},
            {"bytes on the line", static_cast<double>(count.bytes)}};
  }
  void for_each_slot(const std::function<void(const Particle&)>& see) override {
    for (const Particle& particle : make_state().particles) see(particle);
  }
  EngineMemory memory() override { return {{cycles_before_ + session_.cycles()}, {}}; }
  Notes notes() override {
    return {{"port", host_.port()}, {"board clock", fmt::format("{} MHz", session_.info().clock_hz / 1e6)}};
  }

 protected:
  State make_state() override {
    if (!read_ || known_.step != at_) known_ = session_.read(at_);
    read_ = true;
    return known_;
  }

 private:
  Host& host_;
  Session session_;
  State known_;        // the last that was loaded, read, or found before a fault
  bool read_ = false;  // what was loaded is read back once
  uint64_t at_;
  const uint64_t cycles_before_;  // of the runs before this one, up to the checkpoint
};

}  // namespace

EngineKind board_kind(Host& host, const Scene& scene, const Plan& plan) {
  EngineKind kind = fixed_kind("fpga", scene, plan);
  kind.batches = kind.in_pieces = true;
  kind.saves = true;
  kind.make = [&host, &scene, &plan](CheckpointReader* from, bool) {
    return std::make_unique<BoardEngine>(host, scene, plan, from);
  };
  return kind;
}

}  // namespace cuboct::emu
