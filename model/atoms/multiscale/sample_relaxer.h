// SPDX-License-Identifier: MIT
// Brings the samples of a body's elements to rest, all that are due in a step as one batch: in threads here,
// or on a device (emu/gpu/samples/sample_relaxer.h).
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "model/atoms/multiscale/sample_material.h"
#include "model/base/mat3.h"

namespace cuboct {

// What a batch asks of a sample.
struct StrainedSample {
  size_t sample = 0;         // from 0
  Mat3 cell = Mat3::Zero();  // angstrom, edges: columns
};

// Holds the places of all samples' atoms, as fractions of their cells' edges. They begin at the lattice's.
class SampleRelaxer {
 public:
  using Places = std::vector<std::vector<Vec3>>;  // sample by sample

  virtual ~SampleRelaxer() = default;
  // Moves the atoms of each sample of `due` to rest within its cell, from where its last relaxation left
  // them, by the steps and to the force of relax_sample. answers[k] is what due[k] says then; one that found
  // no rest says so. A batch names a sample once.
  virtual void relax(std::span<const StrainedSample> due, std::span<SampleAnswer> answers) = 0;
  virtual Places places() const = 0;
  virtual void set_places(Places places) = 0;  // of as many samples
};

using RelaxerMaker =
    std::function<std::unique_ptr<SampleRelaxer>(const SampleMaterial& material, size_t samples)>;

// relax_sample of each, in threads that change no bit.
RelaxerMaker host_relaxer(int threads);

}  // namespace cuboct
