// SPDX-License-Identifier: MIT
// The bonds of a body as packed: each particle's neighbours within reach, by ascending id.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "model/contract/rule.h"

namespace cuboct {

// A flat cut with straight edges: the parallelogram corner + s along + t across, 0 <= s, t <= 1. m
struct Slit {
  Vec3 corner = Vec3::Zero(), along = Vec3::Zero(), across = Vec3::Zero();
  // Whether the straight line from `from` to `from + d` passes through.
  bool cuts(const Vec3& from, const Vec3& d) const;
  std::string told() const;  // for people
};

struct ReferenceBonds {
  std::vector<uint64_t> first;  // [particle]: where its bonds begin; one more at the end
  std::vector<uint32_t> other;  // [bond]: the particle at its far end
  std::vector<Vec3> vector;     // [bond]: from the particle to the other, m

  size_t particles() const { return first.size() - 1; }
  uint64_t begin(size_t i) const { return first[i]; }
  uint64_t end(size_t i) const { return first[i + 1]; }
};

// Pairs nearer than `reach`, or at it but for rounding (1e-6 of it); without those that a slit cuts. Each
// pair is there twice, with opposite vectors to the last bit. InputError where a periodic extent is below
// two reaches, or two particles stand at one place.
ReferenceBonds reference_bonds(std::span<const Vec3> x, const Periodic& periodic, double reach,
                               const std::vector<Slit>& slits = {});

}  // namespace cuboct
