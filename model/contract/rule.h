// SPDX-License-Identifier: MIT
// The local update rule in real units (SI, double precision): pair law, damping, types and their constraints.
// A Rule and a Body are all that a physical scene is; quantisation makes a FixedRule of the one and a State
// of the other.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "model/base/vec.h"
#include "model/contract/law_form.h"

namespace cuboct {

// A radial pair law: force in newtons at distance r in metres, positive repels. It is zero from `cutoff` on.
class PairLaw {
 public:
  virtual ~PairLaw() = default;
  virtual double force(double r) const = 0;
  // Potential energy in joules, zero at the cutoff; dU/dr = -force.
  virtual double energy(double r) const = 0;
  // df/dr in N/m.
  virtual double slope(double r) const = 0;
  virtual double cutoff() const = 0;
  // Below this distance every law is linear, force(r) = r * force(core)/core: the force rolls off and f/r
  // stays finite.
  virtual double core() const = 0;  // > 0
  // The same force between core and cutoff, but for rounding.
  virtual LawForm form() const { return {}; }
};

// Damping on the radial velocity difference: on i the force c(r) * (w . e) e, e = d/r, d = x_j - x_i, w = v_j
// - v_i. c(r) = coefficient * (1 - (r/cutoff)^2)^2, in kg/s: smooth, and zero at the cutoff of the rule.
// Below the rule's core c/r^2 keeps its value at the core.
struct Damping {
  double coefficient = 0;  // kg/s, >= 0; 0: the scene does not damp
};

// What sets one particle apart from another. Particles of one type share material and constraints.
struct ParticleType {
  std::string name;                                  // "material" or "material/constraint", for messages
  int material = 0;                                  // index into Rule::strength
  std::array<bool, 3> imposed{false, false, false};  // axes whose velocity is imposed; held is an imposed 0
  Vec3 velocity = Vec3::Zero();  // m/s, imposed, or followed by the anchor of the PD controller
  Vec3 gravity = Vec3::Zero();   // m/s^2, of all that acts from outside: gravity proper, and `pull`
  bool pd = false;               // held or moved by force
  double kp = 0;                 // N/m
  double kd = 0;                 // kg/s
  Vec3 pull = Vec3::Zero();      // m/s^2, the part of `gravity` that a force makes, over the particle's mass
};

// Whether nothing imposes or steers the motion of such a particle along the axis.
inline bool is_free(const ParticleType& type, int axis) { return !type.imposed[axis] && !type.pd; }

// A table of the force for each law is in every force pipe: more laws are more memory than small devices
// have.
inline constexpr size_t kMostLaws = 4;

class RoundsRule;  // model/rules/rounds_rule.h

// Of pairs, or of rounds: exactly one of `law` and `rounds` is there.
struct Rule {
  std::shared_ptr<const PairLaw> law;  // of all pairs of materials that have none of their own
  // A rule of several rounds, and the distance beyond which it lets no particle act on another, m.
  std::shared_ptr<const RoundsRule> rounds;
  double rounds_reach = 0;
  // Of pairs of materials with laws of their own, each once. Symmetric, materials x materials: 0 means `law`,
  // k other_laws[k - 1]. Both empty where `law` serves all.
  std::vector<std::shared_ptr<const PairLaw>> other_laws;
  std::vector<std::vector<uint8_t>> law_index;
  Damping damping;
  double mass = 0;                  // kg per particle; where masses differ, of the lightest material
  std::vector<double> masses;       // kg by material; empty where all have `mass`
  double dt = 0;                    // s
  std::vector<ParticleType> types;  // at least one
  std::vector<std::vector<double>>
      strength;  // symmetric, materials x materials, > 0: factor on the pair force
  // Materials that only touch: their pairs push within the contact distance and do nothing beyond it.
  // Symmetric, materials x materials; empty where no two do.
  std::vector<std::vector<char>> contact;
  double contact_distance = 0;  // m, where the laws' push ends (law.h); only with `contact`

