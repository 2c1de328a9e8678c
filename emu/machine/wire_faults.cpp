// SPDX-License-Identifier: MIT
#include "emu/machine/wire_faults.h"

#include <algorithm>
#include <cmath>

#include "emu/machine/stall.h"

namespace cuboct::emu {
namespace {

// The number of beats is that of the initial state; this share of it is counted on.
constexpr double kCertain = 0.9;
uint64_t threshold_of(double rate) {
  return rate >= 1 ? UINT64_MAX : static_cast<uint64_t>(std::ldexp(rate, 64));
}

// Bits that one fault flips at the most, next to each other: a burst as wide as the check. Scattered ones are
// fewer than the check's distance, or this many where there is none.
constexpr int kBurst = 16, kScattered = 3;

}  // namespace

uint64_t beats_per_step(const Plan& plan, const State& state) {
  const BrickMap map(plan.lattice, plan.bricks, plan.rule.axes);
  std::vector<uint64_t> held(plan.lattice.size());
  for (const Particle& p : state.particles) ++held[p.cell];
  uint64_t beats = 0, record_beats = 0;  // record_beats: of a particle in all rounds
  for (const PlanRound& round : plan.rounds) record_beats += static_cast<uint64_t>(round.beats);
  for (uint32_t n = 0; n < plan.nodes(); ++n)
    for (int f = 0; f < 2 * plan.rule.axes; ++f) {
      if (plan.neighbour(n, f) == kNoNode) continue;
      beats += 1 + plan.rounds.size();  // the end beats of particles, and of each round's halo
      for (const BrickWalk::Sent& s : map.walk(n).sent[static_cast<size_t>(f)])
        if (const uint32_t cell = map.cell(n, s.grid); cell != kNoCell) beats += held[cell] * record_beats;
    }
  return beats;
}

FaultSource::FaultSource(const Plan& plan, const FaultOptions& options, const State& initial, uint64_t steps)
    : plan_(plan), options_(options) {
  if (!options.enabled()) return;
  threshold_ = threshold_of(options.rate);
  if (options.count == 0) return;
  expected_ = kCertain * static_cast<double>(beats_per_step(plan, initial) * std::max<uint64_t>(steps, 1));
  if (plan.link.checked() && options.acks > 0) expected_ *= 2;
}

// Before the first beat of a cycle: so a fault does not depend on the order of the wires.
void FaultSource::begin(uint64_t cycle) {
  if (cycle == cycle_) return;
  cycle_ = cycle;
  if (options_.count == 0) return;
  const double wanted = static_cast<double>(options_.count) - static_cast<double>(counts_.injected());
  threshold_ = threshold_of(wanted / std::max(expected_ - static_cast<double>(seen_), 100.0));
}

Counters FaultSource::counters() const {
  const auto number = [](uint64_t n) { return static_cast<double>(n); };
  const FaultCounts& c = counts_;
  return {{"faults_injected", number(c.injected())}, {"faults_flipped", number(c.flips)},
          {"faults_dropped", number(c.drops)},       {"faults_repeated", number(c.repeats)},
          {"faults_in_acks", number(c.acks)},        {"faults_detected", number(c.detected)},
          {"faults_healed", number(c.healed)}};
}

// Which fault the beat, or the acknowledgement, of this number meets.
FaultKind FaultyWire::choose(uint64_t number, bool ack, uint64_t dice) const {
  const FaultOptions& o = source_.options_;
  if (const FaultTarget& t = o.target; t.kind != FaultKind::none) {
    const bool here = t.node == node_ && t.face == face_ && t.beat == number;
    return here && ack == (t.kind == FaultKind::ack) ? t.kind : FaultKind::none;
  }
  if (dice >= source_.threshold_) return FaultKind::none;
  if (o.count > 0 && source_.counts_.injected() >= o.count) return FaultKind::none;
  if (ack) return o.acks > 0 ? FaultKind::ack : FaultKind::none;
  const uint64_t sum = uint64_t{o.flips} + o.drops + o.repeats;
  if (sum == 0) return FaultKind::none;
  const uint64_t at = mix(dice) % sum;
  return at < o.flips                       ? FaultKind::flip
         : at < uint64_t{o.flips} + o.drops ? FaultKind::drop
                                            : FaultKind::repeat;
}

// The fault that the next beat, or acknowledgement, meets.
FaultKind FaultyWire::draw(uint64_t cycle, bool ack) {
  FaultSource& s = source_;
  const uint64_t wire = uint64_t{node_} * kFaces + static_cast<uint64_t>(face_);
  const uint64_t number = ack ? acks_++ : beats_++;
  ++s.seen_;
  const uint64_t dice = mix(mix(mix(s.options_.seed) + 2 * wire + (ack ? 1 : 0)) ^ number);
  if (!s.enabled() || (open_ != FaultKind::none && s.plan_.link.checked())) return FaultKind::none;
  const FaultKind kind = choose(number, ack, dice);
  if (kind == FaultKind::none) return kind;
  if (s.counts_.injected() == 0) s.first_ = {cycle, node_, face_};
  ++(kind == FaultKind::flip     ? s.counts_.flips
     : kind == FaultKind::drop   ? s.counts_.drops
     : kind == FaultKind::repeat ? s.counts_.repeats
                                 : s.counts_.acks);
  open_ = kind;
  detected_ = false;
  if (kind == FaultKind::flip) flip(mix(dice + 1));
  return kind;
}

// Flips bits of `other_`, in the order of the check: payload, end, sequence, check.
void FaultyWire::flip(uint64_t dice) {
  const Plan& plan = source_.plan_;
  const int link_bits = plan.words.link_bits, all = plan.link.wire_bits + 1;
  const int held = std::min(all, int{Bits::kWidth});
  const auto flip_one = [&](int i) {
    if (i == link_bits) {
      other_.end = !other_.end;
      return;
    }
    const int at = i < link_bits ? i : i - 1;
    other_.payload.word[static_cast<size_t>(at >> 6)] ^= uint64_t{1} << (at & 63);
  };
  const auto roll = [&dice](int n) {
    dice = mix(dice);
    return static_cast<int>(dice % static_cast<uint64_t>(n));
  };
  if (roll(2) == 0) {
    const int width = std::min(1 + roll(kBurst), held), first = roll(held - width + 1);
    flip_one(first);
    if (width > 1) flip_one(first + width - 1);
    for (int k = 1; k + 1 < width; ++k)
      if (roll(2) == 0) flip_one(first + k);
    return;
  }
  const int most = std::min(plan.link.checked() ? plan.link.distance - 1 : kScattered, held);
  std::vector<int> chosen;
  for (int left = 1 + roll(most); left > 0;) {
    const int i = roll(held);
    if (std::find(chosen.begin(), chosen.end(), i) != chosen.end()) continue;
    chosen.push_back(i);
    flip_one(i);
    --left;
  }
}

uint32_t FaultyWire::sequence(const Beat& beat) const {
  const Plan& plan = source_.plan_;
  return static_cast<uint32_t>(beat.payload.get(plan.words.link_bits, plan.link.sequence_bits));
}

void FaultyWire::pass(uint64_t cycle, const View& truth) {
  view_ = truth;
  if (repeat_) {
    // The receiver sees the last beat again; the next one, if any, waits.
    repeat_ = false;
    view_.valid = true;
    view_.beat = &other_;
    view_.ready = false;
  } else if (truth.valid && truth.ready) {
    // Known before a fault changes it.
    const bool checked = source_.plan_.link.checked();
    const uint32_t number = checked ? sequence(*truth.beat) : 0;
    const FaultKind before = open_;
    other_ = *truth.beat;
    const FaultKind kind = draw(cycle, false);
    if (kind == FaultKind::none && checked && detected_ && number == sequence_ &&
        (before == FaultKind::flip || before == FaultKind::drop)) {
      ++source_.counts_.healed;
      open_ = FaultKind::none;
    }
    if (kind != FaultKind::none) sequence_ = number;
    if (kind == FaultKind::flip) view_.beat = &other_;
    if (kind == FaultKind::drop) view_.valid = false;
    if (kind == FaultKind::repeat) repeat_ = true;
  }
  // An acknowledgement is a new value; afterwards the wire holds it, and the sender sees it again.
  if (source_.plan_.link.checked() && truth.ack != last_ack_) {
    last_ack_ = truth.ack;
    if (source_.options_.acks > 0 && draw(cycle, true) == FaultKind::ack) {
      const auto bits = static_cast<uint64_t>(source_.plan_.link.ack_bits);
      const uint64_t dice = mix(cycle * 64 + static_cast<uint64_t>(face_));
      // One to three bits; fewer than the distance of the check, which is 6 here.
      for (int k = 0; k < 3; ++k) view_.ack ^= static_cast<uint16_t>(1u << (dice >> (8 * k)) % bits);
      if (view_.ack == truth.ack) view_.ack ^= 1;
    }
  }
}

const FaultyWire::View& FaultyWire::look(uint64_t cycle, const View& truth) {
  if (cycle != cycle_) {
    cycle_ = cycle;
    source_.begin(cycle);
    pass(cycle, truth);
  }
  return view_;
}

void FaultyWire::detected() {
  if (open_ == FaultKind::none || detected_) return;
  detected_ = true;
  ++source_.counts_.detected;
  // A repeated beat was dropped when it was found; the right acknowledgement stood there one cycle later.
  if (open_ == FaultKind::repeat || open_ == FaultKind::ack) {
    if (source_.plan_.link.check == LinkCheck::retry) ++source_.counts_.healed;
    open_ = FaultKind::none;
  }
}

FaultyWires::FaultyWires(const Plan& plan, const FaultOptions& options, const State& initial, uint64_t steps)
    : source(plan, options, initial, steps) {
  if (!options.enabled()) return;
  for (uint32_t n = 0; n < plan.nodes(); ++n)
    for (int f = 0; f < kFaces; ++f) wires.push_back(std::make_unique<FaultyWire>(source, n, f));
}

void FaultyWires::heed(const Plan& plan, uint32_t node, const NodeOutputs& out) {
  if (wires.empty() || (out.beat_errors | out.ack_errors) == 0) return;
  for (int f = 0; f < kFaces; ++f) {
    if (out.ack_errors >> f & 1) at(node, f)->detected();
    const uint32_t other = plan.neighbour(node, f);
    if ((out.beat_errors >> f & 1) && other != kNoNode) at(other, f ^ 1)->detected();
  }
}

}  // namespace cuboct::emu
