// SPDX-License-Identifier: MIT
// What a fixed engine holds between two steps.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "model/contract/fixed_rule.h"
#include "model/contract/lattice.h"

namespace cuboct {

struct Particle {
  uint32_t id = 0;
  uint8_t type = 0;
  uint32_t cell = 0;  // index into the lattice
  Int3 x{};           // P+G fractional bits, in [0, 2^(P+G)); forces see its leading P (visible)
  Int3 v{};           // P+G fractional bits, at half steps
  Int3 u{};           // P+G fractional bits; zero unless the type is held by force

  bool operator==(const Particle&) const = default;
};

struct State {
  uint64_t step = 0;
  std::vector<Particle> particles;  // sorted by id wherever a State is handed over
  // What a program (model/graph/program.h) keeps of a particle besides: so many numbers of each, in the order
  // of the particles. Empty of the pair law.
  std::vector<int64_t> fields = {};
  // What the rounds of a program keep of bonds, in the order of its rows (model/graph/bond_rows.h): those of
  // particle `id` begin at bond_begin[id], and one more entry ends them. Both empty where there are none.
  std::vector<int64_t> bonds = {};
  std::vector<uint64_t> bond_begin = {};

  bool operator==(const State&) const = default;
};

// Sum over particles (modulo 2^64) of a 64-bit mix of id, type, cell coordinates, x, v, u, and where there
// are any, fields and what its bonds keep: independent of order, so that threads, ranks and GPUs can add up
// their shares.
uint64_t hash_of(const Lattice& lattice, const Particle& particle);
// With its numbers of State::fields, and of State::bonds.
uint64_t hash_of(const Lattice& lattice, const Particle& particle, std::span<const int64_t> fields,
                 std::span<const int64_t> bonds = {});
uint64_t hash_of(const Lattice& lattice, const State& state);

// Sum of v over the particles, P+G fractional bits; where masses differ, of v times the mass over the
// lightest, rounded.
Int3 momentum(const FixedRule& rule, const State& state);
// The same of the sums of v by type.
Int3 momentum(const FixedRule& rule, const std::vector<Int3>& by_type);

// Particles in the integers of the run that left them, by id. A rule of the same formats takes them over as
// they are.
struct ExactBody {
  Widths widths;
  double cell_edge = 0;  // m, the longest
  CellShape shape = kCube;
  double dt = 0;               // s
  Vec3 origin = Vec3::Zero();  // m, lower corner of cell (0,0,0)
  std::vector<Cell> cell;      // coordinates
  std::vector<Int3> x, v, u;   // as in Particle

  // Whether the integers mean the same under this rule.
  bool fits(const FixedRule& rule, const Vec3& rule_origin) const;
};

// Between real and fixed state. `origin` is the position of cell (0,0,0)'s lower corner in metres.
// Positions are rounded to nearest; a particle whose cell the lattice lacks, or whose velocity does not fit
// its width, is an InputError. Integers of Body::exact that fit the rule are taken over bit for bit. Particle
// by particle, no State need be held: an engine can be fed from the Body.
Particle fixed_particle(const Body& body, uint32_t id, const FixedRule& rule, const Lattice& lattice,
                        const Vec3& origin);
State to_fixed(const Body& body, const FixedRule& rule, const Lattice& lattice, const Vec3& origin);
Body to_real(const State& state, const FixedRule& rule, const Lattice& lattice, const Vec3& origin);

// Position of a particle, m.
Vec3 position_of(const FixedRule& rule, const Lattice& lattice, const Vec3& origin, const Particle& particle);

// m of a position's least bit, and m/s of a velocity's, along each axis.
Vec3 position_units(const FixedRule& rule);
Vec3 velocity_units(const FixedRule& rule);

// Velocity of a particle, m/s.
Vec3 velocity_of(const FixedRule& rule, const Particle& particle);

}  // namespace cuboct
