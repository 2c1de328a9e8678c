// SPDX-License-Identifier: MIT
#include "model/atoms/bond_order/tersoff_forces.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

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

TersoffSweep TersoffForces::sweep() {
  return {list_,
          x_.data(),
          partial_.data(),
          force_.data(),
          sums_ ? energies_.data() : nullptr,
          sums_ ? virials_.data() : nullptr};
}

void TersoffForces::begin(const BondList& list, const AtomBox& box, std::span<const Vec3> x,
                          const TersoffAsked& asked) {
  if (list.atoms() != x.size())
    throw std::invalid_argument(fmt::format("{} positions and a list of {}", x.size(), list.atoms()));
  if (list.lanes() != bond_lanes())
    throw std::invalid_argument("the list is of other lanes than the vectors here");
  if (!asked.element.empty() && asked.element.size() != x.size())
    throw std::invalid_argument(fmt::format("{} positions and {} elements", x.size(), asked.element.size()));
  for (const uint8_t element : asked.element)
    if (element >= tersoff_.elements.size())
      throw std::invalid_argument(fmt::format("no element {}", element));
  list_ = &list;
  sums_ = asked.sums;
  lanes_ = list.lanes();
  place(list, box, x, asked);
  reserve(partial_, 4 * list.rows() * lanes_), reserve(force_, 4 * list.slots());
  if (sums_) reserve(energies_, list.slots()), reserve(virials_, 6 * list.slots());
}

void TersoffForces::first_sweep(size_t first, size_t last) {
  if (tersoff_.elements.size() > 1) return tersoff_scalar_partials(tersoff_, sweep(), first, last);
  thread_local std::vector<double> memory;  // of all objects that a thread serves
  reserve(memory, tersoff_scratch(list_->most_rows()) + kAlign / sizeof(double));
  auto at = reinterpret_cast<uintptr_t>(memory.data());
  at = (at + kAlign - 1) / kAlign * kAlign;
  tersoff_partials(tersoff_.terms[0], sweep(), first, last, reinterpret_cast<double*>(at));
}

void TersoffForces::second_sweep(size_t first, size_t last, std::span<Vec3> f) {
  tersoff_collect(sweep(), first, last);
  for (size_t i = first * lanes_; i < std::min(f.size(), last * lanes_); ++i)
    f[i] = Vec3(force_[4 * i], force_[4 * i + 1], force_[4 * i + 2]);
}

void TersoffForces::evaluate(const BondList& list, const AtomBox& box, std::span<const Vec3> x,
                             std::span<Vec3> f, const TersoffAsked& asked) {
  if (f.size() != x.size())
    throw std::invalid_argument(fmt::format("{} positions and {} forces", x.size(), f.size()));
  begin(list, box, x, asked);
  const size_t groups = list.groups(),
               parts = std::max<size_t>(1, (groups + kGroupsOfPart - 1) / kGroupsOfPart);
  const auto from = [&](size_t part) { return groups * part / parts; };
  for_each_part(parts, asked.threads, [&](size_t part, int) { first_sweep(from(part), from(part + 1)); });
  for_each_part(parts, asked.threads, [&](size_t part, int) { second_sweep(from(part), from(part + 1), f); });
  if (sums_) add_up();
}

void TersoffForces::sum_up(int threads) {
  if (!std::exchange(sums_, true)) reserve(energies_, list_->slots()), reserve(virials_, 6 * list_->slots());
  const size_t groups = list_->groups(),
               parts = std::max<size_t>(1, (groups + kGroupsOfPart - 1) / kGroupsOfPart);
  for_each_part(parts, threads,
                [&](size_t part, int) { first_sweep(groups * part / parts, groups * (part + 1) / parts); });
  add_up();
}

uint64_t TersoffForces::bonds() const {
  const auto at = [&](size_t place) { return Vec3(x_[place], x_[place + 1], x_[place + 2]); };
  const auto element = [&](size_t place) { return static_cast<size_t>(x_[place + 3]); };
  uint64_t ends = 0;
  for (size_t i = 0; i < list_->atoms(); ++i)
    for (size_t row = list_->first_row()[i / lanes_]; row < list_->first_row()[i / lanes_ + 1]; ++row) {
      const size_t other = list_->entry()[row * lanes_ + i % lanes_];
      if (other == 4 * i) continue;
      const TersoffTerm<double>& bond = tersoff_.term(element(4 * i), element(other), element(other));
      ends += (at(4 * i) - at(other)).norm() < bond.R + bond.D;
    }
  return ends / 2;
}

void TersoffForces::add_up() {
  energy_ = 0;
  virial_.setZero();
  for (size_t i = 0; i < list_->atoms(); ++i) energy_ += energies_[i], virial_ += virial_of(i);
}

Mat3 TersoffForces::virial_of(size_t atom) const {
  const auto of = [&](size_t k) { return virials_[(atom / lanes_ * 6 + k) * lanes_ + atom % lanes_]; };
  Mat3 virial;
  virial << of(0), of(5), of(4), of(5), of(1), of(3), of(4), of(3), of(2);
  return virial;
}

}  // namespace cuboct
