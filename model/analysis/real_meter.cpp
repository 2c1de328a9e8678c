// SPDX-License-Identifier: MIT
#include "model/analysis/real_meter.h"

#include <numeric>

namespace cuboct {

RealMeter::RealMeter(const Scene& scene, Integrator integrator, bool probes, bool energies)
    : scene_(scene),
      late_(integrator == Integrator::semi_implicit_euler ? scene.rule.dt / 2 : 0),
      probes_(probes ? scene.probes : std::vector<Probe>(), scene.periodic, scene.body.x),
      energy_(energies, scene) {}

void RealMeter::add(const Reference& reference, Watch* watch) {
  const Body& body = reference.body();
  const std::vector<Vec3> force = reference.forces();
  probes_.add({reference.step_count(), body.x, force});
  if (!energy_.wanted()) return;
  const Rule& rule = scene_.rule;
  Energies e;
  for (size_t i = 0; i < body.size(); ++i) {
    const Vec3 v = body.v[i] + late_ * acceleration(rule, body, i, force[i]);
    const ParticleType& type = rule.types[body.type[i]];
    e.kinetic += rule.mass * v.squaredNorm() / 2;
    e.gravity -= rule.mass * type.gravity.dot(body.x[i]);
    for (int a = 0; a < 3; ++a)
      if (is_free(type, a)) e.free.kinetic += rule.mass * v[a] * v[a] / 2, e.free.velocities[a] += v[a];
  }
  e.potential = reference.potential_energy();
  if (watch) watch->see(reference.step_count(), body, force, e);
  energy_.add(reference.step_count(), e, [&] {
    const std::vector<Mat3> stress = reference.virial_stress(energy_.volume());
    return std::accumulate(stress.begin(), stress.end(), Mat3(Mat3::Zero()));
  });
}

std::vector<Curve> RealMeter::curves() const {
  std::vector<Curve> all = probes_.curves();
  all.insert(all.end(), energy_.curves().begin(), energy_.curves().end());
  return all;
}

}  // namespace cuboct
