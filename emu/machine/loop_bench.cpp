// SPDX-License-Identifier: MIT
#include "emu/machine/loop_bench.h"

#include <fmt/format.h>

#include <optional>

#include "emu/machine/device_wire.h"
#include "emu/machine/stall.h"
#include "model/base/clock.h"

namespace cuboct::emu {
namespace {

struct Place {
  // The link registers, and where the node writes the next; a node is called while others read the former.
  std::array<Beat, kFaces> beat, next;
  std::unique_ptr<NodeModel> model;
  Control control;
  NodeInputs in;
  NodeOutputs out;
  std::array<uint16_t, kFaces> ack{};
  uint8_t valid = 0, ready = 0;
};

// A lattice, cycle by cycle.
class Machine {
 public:
  Machine(const Plan& plan, const State& initial, const RunOptions& options, const NodeFactory& factory)
      : places(plan.nodes()),
        faults(plan, options.faults, initial, options.steps),
        plan_(plan),
        stalls_(options.stall_rate, options.stall_seed) {
    for (uint32_t n = 0; n < places.size(); ++n) {
      places[n].model = factory(n, links_of(plan_, n));
      for (size_t f = 0; f < kFaces; ++f) places[n].out.beat[f] = &places[n].next[f];
    }
    if (plan_.cut.empty()) return;
    boards_.resize(places.size() * kFaces);
    for (uint32_t n = 0; n < places.size(); ++n)
      for (int f = 0; f < kFaces; ++f)
        if (plan_.crosses(n, f)) boards_[n * kFaces + static_cast<size_t>(f)].emplace(plan_.arch.boards);
  }

  // Of every node: all read the registers of before the edge, then all registers change. `cycle` is that of
  // the run, from where on links stall and fail; nothing before it.
  void clock(std::optional<uint64_t> cycle) {
    for (uint32_t n = 0; n < places.size() && !boards_.empty(); ++n)
      for (int f = 0; f < kFaces; ++f)
        if (plan_.crosses(n, f)) pass(n, f, cycle);
    for (uint32_t n = 0; n < places.size(); ++n) {
      Place& p = places[n];
      p.in = {now_, &p.control, 0, 0, {}, {}};
      for (int f = 0; f < kFaces; ++f) {
        const uint32_t other = plan_.neighbour(n, f);
        if (other == kNoNode) continue;
        const uint8_t bit = static_cast<uint8_t>(1u << f);
        const FaultyWire::View out = look(n, f, other, cycle), in = look(other, f ^ 1, n, cycle);
        if (out.ready) p.in.ready |= bit;
        if (in.valid) p.in.valid |= bit;
        p.in.beat[static_cast<size_t>(f)] = in.beat;
        p.in.ack[static_cast<size_t>(f)] = out.ack;
      }
      try {
        p.model->clock(p.in, p.out);
      } catch (const std::runtime_error& e) {
        throw std::runtime_error(node_text(plan_, n) + ", " + e.what());
      }
      faults.heed(plan_, n, p.out);
    }
    for (Place& p : places) {
      p.valid = p.out.valid;
      p.ready = p.out.ready;
      p.ack = p.out.ack;
      for (size_t f = 0; f < kFaces; ++f)
        if (p.out.loaded >> f & 1) p.beat[f] = p.next[f];
    }
    ++now_;
  }

  uint64_t now() const { return now_; }  // the next cycle, counted from the reset

  std::vector<Place> places;
  FaultyWires faults;

 private:
  // A link between devices, and what its ends see of it in a cycle.
  struct Board : DeviceWire {
    using DeviceWire::DeviceWire;
    FaultyWire::View view;
    Beat beat;
  };
  bool passes(uint32_t n, int face, std::optional<uint64_t> cycle) const {
    return !cycle || !stalls_.stalled(n * kFaces + static_cast<uint32_t>(face), *cycle);
  }
  // One cycle of such a link: a beat goes in, another comes out.
  void pass(uint32_t n, int face, std::optional<uint64_t> cycle) {
    Board& board = *boards_[n * kFaces + static_cast<size_t>(face)];
    const Place &from = places[n], &to = places[plan_.neighbour(n, face)];
    const bool open = passes(n, face, cycle);
    board.view = {};
    board.view.ready = open && board.ready(now_);
    if (board.view.ready && (from.valid >> face & 1)) board.take(now_, from.beat[static_cast<size_t>(face)]);
    const Beat* const come = open ? board.come(now_) : nullptr;
    if (come == nullptr) return;
    board.beat = *come;
    board.view.valid = true;
    board.view.beat = &board.beat;
    if (to.ready >> (face ^ 1) & 1) board.read();
  }
  // The wire of node `n` over `face`, to `other`.
  FaultyWire::View look(uint32_t n, int face, uint32_t other, std::optional<uint64_t> cycle) {
    if (plan_.crosses(n, face)) return boards_[n * kFaces + static_cast<size_t>(face)]->view;
    const Place &from = places[n], &to = places[other];
    const int back = face ^ 1;
    const bool passes = this->passes(n, face, cycle);
    const FaultyWire::View truth{passes && (from.valid >> face & 1), &from.beat[static_cast<size_t>(face)],
                                 passes && (to.ready >> back & 1), to.ack[static_cast<size_t>(back)]};
    FaultyWire* const wire = cycle ? faults.at(n, face) : nullptr;
    return wire != nullptr ? wire->look(*cycle, truth) : truth;
  }

