// SPDX-License-Identifier: MIT
#include "emu/systemc/brick_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "model/fixed_math.h"

namespace cuboct::emu {
namespace {

constexpr uint8_t bit(int i) { return static_cast<uint8_t>(1u << i); }
constexpr uint8_t bit(Phase phase) { return bit(static_cast<int>(phase)); }
constexpr Fault along(Fault x, int axis) { return static_cast<Fault>(static_cast<int>(x) + 2 * axis); }

}  // namespace

BrickNode::BrickNode(const Plan& plan, uint32_t node, uint8_t has_link)
    : plan_(plan),
      node_(node),
      has_link_(has_link),
      axes_(plan.rule.axes),
      capacity_(plan.arch.capacity),
      link_words_(std::min((plan.words.link_bits + 63) / 64, int{Bits::kWords})),
      extent_(plan.bricks.node(node).extent),
      grid_(plan.bricks.shape()),
      walk_(plan.bricks.shape(), extent_, has_link, axes_),
      cells_{std::vector<std::vector<Slot>>(cells_of(plan.bricks.shape())),
             std::vector<std::vector<Candidate>>(grid_.size())},
      engine_(plan, walk_, cells_, fault_),
      leaving_(cells_.own.size()) {}

void BrickNode::reset() {
  for (auto& list : cells_.own) list.clear();
  for (auto& list : cells_.halo) list.clear();
  for (Receiver& r : receiver_) {
    r.beat = 0;
    r.fifo.clear();
  }
  for (auto& list : inner_) list.clear();
  migrating_ = halo_end_ = migrate_end_ = 0;
  engine_.reset();
  main_ = Main::idle;
  fault_ = {};
  starting_ = valid_ = 0;
}

// The register of a linked face, for what is loaded in this cycle; zeros.
Bits& BrickNode::load(int face, bool end) {
  valid_ |= bit(face);
  out_->loaded |= bit(face);
  ++beats_;
  Beat& beat = *out_->beat[face];
  beat.end = end;
  for (int k = 0; k < link_words_; ++k) beat.payload.word[k] = 0;
  return beat.payload;
}

// Loads beat `beat_` of `word_`.
void BrickNode::load_slice(int face) {
  load(face, false) = word_.slice(beat_ * plan_.words.link_bits, plan_.words.link_bits);
}

BrickNode::Main BrickNode::after(Main phase) const {
  if (axes_ == 2 && phase == Main::exchange_y) return Main::force;
  return static_cast<Main>(static_cast<int>(phase) + 1);
}

// Prepares the registers for a main state's first cycle, which is the next one.
void BrickNode::enter(Main next) {
  main_ = next;
  pass_ = beat_ = 0;
  place_ = record_ = kept_ = 0;
  sent_ = false;
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
    size_t walk = 0, held = 0;
    for (const uint32_t c : walk_.own) {
      walk += std::max<size_t>(cells_.own[c].size(), 1);
      held += cells_.own[c].size();
    }
    phase_last_ = now_ + (held == 0 ? 1 : walk - 1 + static_cast<uint64_t>(plan_.latency.update));
  }
  if (next >= Main::migrate_x) {
    const bool any = std::any_of(leaving_.begin(), leaving_.end(),
                                 [this](uint8_t axes) { return (axes & bit(axis())) != 0; });
    migrate_ = any ? Migrate::scan : Migrate::end;
  }
}

void BrickNode::finish_phase(Main next) {
  out_->phase_end |= bit(static_cast<int>(main_));
  enter(next);
}

// A cycle of a walk over the own cells that has done with a record, of `count` in this cell, or has met an
// empty one; whether it was the walk's last.
bool BrickNode::walk_on(size_t count) {
  if (++record_ < count) return false;
  record_ = 0;
  return ++place_ == walk_.own.size();
}

void BrickNode::observe(const Slot& slot) {
  out_->observe = true;
  out_->observe_cell = walked();
  out_->observe_data = pack_particle(plan_, slot);
}

void BrickNode::idle() {
  const Control& host = *control_;
  out_->idle = true;
  if (!host.load_valid && !host.start) wakes_at_ = kNever;
  if (host.load_valid) cells_.own[host.load_cell].push_back(unpack_particle(plan_, host.load_data));
  if (!host.start) return;
  steps_ = host.steps;
  step_ = 0;
  enter(steps_ == 0 ? Main::dump : Main::exchange_x);
}

