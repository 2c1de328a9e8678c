// SPDX-License-Identifier: MIT
// The elastic constants of a cell by simulation: strained, relaxed to a minimum by FIRE, its stress read. The
// forces are the reference engine's, over the cell and its images in open space: cells may be oblique, and
// smaller than the cutoff. The rule is of pairs, or a text that refuse_cell() lets pass.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "model/base/fire.h"
#include "model/base/mat3.h"
#include "model/real/real_engine.h"
#include "model/solid/elastic_tensor.h"

namespace cuboct {

class StrainedCell {
 public:
  // Keeps a reference to neither. `threads`: of the engine.
  StrainedCell(const Rule& rule, CrystalCell cell, int threads = 1);

  // The cell as it stands.
  const CrystalCell& cell() const { return cell_; }
  // x -> deformation * x, of vectors and particles.
  void deform(const Mat3& deformation);
  // To a minimum at these vectors. std::runtime_error where there is none within `most` evaluations.
  uint64_t relax(uint64_t most = 200000);
  // Pa, tension positive: the virial of the cell's particles over its volume.
  Mat3 stress() const;

 private:
  void gather();
  void place();
  void places(const CrystalCell& cell, std::vector<Vec3>& to) const;
  void make_engine();

  Rule rule_;
  CrystalCell cell_;
  int threads_;
  double stiffness_ = 0;  // N/m, of the stiffest site
  double range_ = 0;      // m, so far from the cell images stand
  bool lasting_ = false;  // bonds are those of CrystalCell::packed
  Body body_;             // the cell's particles and then their images
  std::vector<CellImage> images_;
  std::vector<Vec3> gathered_;  // m, where the particles of body_ stood when the images were gathered
  std::optional<Reference> reference_;
  std::unique_ptr<RealEngine> rounds_;  // instead, of a rule of rounds
};

// Central differences of the stress, of strains of +-`strain` from a cell that is at rest. Both axes of a
// strain repeat; the constants of the others are 0. `evaluations` counts forces. `begins` hears of each of
// the twelve strained cells before it relaxes.
using Begins = std::function<void(int cell)>;
Matrix6 constants_by_strain(const Rule& rule, const CrystalCell& cell, double strain, int threads,
                            uint64_t& evaluations, const Begins& begins = {});

// Of a rule of pairs elastic_tensor(), of another constants_by_strain() and the stress of the cell.
ElasticTensor tensor_of(const Rule& rule, const CrystalCell& cell, double strain, int threads,
                        uint64_t& evaluations, const Begins& begins = {});

// Strains the cell along its repeating axes until they carry no stress (Newton's method with tensor_of's
// constants), and relaxes its particles.
CrystalCell without_stress(const Rule& rule, const CrystalCell& cell, int threads);

}  // namespace cuboct
