// SPDX-License-Identifier: MIT
#include "hw/pipeline/schedule_check.h"

#include <fmt/format.h>

#include <algorithm>

namespace cuboct::pipeline {
namespace {

// The least n with 2^n >= count.
int doublings(int count) {
  int n = 0;
  while ((1LL << n) < count) ++n;
  return n;
}

// Walks over a schedule in absolute time: ps since the inputs' clock, periods of which only `room` is of use.
class Audit {
 public:
  Audit(const graph::Graph& graph, const std::vector<int>& outputs, const Schedule& schedule,
        const Delays& delays)
      : graph_(graph), outputs_(outputs), s_(schedule), delays_(delays) {}

  std::string refusal() {
    structure();
    if (found_.empty())
      for (size_t k = 0; k < s_.steps.steps.size() && found_.empty(); ++k) timing(static_cast<int>(k));
    if (found_.empty()) made();
    return found_;
  }

 private:
  const Step& step(int k) const { return s_.steps.steps[static_cast<size_t>(k)]; }
  Moment at(int k) const { return s_.at[static_cast<size_t>(k)]; }
  bool exists(int k) const { return k >= 0 && k < static_cast<int>(s_.steps.steps.size()); }
  void refuse(std::string why) {
    if (found_.empty()) found_ = std::move(why);
  }
  std::string name(int k) const {
    const int node = step(k).node;
    return node < 0 ? fmt::format("step {}", k) : fmt::format("step {} of '{}'", k, label(graph_, node));
  }

  void structure() {
    if (s_.at.size() != s_.steps.steps.size() || s_.ready.size() != graph_.nodes.size() ||
        s_.steps.of_node.size() != graph_.nodes.size())
      return refuse("the schedule is of another graph");
    for (int k = 0; exists(k); ++k)
      for (const int input : step(k).inputs)
        if (input < 0 || input >= k) refuse(fmt::format("{} reads a step that is not before it", name(k)));
  }

  int width(int k, size_t input) const { return step(step(k).inputs[input]).bits; }
  int width(int k) const {
    int most = 0;
    for (size_t n = 0; n < step(k).inputs.size(); ++n) most = std::max(most, width(k, n));
    return most;
  }

  // The table in delays.h.
  int picoseconds(int k) const {
    int w = 0, n = 0;
    switch (step(k).kind) {
      case Kind::constant:
      case Kind::input:
      case Kind::slice:
      case Kind::join:
        return 0;
      case Kind::add:
      case Kind::sub:
      case Kind::less:
      case Kind::less_equal:
        w = std::max(width(k), step(k).bits);
        break;
      case Kind::equal:
        n = doublings(width(k));
        break;
      case Kind::choose:
        n = std::min(doublings(step(k).bits), 3);
        break;
      case Kind::leading:
        n = std::max(doublings(width(k, 0)) - 1, 1);
        break;
      case Kind::shift_left:
        n = width(k, 1);
        break;
      case Kind::carry:
        n = doublings(step(k).low);
        break;
      case Kind::unfit:
        n = doublings(width(k, 0) - step(k).low + 1);
        break;
      case Kind::both:
      case Kind::either:
      case Kind::negate:
      case Kind::exclusive:
      case Kind::product:
      case Kind::rom:
        break;
    }
    const StepDelay& of = delays_.of[static_cast<size_t>(step(k).kind)];
    return of.fixed + w * of.per_bit + n * of.per_level;
  }

