// SPDX-License-Identifier: MIT
// The two rounds of the linear peridynamic solid on a body.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "model/rules/lps.h"

namespace cuboct {

// Of a neighbour's volume the share that counts at distance r: 1, or less at the horizon's edge for
// `partial`. LAMMPS tapers alike (its Peridynamics guide, section 3.3).
double share_of(const LpsMaterial& material, double r);

// With what another engine makes its own arrays of.
class LpsTerms : public RoundsTerms {
 public:
  virtual const LpsMaterial& material() const = 0;
  virtual const ReferenceBonds& reference() const = 0;
  // [bond], m^3: the volume that the far end stands for; and times its influence.
  virtual const std::vector<double>& volumes() const = 0;
  virtual const std::vector<double>& weights() const = 0;
  virtual bool breaks(uint64_t bond) const = 0;  // false: never
  // [particle]: 1/m^5, 1 over the weighted volume; 1, of the last rounds.
  virtual const std::vector<double>& inverse_weighted() const = 0;
  virtual const std::vector<double>& dilatation() const = 0;

  // What the rounds read and write, by the names of the declaration.
  struct Field {
    std::string name;
    std::span<double> numbers;  // [particle x numbers], or [bond]
    bool of_bonds = false;
  };
  virtual std::vector<Field> fields() = 0;
};

// `whole`: weighted volume of a particle that lacks no bond. InputError, with the particle, where its bonds
// do not span the space, or its weights are not those of a stable solid.
std::unique_ptr<LpsTerms> make_lps_terms(const LpsMaterial& material, double whole, ReferenceBonds bonds,
                                         const std::vector<Vec3>& x, const std::vector<char>& unbreakable,
                                         int threads);

}  // namespace cuboct
