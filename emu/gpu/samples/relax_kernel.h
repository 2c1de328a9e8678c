// SPDX-License-Identifier: MIT
// Relaxations of samples of one lattice, one block each. Their atoms stay in the device's memory as fractions
// of the cells' edges; one list of bonds, made of the lattice without strain, serves all that are near it.
#pragma once

#include "emu/gpu/samples/sample_kernel.h"

namespace cuboct::gpu {

// The lattice of all samples. `away`, in fractions, takes its atoms off the faces of the cell, so that
// roundings wrap none.
template <class Real>
struct LatticeView {
  const Real* place = nullptr;    // [axis][atom], fractions
  const Real* cell = nullptr;     // [9], without strain: the edge vectors, one after the other
  const Real* inverse = nullptr;  // [9]: its rows times x are fractions
  uint32_t* list = nullptr;       // SampleMemory::list_words
  Real away = 0;
};

// Makes the list of the lattice; sums->fault says whether there was room. One block.
template <class Real>
struct ListKernel {
  LatticeView<Real> lattice;
  SampleRule<Real> rule;
  SampleSums<Real>* sums;

  template <class Block>
  CUBOCT_DEVICE void operator()(uint32_t, const Block& block, void* memory) const {
    SampleBlock<Real, Block> work(block, rule, lattice.cell, lattice.inverse, memory);
    work.load_places(lattice.place, lattice.away);
    const bool room = work.list_bonds();
    if (room) work.store_list(lattice.list);
    block.each(1, [&](uint32_t) {
      *sums = {};
      if (!room) sums->fault = SampleFault::too_many_bonds;
    });
  }
};

// Of a batch: what stands at k is that of the sample due[k].
template <class Real>
struct BatchView {
  const uint32_t* due = nullptr;
  const Real* cell = nullptr;  // [9] each, as LatticeView::cell
  Real* inverse = nullptr;     // [9] each: room for its inverse
  SampleSums<Real>* sums = nullptr;
};

template <class Real>
struct RelaxKernel {
  LatticeView<Real> lattice;
  BatchView<Real> batch;
  Real* place;  // of all samples, [sample][axis][atom], fractions
  SampleRule<Real> rule;
  SampleTask<Real> task;

  template <class Block>
  CUBOCT_DEVICE void operator()(uint32_t k, const Block& block, void* memory) const {
    const Real* cell = batch.cell + 9 * size_t{k};
    Real* inverse = batch.inverse + 9 * size_t{k};
    Real* at = place + size_t{3} * rule.atoms * batch.due[k];
    block.each(1, [&](uint32_t) { invert(cell, inverse); });
    SampleBlock<Real, Block> work(block, rule, cell, inverse, memory);
    SampleSums<Real> sums;
    work.load_places(at, lattice.away);
    bool room =
        work.take_list(lattice.list, lattice.place, lattice.inverse, lattice.away) || work.list_bonds();
    if (room) work.forces(), room = work.relax(task, &sums.steps);
    if (room) {
      work.sums(&sums);
      if (!(sums.force < Real(1e30))) sums.fault = SampleFault::not_finite;
      work.store_places(at, lattice.away);
    } else {
      sums.fault = SampleFault::too_many_bonds;
    }
    block.each(1, [&](uint32_t) { batch.sums[k] = sums; });
  }

 private:
  // Rows of the inverse are cross products of the other two edges over the volume.
  CUBOCT_DEVICE static void invert(const Real* cell, Real* inverse) {
    Real volume = 0;
    for (int e = 0; e < 3; ++e) {
      const Real *b = cell + 3 * ((e + 1) % 3), *c = cell + 3 * ((e + 2) % 3);
      for (int a = 0; a < 3; ++a)
        inverse[3 * e + a] = b[(a + 1) % 3] * c[(a + 2) % 3] - b[(a + 2) % 3] * c[(a + 1) % 3];
    }
    for (int a = 0; a < 3; ++a) volume += cell[a] * inverse[a];
    for (int k = 0; k < 9; ++k) inverse[k] /= volume;
  }
};

}  // namespace cuboct::gpu
