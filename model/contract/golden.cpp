// SPDX-License-Identifier: MIT
#include "model/contract/golden.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <tuple>

#include "model/contract/pair_program.h"

namespace cuboct {
namespace {

// The fault of `axis` that belongs to `along_x`: they follow one another by axis.
Fault along(int axis, Fault along_x) { return static_cast<Fault>(static_cast<int>(along_x) + 2 * axis); }
static_assert(static_cast<int>(Fault::left_z) == static_cast<int>(Fault::left_x) + 4);
static_assert(static_cast<int>(Fault::full_z) == static_cast<int>(Fault::full_x) + 4);

// Golden takes any state, also one that moves along z where its scene is flat.
FixedRule with_three_axes(FixedRule rule) {
  rule.axes = 3;
  return rule;
}

void add(std::vector<int64_t>& to, const std::vector<int64_t>& numbers) {
  to.insert(to.end(), numbers.begin(), numbers.end());
}

auto order(const RunError& e) { return std::tuple(e.fault, e.particle, e.number); }

}  // namespace

Golden::Golden(const FixedRule& rule, const Lattice& lattice, int capacity, const State& initial)
    : Golden(pair_program(with_three_axes(rule), capacity), lattice, capacity, initial) {}

Golden::Golden(graph::FixedProgram program, const Lattice& lattice, int capacity, const State& initial,
               std::shared_ptr<const graph::BondRows> rows)
    : program_(std::make_shared<const graph::FixedProgram>(std::move(program))),
      lattice_(lattice),
      capacity_(capacity),
      step_(initial.step),
      cells_(lattice.size()),
      rows_(std::move(rows)),
      bonds_(initial.bonds) {
  if (program_->bonded != (rows_ != nullptr)) throw std::logic_error("bonds need their rows");
  std::vector<RunError> faults;
  for (const Particle& p : initial.particles) {
    auto& cell = cells_[p.cell];
    if (static_cast<int>(cell.size()) == capacity_)
      faults.push_back(fault_of(Fault::full_x, p.cell, p.id, capacity_));
    else
      cell.push_back(p);
  }
  fail_if_any(faults);
  add_fields(initial);
}

void Golden::add_fields(const State& initial) {
  for (size_t b = 0; initial.bonds.empty() && rows_ && b < rows_->other.size(); ++b)
    add(bonds_, beginning_of(program_->bonds));
  if (program_->numbers() == 0) return;
  for (uint32_t row = 0; row < initial.particles.size(); ++row) {
    const uint32_t id = initial.particles[row].id;
    if (id >= row_of_id_.size()) row_of_id_.resize(id + 1);
    row_of_id_[id] = row;
  }
  fields_ = initial.fields;
  if (!fields_.empty()) return;
  for (size_t k = 0; k < initial.particles.size(); ++k) add(fields_, beginning_of(program_->fields));
}

RunError Golden::fault_of(Fault fault, uint32_t cell, uint32_t particle, int64_t number) const {
  const Cell& c = lattice_.cell(cell);
  return {fault, step_, cell, particle, number, fmt::format(" at ({}, {}, {})", c[0], c[1], c[2])};
}

void Golden::fail_if_any(const std::vector<RunError>& faults) const {
  if (faults.empty()) return;
  throw *std::min_element(faults.begin(), faults.end(),
                          [](const auto& a, const auto& b) { return order(a) < order(b); });
}

Seen Golden::seen(const Particle& particle) const {
  const int guard = program_->guard;
  const Int3& x = particle.x;
  const auto numbers = static_cast<size_t>(program_->numbers());
  return {&particle,
          {x[0] >> guard, x[1] >> guard, x[2] >> guard},
          numbers > 0 ? fields_.data() + row_of_id_[particle.id] * numbers : nullptr};
}

// Particles of a cell and of those around it, in the frame of the cell.
std::vector<Seen> Golden::neighbours(uint32_t cell) const {
  std::vector<Seen> all;
  for (const auto& [other, offset] : lattice_.neighbourhood(cell))
    for (const Particle& j : cells_[other]) {
      all.push_back(seen(j));
      for (int a = 0; a < 3; ++a) all.back().x[a] += int64_t{offset[a]} << program_->position_frac;
    }
  return all;
}

// Of those near, sorted by id, the ones that the particle has a bond to. A bond that counts must be met.
std::vector<Seen> Golden::bonded(uint32_t cell, uint32_t id, const std::vector<Seen>& near,
                                 std::vector<RunError>& faults) {
  const auto numbers = static_cast<size_t>(program_->bond_numbers());
  std::vector<Seen> partners;
  for (uint64_t b = rows_->first[id]; b < rows_->first[id + 1]; ++b) {
    Seen bond{.bond = bonds_.data() + b * numbers,
              .bond_constants = rows_->constants.data() + rows_->kind[b] * program_->bond_constants.size()};
    const uint32_t other = rows_->other[b];
    const auto at = std::ranges::lower_bound(near, other, {}, [](const Seen& s) { return s.particle->id; });
    if (at != near.end() && at->particle->id == other)
      partners.push_back({at->particle, at->x, at->fields, bond.bond, bond.bond_constants});
    else if (!is_broken(*program_, bond))
      faults.push_back(fault_of(Fault::bond_lost, cell, id, other));
  }
  return partners;
}

Golden::Sums Golden::meet(const graph::Round& round) {
  std::vector<RunError> faults;
  PairRun pairs(*program_, round, step_);
  const auto numbers = static_cast<size_t>(round.numbers());
  Sums sums(cells_.size());
  for (uint32_t n = 0; n < cells_.size(); ++n) {
    if (cells_[n].empty()) continue;
    sums[n].resize(cells_[n].size() * numbers);
    std::vector<Seen> near = neighbours(n);
    if (rows_) std::ranges::sort(near, {}, [](const Seen& s) { return s.particle->id; });
    for (size_t k = 0; k < cells_[n].size(); ++k) {
      const Particle& i = cells_[n][k];
      const std::vector<Seen> bonds = rows_ ? bonded(n, i.id, near, faults) : std::vector<Seen>();
      pairs.add(seen(i), rows_ ? bonds : near, std::span(sums[n]).subspan(k * numbers, numbers));
      for (const graph::LaneFault& f : pairs.faults()) faults.push_back(fault_of(f.fault, n, i.id, f.number));
    }
  }
  fail_if_any(faults);
  return sums;
}

void Golden::finish(const graph::Round& round, const Sums& sums, std::vector<std::vector<Moving>>& moving) {
  std::vector<RunError> faults;
  FinishRun run(*program_, round, step_);
  const bool last = &round == &program_->rounds.back();
  const auto numbers = static_cast<size_t>(round.numbers());
  for (uint32_t n = 0; n < cells_.size(); ++n) {
    std::vector<Seen> own;
    for (const Particle& p : cells_[n]) own.push_back(seen(p));
    for (size_t k = 0; k < own.size(); k += FinishRun::kRoom) {
      const auto some = std::span(own).subspan(k, std::min(FinishRun::kRoom, own.size() - k));
      run.run(some, std::span(sums[n]).subspan(k * numbers, some.size() * numbers));
      for (const auto& f : run.faults())
        faults.push_back(fault_of(f.fault, n, cells_[n][k + static_cast<size_t>(f.lane)].id, f.number));
      for (size_t lane = 0; lane < some.size(); ++lane) {
        keep(round, run, lane, cells_[n][k + lane].id);
        if (last) moving[n].push_back(moved(cells_[n][k + lane], run, lane));
      }
    }
  }
  fail_if_any(faults);
}

void Golden::keep(const graph::Round& round, FinishRun& run, size_t lane, uint32_t id) {
  for (const graph::Write& write : round.writes) {
    const size_t row = row_of_id_[id] * static_cast<size_t>(program_->numbers());
    fields_[row + static_cast<size_t>(program_->place(write.field) + write.component)] =
        run.value(write.node, lane);
  }
}

Golden::Moving Golden::moved(const Particle& particle, FinishRun& run, size_t lane) const {
  const int frac = program_->position_frac + program_->guard;
  const graph::Motion& motion = program_->motion;
  Moving m{particle, {}};
  m.particle.u = {};
  for (size_t a = 0; a < motion.v.size(); ++a) {
    m.particle.v[a] = run.value(motion.v[a], lane);
    if (!motion.u.empty()) m.particle.u[a] = run.value(motion.u[a], lane);
    const int64_t x = particle.x[a] + run.value(motion.drift[a], lane);
    m.away[a] = static_cast<int>(x >> frac);
    m.particle.x[a] = x & ((int64_t{1} << frac) - 1);
  }
  return m;
}

std::vector<Int3> Golden::next_velocities() const {
  Golden next = *this;
  std::vector<std::vector<Moving>> moving(cells_.size());
  try {
    for (const graph::Round& round : program_->rounds) next.finish(round, next.meet(round), moving);
  } catch (const RunError&) {
    return {};
  }
  std::vector<Int3> v;
  for (const std::vector<Moving>& cell : moving)
    for (const Moving& m : cell) {
      if (m.particle.id >= v.size()) v.resize(m.particle.id + 1);
      v[m.particle.id] = m.particle.v;
    }
  return v;
}

void Golden::step() {
  // Rounds write fields and bonds where they stand: a step that fails puts back what it found.
  std::pair before(fields_, bonds_);
  std::vector<std::vector<Moving>> moving(cells_.size());
  try {
    for (const graph::Round& round : program_->rounds) finish(round, meet(round), moving);
    // Migration: along x, then y, then z; those who stay keep their order, then come those from below, then
    // from above.
    for (int axis = 0; axis < 3; ++axis) migrate(axis, moving);
  } catch (const RunError&) {
    std::tie(fields_, bonds_) = std::move(before);
    throw;
  }
  for (uint32_t n = 0; n < cells_.size(); ++n) {
    cells_[n].clear();
    for (const Moving& m : moving[n]) cells_[n].push_back(m.particle);
  }
  ++step_;
}

void Golden::migrate(int axis, std::vector<std::vector<Moving>>& moving) const {
  std::vector<RunError> faults;
  std::vector<std::array<std::vector<Moving>, 2>> arrived(moving.size());  // from below, from above
  for (uint32_t n = 0; n < moving.size(); ++n) {
    std::vector<Moving> stay;
    for (Moving& m : moving[n]) {
      const int way = m.away[axis];
      if (way == 0) {
        stay.push_back(m);
        continue;
      }
      const uint32_t to = lattice_.neighbour(n, 2 * axis + (way > 0));
      if (to == kNoCell) {
        faults.push_back(fault_of(along(axis, Fault::left_x), n, m.particle.id, 0));
        continue;
      }
      m.particle.cell = to;
      arrived[to][way < 0].push_back(m);
    }
    moving[n] = stay;
  }
  for (uint32_t n = 0; n < moving.size(); ++n)
    for (const auto& side : arrived[n])
      for (const Moving& m : side) {
        if (static_cast<int>(moving[n].size()) < capacity_)
          moving[n].push_back(m);
        else
          faults.push_back(fault_of(along(axis, Fault::full_x), n, m.particle.id, capacity_));
      }
  fail_if_any(faults);
}

State Golden::state() const {
  State state{step_, {}};
  for (const auto& cell : cells_) state.particles.insert(state.particles.end(), cell.begin(), cell.end());
  std::sort(state.particles.begin(), state.particles.end(), [](auto& a, auto& b) { return a.id < b.id; });
  const auto numbers = static_cast<size_t>(program_->numbers());
  for (const Particle& p : state.particles)
    for (size_t f = 0; f < numbers; ++f) state.fields.push_back(fields_[row_of_id_[p.id] * numbers + f]);
  if (bonds_.empty()) return state;
  state.bonds = bonds_;
  state.bond_begin = begins_of(*rows_, program_->bond_numbers());
  return state;
}

}  // namespace cuboct