  void timing(int k) {
    const Moment own = at(k);
    if (own.cycle < 0 || own.ps < 0 || own.ps > delays_.room())
      return refuse(fmt::format("{} ends {} ps into cycle {}, beyond the {} ps that a cycle has", name(k),
                                own.ps, own.cycle, delays_.room()));
    const bool product = step(k).kind == Kind::product, rom = step(k).kind == Kind::rom;
    if ((product || rom) && own.ps != 0) refuse(fmt::format("{} ends in a register", name(k)));
    for (const int input : step(k).inputs) {
      const Moment in = at(input);
      bool late = false;
      if (product)
        late = in.cycle > own.cycle - 1 || (in.cycle == own.cycle - 1 && in.ps > 0);
      else if (rom)
        late = in.cycle > own.cycle - 2 ||
               (in.cycle == own.cycle - 2 && in.ps + picoseconds(k) > delays_.room());
      else
        late = in.cycle > own.cycle || own.ps < (in.cycle == own.cycle ? in.ps : 0) + picoseconds(k);
      if (late)
        return refuse(
            fmt::format("{} is there in cycle {} after {} ps, which is too soon after {} in cycle {} "
                        "after {} ps",
                        name(k), own.cycle, own.ps, name(input), in.cycle, in.ps));
    }
  }

  // Whether a step's value can stand in registers in the last cycle.
  void made_by(int k, const std::string& what) {
    if (!exists(k)) return refuse(fmt::format("nothing makes {}", what));
    if (at(k).cycle > s_.cycles || (at(k).cycle == s_.cycles && at(k).ps > 0))
      refuse(fmt::format("{} is there in cycle {} after {} ps, and the pipeline ends in cycle {}", what,
                         at(k).cycle, at(k).ps, s_.cycles));
  }

  void made() {
    if (s_.steps.outputs.size() != outputs_.size()) return refuse("the schedule has other outputs");
    for (size_t n = 0; n < outputs_.size(); ++n) {
      const Port& port = s_.steps.outputs[n];
      if (port.node != outputs_[n]) return refuse("the schedule has other outputs");
      made_by(port.step, "output '" + label(graph_, port.node) + "'");
      if (port.step != s_.steps.of_node[static_cast<size_t>(port.node)])
        return refuse("an output is another step");
    }
    std::vector<bool> needed(graph_.nodes.size());
    for (const int n : outputs_) needed[static_cast<size_t>(n)] = true;
    for (size_t n = needed.size(); n-- > 0;)
      if (needed[n]) {
        for (const int input : graph_.nodes[n].inputs) needed[static_cast<size_t>(input)] = true;
        ready(static_cast<int>(n));
        if (graph_.nodes[n].op == graph::Op::check) reported(static_cast<int>(n));
      }
  }

  void ready(int node) {
    const int k = s_.steps.of_node[static_cast<size_t>(node)];
    if (!exists(k)) return refuse(fmt::format("nothing makes '{}'", label(graph_, node)));
    if (s_.ready[static_cast<size_t>(node)] < at(k).cycle + (at(k).ps > 0 ? 1 : 0))
      refuse(fmt::format("'{}' is not ready in cycle {}", label(graph_, node),
                         s_.ready[static_cast<size_t>(node)]));
  }

  // A check's truth is among those that the fault is made of.
  void reported(int node) {
    for (const int k : {s_.steps.fault, s_.steps.fault_code, s_.steps.fault_number}) made_by(k, "the fault");
    if (!found_.empty()) return;
    std::vector<int> open{s_.steps.fault};
    std::vector<bool> seen(s_.steps.steps.size());
    while (!open.empty()) {
      const int k = open.back();
      open.pop_back();
      if (seen[static_cast<size_t>(k)]) continue;
      seen[static_cast<size_t>(k)] = true;
      if (step(k).kind == Kind::unfit && step(k).low == graph_.nodes[static_cast<size_t>(node)].width &&
          step(k).inputs[0] ==
              s_.steps.of_node[static_cast<size_t>(graph_.nodes[static_cast<size_t>(node)].inputs[0])])
        return;
      open.insert(open.end(), step(k).inputs.begin(), step(k).inputs.end());
    }
    refuse(fmt::format("no fault tells of '{}'", label(graph_, node)));
  }

  const graph::Graph& graph_;
  const std::vector<int>& outputs_;
  const Schedule& s_;
  const Delays& delays_;
  std::string found_;
};

}  // namespace

std::string refusal_of(const graph::Graph& graph, const std::vector<int>& outputs, const Schedule& schedule,
                       const Delays& delays) {
  return Audit(graph, outputs, schedule, delays).refusal();
}

}  // namespace cuboct::pipeline
