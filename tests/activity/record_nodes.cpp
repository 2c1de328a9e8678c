// SPDX-License-Identifier: MIT
// record_nodes SCENE ARCH TECHNOLOGY SKIPPED STEPS OUT [NODE...]: what nodes of a scene's machine get and
// give at their ports, cycle by cycle, for a gate netlist of cuboct_node to repeat; and what the energy model
// tells of each node. The run begins behind SKIPPED steps, when particles have left the sites of their
// packing.
//
//   OUT/project/       the machine, emitted
//   OUT/node_N.hex     a line per cycle: inputs, then outputs, each field in whole hexadecimal digits
//   OUT/model.json     of each node its cycles, events and terms of energy (pJ), over STEPS steps
//
// Without NODE: the nodes with the most pairs, with the median of those that have any, and with the fewest.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "emu/lattice/engine.h"
#include "emu/machine/loop_bench.h"
#include "emu/systemc/node.h"
#include "emu/timing/kicks.h"
#include "emu/timing/timing.h"
#include "hw/cost/energy.h"
#include "hw/plan/setup.h"
#include "hw/rtl/rtl_emit.h"
#include "model/base/json.h"

namespace cuboct {
namespace {

// The rows of one node's energy, as energy_of tells all nodes' clock and leakage.
std::vector<EnergyRow> rows_of_node(const Plan& plan, const MachineEvents& events, uint64_t cycles,
                                    const Technology& technology) {
  constexpr double kClock = 1e8;
  Energy energy = energy_of(plan, events, memory_traffic(plan, events), cycles, kClock, technology);
  for (EnergyRow& row : energy.rows)
    if (row.term == "clock: gates and control" || row.term.starts_with("leakage")) {
      row.events /= plan.nodes();
      row.picojoules = (1.0 / plan.nodes()) * row.picojoules;
    }
  return energy.rows;
}

struct Counted {
  std::vector<MachineEvents> nodes;
  std::vector<uint64_t> cycles;  // by node: from the run's first to the last of its last step
};

State state_after(const Setup& setup, uint64_t steps) {
  emu::LatticeEngine engine(setup.plan, 0, setup.plan.particles,
                            [&](uint32_t k) { return setup.initial.particles[k]; }, {});
  for (uint64_t s = 0; s < steps; ++s) engine.step();
  return engine.state();
}

Counted count(const Plan& plan, const State& initial, uint64_t steps) {
  emu::LatticeEngine engine(plan, initial.step, plan.particles,
                            [&](uint32_t k) { return initial.particles[k]; }, {});
  emu::TimingModel timing(plan, 1);
  emu::KickCounter kicks(plan, 1);
  emu::CellSlots slots;
  Counted counted{std::vector<MachineEvents>(plan.nodes()), std::vector<uint64_t>(plan.nodes())};
  std::vector<PhaseSpan> spans(size_t{plan.nodes()} * kPhases);
  std::vector<Particle> particles;
  for (uint64_t s = 0; s < steps; ++s) {
    engine.slots(slots);
    particles.clear();
    engine.for_each_slot([&](const Particle& p) { particles.push_back(p); });
    engine.step();
    kicks.add(particles, counted.nodes);
    timing.step(slots, engine.leaving(), spans);
  }
  for (uint32_t n = 0; n < plan.nodes(); ++n) {
    counted.nodes[n] += timing.events()[n];
    const auto of_node = std::span(spans).subspan(size_t{n} * kPhases, kPhases);
    for (const PhaseSpan& span : of_node) counted.cycles[n] = std::max(counted.cycles[n], span.end + 1);
  }
  return counted;
}

std::set<uint32_t> busiest_median_idlest(const std::vector<MachineEvents>& nodes) {
  std::vector<uint32_t> order(nodes.size());
  for (uint32_t n = 0; n < order.size(); ++n) order[n] = n;
  std::ranges::stable_sort(order, {}, [&](uint32_t n) { return nodes[n].pairs; });
  const auto some =
      static_cast<size_t>(std::ranges::count_if(nodes, [](const MachineEvents& e) { return e.pairs > 0; }));
  return {order.back(), order[order.size() - 1 - some / 2], order.front()};
}

// A line of hexadecimal digits, the last field first.
class Digits {
 public:
  template <int kWords>
  Digits& put(const emu::BitsOf<kWords>& bits, int width) {
    std::string field;
    for (int lsb = (width + 3) / 4 * 4 - 4; lsb >= 0; lsb -= 4)
      field += "0123456789abcdef"[bits.get(lsb, std::min(4, width - lsb))];
    text_ = field + text_;
    return *this;
  }
  Digits& put(uint64_t value, int width) {
    emu::Bits bits;
    bits.put(0, width, static_cast<int64_t>(value));
    return put(bits, width);
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

// A node that writes down what it gets and gives. The fields of a line are those of tests/activity/bench.py.
class Recorder final : public emu::NodeModel {
 public:
  Recorder(const Plan& plan, uint8_t has_link, const std::string& path)
      : plan_(plan), faces_(2 * plan.rule.axes), has_link_(has_link), node_(plan, has_link), file_(path) {}

  void clock(const emu::NodeInputs& in, emu::NodeOutputs& out) override {
    const emu::Control& host = *in.control;
    Digits inputs, outputs;
    inputs.put(host.reset_n, 1).put(host.start, 1).put(host.steps, 32).put(has_link_, faces_);
    inputs.put(host.load_valid, 1).put(host.load_data, plan_.words.particle_bits);
    inputs.put(in.ready, faces_).put(in.valid, faces_).put(ends(in), faces_);
    for (int f = 0; f < faces_; ++f) inputs.put(came_[at(f)].payload, plan_.words.link_bits);
    node_.clock(in, out);
    outputs.put(out.phase_start, 8).put(out.phase_end, 8).put(out.idle, 1).put(out.fault, 1);
    outputs.put(out.observe, 1).put(out.observe ? out.observe_data : emu::Word{}, plan_.words.particle_bits);
    outputs.put(ready_, faces_).put(valid_, faces_);
    uint64_t ended = 0;
    for (int f = 0; f < faces_; ++f) ended |= uint64_t{sent_[at(f)].end} << f;
    outputs.put(ended, faces_);
    for (int f = 0; f < faces_; ++f) outputs.put(sent_[at(f)].payload, plan_.words.link_bits);
    valid_ = out.valid, ready_ = out.ready;
    for (int f = 0; f < faces_; ++f)
      if (out.loaded >> f & 1) sent_[at(f)] = *out.beat[at(f)];
    file_ << inputs.text() << ' ' << outputs.text() << '\n';
  }

 private:
  static size_t at(int face) { return static_cast<size_t>(face); }
  // A neighbour's register keeps its beat where it is not valid.
  uint64_t ends(const emu::NodeInputs& in) {
    uint64_t bits = 0;
    for (int f = 0; f < faces_; ++f) {
      if (in.valid >> f & 1) came_[at(f)] = *in.beat[at(f)];
      bits |= uint64_t{came_[at(f)].end} << f;
    }
    return bits;
  }

  const Plan& plan_;
  const int faces_;
  const uint8_t has_link_;
  emu::Node node_;
  std::ofstream file_;
  std::array<emu::Beat, kFaces> came_{}, sent_{};
  uint8_t valid_ = 0, ready_ = 0;  // after the edge before
};

std::string json_node(const Plan& plan, uint32_t node, const MachineEvents& events, uint64_t cycles,
                      const Technology& technology) {
  std::vector<std::string> counts, terms;
  for (const auto& [name, count] : event_names())
    counts.push_back(fmt::format("{}:{}", json(std::string(name)), events.*count));
  for (const EnergyRow& row : rows_of_node(plan, events, cycles, technology))
    terms.push_back(fmt::format("{{\"term\":{},\"events\":{},\"picojoules\":[{},{}]}}", json(row.term),
                                json(row.events), json(row.picojoules.low), json(row.picojoules.high)));
  return fmt::format("{{\"node\":{},\"cycles\":{},\n\"events\":{{{}}},\n\"terms\":[{}]}}", node, cycles,
                     fmt::join(counts, ","), fmt::join(terms, ",\n"));
}

int run(std::span<char*> arguments) {
  const std::string out = arguments[5];
  const uint64_t steps = std::stoull(arguments[4]);
  const Setup setup = make_setup(read_scene(arguments[0]), read_arch(arguments[1]));
  const Plan& plan = setup.plan;
  if (!plan.bricks.one_cell() || plan.arch.link_check != LinkCheck::none)
    throw InputError("only nodes of one cell whose links are not checked");
  const State initial = state_after(setup, std::stoull(arguments[3]));
  const Counted counted = count(plan, initial, steps);
  std::set<uint32_t> nodes;
  for (char* text : arguments.subspan(6)) nodes.insert(static_cast<uint32_t>(std::stoul(text)));
  if (nodes.empty()) nodes = busiest_median_idlest(counted.nodes);
  emit_rtl(plan, initial, out + "/project", {.vector_steps = 0});
  const auto factory = [&](uint32_t n, uint8_t links) -> std::unique_ptr<emu::NodeModel> {
    if (nodes.contains(n))
      return std::make_unique<Recorder>(plan, links, fmt::format("{}/node_{}.hex", out, n));
    return std::make_unique<emu::Node>(plan, links);
  };
  emu::RunOptions options;
  options.steps = steps + 1;  // so that no node dumps before the window of all ends
  emu::run_loop_bench(plan, initial, options, factory, "record_nodes");
  const Technology technology = read_technology(arguments[2]);
  std::vector<std::string> told;
  for (uint32_t n : nodes)
    told.push_back(json_node(plan, n, counted.nodes[n], counted.cycles[n], technology));
  std::ofstream(out + "/model.json") << fmt::format(
      "{{\"steps\":{},\"nodes_in_all\":{},\"nodes\":[{}],\n\"pairs\":{}}}\n", steps, plan.nodes(),
      fmt::join(told, ",\n"), sum(counted.nodes).pairs);
  return 0;
}

}  // namespace
}  // namespace cuboct

int main(int argc, char** argv) {
  if (argc < 7) {
    std::fprintf(stderr, "usage: record_nodes SCENE ARCH TECHNOLOGY SKIPPED STEPS OUT [NODE...]\n");
    return 2;
  }
  try {
    return cuboct::run(std::span(argv + 1, static_cast<size_t>(argc - 1)));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "record_nodes: %s\n", e.what());
    return 1;
  }
}
