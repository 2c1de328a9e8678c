// SPDX-License-Identifier: MIT
// What a study of macro-elements asks for: docs/user/multiscale.md has its file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/multiscale/element_body.h"
#include "model/multiscale/wave.h"

namespace cuboct {

struct MaterialInput {
  std::shared_ptr<const AtomicLaw> law;
  double guess = 0;  // angstrom, of the edge of the cubic cell
  int cells = 2;     // along each edge of a sample
  double mass = 0;   // kg
  double force = 0;  // eV/angstrom: Relaxation
  std::string name;  // of the potential, for people
};

struct StretchInput {
  int axis = 0;
  std::vector<double> strains;  // ascending sizes
};

struct WaveInput {
  int axis = 0, polarisation = 0;
  double peak = 0;  // Pa
  std::optional<double> pulse,
      duration;                     // s; none: a quarter of the time in which the front crosses, that time
  std::optional<double> reference;  // m/s, to be shown beside
  std::vector<double> snapshots;    // s
  double step = 0;                  // of the largest stable dt
};

struct ElementStudy {
  std::string path, title;
  uint64_t hash = 0;  // of the file's text, and of the mesh's
  MaterialInput material;
  ElementMesh mesh;
  std::string mesh_name;  // for messages
  uint64_t seed = 1;      // of the first set's grains; each set has the next
  size_t sets = 1;
  std::optional<Mat3> orientation;  // of all grains; none: drawn at random
  double strain_tolerance = 0;
  std::optional<StretchInput> stretch;
  std::optional<WaveInput> wave;
};

// Throws InputError.
ElementStudy read_element_study(const std::string& path);

// The study's material. InputError at the place of the potential where its parameters hold no lattice.
std::shared_ptr<const SampleMaterial> material_of(const ElementStudy& study);

// The body of set `set`, its samples at rest without strain.
ElementBody body_of(const ElementStudy& study, std::shared_ptr<const SampleMaterial> material, size_t set,
                    int threads);

}  // namespace cuboct
