// SPDX-License-Identifier: MIT
#include "model/bond_order/tersoff_forces.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "model/base/parallel.h"

namespace cuboct {
namespace {

constexpr size_t kGroupsOfPart = 128;
constexpr size_t kAlign = 64;  // bytes, of the widest vectors

// Memory that only grows.
void reserve(std::vector<double>& memory, size_t size) {
  if (memory.size() < size) memory.resize(size);
}

}  // namespace

TersoffForces::TersoffForces(Tersoff tersoff) : tersoff_(std::move(tersoff)) {}

void TersoffForces::place(const BondList& list, const AtomBox& box, std::span<const Vec3> x,
                          const TersoffAsked& asked) {
  const size_t slots = list.slots();
  reserve(x_, 4 * (slots + list.ghosts().size()));
  const bool several = !asked.element.empty();
  for_each_range(
      x.size(), 20000,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          double* const to = x_.data() + 4 * i;
          to[0] = x[i][0], to[1] = x[i][1], to[2] = x[i][2], to[3] = several ? asked.element[i] : 0;
        }
      },
      asked.threads);
  std::fill(x_.begin() + static_cast<ptrdiff_t>(4 * x.size()), x_.begin() + static_cast<ptrdiff_t>(4 * slots),
            0.0);
  double* to = x_.data() + 4 * slots;
  for (const BondList::Ghost& ghost : list.ghosts()) {
    const Vec3 at = x[ghost.owner] + box.edges * Vec3(ghost.image[0], ghost.image[1], ghost.image[2]);
    to[0] = at[0], to[1] = at[1], to[2] = at[2], to[3] = several ? asked.element[ghost.owner] : 0;
    to += 4;
  }
}

void TersoffForces::evaluate(const BondList& list, const AtomBox& box, std::span<const Vec3> x,
                             std::span<Vec3> f, const TersoffAsked& asked) {
  if (list.atoms() != x.size() || f.size() != x.size())
    throw std::invalid_argument(
        fmt::format("{} positions, a list of {} and {} forces", x.size(), list.atoms(), f.size()));
  if (list.lanes() != bond_lanes())
    throw std::invalid_argument("the list is of other lanes than the vectors here");
  if (!asked.element.empty() && asked.element.size() != x.size())
    throw std::invalid_argument(fmt::format("{} positions and {} elements", x.size(), asked.element.size()));
  for (const uint8_t element : asked.element)
    if (element >= tersoff_.elements.size())
      throw std::invalid_argument(fmt::format("no element {}", element));
  lanes_ = list.lanes();
  place(list, box, x, asked);
  const size_t groups = list.groups(), slots = list.slots(), rows = list.rows();
  reserve(partial_, 4 * rows * lanes_), reserve(force_, 4 * slots);
  if (asked.sums) reserve(energies_, slots), reserve(virials_, 6 * slots);
  const TersoffSweep sweep{&list,
                           x_.data(),
                           partial_.data(),
                           force_.data(),
                           asked.sums ? energies_.data() : nullptr,
                           asked.sums ? virials_.data() : nullptr};
  const size_t parts = std::max<size_t>(1, (groups + kGroupsOfPart - 1) / kGroupsOfPart);
  const auto begin = [&](size_t part) { return groups * part / parts; };
  const int threads = std::max(1, asked.threads);
  const size_t each = tersoff_scratch(list.most_rows()) + kAlign / sizeof(double);
  reserve(memory_, each * static_cast<size_t>(threads) + kAlign);
  for_each_part(parts, threads, [&](size_t part, int member) {
    if (tersoff_.elements.size() > 1)
      return tersoff_plain_partials(tersoff_, sweep, begin(part), begin(part + 1));
    auto at = reinterpret_cast<uintptr_t>(memory_.data() + each * static_cast<size_t>(member));
    at = (at + kAlign - 1) / kAlign * kAlign;
    tersoff_partials(tersoff_.terms[0], sweep, begin(part), begin(part + 1), reinterpret_cast<double*>(at));
  });
  for_each_part(parts, threads, [&](size_t part, int) {
    tersoff_collect(sweep, begin(part), begin(part + 1));
    for (size_t i = begin(part) * lanes_; i < std::min(x.size(), begin(part + 1) * lanes_); ++i)
      f[i] = Vec3(force_[4 * i], force_[4 * i + 1], force_[4 * i + 2]);
  });
  if (asked.sums) add_up(x.size());
}

void TersoffForces::add_up(size_t atoms) {
  energy_ = 0;
  virial_.setZero();
  for (size_t i = 0; i < atoms; ++i) energy_ += energies_[i], virial_ += virial_of(i);
}

Mat3 TersoffForces::virial_of(size_t atom) const {
  const auto of = [&](size_t k) { return virials_[(atom / lanes_ * 6 + k) * lanes_ + atom % lanes_]; };
  Mat3 virial;
  virial << of(0), of(5), of(4), of(5), of(1), of(3), of(4), of(3), of(2);
  return virial;
}

}  // namespace cuboct
