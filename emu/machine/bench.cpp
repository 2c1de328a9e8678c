// SPDX-License-Identifier: MIT
#include "emu/machine/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "model/base/interrupt.h"
#include "model/base/parallel.h"

namespace cuboct::emu {

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

NodeModule::NodeModule(const sc_core::sc_module_name& name, uint32_t node, uint8_t has_link,
                       std::unique_ptr<NodeModel> model, bool checked, bool faults)
    : sc_module(name),
      node_(node),
      has_link_(has_link),
      model_(std::move(model)),
      checked_(checked),
      faults_(faults) {
  for (int f = 0; f < kFaces; ++f)
    if (has_link >> f & 1) faces_.push_back(f);
  SC_HAS_PROCESS(NodeModule);
  SC_METHOD(cycle);
  sensitive << clk_i.pos();
  dont_initialize();
  SC_METHOD(heed_control);
  sensitive << control_i;
  dont_initialize();
}

void NodeModule::end_of_elaboration() {
  timeline_ = &monitor_o->timeline();
  pins_.inputs.control = &control_i.read();  // the signal's current value, which keeps its place
  for (const int f : faces_) {
    in_link_[f] = link_i[f][0];
    out_link_[f] = link_o[f][0];
    in_link_[f]->attach_receiver(pins_, f);
    out_link_[f]->attach_sender(pins_, f);
    stalls_ |= out_link_[f]->stalls();
  }
}

void NodeModule::heed_control() {
  if (pins_.asleep) pins_.wake.notify(sc_core::SC_ZERO_TIME);
}

void NodeModule::sleep(uint64_t until) {
  pins_.asleep = true;
  next_trigger(pins_.wake);
  if (until == kNever) return;
  // Half a period before the edge. A register that is filled before notifies the same event at once, which
  // takes the place of this.
  const uint64_t period = timeline_->period;
  pins_.wake.notify(sc_core::sc_time::from_value((until - timeline_->edge) * period - period / 2));
}

// What the node's ends of faulty wires show.
const NodeInputs& NodeModule::seen() {
  seen_ = pins_.inputs;
  for (const int f : faces_) {
    const uint8_t bit = static_cast<uint8_t>(1u << f);
    if (const FaultyWire::View* in = in_link_[f]->faulty()) {
      seen_.valid = static_cast<uint8_t>((seen_.valid & ~bit) | (in->valid ? bit : 0));
      seen_.beat[f] = in->beat;
    }
    if (const FaultyWire::View* out = out_link_[f]->faulty()) {
      seen_.ready = static_cast<uint8_t>((seen_.ready & ~bit) | (out->ready ? bit : 0));
      seen_.ack[f] = out->ack;
    }
  }
  return seen_;
}

void NodeModule::evaluate() {
  evaluated_ = timeline_->edge;
  NodeInputs& in = pins_.inputs;
  in.now = timeline_->edge;
  in.valid = pins_.held;
  in.ready = pins_.ready;
  if (stalls_) {
    for (const int f : faces_) {
      const uint8_t bit = static_cast<uint8_t>(1u << f);
      if ((in.valid & bit) && in_link_[f]->gated()) in.valid &= static_cast<uint8_t>(~bit);
      if ((in.ready & bit) && out_link_[f]->gated()) in.ready &= static_cast<uint8_t>(~bit);
    }
  }
  // SystemC would wrap the text of an exception that leaves a process.
  try {
    model_->clock(faults_ ? seen() : in, pins_.outputs);
  } catch (const std::runtime_error& e) {
    failure_ = e.what();
  }
}

void NodeModule::cycle() {
  // The wake event comes between two edges, or one delta after the edge at which a link or the control
  // changed: the change belongs to the next cycle, and the static sensitivity is back.
  if (pins_.asleep) {
    pins_.asleep = false;
    monitor_o->expect(*this);
    return;
  }
  if (timeline_->over) {
    sleep(kNever);
    return;
  }
  if (evaluated_ != timeline_->edge) monitor_o->evaluate();
  if (!failure_.empty()) {
    monitor_o->fail(node_, failure_);
    sleep(kNever);
    return;
  }
  const NodeInputs& in = pins_.inputs;
  const NodeOutputs& out = pins_.outputs;
  if (timeline_->running()) {
    ++calls_;
    if (Collector::shows(out) || (out.beat_errors | out.ack_errors) != 0) monitor_o->report(node_, out);
  }

  const uint8_t emptied = valid_ & static_cast<uint8_t>(~out.valid);
  const uint8_t ready_changed = ready_ ^ out.ready;
  const uint8_t taken = in.valid & ready_;
  for (uint8_t left = out.loaded; left != 0; left &= static_cast<uint8_t>(left - 1))
    out_link_[__builtin_ctz(left)]->put();
  for (uint8_t left = emptied; left != 0; left &= static_cast<uint8_t>(left - 1))
    out_link_[__builtin_ctz(left)]->clear();
  for (uint8_t left = ready_changed; left != 0; left &= static_cast<uint8_t>(left - 1)) {
    const int f = __builtin_ctz(left);
    in_link_[f]->set_ready(out.ready >> f & 1);
  }
  valid_ = out.valid;
  ready_ = out.ready;
  if (checked_)
    for (const int f : faces_)
      if (ack_[f] != out.ack[f]) in_link_[f]->set_ack(ack_[f] = out.ack[f]);
  if (valid_ == 0 && (pins_.held & ~taken) == 0) rest();
  if (!pins_.asleep) monitor_o->expect(*this);
}

// No link holds a beat on either side.
void NodeModule::rest() {
  if (faults_ && std::any_of(faces_.begin(), faces_.end(), [&](int f) { return in_link_[f]->repeats(); }))
    return;
  // Gates and faults change inputs without an event.
  pins_.heeds_all = model_->stands_still() && !stalls_ && !faults_;
  if (pins_.heeds_all)
    sleep(kNever);
  else if (model_->wakes_at() > pins_.inputs.now + 1)
    sleep(model_->wakes_at());
}

Bench::Bench(const sc_core::sc_module_name& name, const Plan& plan, const State& initial,
             const RunOptions& options, const NodeFactory& factory, const std::string& engine)
    : sc_module(name),
      plan_(plan),
      options_(options),
      engine_(engine),
      particles_(by_node(plan, initial)),
      patience_(options.patience != 0 ? options.patience : patience_of(plan, options.stall_rate)),
      stalls_(options.stall_rate, options.stall_seed),
      faults_(plan, options.faults, initial, options.steps),
      aftermath_(options.faults.enabled() ? kAftermath : 0),
      collector_(plan, options),
      control_("control", plan.nodes()) {
  for (const auto& list : particles_) most_ = std::max(most_, list.size());
  for (uint32_t n = 0; n < plan.nodes(); ++n) {
    const uint8_t has_link = links_of(plan, n);
    nodes_.push_back(std::make_unique<NodeModule>(fmt::format("node_{}", n).c_str(), n, has_link,
                                                  factory(n, has_link), plan.link.checked(),
                                                  options.faults.enabled()));
    nodes_[n]->clk_i(clk_i);
    nodes_[n]->control_i(control_[n]);
    nodes_[n]->monitor_o(*this);
    expected_.push_back(nodes_[n].get());
  }
  for (uint32_t n = 0; n < plan.nodes(); ++n)
    for (int f = 0; f < kFaces; ++f)
      if (plan.neighbour(n, f) != kNoNode) wire(n, f);
  timeline_.period = sc_core::sc_time(1, sc_core::SC_NS).value();
  SC_HAS_PROCESS(Bench);
  SC_METHOD(host);
  sensitive << clk_i.pos();
  dont_initialize();
  SC_METHOD(tick);
  sensitive << clk_i.neg();
  dont_initialize();
}

Bench::~Bench() = default;

// What node `n` sends over a face. Between devices there are two channels, and the board's link.
void Bench::wire(uint32_t n, int face) {
  const uint32_t number = n * kFaces + static_cast<uint32_t>(face);
  const auto channel = [&](const char* end) -> Link& {
    const std::string name = fmt::format("link_{}_{}{}", n, face, end);
    return *links_.emplace_back(
        std::make_unique<Link>(name.c_str(), timeline_, stalls_, number, faults_.at(n, face)));
  };
  auto& sender = nodes_[n]->link_o[static_cast<size_t>(face)];
  auto& receiver = nodes_[plan_.neighbour(n, face)]->link_i[static_cast<size_t>(face ^ 1)];
  if (!plan_.crosses(n, face)) {
    Link& link = channel("");
    sender(link);
    receiver(link);
    return;
  }
  Link &from = channel("_from"), &to = channel("_to");
  const std::string name = fmt::format("board_{}_{}", n, face);
  DeviceLink& board =
      *board_links_.emplace_back(std::make_unique<DeviceLink>(name.c_str(), timeline_, plan_.arch.boards));
  board.clk_i(clk_i);
  sender(from);
  board.link_i(from);
  board.link_o(to);
  receiver(to);
}

void Bench::report(uint32_t node, const NodeOutputs& out) {
  if (timeline_.over) return;
  faults_.heed(plan_, node, out);
  if (collector_.done()) return;
  try {
    if (Collector::shows(out)) collector_.collect(node, timeline_.cycle(), out);
  } catch (const std::runtime_error& e) {
    fail(node, e.what());
  }
}

void Bench::evaluate() {
  // A wire with faults is looked at by both of its nodes.
  const int threads = options_.faults.enabled() ? 1 : options_.threads;
  const size_t least = threads > 0 ? 1 : 64;  // nodes, below which a thread is not worth its waking
  for_each_range(
      expected_.size(), least,
      [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) expected_[k]->evaluate();
      },
      threads);
  expected_.clear();
}

