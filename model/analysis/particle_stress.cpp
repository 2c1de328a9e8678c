// SPDX-License-Identifier: MIT
#include "model/analysis/particle_stress.h"

#include <algorithm>

#include "model/analysis/body_reading.h"
#include "model/base/error.h"
#include "model/base/parallel.h"

namespace cuboct {

ParticleStress::ParticleStress(const Scene& scene, int threads)
    : scene_(scene), threads_(threads > 0 ? threads : usable_cores()) {
  if (scene.rule.rounds)
    throw InputError(
        "stress is that of pairs, and the scene's rule has rounds: frames lack what its bonds and fields "
        "hold",
        "probes of kind stress_strain read the stress while the run goes");
}

std::vector<Mat3> ParticleStress::of(const Body& given, bool kinetic, double late) {
  const bool held = std::ranges::any_of(scene_.rule.types, &ParticleType::pd);
  Body body = given;
  if (held && body.u.empty()) body.u.assign(body.size(), Vec3::Zero());
  if (reference_)
    reference_->place(body);
  else
    reference_ =
        std::make_unique<Reference>(scene_.rule, body, scene_.periodic, RealOptions{.threads = threads_});
  std::vector<Mat3> stress = reference_->virial_stress(1);
  if (!kinetic) return stress;
  const std::vector<Vec3> force = late != 0 ? reference_->forces() : std::vector<Vec3>();
  const std::vector<Vec3> v = velocities_at(scene_.rule, body, force, late);
  for (size_t i = 0; i < stress.size(); ++i)
    stress[i] -= scene_.rule.mass_of(body.type[i]) * v[i] * v[i].transpose();
  return stress;
}

}  // namespace cuboct
