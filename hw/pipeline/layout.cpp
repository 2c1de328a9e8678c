// SPDX-License-Identifier: MIT
#include "hw/pipeline/layout.h"

namespace cuboct::pipeline {
namespace {

Bits lowest(int n) { return n <= 0 ? Bits{} : ~Bits{} >> (kMostBits - n); }

class Readers {
 public:
  explicit Readers(const Schedule& schedule) : schedule_(schedule), steps_(schedule.steps.steps) {
    layout_.read.resize(steps_.size());
    const Steps& all = schedule.steps;
    for (const Port& port : all.outputs) read(port.step, schedule.cycles, whole(port.step));
    if (all.fault >= 0)
      for (const int step : {all.fault, all.fault_code, all.fault_number})
        read(step, schedule.cycles, whole(step));
    // Whoever reads a step stands behind it.
    for (int k = static_cast<int>(steps_.size()); k-- > 0;) take(k);
  }
  Layout take() { return std::move(layout_); }

 private:
  const Step& step(int k) const { return steps_[static_cast<size_t>(k)]; }
  Bits whole(int k) const { return lowest(step(k).bits); }

  void read(int k, int cycle, const Bits& bits) {
    if (step(k).kind != Kind::constant) layout_.read[static_cast<size_t>(k)][cycle] |= bits;
  }

  void take(int k) {
    const auto& cycles = layout_.read[static_cast<size_t>(k)];
    if (cycles.empty()) return;
    const Step& of = step(k);
    if (of.kind == Kind::slice || of.kind == Kind::join) {
      for (const auto& [cycle, bits] : cycles)
        of.kind == Kind::slice ? slice(of, cycle, bits) : join(of, cycle, bits);
      return;
    }
    for (size_t n = 0; n < of.inputs.size(); ++n)
      read(of.inputs[n], start_of(schedule_, k), operand(of, n) & whole(of.inputs[n]));
  }

  // What a step looks at of an input.
  Bits operand(const Step& of, size_t n) const {
    const Step& input = step(of.inputs[n]);
    switch (of.kind) {
      case Kind::add:
      case Kind::sub:
      case Kind::exclusive:
      case Kind::choose:
        return lowest(of.bits);
      case Kind::carry:
        return lowest(of.low) | Bits{1} << (input.bits - 1);
      case Kind::unfit:
        return ~lowest(of.low - 1);
      default:
        return ~Bits{};
    }
  }

  void slice(const Step& of, int cycle, const Bits& bits) {
    const Step& input = step(of.inputs[0]);
    Bits from;
    for (int k = 0; k < of.bits; ++k) {
      if (!bits[static_cast<size_t>(k)]) continue;
      if (k + of.low < input.bits)
        from.set(static_cast<size_t>(k + of.low));
      else if (input.is_signed)
        from.set(static_cast<size_t>(input.bits - 1));
    }
    read(of.inputs[0], cycle, from);
  }

  void join(const Step& of, int cycle, const Bits& bits) {
    const int low = step(of.inputs[1]).bits;
    read(of.inputs[0], cycle, (bits >> static_cast<size_t>(low)) & whole(of.inputs[0]));
    read(of.inputs[1], cycle, bits & lowest(low));
  }

  const Schedule& schedule_;
  const std::vector<Step>& steps_;
  Layout layout_;
};

}  // namespace

Bits Layout::held(int step, int cycle) const {
  Bits bits;
  const auto& cycles = read[static_cast<size_t>(step)];
  for (auto at = cycles.lower_bound(cycle); at != cycles.end(); ++at) bits |= at->second;
  return bits;
}

Layout layout_of(const Schedule& schedule) { return Readers(schedule).take(); }

int start_of(const Schedule& schedule, int step) {
  const int cycle = schedule.at[static_cast<size_t>(step)].cycle;
  switch (schedule.steps.steps[static_cast<size_t>(step)].kind) {
    case Kind::product:
      return cycle - 1;
    case Kind::rom:
      return cycle - 2;
    default:
      return cycle;
  }
}

}  // namespace cuboct::pipeline