void Bench::fail(uint32_t node, const std::string& text) {
  if (timeline_.over || collector_.done()) return;
  stuck_ = node_text(plan_, node) + ", " + text;
  timeline_.over = true;
}

void Bench::tell_all(const Control& control) {
  for (size_t n = 0; n < control_.size(); ++n) control_[n].write(control);
}

// Writes the controls for the next cycle.
void Bench::host() {
  if (timeline_.over) return;
  Control control;
  control.reset_n = true;
  switch (state_) {
    case Host::reset:
      tell_all(control);
      state_ = Host::load;
      return;
    case Host::load:
      for (uint32_t n = 0; n < nodes_.size(); ++n) {
        load(particles_[n], loaded_, control);
        control_[n].write(control);
      }
      if (++loaded_ > most_) state_ = Host::start;
      return;
    case Host::start:
      control.start = true;
      control.steps = static_cast<uint32_t>(options_.steps);
      tell_all(control);
      timeline_.base = timeline_.edge + 2;  // the next cycle is the last in IDLE
      begin_ = now();
      state_ = Host::run;
      return;
    case Host::run:
      if (timeline_.edge + 1 == timeline_.base) tell_all(control);
      if (!timeline_.running()) return;
      if (interrupted()) collector_.break_off(timeline_.cycle());
      if (collector_.done()) {
        seconds_ = now() - begin_;
        faults_.source.close();
        timeline_.over = aftermath_-- == 0;
      } else if (timeline_.cycle() > collector_.last_event() + patience_) {
        std::vector<std::string> doing;
        for (const auto& n : nodes_) doing.push_back(n->model().doing());
        stuck_ = stuck_text(plan_, timeline_.cycle(), patience_, doing);
        timeline_.over = true;
      }
      return;
  }
}

