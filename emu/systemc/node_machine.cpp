// SPDX-License-Identifier: MIT
#include "emu/systemc/node_machine.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/base/fixed_math.h"

namespace cuboct::emu {

NodeMachine::NodeMachine(const Plan& plan, uint8_t has_link)
    : plan_(plan),
      has_link_(has_link),
      axes_(plan.rule.axes),
      capacity_(plan.arch.capacity),
      link_words_(std::min((plan.words.link_bits + 63) / 64, int{Bits::kWords})) {}

void NodeMachine::reset() {
  for (Assembly& a : assembly_) a.beat = 0;
  stream_ = {};
  halo_end_ = {};
  migrate_end_ = 0;
  round_ = 0;
  all_steps_ = 0;
  engine_->reset();
  main_ = Main::idle;
  fault_ = {};
  starting_ = valid_ = 0;
}

bool NodeMachine::can_load(uint8_t faces) {
  const bool can = (faces & ~can_load_) == 0;
  link_waits_ += !can;
  return can;
}

Bits& NodeMachine::load(int face, bool end) {
  valid_ |= bit(face);
  out_->loaded |= bit(face);
  ++beats_;
  Beat& beat = *out_->beat[face];
  beat.end = end;
  for (int k = 0; k < link_words_; ++k) beat.payload.word[k] = 0;
  return beat.payload;
}

void NodeMachine::show(const Slot& slot) {
  out_->observe = true;
  out_->observe_data.clear(plan_.words.particle_bits);
  pack_particle(plan_, slot, out_->observe_data);
}

void NodeMachine::take_up(const Slot& slot) {
  word_.clear(plan_.words.migrate_beats * plan_.words.link_bits);
  pack_particle(plan_, slot, word_);
}

void NodeMachine::load_slice(int face) {
  if (!linked(face)) return;
  word_.slice(beat_ * plan_.words.link_bits, plan_.words.link_bits, load(face, false));
}

bool NodeMachine::load_ends(uint8_t faces) {
  if (!can_load(faces)) return false;
  for (int f = 0; f < kFaces; ++f)
    if (faces >> f & 1) load(f, true);
  return true;
}

// The main state after a phase; a step ends after the last one.
NodeMachine::Main NodeMachine::after(Main phase) const {
  if (axes_ == 2 && phase == Main::exchange_y) return Main::force;
  return static_cast<Main>(static_cast<int>(phase) + 1);
}

// Prepares the registers for a main state's first cycle, which is the next one.
void NodeMachine::enter(Main next) {
  main_ = next;
  const bool relays = plan_.arch.halos == Halos::arrival && next > Main::exchange_x && next < Main::force;
  if (!relays) beat_ = 0;
  sent_ = false;
  begin();
  if (next == Main::dump || next == Main::idle) return;
  const bool begins_engine = plan_.arch.overlap ? next == Main::exchange_x : next == Main::force;
  if (RoundWork* const work = engine_->rounds(); work != nullptr) {
    fault_.now = 2 * round_ + (next < Main::update ? 0 : next == Main::update ? 1 : 2);
    if (next == Main::force) work->begin(round_, all_steps_);
  }
  if (begins_engine) engine_->begin(now_ + 1), starting_ |= phase_bit(Main::force);
  if (next == Main::force)
    engine_->available(axes_ - 1, now_ + 1);
  else if (next > Main::exchange_x && next < Main::force)
    engine_->available(static_cast<int>(next) - 1, now_ + 1);
  if (next == Main::force)
    phase_last_ = engine_->run();
  else
    starting_ |= phase_bit(next);
}

void NodeMachine::finish_phase(Main next) {
  out_->phase_end |= phase_bit(main_);
  if (main_ == Main::update && next == Main::exchange_x)
    ++round_;
  else if (migrates() && !(next >= Main::migrate_x && next <= Main::migrate_z))
    round_ = 0;
  enter(next);
}

void NodeMachine::finish_migration() {
  const int a = axis();
  migrate_end_ &= static_cast<uint8_t>(~faces_of(a));
  if (a + 1 < axes_) {
    finish_phase(after(main_));
    return;
  }
  if (fault_.code != Fault::none) {
    out_->fault = true;
    out_->fault_code = static_cast<uint8_t>(fault_.code);
    out_->fault_id = fault_.id;
    out_->fault_number = fault_.number;
    out_->fault_cell = fault_.cell;
    out_->fault_stage = fault_.stage;
    fault_ = {};
  }
  ++all_steps_;
  finish_phase(++step_ < steps_ ? Main::exchange_x : Main::dump);
}

void NodeMachine::finish_slot(Slot& slot, uint32_t cell, size_t index) {
  ++updates_;
  if (RoundWork* const work = engine_->rounds(); work != nullptr) return work->finish(slot, index);
  const Widths& w = plan_.rule.widths;
  const FinishResult r = finish(plan_.rule, engine_->take_sum(cell, index), position_of(w, slot), slot.body.v,
                                slot.u, slot.body.type);
  fault_.add(r.fault, slot.body.id, r.number, cell);
  slot.u = r.u;
  for (size_t a = 0; a < 3; ++a) {
    slot.body.v[a] = wrap(r.v[a], w.velocity_bits);
    slot.away[a] = static_cast<int8_t>(wrap(r.x[a] >> w.velocity_frac(), 2));
  }
  put_position(w, r.x, slot);
}

void NodeMachine::idle(const Control& host) {
  out_->idle = true;
  if (!host.load_valid && !host.start) wakes_at_ = kNever;
  if (host.load_valid) append(host.load_cell, unpack_particle(plan_, host.load_data));
  if (!host.start) return;
  steps_ = host.steps;
  step_ = 0;
  enter(steps_ == 0 ? Main::dump : Main::exchange_x);
}

void NodeMachine::await_halos() {
  if ((faces_of(axis()) & ~halo_ended()) == 0)
    finish_phase(after(main_));
  else
    wakes_at_ = kNever;
}

void NodeMachine::force() {
  if (now_ < phase_last_) {
    wakes_at_ = phase_last_;
    return;
  }
  if (last_round()) clear_halos();
  halo_end_[round_ % 2] = 0;
  finish_phase(Main::update);
}

void NodeMachine::receive(int face, const Beat& beat) {
  uint8_t& stream = stream_[static_cast<size_t>(face)];
  const bool migrating = stream == rounds();
  if (beat.end) {
    (migrating ? migrate_end_ : halo_end_[stream % 2]) |= bit(face);
    if (!migrating) take_halo_end(face);
    stream = migrating ? 0 : static_cast<uint8_t>(stream + 1);
    return;
  }
  const int beats = migrating ? plan_.words.migrate_beats : plan_.rounds[stream].beats;
  std::span<const uint64_t> record = beat.payload;
  if (beats > 1) {
    Assembly& a = assembly_[face];
    if (a.beat == 0) a.partial.clear(beats * plan_.words.link_bits);
    a.partial.join(a.beat * plan_.words.link_bits, plan_.words.link_bits, beat.payload);
    if (++a.beat < beats) return;
    a.beat = 0;
    record = a.partial;
  }
  if (migrating) {
    ++moved_;
    take_particle(face, record);
  } else {
    ++halos_[static_cast<size_t>(face / 2)];
    take_halo(face, stream, record);
  }
}

void NodeMachine::clock(const NodeInputs& in, NodeOutputs& out) {
  out_ = &out;
  now_ = in.now;
  wakes_at_ = now_ + 1;
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
  full_ = valid_;
  can_load_ = static_cast<uint8_t>(~valid_ | in.ready);
  valid_ &= static_cast<uint8_t>(~in.ready);

  switch (main_) {
    case Main::idle:
      idle(*in.control);
      break;
    case Main::exchange_x:
    case Main::exchange_y:
    case Main::exchange_z:
      if (sent_ && plan_.arch.halos == Halos::phases)
        await_halos();
      else
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

std::string NodeMachine::doing() const {
  static const char* const kFace[] = {"-x", "+x", "-y", "+y", "-z", "+z"};
  if (main_ == Main::idle) return "idle";
  if (main_ == Main::dump) return "dump";
  const int phase = phase_index(static_cast<Phase>(main_), round_, rounds());
  std::string text = fmt::format("step {}, {}", step_, phase_name(phase, rounds()));
  const auto faces = [&](uint8_t mask) {
    std::string list;
    for (int f = 0; f < kFaces; ++f)
      if (mask >> f & 1) list += fmt::format(" {}", kFace[f]);
    return list;
  };
  if (main_ <= Main::exchange_z && sent_)
    return text + ": waits for the halo of" + faces(faces_of(axis()) & static_cast<uint8_t>(~halo_ended()));
  if (const uint8_t mask = migrates() ? awaited() : uint8_t{0}; mask != 0)
    return text + ": waits for the particles of" + faces(mask);
  if (valid_ != 0) return text + ": waits for ready of" + faces(valid_);
  return text;
}

Counters NodeMachine::counters(uint64_t) const {
  const ForceCounts& c = engine_->counts();
  const auto number = [](uint64_t n) { return static_cast<double>(n); };
  return {{"candidates", number(c.candidates)},
          {"candidates_x", number(c.by_axis[0])},
          {"candidates_y", number(c.by_axis[1])},
          {"candidates_z", number(c.by_axis[2])},
          {"pairs_issued", number(c.pairs_issued)},
          {"pairs_inside", number(c.pairs_inside)},
          {"queue_stalls", number(c.stalls)},
          {"issue_cycles", number(c.issue_cycles)},
          {"force_cycles", number(c.busy)},
          {"link_beats", number(beats_)},
          {"link_waits", number(link_waits_)},
          {"updates", number(updates_)},
          {"queue_entries", number(c.entries)},
          {"relayed", number(relayed_)},
          {"relayed_own", number(relayed_own_)},
          {"halos_x", number(halos_[0])},
          {"halos_y", number(halos_[1])},
          {"halos_z", number(halos_[2])},
          {"tested", number(c.tested)},
          {"culled_x", number(c.culled[0])},
          {"culled_y", number(c.culled[1])},
          {"culled_z", number(c.culled[2])},
          {"moved", number(moved_)},
          {"left", number(left_)},
          {"inner", number(inner_moves_)},
          {"scanned", number(scanned_)}};
}

}  // namespace cuboct::emu