// The linked faces that this pass of an exchange sends to: both at once where the brick is one cell thick.
uint8_t BrickNode::pass_faces() const {
  const int low = 2 * axis();
  if (plan_.bricks.shape()[axis()] == 1) return faces_of(axis());
  return static_cast<uint8_t>(has_link_ & bit(low + pass_));
}

void BrickNode::end_pass(uint8_t faces) {
  for (int f = 0; f < kFaces; ++f)
    if (faces >> f & 1) load(f, true);
  place_ = record_ = 0;
  if (plan_.bricks.shape()[axis()] == 1 || ++pass_ == 2) sent_ = true;
}

void BrickNode::exchange() {
  if (sent_) {
    if ((faces_of(axis()) & ~halo_end_) == 0)
      finish_phase(after(main_));
    else
      wakes_at_ = kNever;
    return;
  }
  const uint8_t faces = pass_faces();
  if (faces == 0) {  // nobody there: the cycle of the end beat
    end_pass(0);
    return;
  }
  // Both layers of a brick one cell thick are the same.
  const auto& layer = walk_.sent[static_cast<size_t>(__builtin_ctz(faces))];
  const auto size = [&](const BrickWalk::Sent& s) {
    return s.local >= 0 ? cells_.own[static_cast<size_t>(s.local)].size() : cells_.halo[s.grid].size();
  };
  if (place_ < layer.size() && size(layer[place_]) == 0) {
    ++place_;
    return;
  }
  if ((faces & ~can_load_) != 0) {
    ++link_waits_;
    return;
  }
  if (place_ == layer.size()) {
    end_pass(faces);
    return;
  }
  const BrickWalk::Sent& from = layer[place_];
  if (beat_ == 0) {
    word_ = {};
    pack_cell_halo(plan_,
                   from.local >= 0 ? cells_.own[static_cast<size_t>(from.local)][record_].body
                                   : cells_.halo[from.grid][record_],
                   from.tag, word_);
  }
  for (int f = 0; f < kFaces; ++f)
    if (faces >> f & 1) load_slice(f);
  if (++beat_ < plan_.words.halo_beats) return;
  beat_ = 0;
  if (++record_ < size(from)) return;
  record_ = 0;
  ++place_;
}

void BrickNode::force() {
  if (now_ < phase_last_) {
    wakes_at_ = phase_last_;
    return;
  }
  out_->phase_end |= bit(Phase::force);
  for (auto& list : cells_.halo) list.clear();
  halo_end_ = 0;
  enter(Main::update);
}

void BrickNode::update() {
  if (place_ < walk_.own.size()) {
    const auto& slots = cells_.own[walked()];
    if (!slots.empty()) observe(slots[record_]);
    walk_on(slots.size());
  }
  if (now_ < phase_last_) return;
  finish_particles();
  finish_phase(Main::migrate_x);
}

// Notes along which axes, from `first_axis` on, a particle of the cell leaves it.
void BrickNode::mark(uint32_t local, const Slot& slot, int first_axis) {
  for (int a = first_axis; a < axes_; ++a)
    if (slot.away[static_cast<size_t>(a)] != 0) leaving_[local] |= bit(a);
}

void BrickNode::finish_particles() {
  const int p = plan_.rule.widths.position_frac;
  std::fill(leaving_.begin(), leaving_.end(), 0);
  for (const uint32_t c : walk_.own)
    for (size_t k = 0; k < cells_.own[c].size(); ++k) {
      Slot& s = cells_.own[c][k];
      const FinishResult r = finish(plan_.rule, engine_.take_sum(c, k),
                                    {s.body.x[0], s.body.x[1], s.body.x[2]}, s.body.v, s.u, s.body.type);
      fault_.add(r.fault, s.id, r.number, c);
      s.u = r.u;
      for (size_t a = 0; a < 3; ++a) {
        s.body.v[a] = wrap(r.v[a], plan_.rule.widths.velocity_bits);
        s.away[a] = static_cast<int8_t>(wrap(r.x[a] >> p, 2));
        s.body.x[a] = static_cast<int32_t>(r.x[a] & ((int64_t{1} << p) - 1));
      }
      mark(c, s, 0);
    }
}

