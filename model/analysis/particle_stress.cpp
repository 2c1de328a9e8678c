// SPDX-License-Identifier: MIT
#include "model/analysis/particle_stress.h"

#include <algorithm>

#include "model/analysis/body_reading.h"
#include "model/base/error.h"
#include "model/base/resources.h"

namespace cuboct {

ParticleStress::ParticleStress(const Rule& rule, const Periodic& box, int threads)
    : rule_(rule), box_(box), threads_(threads > 0 ? threads : usable_cores()) {}

ParticleStress::ParticleStress(const Scene& scene, int threads)
    : ParticleStress(scene.rule, scene.periodic, threads) {
  if (scene.rule.rounds)
    throw InputError(
        "stress is that of pairs, and the scene's rule has rounds: frames lack what its bonds and fields "
        "hold",
        "probes of kind stress and stress_strain read it while the run goes");
}

void ParticleStress::set_box(const Periodic& box) {
  if (box.extent != box_.extent) reference_.reset();
  box_ = box;
}

std::vector<Mat3> ParticleStress::virial(const Body& given) {
  const bool held = std::ranges::any_of(rule_.types, &ParticleType::pd);
  Body body = given;
  if (held && body.u.empty()) body.u.assign(body.size(), Vec3::Zero());
  if (reference_)
    reference_->place(body);
  else
    reference_ = std::make_unique<Reference>(rule_, body, box_, RealOptions{.threads = threads_});
  return reference_->virial_stress(1);
}

std::vector<Mat3> ParticleStress::of(const Body& given, bool kinetic, double late) {
  std::vector<Mat3> stress = virial(given);
  if (!kinetic) return stress;
  const Body& body = reference_->body();
  const std::vector<Vec3> force = late != 0 ? reference_->forces() : std::vector<Vec3>();
  const std::vector<Vec3> v = velocities_at(rule_, body, force, late);
  for (size_t i = 0; i < stress.size(); ++i)
    stress[i] -= rule_.mass_of(body.type[i]) * v[i] * v[i].transpose();
  return stress;
}

}  // namespace cuboct
