// SPDX-License-Identifier: MIT
#include "emu/verilated/verilated_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>

#include "emu/machine/words.h"
#include "hw/rtl/rtl_design.h"
#include "model/trace/trace.h"

namespace cuboct::emu {

void read_outputs(const CuboctOut& from, NodeOutputs& out) {
  out.phase_start = from.phase_start;
  out.phase_end = from.phase_end;
  out.idle = from.idle != 0;
  out.observe = from.observe_valid != 0;
  static_assert(Bits::kWords == kCuboctWords && Word::kWords >= kCuboctParticleWords);
  if (out.observe) std::memcpy(out.observe_data.word.data(), from.observe_data, sizeof from.observe_data);
  out.fault = from.fault_valid != 0;
  out.fault_code = from.fault_code;
  out.fault_stage = from.fault_stage;
  out.fault_id = from.fault_id;
  out.observe_cell = from.observe_cell;
  out.fault_cell = from.fault_cell;
  out.fault_number = from.fault_number;
  out.beat_errors = from.beat_errors;
  out.ack_errors = from.ack_errors;
}

VerilatedNode::VerilatedNode(std::shared_ptr<const Library> library, const Plan& plan, uint32_t node,
                             uint8_t has_link, uint32_t seed)
    : library_(std::move(library)),
      has_link_(has_link),
      model_(library_->create(seed)),
      rounds_(static_cast<int>(plan.rounds.size())) {
  if (plan.bricks.one_cell()) return;
  const auto words = [](const std::vector<bool>& bits) {
    std::vector<uint64_t> packed(bits.size() / 64 + 2);
    for (size_t k = 0; k < bits.size(); ++k) packed[k / 64] |= uint64_t{bits[k]} << k % 64;
    return packed;
  };
  library_->place(model_, words(extent_bits(plan, node)).data(), words(exit_bits(plan, node)).data());
}

VerilatedNode::~VerilatedNode() { library_->destroy(model_); }

void VerilatedNode::clock(const NodeInputs& in, NodeOutputs& out) {
  const Control& host = *in.control;
  CuboctIn ports{};
  ports.reset_n = host.reset_n;
  ports.start = host.start;
  ports.steps = host.steps;
  ports.load_valid = host.load_valid;
  ports.load_data = host.load_data.word.data();
  ports.load_cell = host.load_cell;
  ports.has_link = has_link_;
  ports.link_valid = in.valid;
  ports.link_ready = in.ready;
  std::copy(in.ack.begin(), in.ack.end(), ports.link_ack);
  for (uint8_t left = in.valid; left != 0; left &= static_cast<uint8_t>(left - 1)) {
    const int f = __builtin_ctz(left);
    ports.link_end |= static_cast<uint8_t>(in.beat[f]->end << f);
    ports.link_data[f] = in.beat[f]->payload.word.data();
  }
  for (size_t e = 0; e < events_.size(); ++e) events_[e] = event_cycles(e, in.now);
  if (host.reset_n)
    beats_ +=
        static_cast<uint64_t>(std::popcount(static_cast<unsigned>(out_.link_valid & has_link_ & in.ready)));
  last_ = in.now;
  const char* failed = library_->clock(model_, &ports, &out_);
  if (failed != nullptr) {
    const std::string when = begin_ ? fmt::format("cycle {}", in.now - *begin_) : "before the run";
    throw std::runtime_error(fmt::format("{}: the assertion of the RTL at {} failed", when, failed));
  }
  if (host.start) begin_ = in.now + 1;

  read_outputs(out_, out);
  if (!host.reset_n) out_.force_event = out_.pairs = 0;  // what registers hold before is no event
  pairs_ += out_.pairs;
  out.valid = out.loaded = out_.link_valid & has_link_;
  out.ready = out_.link_ready & has_link_;
  std::copy(out_.link_ack, out_.link_ack + kFaces, out.ack.begin());
  for (uint8_t left = out.loaded; left != 0; left &= static_cast<uint8_t>(left - 1)) {
    const int f = __builtin_ctz(left);
    out.beat[f]->end = out_.link_end >> f & 1;
    std::memcpy(out.beat[f]->payload.word.data(), out_.link_data[f], sizeof out_.link_data[f]);
  }
  phases_ = (phases_ | out.phase_start) & ~out.phase_end;
  idle_ = out.idle;
}

uint64_t VerilatedNode::event_cycles(size_t event, uint64_t end) const {
  return events_[event] + ((out_.force_event >> event & 1) != 0 && end > last_ ? end - last_ : 0);
}

Counters VerilatedNode::counters(uint64_t end) const {
  const auto count = [&](size_t event) { return static_cast<double>(event_cycles(event, end)); };
  // Of each streamer.
  const auto sum = [&](size_t event) {
    double cycles = 0;
    for (size_t e = event; e < events_.size(); e += 3) cycles += count(e);
    return cycles;
  };
  return {{"candidates", sum(2)},     {"pairs_issued", static_cast<double>(pairs_)},
          {"queue_stalls", sum(1)},   {"issue_cycles", sum(3)},
          {"force_cycles", count(0)}, {"link_beats", static_cast<double>(beats_)}};
}

std::string VerilatedNode::doing() const {
  if (idle_) return "idle";
  std::string text = "in";
  for (int p = 0; p < phases_of(rounds_); ++p)
    if (phases_ >> p & 1) text += " " + phase_name(p, rounds_);
  return text;
}

NodeFactory verilated_nodes(const Plan& plan, const std::string& build_directory, uint32_t seed,
                            const std::string& optimise) {
  check_words(plan, 64 * kCuboctParticleWords);
  auto library = std::make_shared<const Library>(compile_node(plan, build_directory, optimise));
  return [library, &plan, seed](uint32_t node, uint8_t has_link) {
    return std::make_unique<VerilatedNode>(library, plan, node, has_link, seed == 0 ? 0 : seed + node);
  };
}

}  // namespace cuboct::emu
