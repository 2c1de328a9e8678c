// SPDX-License-Identifier: MIT
// What `cuboct elastic` found, as a table and as JSON.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/base/mat3.h"
#include "model/solid/elastic_tensor.h"
#include "model/solid/moduli.h"

namespace cuboct {

struct SlabModulus {
  int layers = 0;
  double thickness = 0;               // m, of as many layers in the packing
  double by_sums = 0, by_strain = 0;  // Pa
};

struct Cleavage {
  std::string plane;
  Vec3 normal;        // in the scene's axes
  double energy = 0;  // J/m^2
};

struct ElasticFindings {
  std::string scene, cell;
  size_t particles = 0;
  double density = 0;                      // kg/m^3
  uint64_t relaxing = 0, evaluations = 0;  // of forces: to the minimum, and of all strained cells
  double strain = 0;
  ElasticTensor sums;
  Matrix6 strained = Matrix6::Zero();  // Pa
  bool by_sums = true;                 // else of a rule of text: `sums` is what the strained cells say
  std::vector<std::string> left_out;   // fields whose starts in the scene ask where they are
  std::optional<Mat3> crystal;         // of a packing: its cubic axes
  std::vector<SlabModulus> slabs;
  std::vector<Cleavage> cleavage;  // of a packing of one material

  bool stable() const { return softest_strain(sums.c) > 0; }
  // The largest difference of the two over the largest constant.
  double difference() const {
    return (sums.c - strained).cwiseAbs().maxCoeff() / sums.c.cwiseAbs().maxCoeff();
  }
  // The same of the constants and their transpose, which forces from an energy make equal at rest.
  double asymmetry() const {
    return (strained - strained.transpose()).cwiseAbs().maxCoeff() / strained.cwiseAbs().maxCoeff();
  }
};

// A unit of pressure, Pa and its name, in which `largest` has one to three digits before the point.
std::pair<double, std::string> pressure_unit(double largest);

std::string text_of(const ElasticFindings& found);
std::string json_of(const ElasticFindings& found);

}  // namespace cuboct
