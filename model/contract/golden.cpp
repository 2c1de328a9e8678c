// SPDX-License-Identifier: MIT
#include "model/contract/golden.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "model/base/fixed_math.h"

namespace cuboct {
namespace {

// The fault of `axis` that belongs to `along_x`: they follow one another by axis.
Fault along(int axis, Fault along_x) { return static_cast<Fault>(static_cast<int>(along_x) + 2 * axis); }
static_assert(static_cast<int>(Fault::left_z) == static_cast<int>(Fault::left_x) + 4);
static_assert(static_cast<int>(Fault::full_z) == static_cast<int>(Fault::full_x) + 4);

auto order(const RunError& e) { return std::tuple(e.fault, e.particle, e.number); }

}  // namespace

Golden::Golden(const FixedRule& rule, const Lattice& lattice, int capacity, const State& initial)
    : rule_(rule), lattice_(lattice), capacity_(capacity), step_(initial.step), cells_(lattice.size()) {
  std::vector<RunError> faults;
  for (const Particle& p : initial.particles) {
    auto& cell = cells_[p.cell];
    if (static_cast<int>(cell.size()) == capacity_)
      faults.push_back(fault_of(Fault::full_x, p.cell, p.id, capacity_));
    else
      cell.push_back(p);
  }
  fail_if_any(faults);
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

void Golden::step() {
  const int P = rule_.widths.position_frac, frac = rule_.widths.velocity_frac();
  std::vector<RunError> faults;

  // Force: every particle against every other of its own and the neighbour cells.
  std::vector<std::vector<Int3>> sums(cells_.size());
  std::vector<Int3> seen;  // visible positions of a cell's own
  for (uint32_t n = 0; n < cells_.size(); ++n) {
    sums[n].resize(cells_[n].size());
    if (cells_[n].empty()) continue;
    seen.clear();
    for (const Particle& i : cells_[n]) seen.push_back(visible(rule_, i.x));
    for (const auto& [other, offset] : lattice_.neighbourhood(n))
      for (const Particle& j : cells_[other]) {
        Int3 x_j = visible(rule_, j.x);
        for (int a = 0; a < 3; ++a) x_j[a] += int64_t{offset[a]} << P;
        for (size_t k = 0; k < cells_[n].size(); ++k) {
          const Particle& i = cells_[n][k];
          if (i.id == j.id) continue;
          const PairResult pair = pair_kick(rule_, seen[k], i.v, i.type, x_j, j.v, j.type);
          if (pair.fault != Fault::none) faults.push_back(fault_of(pair.fault, n, i.id, pair.number));
          for (int a = 0; a < 3; ++a) sums[n][k][a] += pair.kick[a];
        }
      }
  }
  fail_if_any(faults);

  // Update: kick, constraints, drift.
  std::vector<std::vector<Moving>> moving(cells_.size());
  for (uint32_t n = 0; n < cells_.size(); ++n)
    for (size_t k = 0; k < cells_[n].size(); ++k) {
      Moving m{cells_[n][k], {}};
      Particle& p = m.particle;
      const FinishResult result = finish(rule_, sums[n][k], p.x, p.v, p.u, p.type);
      if (result.fault != Fault::none) faults.push_back(fault_of(result.fault, n, p.id, result.number));
      p.v = result.v;
      p.u = result.u;
      for (int a = 0; a < 3; ++a) {
        m.away[a] = static_cast<int>(result.x[a] >> frac);
        p.x[a] = result.x[a] & ((int64_t{1} << frac) - 1);
      }
      moving[n].push_back(m);
    }
  fail_if_any(faults);

  // Migration: along x, then y, then z; those who stay keep their order, then come those from below, then
  // from above.
  for (int axis = 0; axis < 3; ++axis) migrate(axis, moving);
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
  return state;
}

}  // namespace cuboct
