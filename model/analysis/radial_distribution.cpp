// SPDX-License-Identifier: MIT
#include "model/analysis/radial_distribution.h"

#include <algorithm>
#include <numbers>

#include "model/analysis/near_within.h"

namespace cuboct {

RdfMeter::RdfMeter(const Periodic& periodic, double cutoff, size_t bins, RdfSets sets, int threads)
    : periodic_(periodic),
      cutoff_(cutoff),
      sets_(std::move(sets)),
      threads_(threads > 0 ? threads : usable_cores()),
      pairs_(bins, 0) {
  check_range(cutoff, periodic, "cutoff");
}

void RdfMeter::set_box(const Periodic& periodic) {
  check_range(cutoff_, periodic, "cutoff");
  periodic_ = periodic;
}

void RdfMeter::add(const std::vector<Vec3>& x) {
  const size_t bins = pairs_.size();
  const double per_width = 1 / (cutoff_ / static_cast<double>(bins));
  const bool all = sets_.a.empty();
  std::vector<std::vector<uint64_t>> counts(static_cast<size_t>(threads_));
  for_each_near(
      x, periodic_, cutoff_, threads_, [&](size_t member, uint32_t i, std::span<const uint32_t> near) {
        std::vector<uint64_t>& of = counts[member];
        if (of.empty()) of.resize(bins);
        for (auto at = std::upper_bound(near.begin(), near.end(), i); at != near.end(); ++at) {
          const uint32_t j = *at;
          const int ways = all ? 2 : (sets_.a[i] && sets_.b[j]) + (sets_.a[j] && sets_.b[i]);
          if (ways == 0) continue;
          const auto bin = static_cast<size_t>(nearest_image(x[j] - x[i], periodic_).norm() * per_width);
          if (bin < bins) of[bin] += static_cast<uint64_t>(ways);
        }
      });
  for (const std::vector<uint64_t>& of : counts)
    for (size_t bin = 0; bin < of.size(); ++bin) pairs_[bin] += of[bin];
  ++frames_;
  particles_ = x.size();
}

Rdf RdfMeter::result(double volume) const {
  Rdf rdf{cutoff_ / static_cast<double>(pairs_.size()), pairs_, {}, {}};
  const auto count = [&](auto belongs) {
    size_t number = 0;
    for (size_t i = 0; i < particles_; ++i) number += sets_.a.empty() || belongs(i) ? 1 : 0;
    return static_cast<double>(number);
  };
  const double a = count([&](size_t i) { return sets_.a[i]; }),
               b = count([&](size_t i) { return sets_.b[i]; }),
               both = count([&](size_t i) { return sets_.a[i] && sets_.b[i]; });
  const double frames = static_cast<double>(frames_), density = (a * b - both) / volume;
  double within = 0;
  for (size_t bin = 0; bin < pairs_.size(); ++bin) {
    const double r = static_cast<double>(bin) * rdf.width, end = static_cast<double>(bin + 1) * rdf.width;
    const double shell = 4.0 / 3 * std::numbers::pi * (end * end * end - r * r * r),
                 pairs = static_cast<double>(pairs_[bin]);
    within += pairs;
    const double ideal = frames * density * shell;  // 0 of a shell too thin for any number
    rdf.g.push_back(ideal > 0 ? pairs / ideal : 0);
    rdf.within.push_back(a > 0 ? within / (frames * a) : 0);
  }
  return rdf;
}

namespace {

// The bin of the first peak that is at least half as high as the highest; g.size() where all are 0. A shell
// of a crystal may stand at a bin's end, and rounding part it: a height is that of two bins.
size_t first_peak(const std::vector<double>& g) {
  std::vector<double> height(g);
  for (size_t bin = 0; bin + 1 < g.size(); ++bin) height[bin] += g[bin + 1];
  const double highest = height.empty() ? 0 : *std::ranges::max_element(height);
  if (highest == 0) return g.size();
  size_t bin = 0;
  while (height[bin] < highest / 2 || (bin + 1 < g.size() && height[bin + 1] > height[bin])) ++bin;
  return bin + 1 < g.size() && g[bin + 1] > g[bin] ? bin + 1 : bin;
}

}  // namespace

double first_minimum(const Rdf& rdf) {
  const size_t peak = first_peak(rdf.g);
  if (peak == rdf.g.size()) return 0;
  const double last = 1.6 * rdf.middle(peak);
  size_t end = peak + 1;
  const size_t begin = end;
  while (end < rdf.g.size() && rdf.middle(end) <= last) ++end;
  if (begin == end) return 0;
  const auto least = std::min_element(rdf.g.begin() + static_cast<ptrdiff_t>(begin),
                                      rdf.g.begin() + static_cast<ptrdiff_t>(end));
  const auto from = static_cast<size_t>(least - rdf.g.begin());
  size_t to = from;  // of a crystal at rest no particle stands between two shells
  while (to + 1 < end && rdf.g[to + 1] == *least) ++to;
  return (rdf.middle(from) + rdf.middle(to)) / 2;
}

}  // namespace cuboct
