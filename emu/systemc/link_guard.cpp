// SPDX-License-Identifier: MIT
#include "emu/systemc/link_guard.h"

#include <fmt/format.h>

#include "model/base/error.h"

namespace cuboct::emu {
namespace {

constexpr uint8_t bit(int i) { return static_cast<uint8_t>(1u << i); }

}  // namespace

BeatCode::BeatCode(const Plan& plan)
    : code(plan.link),
      link_bits(plan.words.link_bits),
      sequence_mask((1u << code.sequence_bits) - 1),
      words_(static_cast<size_t>(code.wire_bits + 1 + 63) / 64),
      crc_(code.beat) {
  const CrcTable ack(code.ack);
  for (uint32_t s = 0; s < acks_.size(); ++s) {
    const uint64_t word = s;
    acks_[s] = static_cast<uint16_t>(s | ack(&word, code.sequence_bits) << code.sequence_bits);
  }
}

void BeatCode::seal(const Beat& beat, uint32_t sequence, Beat& wire) const {
  wire.end = beat.end;
  Bits& w = wire.payload;
  copy(beat.payload, w);
  w.put(link_bits, 1, beat.end);
  w.put(link_bits + 1, code.sequence_bits, sequence);
  const uint32_t check = crc_(w.word.data(), link_bits + 1 + code.sequence_bits);
  copy(beat.payload, w);
  w.put(link_bits, code.sequence_bits, sequence);
  w.put(link_bits + code.sequence_bits, code.beat.width, check);
}

bool BeatCode::open(const Beat& wire, Beat& beat) const {
  beat.end = wire.end;
  const auto take = [&] {
    std::fill_n(beat.payload.word.begin(), words_, 0);
    wire.payload.slice(0, link_bits, beat.payload);
  };
  take();
  beat.payload.put(link_bits, 1, wire.end);
  beat.payload.put(link_bits + 1, code.sequence_bits, sequence(wire));
  const uint32_t check = crc_(beat.payload.word.data(), link_bits + 1 + code.sequence_bits);
  take();
  return check == wire.payload.get(link_bits + code.sequence_bits, code.beat.width);
}

LinkGuard::LinkGuard(std::shared_ptr<const BeatCode> code, uint8_t has_link, std::unique_ptr<NodeModel> node)
    : code_(std::move(code)),
      has_link_(has_link),
      retry_(code_->code.check == LinkCheck::retry),
      node_(std::move(node)) {
  for (int f = 0; f < kFaces; ++f) {
    inner_.beat[f] = &taken_[f];
    if (retry_ && (has_link >> f & 1)) sender_[f].kept.resize(static_cast<size_t>(code_->code.window));
  }
}

void LinkGuard::reset() {
  for (int f = 0; f < kFaces; ++f) {
    Sender& s = sender_[f];
    s.base = s.next = s.head = s.timer = 0;
    s.valid = false;
    s.ack = code_->acknowledge(0);
    taker_[f] = {0, false, code_->acknowledge(0)};
  }
  inner_.valid = inner_valid_ = 0;
  errors_ = {};
  told_ = Fault::none;
  shown_ = false;
}

// A cycle of the sender; whether it takes what the node's register holds.
bool LinkGuard::send(int face, bool wire_ready, uint16_t ack, NodeOutputs& out) {
  Sender& s = sender_[face];
  const LinkCode& code = code_->code;
  const uint32_t mask = code_->sequence_mask;
  const uint32_t pending = (s.head - s.base) & mask, sent = (s.next - s.base) & mask;
  const bool good = code_->acknowledges(s.ack);
  const uint32_t acked = ((s.ack & mask) - s.base) & mask;
  const bool progress = good && acked != 0 && acked <= pending;
  const bool waiting = !s.valid && sent != 0 && !progress;
  const bool expired = waiting && s.timer == static_cast<uint32_t>(code.patience);
  s.timer = waiting && !expired ? s.timer + 1 : 0;
  if (!good) errors_.ack_wrong |= bit(face);
  if (expired) errors_.silent |= bit(face);

  const bool can_load = !s.valid || wire_ready, replay = s.next != s.head;
  const bool ready = can_load && !replay && pending != static_cast<uint32_t>(code.window);
  const bool accept = ready && (inner_valid_ & bit(face)) != 0;
  const bool load = accept || (can_load && replay);
  if (load) {
    Beat& wire = *out.beat[face];
    const size_t slot = s.next % static_cast<uint32_t>(code.window);
    if (replay) {
      wire.end = s.kept[slot].end;
      code_->copy(s.kept[slot].payload, wire.payload);
    } else {
      code_->seal(loaded_[face], s.next, wire);
      if (retry_) {
        s.kept[slot].end = wire.end;
        code_->copy(wire.payload, s.kept[slot].payload);
      }
    }
    out.loaded |= bit(face);
  }
  s.valid = load || (s.valid && !wire_ready);
  s.ack = ack;
  const uint32_t oldest = s.base;
  if (accept) s.head = (s.head + 1) & mask;
  if (load) s.next = (s.next + 1) & mask;
  if (progress) {
    s.base = (oldest + acked) & mask;
    if (acked > sent) s.next = s.base;
  }
  if (expired && retry_) {
    s.next = oldest;
    ++resent_;
  }
  return ready;
}

void LinkGuard::take(int face, const Beat& wire) {
  Taker& t = taker_[face];
  if (t.closed) return;
  const bool good = code_->open(wire, taken_[face]);
  if (good && code_->sequence(wire) == t.expected) {
    t.expected = (t.expected + 1) & code_->sequence_mask;
    inner_.valid |= bit(face);
    return;
  }
  (good ? errors_.beat_order : errors_.beat_wrong) |= bit(face);
  ++discarded_;
  t.closed = !retry_;
}

// The node's own fault goes first.
void LinkGuard::show_fault(NodeOutputs& out) {
  if (told_ == Fault::none || shown_ || out.fault) return;
  out.fault = true;
  out.fault_code = static_cast<uint8_t>(told_);
  out.fault_id = 0;
  out.fault_cell = 0;
  out.fault_number = told_face_;
  shown_ = true;
}

void LinkGuard::tell() {
  const uint8_t faces = errors_.beats() | errors_.acks();
  if (retry_ || told_ != Fault::none || faces == 0) return;
  told_face_ = __builtin_ctz(faces);
  const uint8_t face = bit(told_face_);
  told_ = ((errors_.beat_wrong | errors_.ack_wrong) & face) != 0 ? Fault::link_check
          : (errors_.beat_order & face) != 0                     ? Fault::link_order
                                                                 : Fault::link_silent;
}

void LinkGuard::clock(const NodeInputs& in, NodeOutputs& out) {
  const std::array<Beat*, kFaces> wires = out.beat;
  const Errors before = errors_;
  const bool running = in.control->reset_n;
  errors_ = {};
  out.loaded = 0;
  inner_.now = now_ = in.now;
  inner_.control = in.control;
  inner_.ready = 0;
  if (running)
    for (uint8_t left = has_link_; left != 0; left &= static_cast<uint8_t>(left - 1)) {
      const int f = __builtin_ctz(left);
      if (send(f, in.ready >> f & 1, in.ack[f], out)) inner_.ready |= bit(f);
    }
  const uint8_t wires_loaded = out.loaded;

  for (int f = 0; f < kFaces; ++f) out.beat[f] = &loaded_[f];
  node_->clock(inner_, out);
  inner_valid_ = out.valid;
  inner_.valid = 0;
  if (running) {
    show_fault(out);
    for (uint8_t left = has_link_; left != 0; left &= static_cast<uint8_t>(left - 1)) {
      const int f = __builtin_ctz(left);
      taker_[f].ack = code_->acknowledge(taker_[f].expected);
      if (in.valid >> f & 1) take(f, *in.beat[f]);
    }
    tell();
  } else {
    reset();
  }

  out.beat = wires;
  out.loaded = running ? wires_loaded : 0;
  out.valid = 0;
  for (int f = 0; f < kFaces; ++f) {
    if (sender_[f].valid) out.valid |= bit(f);
    out.ack[f] = taker_[f].ack;
  }
  out.ready = has_link_;
  out.beat_errors = before.beats();
  out.ack_errors = before.acks();
}

// Whether nothing is on its way in a register, nothing unacknowledged and nothing still to be told.
bool LinkGuard::quiet() const {
  if (inner_valid_ != 0 || inner_.valid != 0 || (errors_.beats() | errors_.acks()) != 0) return false;
  if (told_ != Fault::none && !shown_) return false;
  for (uint8_t left = has_link_; left != 0; left &= static_cast<uint8_t>(left - 1)) {
    const int f = __builtin_ctz(left);
    const Sender& s = sender_[f];
    if (s.valid || s.base != s.head || s.ack != code_->acknowledge(s.base)) return false;
    if (taker_[f].ack != code_->acknowledge(taker_[f].expected)) return false;
  }
  return true;
}

uint64_t LinkGuard::wakes_at() const { return quiet() ? node_->wakes_at() : now_ + 1; }

std::string LinkGuard::doing() const {
  if (told_ == Fault::none) return node_->doing();
  return fmt::format("{}; {} on the link of face {}", node_->doing(), to_string(told_), told_face_);
}

Counters LinkGuard::counters(uint64_t end) const {
  Counters all = node_->counters(end);
  all.emplace_back("beats_discarded", static_cast<double>(discarded_));
  all.emplace_back("link_resends", static_cast<double>(resent_));
  return all;
}

NodeFactory guarded(const Plan& plan, NodeFactory nodes) {
  if (!plan.link.checked()) return nodes;
  const auto code = std::make_shared<const BeatCode>(plan);
  return [code, nodes = std::move(nodes)](uint32_t node, uint8_t has_link) {
    return std::make_unique<LinkGuard>(code, has_link, nodes(node, has_link));
  };
}

}  // namespace cuboct::emu
