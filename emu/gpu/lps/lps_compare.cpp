// SPDX-License-Identifier: MIT
#include "emu/gpu/lps/lps_compare.h"

#include <algorithm>
#include <cmath>

#include "emu/gpu/bench/power.h"
#include "model/base/error.h"

namespace cuboct::gpu {
namespace {

// Of components, over the largest of the reference's.
class Difference {
 public:
  void see(double here, double reference) {
    off_ = std::max(off_, std::abs(here - reference)), most_ = std::max(most_, std::abs(reference));
  }
  void see(const Vec3& here, const Vec3& reference) {
    for (int a = 0; a < 3; ++a) see(here[a], reference[a]);
  }
  double share() const { return most_ > 0 ? off_ / most_ : off_; }
  double value() const { return off_; }

 private:
  double off_ = 0, most_ = 0;
};

LpsErrors differences(LpsDevice& device, const RealEngine& reference, const Body& packed) {
  const LpsTerms& terms = lps_terms_of(reference);
  const LpsState state = device.state();
  const std::vector<double> damage = device.damage(), expected = terms.damage();
  Body beside = packed;
  reference.read(beside);
  Difference u, v, dilatation, broken;
  for (size_t i = 0; i < packed.size(); ++i) {
    u.see(state.x[i] - packed.x[i], beside.x[i] - packed.x[i]);
    v.see(state.v[i], beside.v[i]);
    dilatation.see(state.dilatation[i], terms.dilatation()[i]);
    broken.see(damage[i], expected.empty() ? 0 : expected[i]);
  }
  return {u.share(), v.share(), dilatation.share(), broken.value()};
}

}  // namespace

const LpsTerms& lps_terms_of(const RealEngine& reference) {
  const auto* terms = dynamic_cast<const LpsTerms*>(reference.terms());
  if (terms == nullptr) throw InputError("the scene's rule is not the linear peridynamic solid");
  return *terms;
}

LpsErrors lps_errors(LpsDevice& device, RealEngine& reference, const Body& packed, uint64_t steps,
                     double* seconds) {
  LpsState state = device.state();
  Body body = packed;
  body.x = std::move(state.x), body.v = std::move(state.v);
  reference.place(body, device.step_count());
  if (const auto memory = device.memory(); !memory.empty()) reference.recall(memory);
  const double begin = steady_clock().now();
  for (uint64_t k = 0; k < steps; ++k) reference.step(device.step_count() + k);
  if (seconds) *seconds = steady_clock().now() - begin;
  device.advance(steps);
  return differences(device, reference, packed);
}

}  // namespace cuboct::gpu
