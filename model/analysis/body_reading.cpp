// SPDX-License-Identifier: MIT
#include "model/analysis/body_reading.h"

namespace cuboct {

std::vector<Vec3> velocities_at(const Rule& rule, const Body& body, const std::vector<Vec3>& force,
                                double late) {
  std::vector<Vec3> v = body.v;
  if (late != 0)
    for (size_t i = 0; i < v.size(); ++i) v[i] += late * acceleration(rule, body, i, force[i]);
  return v;
}

std::vector<Mat3> summed_stress(const Rule& rule, const std::vector<uint8_t>& type,
                                const std::vector<Vec3>& v, const std::vector<Mat3>& virial,
                                std::span<const AskedStress> sets) {
  std::vector<Mat3> sums;
  for (const AskedStress& set : sets) {
    Mat3 sum = Mat3::Zero();
    const size_t count = set.all ? virial.size() : set.ids.size();
    for (size_t k = 0; k < count; ++k) {
      const size_t i = set.all ? k : set.ids[k];
      sum += virial[i];
      if (set.kinetic) sum -= rule.mass_of(type[i]) * v[i] * v[i].transpose();
    }
    sums.push_back(sum);
  }
  return sums;
}

Reading read_body(const Rule& rule, const Body& body, const std::vector<Vec3>& force,
                  const std::vector<Vec3>& v, const Asked& asked) {
  Reading reading;
  for (const uint32_t id : asked.ids) {
    reading.x.push_back(body.x[id]);
    reading.force.push_back(force.empty() ? Vec3(Vec3::Zero()) : force[id]);
    if (asked.velocities) reading.v.push_back(v[id]);
  }
  if (!asked.energies) return reading;
  Energies& e = reading.energies;
  for (size_t i = 0; i < body.size(); ++i) {
    const ParticleType& type = rule.types[body.type[i]];
    const double relative = rule.relative_mass(body.type[i]), mass = rule.mass * relative;
    e.kinetic += mass * v[i].squaredNorm() / 2;
    e.gravity -= mass * type.gravity.dot(body.x[i]);
    for (int a = 0; a < 3; ++a)
      if (is_free(type, a))
        e.free.kinetic += mass * v[i][a] * v[i][a] / 2, e.free.velocities[a] += relative * v[i][a];
  }
  return reading;
}

}  // namespace cuboct
