// SPDX-License-Identifier: MIT
// EmbeddedAtoms files of the embedded-atom method, as LAMMPS reads them: setfl (eam/alloy) and funcfl (eam).
//
// The energy of atoms is the sum of embedding(total) over atoms, where total sums density(r) of the others,
// and of pair(r) over pairs.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "model/program/cubic_table.h"

namespace cuboct {

// In SI units, or in eV and angstrom. Densities are plain numbers.
struct EmbeddedAtoms {
  using Table = std::shared_ptr<const CubicTable>;

  std::vector<std::string> elements;  // those in use
  double cutoff = 0;
  double lattice_constant = 0;            // of the first element; 0: the file does not say
  std::vector<Table> density, embedding;  // by element
  std::vector<Table> pair;                // [i * elements + j]: r times the energy of a pair
  std::string told;                       // for people
  uint64_t hash = 0;                      // of all numbers in use
};

// `elements`: those to use, in this order; empty: the only one that the file has. `si`: else eV and angstrom.
// InputError with file, line and column; of an element that the file does not have about "element".
EmbeddedAtoms read_embedded_atoms(const std::string& path, const std::vector<std::string>& elements, bool si);

}  // namespace cuboct
