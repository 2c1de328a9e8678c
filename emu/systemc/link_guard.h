// SPDX-License-Identifier: MIT
// The checks of a node's links around any node model: what rtl/lib/links/cuboct_link_guard.sv is around the
// node's core, cycle for cycle. docs/reference/links.md.
#pragma once

#include <memory>

#include "emu/machine/node_model.h"
#include "hw/plan/plan.h"
#include "model/base/error.h"

namespace cuboct::emu {

// A link's code with its tables; shared by all nodes.
class BeatCode {
 public:
  explicit BeatCode(const Plan& plan);

  // A node's beat as it goes over the wire, and what the wire's payload holds again.
  void seal(const Beat& beat, uint32_t sequence, Beat& wire) const;
  uint32_t sequence(const Beat& wire) const {
    return static_cast<uint32_t>(
        wire.payload.get(code.wire_bits - code.beat.width - code.sequence_bits, code.sequence_bits));
  }
  // Whether the check of a wire's beat is right; `beat` then is the node's.
  bool open(const Beat& wire, Beat& beat) const;
  uint16_t acknowledge(uint32_t sequence) const { return acks_[sequence]; }
  bool acknowledges(uint16_t ack) const { return acks_[ack & sequence_mask] == ack; }

  // The words that a beat of a wire fills.
  void copy(const Bits& from, Bits& to) const { std::copy_n(from.word.begin(), words_, to.word.begin()); }

  const LinkCode code;
  const int link_bits;
  const uint32_t sequence_mask;

 private:
  const size_t words_;
  CrcTable crc_;
  std::array<uint16_t, 16> acks_{};
};

class LinkGuard : public NodeModel {
 public:
  LinkGuard(std::shared_ptr<const BeatCode> code, uint8_t has_link, std::unique_ptr<NodeModel> node);

  void clock(const NodeInputs& in, NodeOutputs& out) override;
  uint64_t wakes_at() const override;
  std::string doing() const override;
  Counters counters(uint64_t end) const override;

 private:
  // cuboct_link_send: a register for the wire, and the beats that are not acknowledged yet.
  struct Sender {
    uint32_t base = 0, next = 0, head = 0, timer = 0;
    bool valid = false;
    uint16_t ack = 0;
    std::vector<Beat> kept;  // by sequence modulo the window; of wires; only with retry
  };
  // cuboct_link_take.
  struct Taker {
    uint32_t expected = 0;
    bool closed = false;
    uint16_t ack = 0;
  };
  // Faces at which one cycle found something wrong.
  struct Errors {
    uint8_t beat_wrong = 0, beat_order = 0, ack_wrong = 0, silent = 0;
    uint8_t beats() const { return beat_wrong | beat_order; }
    uint8_t acks() const { return ack_wrong | silent; }
  };

  void reset();
  bool send(int face, bool wire_ready, uint16_t ack, NodeOutputs& out);
  void take(int face, const Beat& wire);
  void show_fault(NodeOutputs& out);
  void tell();
  bool quiet() const;

  const std::shared_ptr<const BeatCode> code_;
  const uint8_t has_link_;
  const bool retry_;
  const std::unique_ptr<NodeModel> node_;
  std::array<Sender, kFaces> sender_;
  std::array<Taker, kFaces> taker_;
  NodeInputs inner_;                 // the node's inputs
  std::array<Beat, kFaces> loaded_;  // the node's link registers
  std::array<Beat, kFaces> taken_;   // the checked registers
  uint8_t inner_valid_ = 0;          // of the node's link registers
  Errors errors_;                    // of the last cycle
  // Without retry: code and face of the first error, from the cycle after it.
  Fault told_ = Fault::none;
  int told_face_ = 0;
  bool shown_ = false;
  uint64_t now_ = 0, resent_ = 0, discarded_ = 0;
};

// Nodes with checked links, or `nodes` where the plan has none.
NodeFactory guarded(const Plan& plan, NodeFactory nodes);

}  // namespace cuboct::emu
