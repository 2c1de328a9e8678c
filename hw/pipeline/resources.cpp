// SPDX-License-Identifier: MIT
#include "hw/pipeline/resources.h"

#include <algorithm>

#include "hw/pipeline/layout.h"

namespace cuboct::pipeline {
namespace {

class Tally {
 public:
  Tally(const graph::Graph& graph, const Schedule& schedule)
      : graph_(graph), s_(schedule), layout_(layout_of(schedule)) {
    all_.cycles = schedule.cycles, all_.register_bits = schedule.cycles;
    for (int k = 0; k < static_cast<int>(s_.steps.steps.size()); ++k)
      if (!layout_.read[static_cast<size_t>(k)].empty()) add(k);
  }
  Resources all() const { return all_; }

 private:
  const Step& step(int k) const { return s_.steps.steps[static_cast<size_t>(k)]; }

  void add(int k) {
    const Step& of = step(k);
    if (is_wire(of.kind)) return;
    const int done = s_.at[static_cast<size_t>(k)].cycle;
    const auto held = [&](int cycle) { return static_cast<int64_t>(layout_.held(k, cycle).count()); };
    for (int cycle = done + 1; cycle <= layout_.last(k); ++cycle) all_.register_bits += held(cycle);
    switch (of.kind) {
      case Kind::add:
      case Kind::sub:
        all_.adder_bits += of.bits;
        break;
      case Kind::less:
      case Kind::less_equal:
        all_.adder_bits += std::max(step(of.inputs[0]).bits, step(of.inputs[1]).bits);
        break;
      case Kind::choose:
        all_.choice_bits += of.bits;
        break;
      case Kind::shift_left:
        all_.choice_bits += int64_t{of.bits} * step(of.inputs[1]).bits;
        break;
      case Kind::product:
        all_.products.push_back({step(of.inputs[0]).bits, step(of.inputs[1]).bits});
        all_.register_bits += held(done);
        break;
      case Kind::rom:
        all_.register_bits += 2 * held(done);
        all_.roms.push_back({static_cast<int64_t>(graph_.tables[static_cast<size_t>(of.table)].c0.size()),
                             static_cast<int>(held(done))});
        break;
      default:
        break;
    }
  }

  const graph::Graph& graph_;
  const Schedule& s_;
  Layout layout_;
  Resources all_;
};

}  // namespace

int64_t Resources::rom_bits() const {
  int64_t bits = 0;
  for (const Rom& rom : roms) bits += rom.words * rom.bits;
  return bits;
}

Resources resources_of(const graph::Graph& graph, const Schedule& schedule) {
  return Tally(graph, schedule).all();
}

}  // namespace cuboct::pipeline
