// SPDX-License-Identifier: MIT
#include "model/contract/state.h"

#include <fmt/format.h>

#include <cmath>

#include "model/base/hash.h"

namespace cuboct {

uint64_t hash_of(const Lattice& lattice, const Particle& particle) {
  Hash hash;
  hash.add(particle.id).add(particle.type);
  for (const int32_t c : lattice.cell(particle.cell)) hash.add(c);
  for (int a = 0; a < 3; ++a) hash.add(particle.x[a]).add(particle.v[a]).add(particle.u[a]);
  return hash.value();
}

uint64_t hash_of(const Lattice& lattice, const Particle& particle, std::span<const int64_t> fields,
                 std::span<const int64_t> bonds) {
  Hash hash;
  hash.resume(hash_of(lattice, particle));
  for (const int64_t number : fields) hash.add(number);
  for (const int64_t number : bonds) hash.add(number);
  return hash.value();
}

uint64_t hash_of(const Lattice& lattice, const State& state) {
  uint64_t sum = 0;
  const size_t fields = state.fields.size() / std::max<size_t>(1, state.particles.size());
  for (size_t k = 0; k < state.particles.size(); ++k) {
    const uint32_t id = state.particles[k].id;
    std::span<const int64_t> bonds;
    if (!state.bond_begin.empty())
      bonds = std::span(state.bonds)
                  .subspan(state.bond_begin[id], state.bond_begin[id + 1] - state.bond_begin[id]);
    sum += hash_of(lattice, state.particles[k], std::span(state.fields).subspan(k * fields, fields), bonds);
  }
  return sum;
}

Int3 momentum(const FixedRule& rule, const State& state) {
  std::vector<Int3> by_type(rule.types.size(), Int3{});
  for (const Particle& particle : state.particles)
    for (int a = 0; a < 3; ++a) by_type[particle.type][a] += particle.v[a];
  return momentum(rule, by_type);
}

Int3 momentum(const FixedRule& rule, const std::vector<Int3>& by_type) {
  Int3 sum{};
  for (int a = 0; a < 3; ++a) {
    double weighed = 0;
    for (size_t k = 0; k < by_type.size(); ++k) {
      sum[a] += by_type[k][a];
      weighed += static_cast<double>(by_type[k][a]) * mass_of(rule, static_cast<int>(k)) / rule.mass;
    }
    if (rule.weighted) sum[a] = std::llround(weighed);
  }
  return sum;
}

bool ExactBody::fits(const FixedRule& rule, const Vec3& rule_origin) const {
  return rule.widths.velocity_frac() == widths.velocity_frac() && rule.cell_edge == cell_edge &&
         rule.shape == shape && rule.dt == dt && rule_origin == origin;
}

Particle fixed_particle(const Body& body, uint32_t id, const FixedRule& rule, const Lattice& lattice,
                        const Vec3& origin) {
  const int frac = rule.widths.velocity_frac();
  Particle p;
  p.id = id;
  p.type = body.type[id];
  const FixedType& type = rule.types[p.type];
  const ExactBody* exact = body.exact && body.exact->fits(rule, origin) ? body.exact.get() : nullptr;
  Cell cell;
  for (int a = 0; a < 3; ++a) {
    const double position_unit = std::ldexp(rule.edges()[a], -frac), velocity_unit = position_unit / rule.dt;
    if (exact) {
      cell[a] = exact->cell[id][a];
      p.x[a] = exact->x[id][a];
      p.v[a] = exact->v[id][a];
      p.u[a] = exact->u[id][a];
    } else {
      const int64_t whole = std::llround((body.x[id][a] - origin[a]) / position_unit);
      cell[a] = static_cast<int32_t>(whole >> frac);
      p.x[a] = whole & ((int64_t{1} << frac) - 1);
      p.v[a] = std::llround(body.v[id][a] / velocity_unit);
      if (!body.u.empty()) p.u[a] = std::llround(body.u[id][a] / position_unit);
    }
    if (type.imposed[a]) p.v[a] = type.velocity[a];
    if (!fits(p.v[a], rule.widths.velocity_bits))
      throw InputError(
          fmt::format("particle {} moves at {:.4g} m/s: more than the {:.4g} m/s that {} velocity bits hold",
                      id, body.v[id][a], std::ldexp(velocity_unit, rule.widths.velocity_bits - 1),
                      rule.widths.velocity_bits),
          "a smaller dt or a larger cell edge lets it move fewer cells per step")
          .about({"velocity[fastest]", "velocity", "particle.velocity", "run.dt"});
  }
  p.cell = lattice.find(cell);
  if (p.cell == kNoCell)
    throw InputError(fmt::format("particle {} lies in cell ({}, {}, {}), which the lattice lacks", id,
                                 cell[0], cell[1], cell[2]));
  return p;
}

State to_fixed(const Body& body, const FixedRule& rule, const Lattice& lattice, const Vec3& origin) {
  State state;
  state.particles.resize(body.size());
  for (uint32_t id = 0; id < body.size(); ++id)
    state.particles[id] = fixed_particle(body, id, rule, lattice, origin);
  return state;
}

Body to_real(const State& state, const FixedRule& rule, const Lattice& lattice, const Vec3& origin) {
  Body body;
  const size_t n = state.particles.size();
  body.x.resize(n);
  body.v.resize(n);
  body.type.resize(n);
  if (rule.pd) body.u.resize(n);
  const Vec3 unit = position_units(rule);
  for (size_t k = 0; k < n; ++k) {
    const Particle& p = state.particles[k];
    body.type[k] = p.type;
    body.x[k] = position_of(rule, lattice, origin, p);
    for (int a = 0; a < 3; ++a) {
      body.v[k][a] = static_cast<double>(p.v[a]) * unit[a] / rule.dt;
      if (rule.pd) body.u[k][a] = static_cast<double>(p.u[a]) * unit[a];
    }
  }
  return body;
}

Vec3 position_of(const FixedRule& rule, const Lattice& lattice, const Vec3& origin,
                 const Particle& particle) {
  const CellEdges edges = rule.edges();
  const Vec3 unit = position_units(rule);
  const Cell& cell = lattice.cell(particle.cell);
  Vec3 x;
  for (int a = 0; a < 3; ++a)
    x[a] = origin[a] + cell[a] * edges[a] + static_cast<double>(particle.x[a]) * unit[a];
  return x;
}

Vec3 position_units(const FixedRule& rule) {
  Vec3 units;
  for (int a = 0; a < 3; ++a) units[a] = std::ldexp(rule.edges()[a], -rule.widths.velocity_frac());
  return units;
}

Vec3 velocity_units(const FixedRule& rule) {
  Vec3 units;
  for (int a = 0; a < 3; ++a) units[a] = std::ldexp(rule.edges()[a] / rule.dt, -rule.widths.velocity_frac());
  return units;
}

Vec3 velocity_of(const FixedRule& rule, const Particle& particle) {
  return velocity_units(rule).cwiseProduct(Vec3(static_cast<double>(particle.v[0]),
                                                static_cast<double>(particle.v[1]),
                                                static_cast<double>(particle.v[2])));
}

}  // namespace cuboct
