// SPDX-License-Identifier: MIT
#include "model/analysis/meter.h"

#include "model/rules/rounds_rule.h"
#include "model/scene/readings.h"

namespace cuboct {
namespace {

std::vector<uint32_t> ids_of(const Scene& scene, bool probes) {
  return probes ? probed_ids(scene.probes) : std::vector<uint32_t>();
}

std::vector<Vec3> places_of(const std::vector<uint32_t>& ids, const std::function<Vec3(uint32_t)>& initial) {
  std::vector<Vec3> x;
  x.reserve(ids.size());
  for (const uint32_t id : ids) x.push_back(initial(id));
  return x;
}

}  // namespace

Meter::Meter(const Scene& scene, const std::function<Vec3(uint32_t)>& initial, const MeterOptions& options)
    : scene_(scene),
      ids_(ids_of(scene, options.probes)),
      probes_(options.probes ? placed(scene.probes, ids_) : std::vector<Probe>(), scene.periodic,
              places_of(ids_, initial)),
      energy_(options.energies, scene) {
  if (options.probes)
    for (const Probe& probe : scene.probes) {
      forces_ |= probe.kind == Probe::Kind::force || probe.kind == Probe::Kind::stress_strain;
      velocities_ |= probe.kind >= Probe::Kind::velocity && probe.kind <= Probe::Kind::temperature;
      fields_ |= probe.kind == Probe::Kind::field;
      if (probe.kind == Probe::Kind::stress) stress_.push_back({probe.set.ids, probe.whole, probe.kinetic});
    }
  // What a run is watched for is of pair laws.
  const bool watch = options.watch && scene.rule.rounds == nullptr;
  if (options.energies && watch) watch_.emplace(scene, options.table_error, options.threads);
}

Asked Meter::asked(const Parts& parts, bool look, uint64_t step) {
  Asked asked;
  if (parts.energies && energy_.wanted()) {
    asked.energies = true;
    asked.volume = energy_.volume(step);
    if (look && watch_) asked.watch = &*watch_;
  }
  if (!parts.probes) return asked;
  asked.ids = ids_;
  asked.stress = stress_;
  asked.forces = forces_, asked.velocities = velocities_, asked.fields = fields_;
  return asked;
}

void Meter::add(const Reading& reading, const Parts& parts) {
  if (parts.probes && !probes_.curves().empty()) {
    const Periodic box = scene_.box_at(reading.step);
    probes_.set_box(box);
    probes_.add({reading.step, reading.x, reading.force, reading.v, reading.fields, reading.stress_volume,
                 box.extent.prod(), scene_.deform ? scene_.deform->strain_at(reading.step) : Vec3::Zero()});
  }
  if (parts.energies) energy_.add(reading.step, reading.energies, reading.stress);
}

std::vector<Curve> Meter::curves() const {
  std::vector<Curve> all = probes_.curves();
  all.insert(all.end(), energy_.curves().begin(), energy_.curves().end());
  return all;
}

std::vector<double> Meter::values_at(uint64_t step) const {
  std::vector<double> values;
  for (const std::vector<Curve>* curves : {&probes_.curves(), &energy_.curves()})
    for (const Curve& curve : *curves) {
      if (curve.step.empty() || curve.step.back() != step) return values;
      values.push_back(curve.value.back());
    }
  return values;
}

std::optional<double> Meter::latest_of(const std::string& name) const {
  for (const Curve& curve : probes_.curves())
    if (curve.name == name && !curve.value.empty()) return curve.value.back();
  return std::nullopt;
}

void Meter::restore(ProbeMeter::Memory memory, const std::vector<Curve>& curves) {
  const auto energies = curves.end() - static_cast<ptrdiff_t>(energy_.curves().size());
  probes_.restore(std::move(memory), {curves.begin(), energies});
  energy_.restore({energies, curves.end()});
  if (watch_ && !energies->value.empty())
    watch_->remember({energies[0].value[0], energies[1].value[0], energies[2].value[0]});
}

std::vector<uint64_t> probe_steps_of(const Scene& scene, uint64_t last) {
  std::vector<uint64_t> at;
  const uint64_t every = readings_of(scene, last).probes;
  if (every == 0 || scene.probes.empty()) return at;
  for (uint64_t s = 0; s <= last; s += every) at.push_back(s);
  return at;
}

}  // namespace cuboct
