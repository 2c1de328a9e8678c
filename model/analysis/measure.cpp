// SPDX-License-Identifier: MIT
#include "model/analysis/measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <set>
#include <span>

#include "model/analysis/state_reader.h"
#include "model/analysis/strain.h"
#include "model/base/parallel.h"
#include "model/base/tensor.h"
#include "model/contract/fixed_step.h"
#include "model/contract/law_energies.h"
#include "model/program/rule_program.h"
#include "model/rules/rounds_rule.h"

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

Vec3 as_real(const Int3& whole) {
  return {static_cast<double>(whole[0]), static_cast<double>(whole[1]), static_cast<double>(whole[2])};
}

// What x_j, P+G fractional bits, does to i.
PairResult kick_on(const FixedRule& rule, const Particle& i, const Int3& x_j, const Particle& j) {
  return pair_kick(rule, visible(rule, i.x), i.v, i.type, visible(rule, x_j), j.v, j.type);
}

// What the blocks' pairs give, block by block. part(block, sum)
template <typename T, typename Part>
std::vector<T> by_block(const NearPairs& near, const T& zero, int threads, const Part& part) {
  std::vector<T> sums(near.blocks(), zero);
  for_each_range(
      sums.size(), 1,
      [&](size_t begin, size_t end) {
        for (size_t block = begin; block < end; ++block) part(block, sums[block]);
      },
      threads);
  return sums;
}

struct PairEnergy {
  double energy = 0;  // J
  ClosestPair closest;
  std::vector<PairAcross> across;
};

// Each pair by the law of its two types, in doubles: as Rule::pair_energy() has it, but a call for each law.
void energies_by_law(const Rule& rule, const std::vector<Particle>& particles, const PairDistances& pairs,
                     std::span<double> energy) {
  thread_local std::vector<size_t> those;
  thread_local std::vector<double> r, of;
  for (size_t law = 0; law < rule.laws(); ++law) {
    those.clear(), r.clear();
    for (size_t k = 0; k < pairs.count; ++k) {
      const int type_i = particles[pairs.i[k]].type, type_j = particles[pairs.j[k]].type;
      if (&rule.law_of(type_i, type_j) != &rule.law_at(law)) continue;
      those.push_back(k), r.push_back(pairs.r[k]);
    }
    of.resize(r.size());
    energies_of(rule.law_at(law), r, of);
    for (size_t n = 0; n < those.size(); ++n) {
      const size_t k = those[n];
      const int type_i = particles[pairs.i[k]].type, type_j = particles[pairs.j[k]].type;
      energy[k] = rule.only_touch(type_i, type_j) ? rule.pair_energy(type_i, type_j, r[n])
                                                  : of[n] * rule.strength_of(type_i, type_j);
    }
  }
}

// Whether all pairs have the force of one law, as it is.
bool one_law(const Rule& rule) {
  const auto ones = [](const std::vector<double>& row) {
    return std::ranges::all_of(row, [](double strength) { return strength == 1; });
  };
  return rule.law_index.empty() && rule.contact.empty() && std::ranges::all_of(rule.strength, ones);
}

void add_energies(const Rule& rule, const std::vector<Particle>& particles, const PairDistances& pairs,
                  PairEnergy& sum) {
  thread_local std::vector<double> energy;
  energy.resize(std::max(energy.size(), pairs.count));
  const std::span<const double> r(pairs.r.data(), pairs.count);
  if (one_law(rule))
    energies_of(rule.law_at(0), r, {energy.data(), pairs.count});
  else
    energies_by_law(rule, particles, pairs, energy);
  for (size_t k = 0; k < pairs.count; ++k) {
    sum.energy += energy[k];
    if (r[k] < sum.closest.r) sum.closest = {particles[pairs.i[k]].id, particles[pairs.j[k]].id, r[k]};
  }
}

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

Vec3 newtons_per_kick(const FixedRule& rule) { return velocity_units(rule) * rule.mass / rule.dt; }

Vec3 force_of(const FixedRule& rule, const Int3& kick) {
  return newtons_per_kick(rule).cwiseProduct(as_real(kick));
}

