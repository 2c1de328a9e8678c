// SPDX-License-Identifier: MIT
#include "emu/systemc/brick_node.h"

#include <algorithm>
#include <utility>

namespace cuboct::emu {

BrickNode::BrickNode(const Plan& plan, uint32_t node, uint8_t has_link)
    : NodeMachine(plan, has_link),
      node_(node),
      extent_(plan.bricks.extent(node)),
      grid_(plan.bricks.shape()),
      walk_(plan.bricks.shape(), extent_, has_link, axes_),
      cells_{std::vector<std::vector<Slot>>(cells_of(plan.bricks.shape())),
             std::vector<std::vector<Candidate>>(grid_.size())},
      leaving_(cells_.own.size()) {
  engine_ = std::make_unique<BrickForce>(plan, walk_, cells_, fault_);
}

void BrickNode::reset() {
  NodeMachine::reset();
  for (auto& list : cells_.own) list.clear();
  clear_halos();
  for (auto& list : inbox_) list.clear();
  for (auto& list : inner_) list.clear();
}

void BrickNode::clear_halos() {
  for (auto& list : cells_.halo) list.clear();
}

void BrickNode::begin() {
  pass_ = 0;
  place_ = record_ = kept_ = 0;
  if (main_ == Main::update) {
    size_t walk = 0, held = 0;
    for (const uint32_t c : walk_.own) {
      walk += std::max<size_t>(cells_.own[c].size(), 1);
      held += cells_.own[c].size();
    }
    phase_last_ = now_ + (held == 0 ? 1 : walk - 1 + static_cast<uint64_t>(plan_.latency.update));
  }
  if (migrates()) {
    const bool any = std::any_of(leaving_.begin(), leaving_.end(),
                                 [this](uint8_t axes) { return (axes & bit(axis())) != 0; });
    migrate_ = any ? Migrate::scan : Migrate::end;
  }
}

// A cycle of a walk over the own cells that has done with a record, of `count` in this cell, or has met an
// empty one; whether it was the walk's last.
bool BrickNode::walk_on(size_t count) {
  if (++record_ < count) return false;
  record_ = 0;
  return ++place_ == walk_.own.size();
}

void BrickNode::observe(const Slot& slot) {
  show(slot);
  out_->observe_cell = walked();
}

// The linked faces that this pass of an exchange sends to: both at once where the brick is one cell thick.
uint8_t BrickNode::pass_faces() const {
  const int low = 2 * axis();
  if (plan_.bricks.shape()[axis()] == 1) return faces_of(axis());
  return static_cast<uint8_t>(has_link_ & bit(low + pass_));
}

// After the end beats of this pass, or the cycle that stands for them where there is no link.
void BrickNode::end_pass() {
  place_ = record_ = 0;
  sent_ = plan_.bricks.shape()[axis()] == 1 || ++pass_ == 2;
}

void BrickNode::exchange() {
  const uint8_t faces = pass_faces();
  if (faces == 0) {
    end_pass();
    return;
  }
  // Both layers of a brick one cell thick are the same.
  const auto& layer = walk_.sent[static_cast<size_t>(__builtin_ctz(faces))];
  const auto size = [&](const BrickWalk::Sent& s) {
    return s.local >= 0 ? cells_.own[static_cast<size_t>(s.local)].size() : cells_.halo[s.grid].size();
  };
  if (place_ == layer.size()) {
    if (load_ends(faces)) end_pass();
    return;
  }
  if (size(layer[place_]) == 0) {
    ++place_;
    return;
  }
  if (!can_load(faces)) return;
  const BrickWalk::Sent& from = layer[place_];
  if (beat_ == 0) {
    word_.clear(plan_.words.halo_beats * plan_.words.link_bits);
    count_relayed(from.local >= 0);
    pack_halo(plan_,
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

void BrickNode::update() {
  if (place_ < walk_.own.size()) {
    const auto& slots = cells_.own[walked()];
    if (!slots.empty()) observe(slots[record_]);
    walk_on(slots.size());
  }
  if (now_ < phase_last_) return;
  std::fill(leaving_.begin(), leaving_.end(), 0);
  for (const uint32_t c : walk_.own)
    for (size_t k = 0; k < cells_.own[c].size(); ++k) {
      finish_slot(cells_.own[c][k], c, k);
      mark(c, cells_.own[c][k], 0);
    }
  finish_phase(Main::migrate_x);
}

// Notes along which axes, from `first_axis` on, a particle of the cell leaves it.
void BrickNode::mark(uint32_t local, const Slot& slot, int first_axis) {
  for (int a = first_axis; a < axes_; ++a)
    if (slot.away[static_cast<size_t>(a)] != 0) leaving_[local] |= bit(a);
}

void BrickNode::migrate() {
  switch (migrate_) {
    case Migrate::scan:
      scan();
      break;
    case Migrate::end:
      if (load_ends(faces_of(axis()))) migrate_ = Migrate::wait;
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
    } else if (!leave(c, s)) {
      return;
    }
    ++scanned_;
    const size_t held = slots.size();
    const bool cell_over = record_ + 1 == held;
    walk_over = walk_on(held);
    if (cell_over) slots.resize(std::exchange(kept_, 0));
  }
  if (!walk_over) return;
  place_ = record_ = 0;
  migrate_ = Migrate::end;
}

// A cycle of a particle that leaves its cell; whether it was the last one.
bool BrickNode::leave(uint32_t local, const Slot& slot) {
  const int a = axis();
  const bool up = slot.away[static_cast<size_t>(a)] > 0;
  const int face = 2 * a + (up ? 1 : 0);
  const uint32_t cell = plan_.bricks.cell(node_, local);
  const uint32_t to = cell == kNoCell ? kNoCell : plan_.lattice.neighbour(cell, face);
  if (to == kNoCell) {
    fault_.add(along(Fault::left_x, a), slot.body.id, 0, local);
    return true;
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
    ++inner_moves_;
    return true;
  }
  if (!can_load(bit(face))) return false;
  if (beat_ == 0) {
    take_up(slot);
    word_.put(plan_.words.particle_bits, plan_.words.migrate_cell_bits, grid_.migrate_tag(a, at));
  }
  load_slice(face);
  if (++beat_ < plan_.words.migrate_beats) return false;
  beat_ = 0;
  ++left_;
  return true;
}

// Until all that comes has come.
void BrickNode::wait() {
  if ((faces_of(axis()) & ~migrate_end_) != 0) {
    wakes_at_ = kNever;
    return;
  }
  const int low = 2 * axis();
  if (inner_[0].empty() && inner_[1].empty() && inbox_[low].empty() && inbox_[low + 1].empty()) {
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
  add(inbox_[2 * axis()]);
  add(inbox_[2 * axis() + 1]);
  return count;
}

void BrickNode::settle(uint32_t local, std::deque<Mover>& from) {
  const Slot& s = from.front().slot;
  auto& slots = cells_.own[local];
  if (static_cast<int>(slots.size()) < capacity_) {
    slots.push_back(s);
    mark(local, s, axis() + 1);
  } else {
    fault_.add(along(Fault::full_x, axis()), s.body.id, capacity_, local);
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
      std::array<std::deque<Mover>*, 4> lists{&inner_[0], &inbox_[2 * a], &inner_[1], &inbox_[2 * a + 1]};
      settle(c, **std::find_if(lists.begin(), lists.end(),
                               [&](auto* list) { return !list->empty() && list->front().to == c; }));
    }
    if (left > 1 || ++place_ < walk_.own.size()) return;
  }
  finish_migration();
}

void BrickNode::dump() {
  const auto& slots = cells_.own[walked()];
  if (!slots.empty()) observe(slots[record_]);
  if (walk_on(slots.size())) enter(Main::idle);
}

void BrickNode::take_particle(int face, std::span<const uint64_t> record) {
  const int a = face / 2;
  const auto tag =
      static_cast<uint32_t>(get_bits(record, plan_.words.particle_bits, plan_.words.migrate_cell_bits));
  const Cell at = grid_.of_migrate_tag(a, tag % grid_.migrate_tags(a), face % 2 == 1 ? extent_[a] - 1 : 0);
  Mover& mover = inbox_[face].emplace_back(Mover{grid_.local(at), unpack_particle(plan_, record)});
  mover.slot.away[static_cast<size_t>(a)] = 0;
}

void BrickNode::take_halo(int face, int, std::span<const uint64_t> record) {
  const int a = face / 2;
  Candidate candidate;
  const uint32_t tag = unpack_halo(plan_, record, candidate);
  const Cell at = grid_.of_halo_tag(a, tag % grid_.halo_tags(a), face % 2 == 1 ? extent_[a] : -1);
  cells_.halo[grid_.at(at)].push_back(candidate);
}

uint8_t BrickNode::awaited() const {
  if (migrate_ != Migrate::wait) return 0;
  return static_cast<uint8_t>(faces_of(axis()) & ~migrate_end_);
}

}  // namespace cuboct::emu
