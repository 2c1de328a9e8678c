// SPDX-License-Identifier: MIT
// What a study of macro-elements asks for: docs/user/multiscale.md has its file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/atoms/bond_order/tersoff_terms.h"
#include "model/atoms/multiscale/element_body.h"
#include "model/atoms/multiscale/shell_springs.h"
#include "model/atoms/multiscale/wave.h"
#include "model/base/mat3.h"
#include "model/base/places.h"

namespace cuboct {

// A pair law by the constants that were asked of it.
struct SpringInput {
  double c11 = 0, c12 = 0, c44 = 0;  // Pa
  CauchyFit fit;
  ShellSprings springs;
};

struct MaterialInput {
  std::shared_ptr<const AtomicLaw> law;
  Crystal crystal = Crystal::diamond;
  std::optional<SpringInput> springs;  // what `law` is, or
  std::optional<TersoffTerm<double>> tersoff;
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

// How a body is computed: what [compare] varies, and a study has once.
struct ElementEffort {
  int cells = 2;                // along each edge of a sample
  double force = 0;             // eV/angstrom
  double strain_tolerance = 0;  // ElementOptions
  int refine = 1;               // each edge of a box's cubes is cut in so many; grains stay as they are
  bool operator==(const ElementEffort&) const = default;
};

// Values of each; the grid of all is computed.
struct CompareInput {
  std::vector<int> cells;
  std::vector<double> force, strain_tolerance;
  std::vector<int> refine;
};

struct ElementStudy {
  std::string path, title;
  Places places;      // of the file's keys
  uint64_t hash = 0;  // of the file's text, and of the mesh's; of what an effort changed
  MaterialInput material;
  ElementMesh mesh;
  std::string mesh_name;  // for messages
  uint64_t seed = 1;      // of the first set's grains; each set has the next
  size_t sets = 1;
  std::optional<Mat3> orientation;  // of all grains; none: drawn at random
  double strain_tolerance = 0;
  std::optional<StretchInput> stretch;
  std::optional<WaveInput> wave;
  std::optional<CompareInput> compare;
};

// With `effort` in place of the file's own. Throws InputError.
ElementStudy read_element_study(const std::string& path, const std::optional<ElementEffort>& effort = {});

// The grid of a study's [compare], the last of its axes fastest: refine, cells, force, strain_tolerance.
std::vector<ElementEffort> efforts_of(const CompareInput& compare);
// Of the grid, the one that leaves the least error.
ElementEffort finest(const CompareInput& compare);

// The study's material. InputError at the place of the potential where its parameters hold no lattice.
std::shared_ptr<const SampleMaterial> material_of(const ElementStudy& study);

// The body of set `set`, its samples at rest without strain. `threads`, `relaxer`: ElementOptions.
ElementBody body_of(const ElementStudy& study, std::shared_ptr<const SampleMaterial> material, size_t set,
                    int threads, const RelaxerMaker& relaxer = {});

}  // namespace cuboct
