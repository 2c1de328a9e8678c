// SPDX-License-Identifier: MIT
#include "model/analysis/measure.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <span>

#include "model/analysis/strain.h"
#include "model/base/parallel.h"

namespace cuboct {
namespace {

// Particles (indices into a state) by cell, ascending in each.
struct ByCell {
  ByCell(const Lattice& lattice, const State& state)
      : first(lattice.size() + 1, 0), order(state.particles.size()) {
    for (const Particle& particle : state.particles) ++first[particle.cell + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<uint32_t> next(first.begin(), first.end() - 1);
    for (uint32_t i = 0; i < order.size(); ++i) order[next[state.particles[i].cell]++] = i;
  }
  std::span<const uint32_t> at(uint32_t cell) const {
    return {order.data() + first[cell], order.data() + first[cell + 1]};
  }
  std::vector<uint32_t> first, order;
};

// Calls visit(i, j, x_j in the frame of i's cell, P+G fractional bits) for each particle i of the cells and
// each other one in reach.
template <typename Visit>
void for_each_pair(const FixedRule& rule, const Lattice& lattice, const State& state, const ByCell& by_cell,
                   uint32_t begin, uint32_t end, Visit visit) {
  const int64_t edge = int64_t{1} << rule.widths.velocity_frac();
  for (uint32_t cell = begin; cell < end; ++cell) {
    if (by_cell.at(cell).empty()) continue;
    for (const Lattice::Near& near : lattice.neighbourhood(cell))
      for (const uint32_t j : by_cell.at(near.cell)) {
        Int3 x = state.particles[j].x;
        for (int axis = 0; axis < 3; ++axis) x[axis] += near.offset[axis] * edge;
        for (const uint32_t i : by_cell.at(cell))
          if (i != j) visit(i, j, x);
      }
  }
}

constexpr size_t kCellsWorthAThread = 1000;

// The sum of part(i, j, x_j) over unordered pairs in reach; by blocks of cells, so that its rounding does not
// depend on the number of threads.
template <typename T, typename Part>
T sum_over_pairs(const FixedRule& rule, const Lattice& lattice, const State& state, const T& zero,
                 int threads, Part part) {
  constexpr uint32_t kBlock = 4096;
  const ByCell by_cell(lattice, state);
  std::vector<T> sums((lattice.size() + kBlock - 1) / kBlock, zero);
  for_each_range(
      sums.size(), 1,
      [&](size_t first, size_t last) {
        for (size_t block = first; block < last; ++block) {
          const auto begin = static_cast<uint32_t>(block) * kBlock;
          for_each_pair(rule, lattice, state, by_cell, begin, std::min(begin + kBlock, lattice.size()),
                        [&](uint32_t i, uint32_t j, const Int3& x_j) {
                          if (i < j) sums[block] += part(i, j, x_j);
                        });
        }
      },
      threads);
  T sum = zero;
  for (const T& one : sums) sum += one;
  return sum;
}

// What x_j, P+G fractional bits, does to i.
PairResult kick_on(const FixedRule& rule, const Particle& i, const Int3& x_j, const Particle& j) {
  return pair_kick(rule, visible(rule, i.x), i.v, i.type, visible(rule, x_j), j.v, j.type);
}

// x_j - x_i, P+G fractional bits.
Vec3 between(const Particle& i, const Int3& x_j) {
  return {static_cast<double>(x_j[0] - i.x[0]), static_cast<double>(x_j[1] - i.x[1]),
          static_cast<double>(x_j[2] - i.x[2])};
}

struct PairEnergy {
  double energy = 0;  // J
  ClosestPair closest;
  PairEnergy& operator+=(const PairEnergy& other) {
    energy += other.energy;
    if (other.closest.r < closest.r) closest = other.closest;
    return *this;
  }
};

}  // namespace

std::vector<Int3> summed_kicks(const FixedRule& rule, const Lattice& lattice, const State& state,
                               int threads) {
  std::vector<Int3> sums(state.particles.size(), Int3{});
  const ByCell by_cell(lattice, state);
  for_each_range(
      lattice.size(), kCellsWorthAThread,
      [&](size_t begin, size_t end) {
        for_each_pair(rule, lattice, state, by_cell, static_cast<uint32_t>(begin), static_cast<uint32_t>(end),
                      [&](uint32_t i, uint32_t j, const Int3& x_j) {
                        const Particle &a = state.particles[i], &b = state.particles[j];
                        const PairResult pair = kick_on(rule, a, x_j, b);
                        if (!pair.inside) return;
                        for (int axis = 0; axis < 3; ++axis) sums[i][axis] += pair.kick[axis];
                      });
      },
      threads);
  return sums;
}

double newtons_per_kick(const FixedRule& rule) { return velocity_unit(rule) * rule.mass / rule.dt; }

Vec3 force_of(const FixedRule& rule, const Int3& kick) {
  return newtons_per_kick(rule) *
         Vec3(static_cast<double>(kick[0]), static_cast<double>(kick[1]), static_cast<double>(kick[2]));
}

Energies energies(const Rule& rule, const FixedRule& fixed, const Lattice& lattice, const Vec3& origin,
                  const State& state, const std::vector<Int3>& kicks, int threads, ClosestPair* closest) {
  Energies sum;
  const double length = std::ldexp(fixed.cell_edge, -fixed.widths.velocity_frac());
  const double velocity = velocity_unit(fixed);
  for (size_t i = 0; i < state.particles.size(); ++i) {
    const Particle& particle = state.particles[i];
    const FixedType& type = fixed.types[particle.type];
    const Vec3& gravity = rule.types[particle.type].gravity;
    const Cell& cell = lattice.cell(particle.cell);
    for (int axis = 0; axis < 3; ++axis) {
      // What the step adds to v, of any size: finish() wraps what its widths do not hold.
      double gain = 0;
      if (!type.imposed[axis]) gain = static_cast<double>(kicks[i][axis] + type.gravity[axis]);
      if (!type.imposed[axis] && type.pd)
        gain -= std::ldexp(static_cast<double>(type.kp * particle.u[axis] +
                                               type.kd * (particle.v[axis] - type.velocity[axis])),
                           -fixed.widths.gain_frac);
      const double v = (static_cast<double>(particle.v[axis]) + gain / 2) * velocity;
      const double x =
          origin[axis] + cell[axis] * fixed.cell_edge + static_cast<double>(particle.x[axis]) * length;
      const double kinetic = 0.5 * fixed.mass * v * v;
      sum.kinetic += kinetic;
      if (is_free(rule.types[particle.type], axis))
        sum.free.kinetic += kinetic, sum.free.velocities[axis] += v;
      sum.gravity -= fixed.mass * gravity[axis] * x;
    }
  }
  const double cutoff = rule.law->cutoff();
  const PairEnergy pairs =
      sum_over_pairs(fixed, lattice, state, PairEnergy{}, threads,
                     [&](uint32_t i, uint32_t j, const Int3& x_j) -> PairEnergy {
                       const Particle &a = state.particles[i], &b = state.particles[j];
                       const double r = between(a, x_j).norm() * length;
                       if (r >= cutoff) return {};
                       return {rule.law->energy(r) * rule.strength_of(a.type, b.type), {a.id, b.id, r}};
                     });
  sum.potential = pairs.energy;
  if (closest) *closest = pairs.closest;
  return sum;
}

Vec3 acceleration(const Rule& rule, const Body& body, size_t i, const Vec3& force) {
  const ParticleType& type = rule.types[body.type[i]];
  Vec3 f = force;
  const Vec3 u = body.u.empty() ? Vec3::Zero() : body.u[i];
  if (type.pd) f -= type.kp * u + type.kd * (body.v[i] - type.velocity);
  Vec3 a = f / rule.mass + type.gravity;
  for (int axis = 0; axis < 3; ++axis)
    if (type.imposed[axis]) a[axis] = 0;
  return a;
}

Mat3 virial_stress(const FixedRule& rule, const Lattice& lattice, const State& state, double volume,
                   int threads) {
  const double length = std::ldexp(rule.cell_edge, -rule.widths.velocity_frac());
  const Mat3 sum = sum_over_pairs(rule, lattice, state, Mat3(Mat3::Zero()), threads,
                                  [&](uint32_t i, uint32_t j, const Int3& x_j) -> Mat3 {
                                    const Particle &a = state.particles[i], &b = state.particles[j];
                                    const PairResult pair = kick_on(rule, a, x_j, b);
                                    if (!pair.inside) return Mat3::Zero();
                                    return force_of(rule, pair.kick) * between(a, x_j).transpose();
                                  });
  return sum * (length / volume);
}

double pressure(const Energies& energies, const Mat3& virial_stress, double volume) {
  return energies.kinetic / (1.5 * volume) - virial_stress.trace() / 3;
}

bool keeps_energy(const Rule& rule, const Periodic& periodic) {
  if (rule.damping.coefficient > 0) return false;
  for (const ParticleType& type : rule.types) {
    if (type.pd) return false;
    for (int axis = 0; axis < 3; ++axis) {
      if (type.imposed[axis] && type.velocity[axis] != 0) return false;
      if (type.gravity[axis] != 0 && periodic.extent[axis] > 0) return false;
    }
  }
  return true;
}

bool keeps_momentum(const Rule& rule) {
  for (const ParticleType& type : rule.types)
    if (type.pd || type.imposed != std::array<bool, 3>{} || !type.gravity.isZero(0)) return false;
  return true;
}

double largest_speed(const FixedRule& rule, const State& state) {
  int64_t largest = 0;
  for (const Particle& particle : state.particles)
    for (const int64_t v : particle.v) largest = std::max<int64_t>(largest, std::abs(v));
  return std::ldexp(static_cast<double>(largest), -rule.widths.velocity_frac());
}

Sample sample_of(const FixedRule& rule, const Lattice& lattice, const Vec3& origin, const State& state,
                 const std::vector<Int3>& kicks) {
  Sample sample{state.step, to_real(state, rule, lattice, origin).x, {}};
  for (const Int3& kick : kicks) sample.force.push_back(force_of(rule, kick));
  return sample;
}

std::vector<uint32_t> probed_ids(const std::vector<Probe>& probes) {
  std::vector<uint32_t> ids;
  for (const Probe& probe : probes)
    for (const ParticleSet* set : {&probe.set, &probe.lower, &probe.upper, &probe.grip})
      ids.insert(ids.end(), set->ids.begin(), set->ids.end());
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

std::vector<Probe> placed(std::vector<Probe> probes, const std::vector<uint32_t>& ids) {
  for (Probe& probe : probes)
    for (ParticleSet* set : {&probe.set, &probe.lower, &probe.upper, &probe.grip})
      for (uint32_t& id : set->ids)
        id = static_cast<uint32_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
  return probes;
}

ProbeMeter::ProbeMeter(const std::vector<Probe>& probes, const Periodic& periodic,
                       const std::vector<Vec3>& initial)
    : probes_(probes),
      periodic_(periodic),
      initial_(initial),
      latest_(initial),
      moved_(initial.size(), Vec3::Zero()) {
  for (const Probe& probe : probes_) {
    const auto curve = [&](const char* quantity, const char* unit) {
      curves_.push_back({probe.name + "." + quantity, unit, {}, {}});
    };
    switch (probe.kind) {
      case Probe::Kind::force:
        if (!probe.axis.isZero(0))
          curve("force", "N");
        else
          curve("force_x", "N"), curve("force_y", "N"), curve("force_z", "N");
        break;
      case Probe::Kind::displacement:
        if (!probe.axis.isZero(0))
          curve("along", "m");
        else
          curve("x", "m"), curve("y", "m"), curve("z", "m");
        break;
      case Probe::Kind::stress_strain:
        curve("strain", "1"), curve("stress", "Pa");
        break;
    }
  }
}

void ProbeMeter::add(const Sample& sample) {
  for (size_t i = 0; i < moved_.size(); ++i) {
    moved_[i] += nearest_image(sample.x[i] - latest_[i], periodic_);
    latest_[i] = sample.x[i];
  }
  const auto total_force = [&](const ParticleSet& set) {
    Vec3 sum = Vec3::Zero();
    for (const uint32_t id : set.ids) sum += sample.force[id];
    return sum;
  };
  size_t next = 0;
  const auto point = [&](double value) {
    curves_[next].step.push_back(sample.step);
    curves_[next++].value.push_back(value);
  };
  const auto points = [&](const Vec3& value, const Vec3& axis) {
    if (!axis.isZero(0))
      point(value.dot(axis));
    else
      for (const double component : value) point(component);
  };
  for (const Probe& probe : probes_) switch (probe.kind) {
      case Probe::Kind::force:
        points(total_force(probe.set), probe.axis);
        break;
      case Probe::Kind::displacement:
        points(displacement(probe.set), probe.axis);
        break;
      case Probe::Kind::stress_strain: {
        const double gauge = (position(probe.upper) - position(probe.lower)).dot(probe.axis);
        const double stretch = (displacement(probe.upper) - displacement(probe.lower)).dot(probe.axis);
        point(stretch / gauge);
        point(-total_force(probe.grip).dot(probe.axis) / probe.area);
        break;
      }
    }
}

void ProbeMeter::restore(Memory memory, std::vector<Curve> curves) {
  latest_ = std::move(memory.latest);
  moved_ = std::move(memory.moved);
  curves_ = std::move(curves);
}

Vec3 ProbeMeter::displacement(const ParticleSet& set) const {
  Vec3 sum = Vec3::Zero();
  for (const uint32_t id : set.ids) sum += moved_[id];
  return set.ids.empty() ? sum : Vec3(sum / static_cast<double>(set.ids.size()));
}

Vec3 ProbeMeter::position(const ParticleSet& set) const {
  Vec3 sum = Vec3::Zero();
  for (const uint32_t id : set.ids) sum += initial_[id];
  return set.ids.empty() ? sum : Vec3(sum / static_cast<double>(set.ids.size()));
}

}  // namespace cuboct