Vec3 velocity_of(const FixedRule& rule, const Particle& particle, const Int3& kick, const Vec3& unit) {
  const FixedType& type = rule.types[particle.type];
  Vec3 v;
  for (int axis = 0; axis < 3; ++axis) {
    // What the step adds to v, of any size: finish() wraps what its widths do not hold.
    double gain = 0;
    if (!type.imposed[axis]) gain = static_cast<double>(weighed(rule, type, kick[axis]) + type.gravity[axis]);
    if (!type.imposed[axis] && type.pd)
      gain -= std::ldexp(static_cast<double>(type.kp * particle.u[axis] +
                                             type.kd * (particle.v[axis] - type.velocity[axis])),
                         -rule.widths.gain_frac);
    v[axis] = (static_cast<double>(particle.v[axis]) + gain / 2) * unit[axis];
  }
  return v;
}

Vec3 velocity_of(const FixedRule& rule, const Particle& particle, const Int3& kick) {
  return velocity_of(rule, particle, kick, velocity_units(rule));
}

Energies energies(const Rule& rule, const FixedRule& fixed, const Lattice& lattice, const Vec3& origin,
                  const State& state, const std::vector<Int3>& kicks, const NearPairs& near, int threads,
                  ClosestPair* closest, std::vector<PairAcross>* across) {
  const CellEdges edges = fixed.edges();
  const Vec3 length = position_units(fixed), speed = velocity_units(fixed);
  std::vector<double> masses;  // by type
  for (size_t type = 0; type < rule.types.size(); ++type)
    masses.push_back(mass_of(fixed, static_cast<int>(type)));
  const auto add = [&](size_t i, Energies& sum) {
    const Particle& particle = state.particles[i];
    const ParticleType& type = rule.types[particle.type];
    const double mass = masses[particle.type], relative = mass / fixed.mass;
    const Cell& cell = lattice.cell(particle.cell);
    const Vec3 velocity = velocity_of(fixed, particle, kicks[i], speed);
    for (int axis = 0; axis < 3; ++axis) {
      const double x =
          origin[axis] + cell[axis] * edges[axis] + static_cast<double>(particle.x[axis]) * length[axis];
      const double v = velocity[axis], kinetic = 0.5 * mass * v * v;
      sum.kinetic += kinetic;
      if (is_free(type, axis)) sum.free.kinetic += kinetic, sum.free.velocities[axis] += relative * v;
      sum.gravity -= mass * type.gravity[axis] * x;
    }
  };
  Energies sum;
  for (const Energies& part : by_block(near, Energies{}, threads, [&](size_t block, Energies&part) {
         for (size_t i = near.first_of(block); i < near.first_of(block + 1); ++i) add(i, part);
       })) {
    sum.kinetic += part.kinetic, sum.gravity += part.gravity;
    sum.free.kinetic += part.free.kinetic, sum.free.velocities += part.free.velocities;
  }
  const double cutoff = rule.cutoff();
  const std::vector<PairEnergy> parts =
      by_block(near, PairEnergy{}, threads, [&](size_t block, PairEnergy& part) {
        thread_local PairDistances pairs;
        near.distances(block, cutoff, pairs, part.across);
        add_energies(rule, state.particles, pairs, part);
      });
  PairEnergy pairs;
  for (const PairEnergy& part : parts) {
    pairs.energy += part.energy;
    if (part.closest.r < pairs.closest.r) pairs.closest = part.closest;
    if (across) across->insert(across->end(), part.across.begin(), part.across.end());
  }
  sum.potential = pairs.energy;
  if (closest) *closest = pairs.closest;
  return sum;
}

Energies energies(const Rule& rule, const FixedRule& fixed, const Lattice& lattice, const Vec3& origin,
                  const State& state, const std::vector<Int3>& kicks, int threads, ClosestPair* closest) {
  NearPairs near(fixed, lattice, threads);
  near.take(state);
  return energies(rule, fixed, lattice, origin, state, kicks, near, threads, closest, nullptr);
}

Vec3 acceleration(const Rule& rule, const Body& body, size_t i, const Vec3& force) {
  const ParticleType& type = rule.types[body.type[i]];
  Vec3 f = force;
  const Vec3 u = body.u.empty() ? Vec3::Zero() : body.u[i];
  if (type.pd) f -= type.kp * u + type.kd * (body.v[i] - type.velocity);
  Vec3 a = f / rule.mass_of(body.type[i]) + type.gravity;
  for (int axis = 0; axis < 3; ++axis)
    if (type.imposed[axis]) a[axis] = 0;
  return a;
}