RunResult Bench::take_result() {
  if (!stuck_.empty()) throw std::runtime_error(stuck_);
  if (!timeline_.over) throw std::runtime_error("the bench has not run");
  RunResult result;
  Counters counters{{"cycles", static_cast<double>(collector_.last_cycle() + 1)}};
  double calls = 0;
  for (const auto& n : nodes_) {
    add_counters(counters, 1, n->model().counters(timeline_.edge));
    calls += static_cast<double>(n->calls());
  }
  counters.emplace_back("node_calls", calls);
  if (options_.faults.enabled())
    for (const auto& counter : faults_.source.counters()) counters.push_back(counter);
  result.faults = faults_.source.counts();
  result.first_fault = faults_.source.first();
  result.trace = collector_.take_trace();
  result.order = collector_.order();
  result.trace.engine = engine_;
  result.trace.seconds = seconds_;
  result.trace.counters = std::move(counters);
  return result;
}

double Bench::seconds() const {
  if (begin_ == 0 || collector_.done()) return seconds_;
  return paused_ - begin_;
}

BenchClock::BenchClock(std::vector<Bench*> benches)
    : benches_(std::move(benches)), clock_("clock", sc_core::sc_time(1, sc_core::SC_NS)) {
  for (Bench* b : benches_) b->clk_i(clock_);
}

void BenchClock::go_on() {
  for (Bench* b : benches_)
    if (b->begin_ > 0) b->begin_ += now() - b->paused_;
  if (!std::ranges::all_of(benches_, &Bench::over)) sc_core::sc_start(sc_core::sc_time(1000, sc_core::SC_NS));
  for (Bench* b : benches_) b->paused_ = now();
}

void simulate(const std::vector<Bench*>& benches) {
  BenchClock clock(benches);
  while (!std::ranges::all_of(benches, &Bench::over)) clock.go_on();
}

}  // namespace cuboct::emu
