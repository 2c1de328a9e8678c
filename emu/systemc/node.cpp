// SPDX-License-Identifier: MIT
#include "emu/systemc/node.h"

#include <fmt/format.h>

#include <algorithm>

#include "emu/systemc/brick_node.h"
#include "emu/systemc/link_guard.h"
#include "model/fixed_math.h"

namespace cuboct::emu {
namespace {

constexpr uint8_t bit(int i) { return static_cast<uint8_t>(1u << i); }
constexpr uint8_t bit(Phase phase) { return bit(static_cast<int>(phase)); }
// `left_x` and `full_x` for another axis.
constexpr Fault along(Fault x, int axis) { return static_cast<Fault>(static_cast<int>(x) + 2 * axis); }

}  // namespace

Node::Node(const Plan& plan, uint8_t has_link)
    : plan_(plan),
      has_link_(has_link),
      axes_(plan.rule.axes),
      capacity_(plan.arch.capacity),
      link_words_(std::min((plan.words.link_bits + 63) / 64, int{Bits::kWords})),
      engine_(plan, own_, halo_, fault_) {
  own_.reserve(capacity_);
  // Depths of the memories: an axis brings what the axes before it brought too.
  for (int f = 0, depth = capacity_; f < kFaces; f += 2, depth *= 3)
    halo_[f].reserve(depth), halo_[f + 1].reserve(depth);
  for (Receiver& r : receiver_) r.fifo.reserve(capacity_);
}

void Node::reset() {
  own_.clear();
  for (auto& h : halo_) h.clear();
  for (Receiver& r : receiver_) {
    r.beat = 0;
    r.fifo.clear();
    r.popped = 0;
  }
  migrating_ = halo_end_ = migrate_end_ = 0;
  engine_.reset();
  main_ = Main::idle;
  fault_ = {};
  starting_ = valid_ = 0;
  taking_ = 0;
}

int Node::axis() const {
  return static_cast<int>(main_) % 5;  // exchange_* are 0...2, migrate_* are 5...7
}

// The register of a linked face, for what is loaded in this cycle; zeros.
Bits& Node::load(int face, bool end) {
  valid_ |= bit(face);
  out_->loaded |= bit(face);
  ++beats_;
  Beat& beat = *out_->beat[face];
  beat.end = end;
  for (int k = 0; k < link_words_; ++k) beat.payload.word[k] = 0;
  return beat.payload;
}

void Node::load_end(int low) {
  for (const int f : {low, low + 1})
    if (linked(f)) load(f, true);
}

// Loads beat `beat_` of `word_`.
void Node::load_slice(int face) {
  if (linked(face)) load(face, false) = word_.slice(beat_ * plan_.words.link_bits, plan_.words.link_bits);
}

// The main state after a phase; a step ends after the last one.
Node::Main Node::after(Main phase) const {
  if (axes_ == 2 && phase == Main::exchange_y) return Main::force;
  return static_cast<Main>(static_cast<int>(phase) + 1);
}

// Prepares the registers for a main state's first cycle, which is the next one.
void Node::enter(Main next) {
  main_ = next;
  segment_ = record_ = beat_ = 0;
  sent_ = false;
  kept_ = 0;
  if (next == Main::dump || next == Main::idle) return;
  const bool begins_engine = plan_.arch.overlap ? next == Main::exchange_x : next == Main::force;
  if (begins_engine) engine_.begin(now_ + 1), starting_ |= bit(Phase::force);
  if (next == Main::force)
    engine_.available(axes_ - 1, now_ + 1);
  else if (next > Main::exchange_x && next < Main::force)
    engine_.available(static_cast<int>(next) - 1, now_ + 1);
  if (next == Main::force)
    phase_last_ = engine_.run();
  else
    starting_ |= bit(static_cast<int>(next));
  if (next == Main::update) {
    const int n = static_cast<int>(own_.size());
    phase_last_ = now_ + static_cast<uint64_t>(n == 0 ? 1 : (n - 1) * plan_.latency.stride + plan_.latency.update);
  }
  if (next >= Main::migrate_x)
    migrate_ = (leaving_ & bit(axis())) != 0 && !own_.empty() ? Migrate::scan : Migrate::end;
}

void Node::finish_phase(Main next) {
  out_->phase_end |= bit(static_cast<int>(main_));
  enter(next);
}

void Node::idle() {
  const Control& host = *control_;
  out_->idle = true;
  if (!host.load_valid && !host.start) wakes_at_ = kNever;
  if (host.load_valid) own_.push_back(unpack_particle(plan_, host.load_data));
  if (!host.start) return;
  steps_ = host.steps;
  step_ = 0;
  enter(steps_ == 0 ? Main::dump : Main::exchange_x);
}

int Node::relayed_size(int segment) const {
  return static_cast<int>(segment == 0 ? own_.size() : halo_[segment - 1].size());
}

const Candidate& Node::relayed(int segment, int record) const {
  return segment == 0 ? own_[record].body : halo_[segment - 1][record];
}

void Node::exchange() {
  const int low = 2 * axis(), high = low + 1;
  if (sent_) {
    if ((faces_of(axis()) & ~halo_end_) == 0) {
      finish_phase(after(main_));
    } else {
      wakes_at_ = kNever;
    }
    return;
  }
  const int segments = 1 + low;
  if (segment_ < segments && relayed_size(segment_) == 0) {
    ++segment_;
    return;
  }
  if (!can_load(low) || !can_load(high)) {
    ++link_waits_;
    return;
  }
  if (segment_ == segments) {
    load_end(low);
    sent_ = true;
    return;
  }
  if (beat_ == 0 && main_ == Main::exchange_x) {
    out_->observe = true;
    out_->observe_data = pack_particle(plan_, own_[record_]);
  }
  const Candidate& record = relayed(segment_, record_);
  if (plan_.words.halo_beats == 1) {
    for (const int f : {low, high})
      if (linked(f)) pack_halo(plan_, record, load(f, false));
  } else {
    if (beat_ == 0) word_ = {}, pack_halo(plan_, record, word_);
    load_slice(low);
    load_slice(high);
  }
  if (++beat_ < plan_.words.halo_beats) return;
  beat_ = 0;
  if (++record_ < relayed_size(segment_)) return;
  record_ = 0;
  ++segment_;
}

void Node::force() {
  if (now_ < phase_last_) {
    wakes_at_ = phase_last_;
    return;
  }
  out_->phase_end |= bit(Phase::force);
  for (auto& h : halo_) h.clear();
  halo_end_ = 0;
  enter(Main::update);
}

void Node::update() {
  if (now_ < phase_last_) {
    wakes_at_ = phase_last_;
    return;
  }
  finish_particles();
  finish_phase(Main::migrate_x);
}

void Node::finish_particles() {
  const int p = plan_.rule.widths.position_frac;
  leaving_ = 0;
  for (size_t k = 0; k < own_.size(); ++k) {
    Slot& s = own_[k];
    const FinishResult r = finish(plan_.rule, engine_.take_sum(static_cast<int>(k)),
                                  {s.body.x[0], s.body.x[1], s.body.x[2]}, s.body.v, s.u, s.body.type);
    fault_.add(r.fault, s.id, r.number);
    s.u = r.u;
    for (int a = 0; a < 3; ++a) {
      s.body.v[a] = wrap(r.v[a], plan_.rule.widths.velocity_bits);
      s.away[a] = static_cast<int8_t>(wrap(r.x[a] >> p, 2));
      s.body.x[a] = static_cast<int32_t>(r.x[a] & ((int64_t{1} << p) - 1));
      if (s.away[a] != 0) leaving_ |= bit(a);
    }
  }
}

void Node::migrate() {
  const int low = 2 * axis(), high = low + 1;
  switch (migrate_) {
    case Migrate::scan:
      scan();
      break;
    case Migrate::end:
      if (!can_load(low) || !can_load(high)) {
        ++link_waits_;
        break;
      }
      load_end(low);
      migrate_ = Migrate::take_low;
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
    fault_.add(along(Fault::left_x, a), s.id, 0);
  } else if (!can_load(face)) {
    ++link_waits_;
    return;
  } else {
    if (beat_ == 0) word_ = pack_particle(plan_, s);
    load_slice(face);
    if (++beat_ < plan_.words.migrate_beats) return;
    beat_ = 0;
  }
  if (static_cast<size_t>(++record_) < own_.size()) return;
  own_.resize(kept_);
  migrate_ = Migrate::end;
}

void Node::take(int face, Migrate next, bool last) {
  const int a = axis();
  Receiver& r = receiver_[face];
  if (r.popped < r.fifo.size()) {
    if (plan_.arch.narrow_memories) {  // word by word
      if (taking_ == 0) taking_ = plan_.words.migrate_beats + 2;
      if (--taking_ > 0) return;
    } else if (r.popped + 1 == r.fifo.size() && r.came + 1 == now_) {
      return;  // the memory has not answered yet
    }
    Slot s = r.fifo[r.popped++];
    if (r.popped == r.fifo.size()) r.fifo.clear(), r.popped = 0;
    s.away[a] = 0;
    if (static_cast<int>(own_.size()) == capacity_) {
      fault_.add(along(Fault::full_x, a), s.id, capacity_);
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
  migrate_ = next;
  if (!last) return;
  migrate_end_ &= static_cast<uint8_t>(~faces_of(a));
  if (a != axes_ - 1) {
    finish_phase(after(main_));
    return;
  }
  if (fault_.code != Fault::none) {
    out_->fault = true;
    out_->fault_code = static_cast<uint8_t>(fault_.code);
    out_->fault_id = fault_.id;
    out_->fault_number = fault_.number;
  }
  fault_ = {};
  finish_phase(++step_ < steps_ ? Main::exchange_x : Main::dump);
}

void Node::dump() {
  if (record_ < static_cast<int>(own_.size())) {
    out_->observe = true;
    out_->observe_data = pack_particle(plan_, own_[record_]);
    ++record_;
  }
  if (record_ == static_cast<int>(own_.size())) enter(Main::idle);
}

void Node::receive(int face, const Beat& beat) {
  const bool migrating = migrating_ & bit(face);
  if (beat.end) {
    (migrating ? migrate_end_ : halo_end_) |= bit(face);
    migrating_ ^= bit(face);
    return;
  }
  const int beats = migrating ? plan_.words.migrate_beats : plan_.words.halo_beats;
  const Bits* record = &beat.payload;
  if (beats > 1) {
    Receiver& r = receiver_[face];
    if (r.beat == 0) r.partial = {};
    r.partial.join(r.beat * plan_.words.link_bits, plan_.words.link_bits, beat.payload);
    if (++r.beat < beats) return;
    r.beat = 0;
    record = &r.partial;
  }
  if (migrating) {
    receiver_[face].fifo.push_back(unpack_particle(plan_, *record));
    receiver_[face].came = now_;
    return;
  }
  const int64_t cell = int64_t{1} << plan_.rule.widths.position_frac;
  unpack_halo(plan_, *record, face / 2, face % 2 == 0 ? -cell : cell, halo_[face].emplace_back());
}

void Node::clock(const NodeInputs& in, NodeOutputs& out) {
  out_ = &out;
  now_ = in.now;
  wakes_at_ = now_ + 1;
  control_ = in.control;
  out.phase_start = starting_;
  out.phase_end = out.loaded = 0;
  out.observe = out.fault = out.idle = false;
  out.ready = has_link_;
  starting_ = 0;
  if (!in.control->reset_n) {
    reset();
    out.valid = 0;
    return;
  }
  can_load_ = static_cast<uint8_t>(~valid_ | in.ready | ~has_link_);
  valid_ &= static_cast<uint8_t>(~in.ready);

  switch (main_) {
    case Main::idle:
      idle();
      break;
    case Main::exchange_x:
    case Main::exchange_y:
    case Main::exchange_z:
      exchange();
      break;
    case Main::force:
      force();
      break;
    case Main::update:
      update();
      break;
    case Main::migrate_x:
    case Main::migrate_y:
    case Main::migrate_z:
      migrate();
      break;
    case Main::dump:
      dump();
      break;
  }
  // What comes now may be what the node waits for; the end of a phase of known length does not.
  if (in.valid != 0 && wakes_at_ == kNever) wakes_at_ = now_ + 1;
  for (uint8_t left = in.valid; left != 0; left &= static_cast<uint8_t>(left - 1)) {
    const int f = __builtin_ctz(left);
    receive(f, *in.beat[f]);
  }
  out.valid = valid_;
}

std::string Node::doing() const {
  static const char* const kFace[] = {"-x", "+x", "-y", "+y", "-z", "+z"};
  if (main_ == Main::idle) return "idle";
  if (main_ == Main::dump) return "dump";
  std::string text = fmt::format("step {}, {}", step_, to_string(static_cast<Phase>(main_)));
  const auto faces = [&](uint8_t mask) {
    std::string list;
    for (int f = 0; f < kFaces; ++f)
      if (mask >> f & 1) list += fmt::format(" {}", kFace[f]);
    return list;
  };
  const int low = 2 * axis(), high = low + 1;
  if (main_ <= Main::exchange_z && sent_)
    return text + ": waits for the halo of" + faces(faces_of(axis()) & static_cast<uint8_t>(~halo_end_));
  if (main_ >= Main::migrate_x && migrate_ >= Migrate::take_low)
    return text + ": waits for the particles of" + faces(bit(migrate_ == Migrate::take_low ? low : high));
  if (valid_ != 0) return text + ": waits for ready of" + faces(valid_);
  return text;
}

Counters Node::counters() const {
  const ForceEngine::Counts& c = engine_.counts();
  const auto number = [](uint64_t n) { return static_cast<double>(n); };
  return {{"candidates", number(c.candidates)},     {"pairs_issued", number(c.pairs_issued)},
          {"pairs_inside", number(c.pairs_inside)}, {"queue_stalls", number(c.stalls)},
          {"issue_cycles", number(c.issue_cycles)}, {"force_cycles", number(c.busy)},
          {"link_beats", number(beats_)},           {"link_waits", number(link_waits_)}};
}

NodeFactory native_nodes(const Plan& plan) {
  check_words(plan);
  return guarded(plan, [&plan](uint32_t node, uint8_t has_link) -> std::unique_ptr<NodeModel> {
    if (plan.bricks.single()) return std::make_unique<Node>(plan, has_link);
    return std::make_unique<BrickNode>(plan, node, has_link);
  });
}

}  // namespace cuboct::emu
