// SPDX-License-Identifier: MIT
// Bodies of a linear peridynamic solid, and its force on each particle.
#pragma once

#include <memory>
#include <vector>

#include "model/rules/lps.h"

namespace cuboct::test {

// A simple cubic block of n points along each axis, one unit apart.
inline Body cubic_block(int nx, int ny, int nz) {
  Body body;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k) body.x.push_back(Vec3(i, j, k));
  body.v.assign(body.size(), Vec3::Zero());
  body.type.assign(body.size(), 0);
  return body;
}

// Horizon three spacings, lambda 0.7, mu 1: a ratio of 0.206.
inline LpsMaterial cubic_material() {
  LpsMaterial m;
  m.lambda = 0.7, m.mu = 1;
  m.horizon = 3, m.volume = 1, m.spacing = 1, m.influence = 1;
  return m;
}

// The rule bound to a body, one thread, evaluated where it is asked.
class LpsBody {
 public:
  LpsBody(const LpsMaterial& material, const std::vector<Vec3>& full, const Body& body,
          const Periodic& periodic = {}, std::vector<Slit> slits = {})
      : size_(body.size()), terms_(LpsRule(material, full, std::move(slits)).bind({}, body, periodic, 1)) {}

  const std::vector<Vec3>& forces(const std::vector<Vec3>& x, bool keeps = false) {
    terms_->begin(x);
    run_rounds(*terms_, 2, size_, keeps);
    return terms_->force();
  }
  const RoundsTerms& terms() const { return *terms_; }

 private:
  size_t size_;
  std::unique_ptr<RoundsTerms> terms_;
};

}  // namespace cuboct::test