  size_t laws() const { return 1 + other_laws.size(); }
  // InputError where the rule is of rounds: a body that has them is not one without forces.
  const PairLaw& law_at(size_t k) const {
    if (law == nullptr) refuse_pairs();
    return k == 0 ? *law : *other_laws[k - 1];
  }
  size_t law_between(size_t material, size_t other) const {
    return law_index.empty() ? 0 : law_index[material][other];
  }
  // The largest strength of the pairs of materials that law k serves; 0 where it serves none.
  double strongest_of(size_t k) const {
    double strongest = 0;
    for (size_t i = 0; i < strength.size(); ++i)
      for (size_t j = 0; j < strength.size(); ++j)
        if (law_between(i, j) == k) strongest = std::max(strongest, strength[i][j]);
    return strongest;
  }
  size_t law_index_of(int type_i, int type_j) const {
    return law_between(static_cast<size_t>(types[type_i].material),
                       static_cast<size_t>(types[type_j].material));
  }
  const PairLaw& law_of(int type_i, int type_j) const { return law_at(law_index_of(type_i, type_j)); }
  // Of all laws the longest cutoff and the shortest core, m; of rounds the reach, and a thousandth of it.
  double cutoff() const {
    double longest = law ? law->cutoff() : rounds_reach;
    for (const auto& other : other_laws) longest = std::max(longest, other->cutoff());
    return longest;
  }
  double core() const {
    double shortest = law ? law->core() : rounds_reach / 1000;
    for (const auto& other : other_laws) shortest = std::min(shortest, other->core());
    return shortest;
  }

  double mass_of(int type) const { return masses.empty() ? mass : masses[types[type].material]; }
  // Over the lightest material's, >= 1.
  double relative_mass(int type) const { return mass_of(type) / mass; }
  double heaviest() const { return masses.empty() ? mass : *std::max_element(masses.begin(), masses.end()); }
  // The largest strength over the relative mass of the pair's lighter particle, of the pairs of types that
  // law k serves; 0 where it serves none. A packing's largest squared frequency is at most so many times that
  // of strength 1 and `mass`, w^2: with C this factor, the stiffness of a pair is at most C min(m_i, m_j),
  // which is the sum over masses t of C where both are heavier than t; the bonds among those are some of a
  // packing's, whose energy is at most w^2 times the sum of their x^2.
  double largest_rate(size_t k) const {
    double rate = 0;
    for (size_t i = 0; i < types.size(); ++i)
      for (size_t j = 0; j < types.size(); ++j) {
        const int a = static_cast<int>(i), b = static_cast<int>(j);
        if (law_index_of(a, b) == k)
          rate = std::max(rate, strength_of(a, b) / std::min(relative_mass(a), relative_mass(b)));
      }
    return rate;
  }
  // c(r)/r^2 in kg/(s m^2).
  double damping_over_r2(double r) const {
    const double near = std::max(r, core());
    const double q = near / cutoff();
    return q < 1 ? damping.coefficient * (1 - q * q) * (1 - q * q) / (near * near) : 0.0;
  }
  double strength_of(int type_i, int type_j) const {
    return strength[types[type_i].material][types[type_j].material];
  }
  bool only_touch(int type_i, int type_j) const {
    return !contact.empty() && contact[types[type_i].material][types[type_j].material] != 0;
  }
  // The distance from which on the pair does nothing, m: damping ends at the longest cutoff.
  double reach(int type_i, int type_j) const {
    return only_touch(type_i, type_j) ? contact_distance : cutoff();
  }
  // J, zero from the pair's reach on; dU/dr = -strength * force.
  double pair_energy(int type_i, int type_j, double r) const {
    const double end = reach(type_i, type_j);
    if (r >= end) return 0;
    const PairLaw& of = law_of(type_i, type_j);
    const double beyond = only_touch(type_i, type_j) ? of.energy(end) : 0;
    return (of.energy(r) - beyond) * strength_of(type_i, type_j);
  }

 private:
  [[noreturn]] void refuse_pairs() const;  // defined where rounds are known: model/rules/rounds_rule.cpp
};

struct ExactBody;

// Bonds of a rule of several rounds that are those of the body as packed, and what they keep.
struct BondState {
  std::vector<Vec3> packed;    // m, by id: where each bond counts from
  std::vector<uint64_t> kept;  // of keep_bonds() (model/rules/rounds_rule.h); empty: nothing yet
};

// Particles in SI units; the index is the particle's id.
struct Body {
  std::vector<Vec3> x;        // m
  std::vector<Vec3> v;        // m/s
  std::vector<Vec3> u;        // m, displacement from the PD anchor; empty unless some type has one
  std::vector<uint8_t> type;  // index into Rule::types
  // The same in the integers of a fixed rule that left them (model/contract/state.h); null: there are none.
  // Whoever changes x, v or u drops it.
  std::shared_ptr<const ExactBody> exact;
  // Null: bonds are those of where the particles are, and whole.
  std::shared_ptr<const BondState> bonds{};

  size_t size() const { return x.size(); }
};

// A box that repeats. Axes that are not periodic have extent 0. Where all three are 0 the space is unbounded.
struct Periodic {
  Vec3 origin = Vec3::Zero();  // m
  Vec3 extent = Vec3::Zero();  // m
};

}  // namespace cuboct
