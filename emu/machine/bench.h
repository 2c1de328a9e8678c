// SPDX-License-Identifier: MIT
// The SystemC bench: a lattice of node modules, wired by links, loaded and started by a host, watched by a
// collector. It serves any NodeModel: the native node and the Verilated one run behind the same links.
//
// SystemC elaborates once per process: build all benches, then call `simulate` once.
#pragma once

#include <memory>
#include <ostream>
#include <string>
#include <systemc>
#include <vector>

#include "emu/machine/collector.h"
#include "emu/machine/device_link.h"
#include "emu/machine/link.h"
#include "emu/machine/loop_bench.h"

namespace cuboct::emu {

// sc_signal and its ports ask for these two.
inline std::ostream& operator<<(std::ostream& out, const Control& c) { return out << c.reset_n << c.start; }
inline void sc_trace(sc_core::sc_trace_file*, const Control&, const std::string&) {}

class NodeModule;

// The host's view of the run that the node modules report to.
class Monitor : public virtual sc_core::sc_interface {
 public:
  virtual const Timeline& timeline() const = 0;
  // For the cycles that count and in which the node shows something.
  virtual void report(uint32_t node, const NodeOutputs& out) = 0;
  // A node that cannot go on: the run is over.
  virtual void fail(uint32_t node, const std::string& text) = 0;
  // The node is awake at the next edge.
  virtual void expect(NodeModule& node) = 0;
  // At an edge, before its first node goes on: calls the models of all that were expected, in threads.
  virtual void evaluate() = 0;
};

class NodeModule : public sc_core::sc_module {
 public:
  sc_core::sc_in<bool> clk_i{"clk_i"};
  sc_core::sc_in<Control> control_i{"control_i"};
  sc_core::sc_port<Monitor> monitor_o{"monitor_o"};
  // By face; unbound where there is no neighbour.
  sc_core::sc_vector<sc_core::sc_port<LinkReceiver, 1, sc_core::SC_ZERO_OR_MORE_BOUND>> link_i{"link_i",
                                                                                               kFaces};
  sc_core::sc_vector<sc_core::sc_port<LinkSender, 1, sc_core::SC_ZERO_OR_MORE_BOUND>> link_o{"link_o",
                                                                                             kFaces};

  NodeModule(const sc_core::sc_module_name& name, uint32_t node, uint8_t has_link,
             std::unique_ptr<NodeModel> model, bool checked, bool faults);
  NodeModel& model() { return *model_; }
  uint64_t calls() const { return calls_; }  // of the model, in cycles that count
  // Calls the model for this edge: reads what all links showed before it, writes nothing that another node
  // reads.
  void evaluate();

 private:
  void end_of_elaboration() override;
  void cycle();
  void heed_control();
  void sleep(uint64_t until);
  void rest();
  const NodeInputs& seen();

  const uint32_t node_;
  const uint8_t has_link_;
  std::unique_ptr<NodeModel> model_;
  std::vector<int> faces_;  // that have a neighbour
  std::array<LinkReceiver*, kFaces> in_link_{};
  std::array<LinkSender*, kFaces> out_link_{};
  const Timeline* timeline_ = nullptr;
  bool stalls_ = false;
  const bool checked_, faults_;  // links are checked; wires have faults
  LinkPins pins_;
  uint64_t evaluated_ = kNever;  // the edge that the outputs are of
  std::string failure_;          // of the model
  uint64_t calls_ = 0;
  uint8_t valid_ = 0, ready_ = 0;  // the link registers as the node left them
  std::array<uint16_t, kFaces> ack_{};
  NodeInputs seen_;  // of wires with faults
};

class Bench : public sc_core::sc_module, private Monitor {
 public:
  // Keeps a reference to `plan`. Throws RunError for an initial state beyond a capacity.
  Bench(const sc_core::sc_module_name& name, const Plan& plan, const State& initial,
        const RunOptions& options, const NodeFactory& factory, const std::string& engine);
  ~Bench() override;

  sc_core::sc_in<bool> clk_i{"clk_i"};

  bool over() const { return timeline_.over; }
  const Trace& collected() const { return collector_.trace(); }
  double seconds() const;  // host time of the steps so far
  // After `simulate`; throws std::runtime_error for a run that was stuck or whose node failed.
  RunResult take_result();

 private:
  friend class BenchClock;
  enum class Host : uint8_t { reset, load, start, run };

  const Timeline& timeline() const override { return timeline_; }
  void report(uint32_t node, const NodeOutputs& out) override;
  void fail(uint32_t node, const std::string& text) override;
  void expect(NodeModule& node) override { expected_.push_back(&node); }
  void evaluate() override;
  void host();
  void tell_all(const Control& control);
  void tick() { ++timeline_.edge; }
  void wire(uint32_t node, int face);

  const Plan& plan_;
  const RunOptions options_;
  const std::string engine_;
  const std::vector<std::vector<Loaded>> particles_;
  const uint64_t patience_;
  Timeline timeline_;
  const StallSource stalls_;
  FaultyWires faults_;
  int aftermath_;  // cycles to go on after the run
  Collector collector_;
  sc_core::sc_vector<sc_core::sc_signal<Control>> control_;
  std::vector<std::unique_ptr<Link>> links_;
  std::vector<std::unique_ptr<DeviceLink>> board_links_;
  std::vector<std::unique_ptr<NodeModule>> nodes_;
  std::vector<NodeModule*> expected_;  // at the next edge
  Host state_ = Host::reset;
  size_t loaded_ = 0, most_ = 0;
  std::string stuck_;  // why there is no result
  // Host time, s: when the steps began, less the time between pieces; when the last piece ended; of all
  // steps.
  double begin_ = 0, paused_ = 0, seconds_ = 0;
};

// Clocks benches. One per process.
class BenchClock {
 public:
  explicit BenchClock(std::vector<Bench*> benches);
  // A thousand cycles, unless each bench is over.
  void go_on();

 private:
  std::vector<Bench*> benches_;
  sc_core::sc_clock clock_;
};

// Clocks all benches until each is over.
void simulate(const std::vector<Bench*>& benches);

}  // namespace cuboct::emu
