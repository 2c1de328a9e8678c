// SPDX-License-Identifier: MIT
#include "model/analysis/state_meter.h"

namespace cuboct {

StateMeter::StateMeter(const Scene& scene, const FixedRule& rule, const Lattice& lattice, const Vec3& origin,
                       const std::function<Particle(uint32_t)>& initial, bool energies, int threads,
                       bool watch)
    : scene_(scene),
      rule_(rule),
      lattice_(lattice),
      origin_(origin),
      ids_(probed_ids(scene.probes)),
      probes_(placed(scene.probes, ids_), scene.periodic,
              [&] {
                std::vector<Vec3> x;
                for (const uint32_t id : ids_) x.push_back(position_of(rule, lattice, origin, initial(id)));
                return x;
              }()),
      energy_(energies, scene),
      threads_(threads) {
  for (const Probe& probe : scene.probes) forces_ |= probe.kind != Probe::Kind::displacement;
  if (energies && watch) watch_.emplace(scene, rule.error.worst_force, threads);
}

void StateMeter::add(const State& state) {
  std::vector<Int3> kicks;
  if (forces_ || energy_.wanted()) kicks = summed_kicks(rule_, lattice_, state, threads_);
  if (!scene_.probes.empty()) {
    Sample sample{state.step, {}, {}};
    for (const uint32_t id : ids_) {
      sample.x.push_back(position_of(rule_, lattice_, origin_, state.particles[id]));
      sample.force.push_back(force_of(rule_, kicks.empty() ? Int3{} : kicks[id]));
    }
    probes_.add(sample);
  }
  if (!energy_.wanted()) return;
  ClosestPair closest;
  const Energies e = energies(scene_.rule, rule_, lattice_, origin_, state, kicks, threads_, &closest);
  if (watch_) watch_->see(rule_, lattice_, origin_, state, kicks, e, closest);
  energy_.add(state.step, e,
              [&] { return virial_stress(rule_, lattice_, state, energy_.volume(), threads_); });
}

std::vector<Curve> StateMeter::curves() const {
  std::vector<Curve> all = probes_.curves();
  all.insert(all.end(), energy_.curves().begin(), energy_.curves().end());
  return all;
}

std::vector<double> StateMeter::latest() const {
  std::vector<double> values;
  for (const std::vector<Curve>* part : {&probes_.curves(), &energy_.curves()})
    for (const Curve& curve : *part) values.push_back(curve.value.back());
  return values;
}

void StateMeter::restore(ProbeMeter::Memory memory, const std::vector<Curve>& curves) {
  const auto energies = curves.end() - static_cast<ptrdiff_t>(energy_.curves().size());
  probes_.restore(std::move(memory), {curves.begin(), energies});
  energy_.restore({energies, curves.end()});
  if (watch_ && !energies->value.empty())
    watch_->remember({energies[0].value[0], energies[1].value[0], energies[2].value[0]});
}

std::vector<uint64_t> probe_steps_of(const Scene& scene, uint64_t last) {
  std::vector<uint64_t> at;
  if (scene.probe_every == 0 || scene.probes.empty()) return at;
  for (uint64_t s = 0; s <= last; s += scene.probe_every) at.push_back(s);
  return at;
}

}  // namespace cuboct
