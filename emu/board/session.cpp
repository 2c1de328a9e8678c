// SPDX-License-Identifier: MIT
#include "emu/board/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <thread>
#include <tuple>

#include "emu/machine/collector.h"
#include "hw/rtl/board.h"
#include "model/program/integer_program.h"

namespace cuboct::emu {
namespace {

class Session {
 public:
  Session(Host& host, const Plan& plan) : host_(host), plan_(plan), reader_(plan), info_(host.info()) {
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
        const uint64_t cell = word.get(plan_.words.particle_bits, plan_.bricks.cell_bits());
        reader_.add(reader_.read(word, cell_of(n, cell), step), state);
      }
    sort_by_id(state);
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
    uint64_t least_stage = 0;
    // Above the particle's id is the cell, and above that the stage of a rule of text.
    const int id_bits = plan_.words.id_bits, cell_bits = plan_.bricks.cell_bits();
    const auto part = [](uint64_t told, int lsb, int bits) {
      return told >> lsb & ((uint64_t{1} << bits) - 1);
    };
    for (uint32_t n = 0; n < plan_.nodes(); ++n) {
      const BoardFault found = host_.fault(static_cast<uint16_t>(n));
      if (found.fault == Fault::none) continue;
      const uint64_t told = found.particle;
      const StopReason reason{found.fault,
                              step,
                              faulty_cell(n, found.fault, part(told, id_bits, cell_bits)),
                              static_cast<uint32_t>(part(told, 0, id_bits)),
                              found.number,
                              {}};
      const uint64_t stage = part(told, id_bits + cell_bits, kStageBits);
      const auto key = [](const StopReason& r, uint64_t at) {
        return std::tuple(at, r.fault, r.particle, r.number);
      };
      if (least.fault == Fault::none || key(reason, stage) < key(least, least_stage))
        least = reason, least_stage = stage;
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
  const ShownReader reader_;
  BoardInfo info_;
  uint64_t base_ = 0;                        // step of the state that was loaded
  uint64_t cycles_before_ = 0, cycles_ = 0;  // of runs without a fault
};

// What engines of a board have in common.
class BoardRun {
 public:
  BoardRun(Host& host, const Plan& plan, State from, uint64_t cycles_before)
      : host_(host),
        session_(host, plan),
        known_(std::move(from)),
        at_(known_.step),
        cycles_before_(cycles_before) {
    session_.load(known_);
  }

  uint64_t step_count() const { return at_; }
  void advance(uint64_t steps) {
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
  const State& state() {
    if (!read_ || known_.step != at_) known_ = session_.read(at_);
    read_ = true;
    return known_;
  }
  uint64_t cycles() const { return cycles_before_ + session_.cycles(); }
  Counters counters() const {
    const LinkCount& count = host_.count();
    return {{"cycles", static_cast<double>(cycles())},
            {"requests", static_cast<double>(count.requests)},
            {"retries", static_cast<double>(count.retries)},
            {"bytes on the line", static_cast<double>(count.bytes)}};
  }
  Notes notes() const {
    return {{"port", host_.port()}, {"board clock", fmt::format("{} MHz", session_.info().clock_hz / 1e6)}};
  }

 private:
  Host& host_;
  Session session_;
  State known_;        // the last that was loaded, read, or found before a fault
  bool read_ = false;  // what was loaded is read back once
  uint64_t at_;
  const uint64_t cycles_before_;  // of the runs before this one, up to the checkpoint
};

// Of the pair law.
class BoardEngine : public StateEngine {
 public:
  BoardEngine(Host& host, const Scene& scene, const Plan& plan, CheckpointReader* from)
      : StateEngine(setting_of(scene, plan)),
        run_(host, plan, begin_of(scene, plan, from), from ? from->head().engine.counters[0] : 0) {}

  uint64_t step_count() const override { return run_.step_count(); }
  void advance(uint64_t steps, std::vector<uint64_t>*) override { run_.advance(steps); }
  Counters counters() override { return run_.counters(); }
  void for_each_slot(const std::function<void(const Particle&)>& see) override {
    for (const Particle& particle : run_.state().particles) see(particle);
  }
  EngineMemory memory() override { return {{run_.cycles()}, {}}; }
  Notes notes() override { return run_.notes(); }

 protected:
  State make_state() override { return run_.state(); }

 private:
  BoardRun run_;
};

// Of a rule of text.
class BoardIntegers : public IntegerEngine {
 public:
  BoardIntegers(Host& host, const Plan& plan, const State& from, uint64_t cycles_before)
      : plan_(plan), run_(host, plan, from, cycles_before) {}

  void advance(uint64_t steps, std::vector<uint64_t>*) override { run_.advance(steps); }
  uint64_t step_count() const override { return run_.step_count(); }
  State state() const override { return run_.state(); }
  uint64_t hash() const override { return hash_of(plan_.lattice, run_.state()); }
  std::vector<Int3> next_velocities() override { return golden_of(plan_, run_.state()).next_velocities(); }
  Counters counters() const override { return run_.counters(); }
  std::vector<uint64_t> clocks() const override { return {run_.cycles()}; }
  Notes notes() const override { return run_.notes(); }

 private:
  const Plan& plan_;
  mutable BoardRun run_;  // a look at the state reads it over the line
};

}  // namespace

EngineKind board_kind(Host& host, const Scene& scene, const Plan& plan) {
  EngineKind kind = fixed_kind("fpga", scene, plan);
  kind.batches = kind.in_pieces = true;
  kind.saves = true;
  kind.make = [&host, &scene, &plan](CheckpointReader* from, bool) -> std::unique_ptr<Engine> {
    if (!plan.program) return std::make_unique<BoardEngine>(host, scene, plan, from);
    uint64_t cycles = 0;
    if (from != nullptr) {
      const std::vector<uint64_t>& own = from->head().engine.own;
      const size_t words = program_words(*plan.program, plan.particles);
      if (own.size() > words) cycles = own[words];
    }
    return integer_run(scene, plan, from, [&host, &plan, cycles](const State& initial) {
      return std::make_unique<BoardIntegers>(host, plan, initial, cycles);
    });
  };
  return kind;
}

}  // namespace cuboct::emu
