// SPDX-License-Identifier: MIT
#include "emu/systemc/node.h"

#include <utility>

#include "emu/systemc/brick_node.h"
#include "emu/systemc/link_guard.h"
#include "model/base/fixed_math.h"
#include "model/program/integer_program.h"

namespace cuboct::emu {

Node::Node(const Plan& plan, uint8_t has_link) : NodeMachine(plan, has_link) {
  engine_ = std::make_unique<ForceEngine>(plan, own_, halo_, times_, fault_);
  own_.reserve(capacity_);
  // Depths of the memories: an axis brings what the axes before it brought too.
  for (int f = 0, depth = capacity_; f < kFaces; f += 2, depth *= 3)
    halo_[f].reserve(depth), halo_[f + 1].reserve(depth);
  for (Inbox& i : inbox_) i.fifo.reserve(capacity_);
}

void Node::reset() {
  NodeMachine::reset();
  own_.clear();
  clear_halos();
  for (Inbox& i : inbox_) {
    i.fifo.clear();
    i.popped = 0;
  }
  ended_early_ = false;
  taking_ = 0;
}

void Node::append(uint32_t, const Slot& slot) { own_.push_back(slot); }

void Node::clear_halos() {
  for (auto& h : halo_) h.clear();
  for (auto& faces : later_)
    for (auto& records : faces) records.clear();
  for (auto& came : times_.came) came.clear();
  times_.ended.fill(0);
}

void Node::begin() {
  const bool goes_on = plan_.arch.halos == Halos::arrival && main_ < Main::force;
  if (main_ == Main::exchange_x) {
    relay_axis_ = 0;
    sent_axes_ = 0;
    ending_ = false;
    asked_ = sending_ = {};
  }
  if (!goes_on || main_ == Main::exchange_x) segment_ = record_ = 0;
  kept_ = 0;
  if (main_ == Main::force && round_ > 0) take_later();
  if (main_ == Main::update) {
    const int n = static_cast<int>(own_.size());
    const int finish = plan_.rounds[static_cast<size_t>(round_)].finish;
    const int cycles = n == 0 ? 1 : (n - 1) * plan_.latency.stride + finish;
    phase_last_ = now_ + static_cast<uint64_t>(cycles);
  }
  if (migrates())
    migrate_ = std::exchange(ended_early_, false)               ? Migrate::take_low
               : (leaving_ & bit(axis())) != 0 && !own_.empty() ? Migrate::scan
                                                                : Migrate::end;
}

void Node::pack_relayed(int segment, int record, std::span<uint64_t> out) const {
  if (round_ == 0) return pack_halo(plan_, relayed(segment, record), 0, out);
  const auto round = static_cast<size_t>(round_), at = static_cast<size_t>(record);
  pack_later(plan_.rounds[round].record,
             segment == 0 ? own_[at].body.fields : later_[round % 2][static_cast<size_t>(segment - 1)][at],
             out);
}

// The numbers that came in this round, to the records that they belong to.
void Node::take_later() {
  const auto round = static_cast<size_t>(round_);
  for (size_t f = 0; f < kFaces; ++f) {
    auto& records = later_[round % 2][f];
    for (size_t k = 0; k < records.size(); ++k)
      for (const WordField& field : plan_.rounds[round].record)
        halo_[f][k].fields[static_cast<size_t>(field.number)] = records[k][static_cast<size_t>(field.number)];
    records.clear();
  }
}

int Node::relayed_size(int segment) const {
  if (plan_.rounds[static_cast<size_t>(round_)].beats == 0) return 0;
  return static_cast<int>(segment == 0 ? own_.size() : halo_[segment - 1].size());
}

const Candidate& Node::relayed(int segment, int record) const {
  return segment == 0 ? own_[record].body : halo_[segment - 1][record];
}

void Node::next_segment() {
  record_ = 0;
  if (segment_ == 2 * relay_axis_)
    ending_ = true;
  else
    ++segment_;
}

// The relay asks for one thing: an end beat, a record that has come, or nothing.
Node::Relayed Node::ask() {
  if (relay_axis_ == axes_) return {};
  if (ending_) {
    ending_ = false;
    ++segment_;
    return {Relayed::Kind::end, relay_axis_++, 0};
  }
  const int count = relayed_size(segment_);
  const bool complete = segment_ == 0 || !linked(segment_ - 1) || (halo_ended() & bit(segment_ - 1)) != 0;
  if (record_ == count) {
    if (complete) next_segment();
    return {};
  }
  const Relayed item{Relayed::Kind::record, segment_, record_++};
  if (complete && record_ == count) next_segment();
  return item;
}

// One cycle of the relay: what is loaded, what the memories answer, what is asked for. All wait for the
// links.
void Node::relay() {
  bool held = false;
  if (sending_.kind == Relayed::Kind::end) {
    held = !load_ends(faces_of(sending_.segment));
    if (!held) sent_axes_ |= bit(sending_.segment);
  } else if (sending_.kind == Relayed::Kind::record) {
    uint8_t faces = 0;  // of all axes from the record's on
    for (int a = (sending_.segment + 1) / 2; a < axes_; ++a) faces |= faces_of(a);
    held = !can_load(faces);
    if (!held) {
      if (beat_ == 0) {
        word_.clear(plan_.words.halo_beats * plan_.words.link_bits);
        pack_halo(plan_, relayed(sending_.segment, sending_.record), 0, word_);
        count_relayed(sending_.segment == 0);
      }
      for (int f = 0; f < kFaces; ++f)
        if (faces >> f & 1) load_slice(f);
      held = ++beat_ < plan_.words.halo_beats;
      if (!held) beat_ = 0;
    }
  }
  if (held) return;
  if (asked_.kind == Relayed::Kind::record && asked_.segment == 0) {
    show(own_[static_cast<size_t>(asked_.record)]);
  }
  sending_ = std::exchange(asked_, ask());
}

bool Node::end_early(int axis) {
  return plan_.arch.halos == Halos::arrival && ((leaving_ & bit(axis)) == 0 || own_.empty()) &&
         empty(faces_of(axis)) && load_ends(faces_of(axis));
}

void Node::exchange() {
  if (plan_.arch.halos == Halos::arrival) {
    const bool sent = (sent_axes_ & bit(axis())) != 0;
    relay();
    if (sent && (faces_of(axis()) & ~halo_ended()) == 0) finish_phase(after(main_));
    return;
  }
  const int low = 2 * axis(), high = low + 1;
  const int segments = 1 + low;
  if (segment_ == segments) {
    sent_ = load_ends(faces_of(axis()));
    return;
  }
  if (relayed_size(segment_) == 0) {
    ++segment_;
    return;
  }
  if (!can_load(faces_of(axis()))) return;
  if (beat_ == 0 && main_ == Main::exchange_x && round_ == 0) {
    show(own_[record_]);
  }
  const int beats = plan_.rounds[static_cast<size_t>(round_)].beats;
  if (beat_ == 0) count_relayed(segment_ == 0);
  if (beats == 1) {
    for (const int f : {low, high})
      if (linked(f)) pack_relayed(segment_, record_, load(f, false));
  } else {
    if (beat_ == 0) word_.clear(beats * plan_.words.link_bits), pack_relayed(segment_, record_, word_);
    load_slice(low);
    load_slice(high);
  }
  if (++beat_ < beats) return;
  beat_ = 0;
  if (++record_ < relayed_size(segment_)) return;
  record_ = 0;
  ++segment_;
}

void Node::update() {
  if (now_ < phase_last_) {
    wakes_at_ = phase_last_;
    return;
  }
  leaving_ = 0;
  if (!last_round()) {
    for (size_t k = 0; k < own_.size(); ++k) finish_slot(own_[k], 0, k);
    finish_phase(Main::exchange_x);
    return;
  }
  for (size_t k = 0; k < own_.size(); ++k) {
    finish_slot(own_[k], 0, k);
    for (int a = 0; a < 3; ++a)
      if (own_[k].away[a] != 0) leaving_ |= bit(a);
  }
  ended_early_ = end_early(0);
  finish_phase(Main::migrate_x);
}

void Node::migrate() {
  const int low = 2 * axis(), high = low + 1;
  switch (migrate_) {
    case Migrate::scan:
      scan();
      break;
    case Migrate::end:
      if (load_ends(faces_of(axis()))) migrate_ = Migrate::take_low;
      break;
    case Migrate::take_low:
      take(low, Migrate::take_high, false);
      break;
    case Migrate::take_high:
      take(high, Migrate::scan, true);
      break;
  }
}

void Node::scan() {
  const int a = axis();
  const Slot& s = own_[record_];
  const int face = 2 * a + (s.away[a] > 0);
  if (s.away[a] == 0) {
    if (kept_ != static_cast<size_t>(record_)) own_[kept_] = s;
    ++kept_;
  } else if (!linked(face)) {
    fault_.add(along(Fault::left_x, a), s.body.id, 0, 0);
  } else if (!can_load(bit(face))) {
    return;
  } else {
    if (beat_ == 0) take_up(s);
    load_slice(face);
    if (++beat_ < plan_.words.migrate_beats) return;
    beat_ = 0;
    ++left_;
  }
  ++scanned_;
  if (static_cast<size_t>(++record_) < own_.size()) return;
  own_.resize(kept_);
  migrate_ = Migrate::end;
}

void Node::take(int face, Migrate next, bool last) {
  const int a = axis();
  Inbox& in = inbox_[face];
  if (in.popped < in.fifo.size()) {
    if (plan_.arch.narrow_memories) {  // word by word
      if (taking_ == 0) taking_ = plan_.words.migrate_beats + 2;
      if (--taking_ > 0) return;
    } else if (in.popped + 1 == in.fifo.size() && in.came + 1 == now_) {
      return;  // the memory has not answered yet
    }
    took_ = now_ + 1;
    Slot s = in.fifo[in.popped++];
    if (in.popped == in.fifo.size()) in.fifo.clear(), in.popped = 0;
    s.away[a] = 0;
    if (static_cast<int>(own_.size()) == capacity_) {
      fault_.add(along(Fault::full_x, a), s.body.id, capacity_, 0);
      return;
    }
    own_.push_back(s);
    for (int later = a + 1; later < axes_; ++later)
      if (s.away[later] != 0) leaving_ |= bit(later);
    return;
  }
  if (linked(face) && !(migrate_end_ & bit(face))) {
    wakes_at_ = kNever;
    return;
  }
  if (plan_.arch.halos == Halos::arrival) {
    if (!last) {
      const Inbox& above = inbox_[face + 1];
      last = above.popped == above.fifo.size() &&
             (!linked(face + 1) || (migrate_end_ & bit(face + 1)) != 0) && took_ != now_;
    } else if (took_ == now_) {
      return;  // the slot is not written yet
    }
  }
  migrate_ = next;
  if (!last) return;
  ended_early_ = a + 1 < axes_ && end_early(a + 1);
  finish_migration();
}

void Node::dump() {
  if (record_ < static_cast<int>(own_.size())) {
    show(own_[record_]);
    ++record_;
  }
  if (record_ == static_cast<int>(own_.size())) enter(Main::idle);
}

void Node::take_particle(int face, std::span<const uint64_t> record) {
  inbox_[face].fifo.push_back(unpack_particle(plan_, record));
  inbox_[face].came = now_;
}

void Node::take_halo(int face, int round, std::span<const uint64_t> record) {
  if (round > 0) {
    const auto at = static_cast<size_t>(round);
    auto& numbers = later_[at % 2][static_cast<size_t>(face)].emplace_back();
    numbers.resize(static_cast<size_t>(plan_.program->program.numbers()));
    unpack_later(plan_.rounds[at].record, record, numbers);
    return;
  }
  // Into the own frame.
  const int P = plan_.rule.widths.position_frac;
  const int64_t cell = int64_t{1} << P;
  Candidate& candidate = halo_[face].emplace_back();
  times_.came[static_cast<size_t>(face)].push_back(now_);
  unpack_halo(plan_, record, candidate);
  int32_t& x = candidate.x[static_cast<size_t>(face / 2)];
  x = static_cast<int32_t>(wrap(face % 2 == 0 ? x - cell : x + cell, P + 2));
}

uint8_t Node::awaited() const {
  if (migrate_ < Migrate::take_low) return 0;
  return bit(2 * axis() + (migrate_ == Migrate::take_high ? 1 : 0));
}

NodeFactory native_nodes(const Plan& plan) {
  check_words(plan);
  return guarded(plan, [&plan](uint32_t node, uint8_t has_link) -> std::unique_ptr<NodeModel> {
    if (plan.bricks.one_cell()) return std::make_unique<Node>(plan, has_link);
    return std::make_unique<BrickNode>(plan, node, has_link);
  });
}

}  // namespace cuboct::emu
