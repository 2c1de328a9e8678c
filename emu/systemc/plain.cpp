// SPDX-License-Identifier: MIT
#include "emu/systemc/plain.h"

#include <fmt/format.h>

#include <chrono>

#include "emu/systemc/stall.h"

namespace cuboct::emu {
namespace {

struct Place {
  std::unique_ptr<NodeModel> model;
  NodeOutputs out;
  NodeInputs in;
  Control control;
  // The link registers, and where the node writes the next; a node is called while others read the former.
  std::array<Beat, kFaces> beat, next;
  uint8_t valid = 0, ready = 0;
};

// A clock cycle of every node: all read the registers of before the edge, then all registers change. `cycle`
// is that of the run, which the stalls go by; `now` counts from reset.
void clock_all(const Lattice& lattice, std::vector<Place>& places, const StallSource& stalls, uint64_t now,
               uint64_t cycle) {
  for (uint32_t n = 0; n < places.size(); ++n) {
    Place& p = places[n];
    p.in = {now, &p.control, 0, 0, {}};
    for (int f = 0; f < kFaces; ++f) {
      const uint32_t other = lattice.neighbour(n, f);
      if (other == kNoNode) continue;
      const int back = f ^ 1;
      const uint8_t bit = static_cast<uint8_t>(1u << f);
      if ((places[other].ready >> back & 1) && !stalls.stalled(n * kFaces + static_cast<uint32_t>(f), cycle))
        p.in.ready |= bit;
      if ((places[other].valid >> back & 1) &&
          !stalls.stalled(other * kFaces + static_cast<uint32_t>(back), cycle))
        p.in.valid |= bit;
      p.in.beat[static_cast<size_t>(f)] = &places[other].beat[static_cast<size_t>(back)];
    }
    try {
      p.model->clock(p.in, p.out);
    } catch (const std::runtime_error& e) {
      throw std::runtime_error(node_text(lattice, n) + ", " + e.what());
    }
  }
  for (Place& p : places) {
    p.valid = p.out.valid;
    p.ready = p.out.ready;
    for (size_t f = 0; f < kFaces; ++f)
      if (p.out.loaded >> f & 1) p.beat[f] = p.next[f];
  }
}

}  // namespace

uint8_t links_of(const Lattice& lattice, uint32_t node) {
  uint8_t mask = 0;
  for (int f = 0; f < kFaces; ++f)
    if (lattice.neighbour(node, f) != kNoNode) mask |= static_cast<uint8_t>(1u << f);
  return mask;
}

std::string node_text(const Lattice& lattice, uint32_t node) {
  const Cell& c = lattice.cell(node);
  return fmt::format("node {} ({},{},{})", node, c[0], c[1], c[2]);
}

std::string stuck_text(const Lattice& lattice, uint64_t cycle, uint64_t patience,
                       const std::vector<std::string>& doing) {
  std::string text =
      fmt::format("stuck: no node has begun or ended a phase in {} cycles before cycle {}", patience, cycle);
  size_t told = 0;
  for (uint32_t n = 0; n < doing.size() && told < 16; ++n) {
    if (doing[n] == "idle") continue;
    text += fmt::format("\n  {}: {}", node_text(lattice, n), doing[n]);
    ++told;
  }
  return text;
}

RunResult run_plain(const Plan& plan, const State& initial, const RunOptions& options,
                    const NodeFactory& factory, const std::string& engine) {
  const auto particles = by_node(plan, initial);
  Collector collector(plan, options);
  const uint32_t nodes = plan.lattice.size();
  std::vector<Place> places(nodes);
  for (uint32_t n = 0; n < nodes; ++n) {
    places[n].model = factory(n, links_of(plan.lattice, n));
    for (size_t f = 0; f < kFaces; ++f) places[n].out.beat[f] = &places[n].next[f];
  }
  uint64_t now = 0;
  const StallSource none, stalls(options.stall_rate, options.stall_seed);
  clock_all(plan.lattice, places, none, now++, 0);  // in reset
  for (Place& p : places) p.control.reset_n = true;
  size_t most = 0;
  for (const auto& list : particles) most = std::max(most, list.size());
  for (size_t k = 0; k < most; ++k) {
    for (uint32_t n = 0; n < nodes; ++n) {
      Control& c = places[n].control;
      c.load_valid = k < particles[n].size();
      if (c.load_valid) c.load_data = load_word(plan, particles[n][k]);
    }
    clock_all(plan.lattice, places, none, now++, 0);
  }
  for (Place& p : places) {
    p.control.load_valid = false;
    p.control.start = true;
    p.control.steps = static_cast<uint32_t>(options.steps);
  }
  clock_all(plan.lattice, places, none, now++, 0);
  for (Place& p : places) p.control.start = false;

  const uint64_t patience = options.patience != 0 ? options.patience : patience_of(plan, options.stall_rate);
  const auto begin = std::chrono::steady_clock::now();
  for (uint64_t cycle = 0; !collector.done(); ++cycle) {
    clock_all(plan.lattice, places, stalls, now + cycle, cycle);
    for (uint32_t n = 0; n < nodes; ++n)
      if (Collector::shows(places[n].out)) collector.collect(n, cycle, places[n].out);
    if (cycle - collector.last_event() > patience) {
      std::vector<std::string> doing;
      for (const Place& p : places) doing.push_back(p.model->doing());
      throw std::runtime_error(stuck_text(plan.lattice, cycle, patience, doing));
    }
  }
  RunResult result;
  const double cycles = static_cast<double>(collector.last_cycle() + 1);
  result.trace = collector.take_trace();
  result.order = collector.order();
  result.trace.engine = engine;
  result.trace.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  result.trace.counters = {{"cycles", cycles}};
  for (const Place& p : places) add_counters(result.trace.counters, 1, p.model->counters());
  return result;
}

}  // namespace cuboct::emu
