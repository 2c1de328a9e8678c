// SPDX-License-Identifier: MIT
// Machine: what is read off a state on the devices.
#pragma once

#include "emu/gpu/machine.h"

namespace cuboct::gpu {

template <class Policy>
uint64_t Machine<Policy>::hash() {
  uint64_t sum = 0;
  for (auto& slab : slabs_) {
    slab->hashes.zero(slab->stream);
    const HashEach<Policy> f{slab->rule->view(), grid(*slab), at(*slab, at_),      slab->cell.data(),
                             slab->id.data(),    0,           slab->control.data()};
    sum_each(slab->stream, 0, slab->own, options_.block, f, slab->hashes.data());
    sum += slab->hashes.host(slab->stream, 0, 1)[0];
  }
  return sum;
}

template <class Policy>
void Machine<Policy>::probe(const std::vector<uint32_t>& ids) {
  probed_ = ids.size();
  if (ids.empty()) return;
  std::vector<uint32_t> slot(particles_, kNever);
  for (uint32_t k = 0; k < ids.size(); ++k) slot[ids[k]] = k;
  for (auto& slab : slabs_) {
    slab->slot.set(slab->stream, slot);
    slab->found.resize(probed_), slab->found_here.resize(probed_);
  }
}

template <class Policy>
std::vector<Found<Policy>> Machine<Policy>::read_probed() {
  std::vector<Found<Policy>> all(probed_);
  if (probed_ == 0) return all;
  for (auto& slab : slabs_) {
    Slab& s = *slab;
    if (!alone()) s.found_here.zero(s.stream);
    Policy::with_variant(s.rule->view(), [&](auto variant) {
      const ReadProbed<Policy, decltype(variant)> f{s.rule->view(), grid(s),        at(s, at_),
                                                    list(s),        s.cell.data(),  s.id.data(),
                                                    s.slot.data(),  s.found.data(), s.found_here.data()};
      for_each_cached(s.stream, 0, s.own, options_.block, s.rule->cache(), s.rule->cache_words(), f);
    });
    auto found = s.found.host(s.stream, 0, probed_);
    if (alone()) return found;
    const auto here = s.found_here.host(s.stream, 0, probed_);
    for (size_t k = 0; k < probed_; ++k)
      if (here[k]) all[k] = found[k];
  }
  return all;
}

// `velocity`: m/s per unit of a velocity.
inline Energies energies_of(const Sums& sums, double velocity) {
  const Vec3 flow(sums.flow[0], sums.flow[1], sums.flow[2]);
  return {sums.kinetic, sums.potential, sums.gravity, {sums.free_kinetic, velocity * flow}};
}

template <class Policy>
Sums Machine<Policy>::read_energies() {
  Sums all{};
  if (Policy::kFixed) mirror_residues();
  for (auto& slab : slabs_) {
    Slab& s = *slab;
    const uint32_t chunks = (s.own + kSummed - 1) / kSummed;
    if (s.sums.size() < chunks) s.sums.resize(chunks);
    Policy::with_variant(s.rule->view(), [&](auto variant) {
      ReadEnergies<Policy, decltype(variant)> f{};
      f.view = s.rule->view(), f.grid = grid(s), f.at = at(s, at_), f.list = list(s), f.cell = s.cell.data();
      f.energy = s.energy;
      for (int a = 0; a < 3; ++a) f.edge[a] = setup_.edge[a], f.origin[a] = setup_.origin[a];
      f.unit = setup_.unit, f.count = s.own, f.sums = s.sums.data();
      for_each_cached(s.stream, 0, chunks, options_.block, s.rule->cache(), s.rule->cache_words(), f);
    });
    for (const Sums& part : s.sums.host(s.stream, 0, chunks)) {
      all.kinetic += part.kinetic, all.potential += part.potential, all.gravity += part.gravity;
      all.virial += part.virial, all.free_kinetic += part.free_kinetic;
      for (int a = 0; a < 3; ++a) all.flow[a] += part.flow[a];
      all.speed = std::max(all.speed, part.speed);
    }
  }
  return all;
}

}  // namespace cuboct::gpu
