// SPDX-License-Identifier: MIT
#include "model/atoms/multiscale/tersoff_law.h"

#include <utility>

#include "model/atoms/bond_order/tersoff_forces.h"

namespace cuboct {
namespace {

// Samples of all elements are strained from one lattice: with this a list serves them up to strains of some
// per cent.

class SampleTersoff : public AtomicForces {
 public:
  explicit SampleTersoff(const Tersoff& tersoff)
      : list_(tersoff.cutoff(), kTersoffSkin, bond_lanes()), forces_(tersoff) {}

  double evaluate(const Mat3& cell, std::span<const Vec3> x, std::span<Vec3> f, Mat3& virial) override {
    const AtomBox box{cell, {true, true, true}};
    list_.update(box, x);
    forces_.evaluate(list_, box, x, f, {.sums = true});
    virial = forces_.virial();
    return forces_.energy();
  }

 private:
  BondList list_;
  TersoffForces forces_;
};

struct TersoffLaw : AtomicLaw {
  explicit TersoffLaw(Tersoff parameters) : tersoff(std::move(parameters)) {}
  std::unique_ptr<AtomicForces> forces() const override { return std::make_unique<SampleTersoff>(tersoff); }
  Tersoff tersoff;
};

}  // namespace

std::shared_ptr<const AtomicLaw> tersoff_law(Tersoff tersoff) {
  return std::make_shared<const TersoffLaw>(std::move(tersoff));
}

}  // namespace cuboct