namespace {
// A sum over 2^32 particles of kicks below 2^47 times positions below 2^48 has less.
__extension__ using Int128 = __int128;
}  // namespace

// With k_ij the kick of a pair on i, d_ij = x_j - x_i + s_ij and s_ij the images' part of it, as k_ji =
// -k_ij:
//   sum over pairs of k_ij (x) d_ij = -sum over i of (sum over j of k_ij) (x) x_i + sum over pairs of k_ij
//   (x) s_ij,
// exact in integers. The first sum has the kicks at hand; the second is of pairs across a seam alone.
Mat3 virial_stress(const FixedRule& rule, const Lattice& lattice, const State& state, double volume,
                   const std::vector<Int3>& kicks, const NearPairs& near,
                   const std::vector<PairAcross>& across) {
  Int128 sum[3][3] = {};
  const auto add = [&](const Int3& kick, const std::array<Int128, 3>& at) {
    for (size_t a = 0; a < 3; ++a)
      for (size_t b = 0; b < 3; ++b) sum[a][b] += kick[a] * at[b];
  };
  const int frac = rule.widths.velocity_frac();
  for (size_t i = 0; i < kicks.size(); ++i) {
    const Particle& p = state.particles[i];
    std::array<Int128, 3> at;
    for (size_t a = 0; a < 3; ++a) at[a] = -((Int128{lattice.cell(p.cell)[a]} << frac) + p.x[a]);
    add(kicks[i], at);
  }
  // Of each image the sum of its kicks: |kick| < 2^31, over 2^32 pairs.
  std::array<Int3, 27> by_image{};
  for (const auto& [i, j, image] : across) {
    const Particle &a = state.particles[i], &b = state.particles[j];
    const Int3 d = near.difference(i, j);
    const auto pair =
        pair_kick_of<PairResult>(rule, visible(rule, a.x), a.v, a.type,
                                 visible(rule, {a.x[0] + d[0], a.x[1] + d[1], a.x[2] + d[2]}), b.v, b.type);
    if (!pair.inside) continue;
    Int3& sum_there = by_image[static_cast<size_t>(image[0] + 3 * image[1] + 9 * image[2] + 13)];
    for (size_t axis = 0; axis < 3; ++axis) sum_there[axis] += pair.kick[axis];
  }
  for (int k = 0; k < 27; ++k)
    add(by_image[static_cast<size_t>(k)],
        {Int128{k % 3 - 1} * near.period()[0], Int128{k / 3 % 3 - 1} * near.period()[1],
         Int128{k / 9 - 1} * near.period()[2]});
  const Vec3 length = position_units(rule), newtons = newtons_per_kick(rule);
  Mat3 stress;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      stress(a, b) = static_cast<double>(sum[a][b]) * (newtons[a] * length[b] / volume);
  return stress;
}

Mat3 virial_stress(const FixedRule& rule, const Lattice& lattice, const State& state, double volume,
                   int threads) {
  NearPairs near(rule, lattice, threads);
  near.take(state);
  PairDistances pairs;
  std::vector<PairAcross> across;
  for (size_t block = 0; block < near.blocks(); ++block) near.distances(block, 0, pairs, across);
  return virial_stress(rule, lattice, state, volume, summed_kicks(rule, lattice, state, threads), near,
                       across);
}

double pressure(const Energies& energies, const Mat3& virial_stress, double volume) {
  return energies.kinetic / (1.5 * volume) - virial_stress.trace() / 3;
}

namespace {

// Numbers of a rule's text that change as the energy does not know: velocities and noise make them, or they
// are kept from step to step by a law of their own.
class Unconserved {
 public:
  explicit Unconserved(const RuleProgram& program) : program_(program) {
    seed(program.particle, particle_);
    seed(program.bond, bond_);
    for (size_t before = 1, now = 0; before != now;) {
      before = particle_.size() + bond_.size();
      for (const ProgramRound& round : program.rounds) pass(round);
      now = particle_.size() + bond_.size();
    }
  }

  bool make_the_force() const {
    return std::ranges::any_of(std::array{0U, 1U, 2U},
                               [&](uint32_t axis) { return particle_.contains(program_.force + axis); });
  }

 private:
  static void seed(const std::vector<ProgramField>& fields, std::set<uint32_t>& numbers) {
    for (const ProgramField& field : fields)
      for (uint32_t k = 0; field.kept && k < field.numbers(); ++k) numbers.insert(field.first + k);
  }