void BrickNode::migrate() {
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
      for (const int f : {low, high})
        if (linked(f)) load(f, true);
      migrate_ = Migrate::wait;
      break;
    case Migrate::wait:
      wait();
      break;
    case Migrate::land:
      land();
      break;
  }
}

void BrickNode::scan() {
  const uint32_t c = walked();
  auto& slots = cells_.own[c];
  bool walk_over;
  if (slots.empty() || (leaving_[c] & bit(axis())) == 0) {
    walk_over = ++place_ == walk_.own.size();
  } else {
    const Slot& s = slots[record_];
    if (s.away[static_cast<size_t>(axis())] == 0) {
      if (kept_ != record_) slots[kept_] = s;
      ++kept_;
    } else {
      const uint64_t before = link_waits_;
      leave(c, s);
      if (beat_ != 0 || link_waits_ != before) return;
    }
    const size_t held = slots.size();
    const bool cell_over = record_ + 1 == held;
    walk_over = walk_on(held);
    if (cell_over) slots.resize(std::exchange(kept_, 0));
  }
  if (!walk_over) return;
  place_ = record_ = 0;
  migrate_ = Migrate::end;
}

// A cycle of a particle that leaves its cell. `beat_` is 0 after the last one, unless it had to wait.
void BrickNode::leave(uint32_t local, const Slot& slot) {
  const int a = axis();
  const bool up = slot.away[static_cast<size_t>(a)] > 0;
  const int face = 2 * a + (up ? 1 : 0);
  const uint32_t cell = plan_.bricks.cell(node_, local);
  const uint32_t to = cell == kNoNode ? kNoNode : plan_.lattice.neighbour(cell, face);
  if (to == kNoNode) {
    fault_.add(along(Fault::left_x, a), slot.id, 0, local);
    return;
  }
  // Whether it goes over the brick's face.
  Cell at;
  const Cell& shape = plan_.bricks.shape();
  at[0] = static_cast<int32_t>(local) % shape[0];
  at[1] = static_cast<int32_t>(local) / shape[0] % shape[1];
  at[2] = static_cast<int32_t>(local) / shape[0] / shape[1];
  if (at[a] != (up ? extent_[a] - 1 : 0)) {
    at[a] += up ? 1 : -1;
    inner_[up ? 0 : 1].push_back({grid_.local(at), slot});
    inner_[up ? 0 : 1].back().slot.away[static_cast<size_t>(a)] = 0;
    return;
  }
  if (!can_load(face)) {
    ++link_waits_;
    return;
  }
  if (beat_ == 0) {
    word_ = pack_particle(plan_, slot);
    word_.put(plan_.words.particle_bits, plan_.words.migrate_cell_bits, grid_.migrate_tag(a, at));
  }
  load_slice(face);
  if (++beat_ == plan_.words.migrate_beats) beat_ = 0;
}

// Until all that comes has come.
void BrickNode::wait() {
  if ((faces_of(axis()) & ~migrate_end_) != 0) {
    wakes_at_ = kNever;
    return;
  }
  const int low = 2 * axis();
  if (inner_[0].empty() && inner_[1].empty() && receiver_[low].fifo.empty() &&
      receiver_[low + 1].fifo.empty()) {
    place_ = walk_.own.size();
    land();
    return;
  }
  migrate_ = Migrate::land;
}

// Particles that go to this cell next: in each list they lie in the order of the cells.
size_t BrickNode::landing(uint32_t local) const {
  size_t count = 0;
  const auto add = [&](const std::deque<Mover>& list) {
    for (auto it = list.begin(); it != list.end() && it->to == local; ++it) ++count;
  };
  for (const auto& list : inner_) add(list);
  add(receiver_[2 * axis()].fifo);
  add(receiver_[2 * axis() + 1].fifo);
  return count;
}

void BrickNode::append(uint32_t local, std::deque<Mover>& from) {
  const Slot& s = from.front().slot;
  auto& slots = cells_.own[local];
  if (static_cast<int>(slots.size()) < capacity_) {
    slots.push_back(s);
    mark(local, s, axis() + 1);
  } else {
    fault_.add(along(Fault::full_x, axis()), s.id, capacity_, local);
  }
  from.pop_front();
}

