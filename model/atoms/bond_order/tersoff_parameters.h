// SPDX-License-Identifier: MIT
// Parameters of Tersoff's potential: published sets by name, and files of LAMMPS's `pair_style tersoff`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "model/atoms/bond_order/tersoff_terms.h"

namespace cuboct {

struct Tersoff {
  std::vector<std::string> elements;
  std::vector<TersoffTerm<double>>
      terms;  // [(i E + j) E + k], E elements; eV and angstrom where read or named

  const TersoffTerm<double>& term(size_t i, size_t j, size_t k) const {
    return terms[(i * elements.size() + j) * elements.size() + k];
  }
  // The distance from which on no two atoms interact.
  double cutoff() const;
  // The same in other units: energies times `energy`, lengths times `length`.
  Tersoff scaled(double energy, double length) const;
};

// si_1988, si_1989, c_1989, si_erhart_albe, c_erhart_albe, si_multiscale. InputError for another name.
Tersoff tersoff_set(std::string_view name);
std::vector<std::string> tersoff_set_names();

// One element of parameters that are known. InputError where one has no meaning: names what is wrong.
Tersoff tersoff_of(const std::string& element, const TersoffTerm<double>& term);

// All triples of `elements` from a file of LAMMPS: entries of 17 words, which may go on over lines,
//   element element element m gamma lambda3 c d cos_theta0 n beta lambda2 B R D lambda1 A
// and comments behind #, which may say UNITS: real. Terms are in eV. InputError with file, line, column.
Tersoff read_tersoff(const std::string& path, const std::vector<std::string>& elements);

// The elements of which such a file has entries of their own (element element element), in its order.
std::vector<std::string> tersoff_elements(const std::string& path);

}  // namespace cuboct