  void pass(const ProgramRound& round) {
    sums_.clear();
    const std::vector<bool> pair = reached(round.pair);
    for (const ProgramWrite& write : round.bonds)
      if (pair[write.node]) bond_.insert(write.number);
    for (uint32_t k = 0; k < round.terms.size(); ++k)
      if (pair[round.terms[k]] || pair[round.when[k]]) sums_.insert(k);
    const std::vector<bool> finish = reached(round.finish);
    for (const ProgramWrite& write : round.made)
      if (finish[write.node]) particle_.insert(write.number);
  }

  bool begins(const RealInput& input) const {
    switch (input.source) {
      case RealSource::own_velocity:
      case RealSource::other_velocity:
      case RealSource::noise:
        return true;
      case RealSource::own_field:
      case RealSource::other_field:
        return particle_.contains(input.index);
      case RealSource::bond_field:
        return bond_.contains(input.index);
      case RealSource::sum:
        return sums_.contains(input.index);
      default:
        return false;
    }
  }

  // By node; a node comes after those that it is made of.
  std::vector<bool> reached(const RealGraph& graph) const {
    std::vector<bool> of(graph.nodes().size());
    for (size_t n = 0; n < of.size(); ++n) {
      const RealNode& node = graph.nodes()[n];
      if (node.op == RealOp::input) of[n] = begins(node.input);
      for (int k = 0; k < arity(node.op); ++k) of[n] = of[n] || of[node.of[static_cast<size_t>(k)]];
    }
    return of;
  }

  const RuleProgram& program_;
  std::set<uint32_t> particle_, bond_, sums_;
};

}  // namespace

bool keeps_energy(const Rule& rule, const Periodic& periodic) {
  if (rule.damping.coefficient > 0) return false;
  if (const RoundsRule* rounds = rule.rounds.get(); rounds != nullptr && rounds->text() != nullptr)
    if (!rounds->text()->still && Unconserved(*rounds->text()).make_the_force()) return false;
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
  Sample sample{state.step, to_real(state, rule, lattice, origin).x, {}, {}};
  for (size_t i = 0; i < kicks.size(); ++i) {
    sample.force.push_back(force_of(rule, kicks[i]));
    sample.v.push_back(velocity_of(rule, state.particles[i], kicks[i]));
  }
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
    const auto curve = [&](const std::string& quantity, const std::string& unit) {
      curves_.push_back({probe.name + "." + quantity, unit, {}, {}});
    };
    const auto curves = [&](const std::string& along, const std::string& of, const std::string& unit) {
      if (!probe.axis.isZero(0)) return curve(along, unit);
      for (const char axis : {'x', 'y', 'z'}) curve(of + axis, unit);
    };
    switch (probe.kind) {
      case Probe::Kind::force:
        curves("force", "force_", "N");
        break;
      case Probe::Kind::displacement:
        curves("along", "", "m");
        break;
      case Probe::Kind::stress_strain:
        curve("strain", "1"), curve("stress", "Pa");
        break;
      case Probe::Kind::crack:
        curve("broken", "1"), curve("length", "m"), curve("speed", "m/s"), curve("energy", "J");
        cracks_.emplace_back(probe, periodic, initial);
        break;
      case Probe::Kind::velocity:
        curves("velocity", "velocity_", "m/s");
        break;
      case Probe::Kind::kinetic_energy:
        curve("kinetic_energy", "J");
        break;
      case Probe::Kind::temperature:
        curve("temperature", probe.unit);
        break;
      case Probe::Kind::field:
        if (probe.numbers == 1) curve(probe.field, probe.unit);
        for (int k = 0; probe.numbers > 1 && k < probe.numbers; ++k)
          curve(probe.field + "_" + "xyz"[k], probe.unit);
        break;
      case Probe::Kind::stress:
        for (const std::string& component : kTensorNames) curve(component, "Pa");
        for (int a = 0; probe.whole && a < 3; ++a)
          if (periodic.extent[a] > 0) curve(std::string("strain_") + "xyz"[a], "1");
        break;
    }
  }
}

