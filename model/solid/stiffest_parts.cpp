// SPDX-License-Identifier: MIT
#include "model/solid/stiffest_parts.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "model/contract/nearest_image.h"
#include "model/contract/neighbours.h"

namespace cuboct {
namespace {

constexpr int kMostParts = 8;

}  // namespace

std::vector<double> stiffness_bounds(const Rule& rule, const Body& body, const Periodic& periodic) {
  std::vector<double> bound(body.size(), 0);
  std::vector<Mat3> own(body.size(), Mat3::Zero());
  CellList cells(rule.cutoff(), periodic);
  cells.build(body.x);
  cells.for_each_pair(body.x, [&](uint32_t i, uint32_t j, const Vec3& d, double r) {
    const uint8_t of_i = body.type[i], of_j = body.type[j];
    if (r >= rule.reach(of_i, of_j)) return;
    const double scale = rule.strength_of(of_i, of_j) / rule.mass;
    const PairLaw& law = rule.law_of(of_i, of_j);
    const double axial = -law.slope(r), lateral = -law.force(r) / r;
    const double m_i = rule.relative_mass(of_i), m_j = rule.relative_mass(of_j);
    const Vec3 e = d / r;
    const Mat3 block = scale * (lateral * Mat3::Identity() + (axial - lateral) * e * e.transpose());
    own[i] += block / m_i, own[j] += block / m_j;
    const double beside = scale * std::max(std::abs(axial), std::abs(lateral)) / std::sqrt(m_i * m_j);
    bound[i] += beside, bound[j] += beside;
  });
  for (size_t i = 0; i < body.size(); ++i) {
    const ParticleType& type = rule.types[body.type[i]];
    if (type.imposed[0] && type.imposed[1] && type.imposed[2]) {
      bound[i] = 0;
      continue;
    }
    Eigen::SelfAdjointEigenSolver<Mat3> of;
    of.computeDirect(own[i], Eigen::EigenvaluesOnly);
    bound[i] += std::max(0.0, of.eigenvalues()[2]);
    if (type.pd) bound[i] += type.kp / rule.mass_of(body.type[i]);
  }
  return bound;
}

double stiffest_parts_limit(const Rule& rule, const Body& body, const Periodic& periodic, size_t size) {
  std::vector<double> bound = stiffness_bounds(rule, body, periodic);
  double dt = std::numeric_limits<double>::infinity(), stiffest = 0;
  std::vector<double> distance2(body.size());
  std::vector<uint32_t> order(body.size());
  for (int k = 0; k < kMostParts; ++k) {
    const auto centre = static_cast<size_t>(std::ranges::max_element(bound) - bound.begin());
    if (!(bound[centre] > stiffest)) break;
    for (size_t i = 0; i < body.size(); ++i)
      distance2[i] = nearest_image(body.x[i] - body.x[centre], periodic).squaredNorm();
    std::iota(order.begin(), order.end(), 0U);
    const size_t count = std::min(size, body.size());
    const auto nearer = [&](uint32_t i, uint32_t j) {
      return distance2[i] < distance2[j] || (distance2[i] == distance2[j] && i < j);
    };
    std::nth_element(order.begin(), order.begin() + static_cast<ptrdiff_t>(count - 1), order.end(), nearer);
    order.resize(count);
    std::ranges::sort(order);
    Body part;
    for (const uint32_t i : order) {
      part.x.push_back(nearest_image(body.x[i] - body.x[centre], periodic));
      part.type.push_back(body.type[i]);
      bound[i] = 0;
    }
    order.resize(body.size());
    const Limit limit = stability_limit(vibrations_of(rule, part, {}));
    dt = std::min(dt, limit.dt);
    stiffest = std::max(stiffest, limit.frequency * limit.frequency);
  }
  return dt;
}

}  // namespace cuboct
