// SPDX-License-Identifier: MIT
// The samples of a study's elements (model/atoms/multiscale/sample_relaxer.h) at rest by a device, in
// doubles: one block of threads each, as emu/gpu/samples/samples.h. Their atoms stay in the device's memory
// from one batch to the next; cells go there, energies, virials and forces come back.
// docs/reference/samples.md.
#pragma once

#include "model/atoms/bond_order/tersoff_terms.h"
#include "model/atoms/multiscale/sample_relaxer.h"

namespace cuboct::gpu {

struct RelaxerOptions {
  int device = 0;
  int threads = 1;            // of the host, for what goes there and comes back
  double skin = 0.5;          // angstrom, beyond the cutoff; that of the host's lists
  double bonds_per_atom = 5;  // room for listed bonds at first; it grows where a sample needs more
};

// The material's law must have this term. Throws InputError where the lattice's cell is thinner than cutoff
// and skin, or a sample does not fit into a block's memory; ElementError where a strained cell is thinner
// than that; std::runtime_error where the device fails. A sample with a force that is no number is one that
// finds no rest.
RelaxerMaker device_relaxer(const TersoffTerm<double>& term, const RelaxerOptions& options = {});

}  // namespace cuboct::gpu
