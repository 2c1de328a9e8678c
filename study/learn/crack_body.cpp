// SPDX-License-Identifier: MIT
#include "study/learn/crack_body.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "model/base/dense.h"

namespace cuboct::learn {
namespace {

LpsMaterial material_of(const Grid& grid, const Kernel& kernel, const Breaking& breaking) {
  LpsMaterial m;
  m.dimensions = 2, m.lambda = kernel.lambda, m.mu = kernel.mu;
  m.horizon = kernel.horizon * grid.step(), m.influence = kernel.alpha, m.bernstein = kernel.D;
  m.volume = grid.volume(), m.spacing = grid.step();
  m.quadrature = LpsQuadrature::fitted, m.finite = false, m.corrected = true;
  m.critical_stretch = breaking.stretch, m.damage_width = breaking.width;
  return m;
}

// Bonds as words of the rule's memory: their largest stretch so far.
std::vector<uint64_t> broken_across(const LpsTerms& terms, const std::vector<Vec3>& x, const Slit& slit) {
  std::vector<uint64_t> words = terms.memory();
  const ReferenceBonds& bonds = terms.reference();
  for (size_t i = 0; i < x.size(); ++i)
    for (uint64_t b = bonds.begin(i); b < bonds.end(i); ++b)
      if (slit.cuts(x[i], bonds.vector[b]))
        words[b] = std::bit_cast<uint64_t>(std::numeric_limits<double>::max());
  return words;
}

}  // namespace

CrackBody::CrackBody(const Grid& grid, const Kernel& kernel, const Breaking& breaking, double slit)
    : grid_(grid), home_(grid.all()), x_(home_), force_(home_.size()) {
  const WaveOperator symbol(grid, kernel.horizon);
  const Eigen::VectorXd K = symbol.kernel_at(kernel.alpha, kernel.D);
  const LpsMaterial material = material_of(grid, kernel, breaking);
  terms_ = make_lps_terms(material, symbol.weighted(K), reference_bonds(home_, {}, material.horizon), home_,
                          {}, 1);
  const Vec3 extent = grid.points * grid.spacing;
  // From below the sheet, and through its thickness.
  const Slit cut{Vec3(0, -extent[1], -1), Vec3(0, extent[1] / 2 + slit, 0), Vec3(0, 0, 2)};
  terms_->recall(broken_across(*terms_, home_, cut));
  const WaveOperator::Parts parts = symbol.parts(symbol.kappa(K));
  for (size_t k = 0; k < symbol.waves(); ++k)
    stiffest_ = std::max(
        stiffest_,
        eigensystem<Eigen::Matrix2d>(WaveOperator::matrix(kernel.lambda, kernel.mu, parts, k)).values[1]);
}

const std::vector<Vec3>& CrackBody::force(const std::vector<Vec3>& u, bool keeps) {
  for (size_t i = 0; i < u.size(); ++i) x_[i] = home_[i] + u[i];
  terms_->begin(x_);
  run_rounds(*terms_, 2, u.size(), keeps);
  for (size_t i = 0; i < u.size(); ++i) force_[i] = terms_->force()[i] / grid_.volume();
  return force_;
}

std::vector<double> CrackBody::damage() const {
  const ReferenceBonds& bonds = terms_->reference();
  const std::vector<uint64_t> most = terms_->memory();
  std::vector<double> out(home_.size());
  for (size_t i = 0; i < out.size(); ++i) {
    double left = 0;
    for (uint64_t b = bonds.begin(i); b < bonds.end(i); ++b)
      left += terms_->material().left(std::bit_cast<double>(most[b]));
    out[i] = 1 - left / static_cast<double>(bonds.end(i) - bonds.begin(i));
  }
  return out;
}

double CrackBody::stable_step(double density) const { return 2 / std::sqrt(stiffest_ / density); }

}  // namespace cuboct::learn
