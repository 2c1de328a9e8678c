// SPDX-License-Identifier: MIT
#include "emu/systemc/round_work.h"

#include <algorithm>

#include "model/base/fixed_math.h"
#include "model/program/integer_program.h"

namespace cuboct::emu {
namespace {

// A node of a lattice of thousands keeps its values in the nearest cache.
constexpr size_t kLanes = 16;

Seen seen(const Candidate& body, Particle& particle) {
  particle.id = body.id;
  particle.type = body.type;
  particle.v = body.v;
  return {&particle, {body.x[0], body.x[1], body.x[2]}, body.fields.empty() ? nullptr : body.fields.data()};
}

}  // namespace

RoundWork::RoundWork(const Plan& plan, std::vector<Slot>& own, FaultKeeper& fault)
    : plan_(plan),
      program_(plan.program->program),
      own_(own),
      fault_(fault),
      partners_(static_cast<size_t>(plan.arch.capacity)) {
  if (program_.bonded) kinds_ = plan.program->rows->kinds();
  int numbers = 0;
  for (const graph::Round& round : program_.rounds) {
    rounds_.push_back({PairRun(program_, round, 0, kLanes), FinishRun(program_, round, 0, 1)});
    numbers = std::max(numbers, round.numbers());
  }
  sums_.resize(partners_.size() * static_cast<size_t>(numbers));
}

Seen RoundWork::seen(const Slot& slot, Particle& particle) const {
  particle.x = position_of(plan_.rule.widths, slot);
  particle.u = slot.u;
  return emu::seen(slot.body, particle);
}

void RoundWork::begin(int round, uint64_t step) {
  round_ = static_cast<size_t>(round);
  rounds_[round_].pair.at_step(step);
  rounds_[round_].finish.at_step(step);
  for (auto& partners : partners_) partners.clear();
}

void RoundWork::look(size_t k) {
  const auto& partners = partners_[k];
  others_.resize(partners.size());
  seen_.clear();
  for (size_t j = 0; j < partners.size(); ++j) seen_.push_back(emu::seen(*partners[j], others_[j]));
}

// A bond that counts must be met.
void RoundWork::join(size_t k) {
  Slot& own = own_[k];
  const graph::BondRows& rows = *plan_.program->rows;
  const auto numbers = static_cast<size_t>(program_.bond_numbers());
  const auto bond_at = [&](size_t place) {
    // A word that a bad wire has damaged may name any kind.
    const size_t kind = std::min(own.bonds[place].kind, kinds_ - 1);
    return Seen{.bond = own.bond_numbers.data() + place * numbers,
                .bond_constants = rows.constants.data() + kind * program_.bond_constants.size()};
  };
  met_.assign(own.bonds.size(), false);
  for (Seen& partner : seen_) {
    const auto at = std::ranges::find(own.bonds, partner.particle->id, &Bond::other);
    const auto place = static_cast<size_t>(at - own.bonds.begin());
    const Seen bond = bond_at(place);
    partner.bond = bond.bond, partner.bond_constants = bond.bond_constants;
    met_[place] = true;
  }
  for (size_t place = 0; place < met_.size(); ++place)
    if (const uint32_t other = own.bonds[place].other;
        !met_[place] && other != own.body.id && !is_broken(program_, bond_at(place)))
      fault_.add(Fault::bond_lost, own.body.id, other, 0);
}

uint64_t RoundWork::add() {
  uint64_t counted = 0;
  PairRun& pair = rounds_[round_].pair;
  const auto numbers = static_cast<size_t>(program_.rounds[round_].numbers());
  for (size_t k = 0; k < own_.size(); ++k) {
    look(k);
    if (program_.bonded) join(k);
    Particle own;
    pair.add(seen(own_[k], own), seen_, std::span(sums_).subspan(k * numbers, numbers));
    counted += pair.counted();
    for (const graph::LaneFault& f : pair.faults()) fault_.add(f.fault, own_[k].body.id, f.number, 0);
  }
  return counted;
}

void RoundWork::finish(Slot& slot, size_t index) {
  const graph::Round& round = program_.rounds[round_];
  const auto numbers = static_cast<size_t>(round.numbers());
  const auto sums = std::span(sums_).subspan(index * numbers, numbers);
  Particle particle;
  const Seen own = seen(slot, particle);
  FinishRun& run = rounds_[round_].finish;
  run.run({&own, 1}, sums);
  std::ranges::fill(sums, 0);
  for (const graph::LaneFault& f : run.faults()) fault_.add(f.fault, slot.body.id, f.number, 0);
  for (const graph::Write& write : round.writes)
    slot.body.fields[static_cast<size_t>(program_.place(write.field) + write.component)] =
        run.value(write.node, 0);
  if (&round != &program_.rounds.back()) return;
  const graph::Motion& motion = program_.motion;
  Int3 x = particle.x;
  for (size_t a = 0; a < motion.v.size(); ++a) {
    slot.body.v[a] = run.value(motion.v[a], 0);
    if (!motion.u.empty()) slot.u[a] = run.value(motion.u[a], 0);
    x[a] += run.value(motion.drift[a], 0);
    slot.away[a] = static_cast<int8_t>(wrap(x[a] >> plan_.rule.widths.velocity_frac(), 2));
  }
  put_position(plan_.rule.widths, x, slot);
}

}  // namespace cuboct::emu