// A cycle of the walk over the cells: one particle lands, from below before from above.
void BrickNode::land() {
  const int a = axis();
  if (place_ < walk_.own.size()) {
    const uint32_t c = walked();
    const size_t left = landing(c);
    if (left > 0) {
      std::array<std::deque<Mover>*, 4> lists{&inner_[0], &receiver_[2 * a].fifo, &inner_[1],
                                              &receiver_[2 * a + 1].fifo};
      append(c, **std::find_if(lists.begin(), lists.end(),
                               [&](auto* list) { return !list->empty() && list->front().to == c; }));
    }
    if (left > 1 || ++place_ < walk_.own.size()) return;
  }
  migrate_end_ &= static_cast<uint8_t>(~(3u << 2 * a));
  if (a + 1 < axes_) {
    finish_phase(static_cast<Main>(static_cast<int>(main_) + 1));
    return;
  }
  if (fault_.code != Fault::none) {
    out_->fault = true;
    out_->fault_code = static_cast<uint8_t>(fault_.code);
    out_->fault_id = fault_.id;
    out_->fault_number = fault_.number;
    out_->fault_cell = fault_.cell;
    fault_ = {};
  }
  finish_phase(++step_ == steps_ ? Main::dump : Main::exchange_x);
}

void BrickNode::dump() {
  const auto& slots = cells_.own[walked()];
  if (!slots.empty()) observe(slots[record_]);
  if (walk_on(slots.size())) enter(Main::idle);
}

void BrickNode::receive(int face, const Beat& beat) {
  const bool migrating = migrating_ & bit(face);
  if (beat.end) {
    (migrating ? migrate_end_ : halo_end_) |= bit(face);
    migrating_ ^= bit(face);
    return;
  }
  const int beats = migrating ? plan_.words.migrate_beats : plan_.words.halo_beats;
  const Bits* record = &beat.payload;
  Receiver& r = receiver_[face];
  if (beats > 1) {
    if (r.beat == 0) r.partial = {};
    r.partial.join(r.beat * plan_.words.link_bits, plan_.words.link_bits, beat.payload);
    if (++r.beat < beats) return;
    r.beat = 0;
    record = &r.partial;
  }
  const int a = face / 2;
  const bool high = face % 2 == 1;
  if (migrating) {
    const auto tag =
        static_cast<uint32_t>(record->get(plan_.words.particle_bits, plan_.words.migrate_cell_bits));
    const Cell at = grid_.of_migrate_tag(a, tag % grid_.migrate_tags(a), high ? extent_[a] - 1 : 0);
    r.fifo.push_back({grid_.local(at), unpack_particle(plan_, *record)});
    r.fifo.back().slot.away[static_cast<size_t>(a)] = 0;
    return;
  }
  Candidate candidate;
  const uint32_t tag = unpack_cell_halo(plan_, *record, candidate);
  const Cell at = grid_.of_halo_tag(a, tag % grid_.halo_tags(a), high ? extent_[a] : -1);
  cells_.halo[grid_.at(at)].push_back(candidate);
}

void BrickNode::clock(const NodeInputs& in, NodeOutputs& out) {
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
  if (in.valid != 0 && wakes_at_ == kNever) wakes_at_ = now_ + 1;
  for (uint8_t left = in.valid; left != 0; left &= static_cast<uint8_t>(left - 1)) {
    const int f = __builtin_ctz(left);
    receive(f, *in.beat[f]);
  }
  out.valid = valid_;
}

std::string BrickNode::doing() const {
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
  if (main_ <= Main::exchange_z && sent_)
    return text + ": waits for the halo of" + faces(faces_of(axis()) & static_cast<uint8_t>(~halo_end_));
  if (main_ >= Main::migrate_x && migrate_ == Migrate::wait)
    return text + ": waits for the particles of" +
           faces(faces_of(axis()) & static_cast<uint8_t>(~migrate_end_));
  if (valid_ != 0) return text + ": waits for ready of" + faces(valid_);
  return text;
}

Counters BrickNode::counters() const {
  const ForceCounts& c = engine_.counts();
  const auto number = [](uint64_t n) { return static_cast<double>(n); };
  return {{"candidates", number(c.candidates)},     {"pairs_issued", number(c.pairs_issued)},
          {"pairs_inside", number(c.pairs_inside)}, {"queue_stalls", number(c.stalls)},
          {"issue_cycles", number(c.issue_cycles)}, {"force_cycles", number(c.busy)},
          {"link_beats", number(beats_)},           {"link_waits", number(link_waits_)}};
}

}  // namespace cuboct::emu
