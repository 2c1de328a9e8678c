// SPDX-License-Identifier: MIT
// What the bench asks of a node, whoever implements it: the ports of docs/reference/node.md, one call per
// clock cycle.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "emu/machine/bits.h"
#include "model/contract/lattice.h"

namespace cuboct::emu {

// One beat of a link: the payload, or the end of a stream. Bits beyond the link's width are always
// zero; a writer need not clear them. Aligned so that a narrow one lies in one cache line.
struct alignas(64) Beat {
  bool end = false;
  Bits payload;
};

// The host's side of a node's ports.
struct Control {
  bool reset_n = false;
  bool start = false;
  uint32_t steps = 0;
  bool load_valid = false;
  uint32_t load_cell = 0;  // of a brick
  Word load_data;
  bool operator==(const Control&) const = default;
};

// A cycle that never comes.
inline constexpr uint64_t kNever = UINT64_MAX;

// A node's inputs during one cycle. Bit f of a mask belongs to face f.
struct NodeInputs {
  uint64_t now =
      0;  // the cycle, counted from any origin; ascends over the calls, by more than one after a sleep
  const Control* control = nullptr;
  uint8_t valid = 0;                       // link_valid_i
  uint8_t ready = 0;                       // link_ready_i
  std::array<const Beat*, kFaces> beat{};  // where `valid`
  std::array<uint16_t, kFaces> ack{};      // link_ack_i, where links are checked
};

// What a node shows of one cycle, and its link registers after the edge that ends the cycle.
struct NodeOutputs {
  // Of the cycle.
  uint32_t phase_start = 0, phase_end = 0;  // bit p: number p of the step's phases (model/trace/trace.h)
  bool observe = false, fault = false, idle = false;
  uint32_t observe_cell = 0, fault_cell = 0;  // of a brick: where `observe`, where `fault`
  uint8_t fault_code = 0;                     // these where `fault`
  // Of a rule of text, what the node was doing: twice the round, one more in its finish, two more in a
  // migration. An earlier stage's fault counts before a later one's.
  int fault_stage = 0;
  uint32_t fault_id = 0;
  int64_t fault_number = 0;
  uint8_t beat_errors = 0, ack_errors = 0;  // link_error_o: of arriving beats, of acknowledgements
  // After the edge.
  uint8_t valid = 0;                   // link_valid_o
  uint8_t loaded = 0;                  // faces whose register is new; a subset of `valid`
  uint8_t ready = 0;                   // link_ready_o
  std::array<uint16_t, kFaces> ack{};  // link_ack_o, where links are checked
  // Where the node writes link_end_o and link_data_o of the loaded faces: the caller's, who may put another
  // place here between calls. None where there is no link.
  std::array<Beat*, kFaces> beat{};
  Word observe_data;  // where `observe`; last, as it is long and seldom touched
};

using Counters = std::vector<std::pair<std::string, double>>;

// Adds `part` to what `sum` holds from `first` on; an empty tail takes its names.
inline void add_counters(Counters& sum, size_t first, const Counters& part) {
  if (sum.size() == first)
    for (const auto& [name, value] : part) sum.emplace_back(name, 0.0);
  for (size_t k = 0; k < part.size(); ++k) sum[first + k].second += part[k].second;
}

class NodeModel {
 public:
  virtual ~NodeModel() = default;
  // One clock cycle. `out` is the same object in every call. Different nodes are called in different threads.
  virtual void clock(const NodeInputs& in, NodeOutputs& out) = 0;
  // After `clock`: the next cycle that the node must be called for. In the cycles before, as long as no link
  // holds a beat on either side and the control stays as it is, the node would show nothing and load nothing,
  // and they may be left out. A call in one of them is right too; any value up to the next cycle asks for
  // each.
  virtual uint64_t wakes_at() const { return 0; }
  // After `clock`, of models that do not know their future: with the same inputs no call would change
  // anything or show anything. Calls may be left out until an input changes, be it a ready or an
  // acknowledgement.
  virtual bool stands_still() const { return false; }
  // What the node is doing, for the report of a deadlock.
  virtual std::string doing() const { return "unknown"; }
  // Counters of this node over the cycles before `end`, always the same names in the same order; the bench
  // adds them up over the nodes.
  virtual Counters counters(uint64_t /*end*/) const { return {}; }
};

// `node` counts the plan's physical nodes; `has_link` the faces that have a neighbour.
using NodeFactory = std::function<std::unique_ptr<NodeModel>(uint32_t node, uint8_t has_link)>;

}  // namespace cuboct::emu