namespace {

Vec3 sum_of(const std::vector<Vec3>& values, const std::vector<uint32_t>& at) {
  Vec3 sum = Vec3::Zero();
  for (const uint32_t k : at) sum += values[k];
  return sum;
}

Vec3 mean_of(const std::vector<Vec3>& values, const std::vector<uint32_t>& at) {
  return at.empty() ? Vec3(Vec3::Zero()) : Vec3(sum_of(values, at) / static_cast<double>(at.size()));
}

// Of the motion about `mean`, times the masses.
double squares(const std::vector<Vec3>& v, const Probe& probe, const Vec3& mean) {
  double sum = 0;
  for (size_t k = 0; k < probe.set.ids.size(); ++k)
    sum += (probe.relative.empty() ? 1 : probe.relative[k]) * (v[probe.set.ids[k]] - mean).squaredNorm();
  return sum;
}

// Velocity of the centre of mass.
Vec3 flow_of(const std::vector<Vec3>& v, const Probe& probe) {
  if (probe.relative.empty()) return mean_of(v, probe.set.ids);
  Vec3 sum = Vec3::Zero();
  for (size_t k = 0; k < probe.set.ids.size(); ++k) sum += probe.relative[k] * v[probe.set.ids[k]];
  return sum / std::accumulate(probe.relative.begin(), probe.relative.end(), 0.0);
}

double mean_of_field(const std::vector<double>& values, const Probe& probe, int number) {
  double sum = 0;
  for (const uint32_t k : probe.set.ids)
    sum += values[static_cast<size_t>(probe.numbers) * k + static_cast<size_t>(number)];
  return sum / static_cast<double>(probe.set.ids.size());
}

// m/s, from the reading `window` readings ago, or the first one, to the last.
double speed_of(const Curve& length, const Probe& probe) {
  const size_t last = length.value.size() - 1, from = last - std::min(last, probe.window);
  if (last == from) return 0;
  const double time = static_cast<double>(length.step[last] - length.step[from]) * probe.rule->dt;
  return (length.value[last] - length.value[from]) / time;
}

}  // namespace

void ProbeMeter::add(const Sample& sample) {
  const bool moves = std::ranges::any_of(probes_, [](const Probe& probe) {
    using enum Probe::Kind;
    return probe.kind == displacement || probe.kind == stress_strain || probe.kind == crack;
  });
  for (size_t i = 0; moves && i < moved_.size(); ++i) {
    moved_[i] += nearest_image(sample.x[i] - latest_[i], periodic_);
    latest_[i] = sample.x[i];
  }
  size_t next = 0, crack = 0, stress = 0;
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
        points(sum_of(sample.force, probe.set.ids), probe.axis);
        break;
      case Probe::Kind::displacement:
        points(mean_of(moved_, probe.set.ids), probe.axis);
        break;
      case Probe::Kind::stress_strain: {
        const auto growth = [&](const std::vector<Vec3>& of) {
          return (mean_of(of, probe.upper.ids) - mean_of(of, probe.lower.ids)).dot(probe.axis);
        };
        point(growth(moved_) / growth(initial_));
        point(-sum_of(sample.force, probe.grip.ids).dot(probe.axis) / probe.area);
        break;
      }
      case Probe::Kind::crack: {
        const CrackMeter::Found found = cracks_[crack++].look(moved_);
        point(static_cast<double>(found.broken)), point(found.length);
        point(speed_of(curves_[next - 1], probe)), point(found.energy);
        break;
      }
      case Probe::Kind::velocity:
        points(mean_of(sample.v, probe.set.ids), probe.axis);
        break;
      case Probe::Kind::kinetic_energy:
        point(probe.scale * squares(sample.v, probe, Vec3::Zero()));
        break;
      case Probe::Kind::temperature:
        point(probe.scale * squares(sample.v, probe, flow_of(sample.v, probe)));
        break;
      case Probe::Kind::field:
        for (int k = 0; k < probe.numbers; ++k) point(mean_of_field(sample.fields[probe.field_at], probe, k));
        break;
      case Probe::Kind::stress: {
        const Mat3 of = sample.stress_volume.at(stress++) /
                        (probe.volume > 0 ? probe.volume : probe.share * sample.box_volume);
        for (const auto& [a, b] : kTensorPlaces) point(of(a, b));
        for (int a = 0; probe.whole && a < 3; ++a)
          if (periodic_.extent[a] > 0) point(sample.box_strain[a]);
        break;
      }
    }
}

void ProbeMeter::restore(Memory memory, std::vector<Curve> curves) {
  latest_ = std::move(memory.latest);
  moved_ = std::move(memory.moved);
  curves_ = std::move(curves);
}

}  // namespace cuboct
