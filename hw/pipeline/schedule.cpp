// SPDX-License-Identifier: MIT
#include "hw/pipeline/schedule.h"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <string>

namespace cuboct::pipeline {
namespace {

int levels(int n) { return n <= 1 ? 0 : std::bit_width(static_cast<unsigned>(n - 1)); }

class Asap {
 public:
  Asap(const std::vector<Step>& steps, const Delays& delays) : steps_(steps), delays_(delays) {
    for (const Step& step : steps) at_.push_back(moment_of(step));
  }
  std::vector<Moment> take() { return std::move(at_); }

 private:
  Moment moment_of(const Step& step) const {
    Moment last{};
    for (const int k : step.inputs) last = std::max(last, at_[static_cast<size_t>(k)]);
    if (is_wire(step.kind) || step.kind == Kind::input) return last;
    if (step.kind == Kind::product) return {in_registers(last) + 1, 0};
    const int delay = delay_of(step);
    if (delay > delays_.room())
      throw std::logic_error("a step of a pipeline takes " + std::to_string(delay) + " ps");
    if (last.ps + delay > delays_.room()) last = {last.cycle + 1, 0};
    if (step.kind == Kind::rom) return {last.cycle + 2, 0};
    return {last.cycle, last.ps + delay};
  }

  static int in_registers(Moment moment) { return moment.cycle + (moment.ps > 0); }

  int widest(const Step& step) const {
    int bits = 1;
    for (const int k : step.inputs) bits = std::max(bits, steps_[static_cast<size_t>(k)].bits);
    return bits;
  }

  int delay_of(const Step& step) const {
    const StepDelay& d = delays_.of[static_cast<size_t>(step.kind)];
    const auto input = [&](size_t k) { return steps_[static_cast<size_t>(step.inputs[k])].bits; };
    switch (step.kind) {
      case Kind::add:
      case Kind::sub:
      case Kind::less:
      case Kind::less_equal:
        return d.fixed + d.per_bit * std::max(widest(step), step.bits);
      case Kind::equal:
        return d.fixed + d.per_level * levels(widest(step));
      case Kind::choose:
        return d.fixed + d.per_level * std::min(3, levels(step.bits));
      case Kind::leading:
        return d.fixed + d.per_level * std::max(1, levels(input(0)) - 1);
      case Kind::shift_left:
        return d.fixed + d.per_level * input(1);
      case Kind::carry:
        return d.fixed + d.per_level * levels(step.low);
      case Kind::unfit:
        return d.fixed + d.per_level * levels(input(0) - step.low + 1);
      default:
        return d.fixed;
    }
  }

  const std::vector<Step>& steps_;
  const Delays& delays_;
  std::vector<Moment> at_;
};

}  // namespace

Schedule schedule_of(const graph::Graph& graph, const std::vector<int>& outputs, const Delays& delays) {
  Schedule s;
  s.steps = steps_of(graph, outputs);
  s.at = Asap(s.steps.steps, delays).take();
  const auto registered = [&](int step) {
    const Moment at = s.at[static_cast<size_t>(step)];
    return at.cycle + (at.ps > 0);
  };
  for (const int step : s.steps.of_node) s.ready.push_back(step < 0 ? -1 : registered(step));
  for (const Port& port : s.steps.outputs) s.cycles = std::max(s.cycles, registered(port.step));
  if (s.steps.fault >= 0)
    for (const int step : {s.steps.fault, s.steps.fault_code, s.steps.fault_number})
      s.cycles = std::max(s.cycles, registered(step));
  return s;
}

std::vector<int> piped_outputs(const graph::Round& round) {
  std::vector<int> nodes = graph::pair_outputs(round);
  nodes.push_back(round.when);
  return nodes;
}

}  // namespace cuboct::pipeline
