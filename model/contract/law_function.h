// SPDX-License-Identifier: MIT
// Pair laws whose force is a function that somebody else gives.
#pragma once

#include <memory>
#include <span>

#include "model/contract/hermite.h"
#include "model/contract/rule.h"

namespace cuboct {

// Between core and cutoff: N over m, positive repels.
class LawFunction {
 public:
  virtual ~LawFunction() = default;
  double force(double r) const {
    double f = 0;
    forces({&r, 1}, {&f, 1});
    return f;
  }
  virtual void forces(std::span<const double> r, std::span<double> f) const = 0;
  virtual double slope(double r) const = 0;
};

// As law.h has all laws. Its energy is the integral of the force, by five points of Gauss and Legendre in
// each of 8,192 parts of the range, and cubics between them: of Lennard-Jones to 1e-12.
// InputError where the force is no number somewhere.
std::shared_ptr<const PairLaw> function_law(std::shared_ptr<const LawFunction> of, double cutoff,
                                            double core);

// `name`: for complaints.
std::shared_ptr<const PairLaw> hermite_law(const char* name, Hermite force, double core);

// N of each r (m) between core and cutoff, where the law is a function's; false: it is none.
bool forces_of(const PairLaw& law, std::span<const double> r, std::span<double> f);

}  // namespace cuboct