  const Plan& plan_;
  const StallSource stalls_;
  std::vector<std::optional<Board>> boards_;  // by sender * kFaces + face; none on one device
  uint64_t now_ = 0;
};

}  // namespace

uint8_t links_of(const Plan& plan, uint32_t node) { return plan.bricks.links(plan.lattice, node); }

std::string node_text(const Plan& plan, uint32_t node) {
  const Cell c = plan.low_of(node);
  return fmt::format("node {} ({},{},{})", node, c[0], c[1], c[2]);
}

std::string stuck_text(const Plan& plan, uint64_t cycle, uint64_t patience,
                       const std::vector<std::string>& doing) {
  std::string text =
      fmt::format("stuck: no node has begun or ended a phase in {} cycles before cycle {}", patience, cycle);
  size_t told = 0;
  for (uint32_t n = 0; n < doing.size() && told < 16; ++n) {
    if (doing[n] == "idle") continue;
    text += fmt::format("\n  {}: {}", node_text(plan, n), doing[n]);
    ++told;
  }
  return text;
}

RunResult run_loop_bench(const Plan& plan, const State& initial, const RunOptions& options,
                         const NodeFactory& factory, const std::string& engine) {
  const auto particles = by_node(plan, initial);
  Collector collector(plan, options);
  const uint32_t nodes = plan.nodes();
  Machine machine(plan, initial, options, factory);
  std::vector<Place>& places = machine.places;
  machine.clock({});  // in reset
  for (Place& p : places) p.control.reset_n = true;
  size_t most = 0;
  for (const auto& list : particles) most = std::max(most, list.size());
  for (size_t k = 0; k < most; ++k) {
    for (uint32_t n = 0; n < nodes; ++n) {
      Control& c = places[n].control;
      load(particles[n], k, c);
    }
    machine.clock({});
  }
  for (Place& p : places) {
    p.control.load_valid = false;
    p.control.start = true;
    p.control.steps = static_cast<uint32_t>(options.steps);
  }
  machine.clock({});
  for (Place& p : places) p.control.start = false;

  const uint64_t patience = options.patience != 0 ? options.patience : patience_of(plan, options.stall_rate);
  const auto begin = Clock::now();
  uint64_t cycle = 0;
  for (; !collector.done(); ++cycle) {
    machine.clock(cycle);
    for (uint32_t n = 0; n < nodes && !collector.done(); ++n) {
      if (!Collector::shows(places[n].out)) continue;
      try {
        collector.collect(n, cycle, places[n].out);
      } catch (const std::runtime_error& e) {
        throw std::runtime_error(node_text(plan, n) + ", " + e.what());
      }
    }
    if (cycle - collector.last_event() > patience) {
      std::vector<std::string> doing;
      doing.reserve(places.size());
      for (const Place& p : places) doing.push_back(p.model->doing());
      throw std::runtime_error(stuck_text(plan, cycle, patience, doing));
    }
  }
  if (options.faults.enabled()) {
    machine.faults.source.close();
    for (int k = 0; k < kAftermath; ++k) machine.clock(cycle++);
  }
  RunResult result;
  const double cycles = static_cast<double>(collector.last_cycle() + 1);
  result.trace = collector.take_trace();
  result.order = collector.order();
  result.faults = machine.faults.source.counts();
  result.first_fault = machine.faults.source.first();
  result.trace.engine = engine;
  result.trace.seconds = seconds_since(begin);
  result.trace.counters = {{"cycles", cycles}};
  for (const Place& p : places) add_counters(result.trace.counters, 1, p.model->counters(machine.now()));
  if (options.faults.enabled())
    for (const auto& counter : machine.faults.source.counters()) result.trace.counters.push_back(counter);
  return result;
}

}  // namespace cuboct::emu
