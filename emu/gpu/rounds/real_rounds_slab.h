// SPDX-License-Identifier: MIT
// What one device holds of a rule of text in floats or doubles: two copies of its particles and of others'
// ghosts behind them, their bonds, and the lists of its own.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "emu/gpu/device/device.h"
#include "emu/gpu/device/loaded_kernels.h"
#include "emu/gpu/rounds/real_rounds_kernel.h"
#include "emu/gpu/rounds/real_rounds_list.h"
#include "emu/gpu/rounds/rounds_list.h"
#include "emu/gpu/rounds/rounds_sending.h"

namespace cuboct::gpu {

// In which of two copies the state is: positions; types and ids; each number of a field and of a bond.
struct RealPlaces {
  size_t at = 0, who = 0;
  std::vector<size_t> fields, bonds;
};

template <class Real, class Number>
struct RealSlab {
  using Frame = RealFrame<Real, Number>;
  using Place = RealPlace<Number>;
  struct Copy {
    std::array<Array<int64_t>, 3> x;
    std::array<Array<Real>, 3> u;
    std::vector<Array<Real>> fields;
    Array<RealFour<Real>> v;
    Array<Place> place;
    Array<uint8_t> type;
    Array<uint32_t> id;
  };
  // With so many numbers of fields.
  RealSlab(int device, size_t numbers, bool displaced, bool bonded)
      : stream(device), displaced_(displaced), bonded_(bonded) {
    for (Copy& copy : copies) {
      for (size_t a = 0; a < 3; ++a) copy.x[a] = Array<int64_t>(device), copy.u[a] = Array<Real>(device);
      for (size_t f = 0; f < numbers; ++f) copy.fields.emplace_back(device);
      copy.v = Array<RealFour<Real>>(device), copy.place = Array<Place>(device);
      copy.type = Array<uint8_t>(device), copy.id = Array<uint32_t>(device);
    }
    for (Array<int64_t>& axis : listed_x) axis = Array<int64_t>(device);
    for (Array<Real>& axis : force) axis = Array<Real>(device);
    for (auto* a : {&listed_at, &near_at}) *a = Array<Place>(device);
    for (auto* a : {&bin, &order, &counts, &near_counts, &entries, &near_entries, &bin_count, &bin_first,
                    &bin_taken, &most, &bond_kind, &sent, &sent_count})
      *a = Array<uint32_t>(device);
    sum = Array<uint64_t>(device);
    types = Array<RealKind<Real>>(device), tables = Array<RealFour<Real>>(device);
    control = Array<RealControl>(device), others = Array<RealControl*>(device);
    control.resize(1), most.resize(1), sum.resize(1), sent_count.resize(kMostSlabs);
  }

  // For so many particles, of which the first `kept` stay.
  void make_room(size_t particles, size_t kept) {
    const auto grow = [&](auto& array) { array.grow(stream, particles, kept); };
    for (Copy& copy : copies) {
      for (size_t a = 0; a < 3; ++a) {
        grow(copy.x[a]);
        if (displaced_) grow(copy.u[a]);
      }
      for (Array<Real>& field : copy.fields) grow(field);
      grow(copy.v), grow(copy.place), grow(copy.type), grow(copy.id);
    }
    if (bonded_) return;
    for (auto* a : {&bin, &order, &counts, &near_counts}) grow(*a);
    for (Array<int64_t>& axis : listed_x) grow(axis);
    grow(listed_at), grow(near_at);
  }
  size_t room() const { return copies[0].id.size(); }

  std::vector<uint32_t> ids(const RealPlaces& places) { return copies[places.who].id.host(stream, 0, own); }

  // From the state at hand into copy `to`; `frame` has what is no array of a slab's.
  Frame frame_of(Frame frame, const RealPlaces& places, size_t to) {
    const Copy& here = copies[places.at];
    const Copy& there = copies[to];
    for (size_t a = 0; a < 3; ++a) {
      frame.x[a] = here.x[a].data(), frame.u[a] = here.u[a].data();
      frame.to_x[a] = there.x[a].data(), frame.to_u[a] = there.u[a].data();
    }
    frame.place = here.place.data(), frame.v = here.v.data();
    frame.to_place = there.place.data(), frame.to_v = there.v.data();
    frame.type = copies[places.who].type.data(), frame.id = copies[places.who].id.data();
    for (size_t f = 0; f < places.fields.size(); ++f)
      frame.fields[f] = copies[places.fields[f]].fields[f].data();
    for (size_t n = 0; n < places.bonds.size(); ++n) frame.bonds[n] = bond_copies[places.bonds[n]][n].data();
    frame.entries = entries.data(), frame.counts = counts.data(), frame.stride = own;
    frame.listed = listed_at.data(), frame.near_listed = near_at.data();
    frame.near_entries = near_entries.data(), frame.near_counts = near_counts.data();
    frame.bond_kind = bond_kind.data(), frame.types = types.data(), frame.tables = tables.data();
    frame.control = control.data(), frame.others = others.data();
    return frame;
  }

  // Counts particles in bins, and brings their numbers into the order of bins and of ids.
  void put_in_bins(const RealPlaces& places, uint32_t particles, const RealBins& bins, const RealCut& cut,
                   int self, int block) {
    bin_count.zero(stream), bin_taken.zero(stream);
    const Copy& now = copies[places.at];
    for_each(stream, 0, particles, block,
             RealSettle{bins,
                        cut,
                        self,
                        {now.x[0].data(), now.x[1].data(), now.x[2].data()},
                        bin.data(),
                        bin_count.data()});
    const auto all_bins = static_cast<uint32_t>(bins.count[0] * bins.count[1] * bins.count[2]);
    exclusive_sums(stream, bin_count.data(), bin_first.data(), all_bins);
    for_each(stream, 0, particles, block,
             RoundsOrder{bin.data(), bin_first.data(), bin_taken.data(), order.data()});
    for_each(stream, 0, all_bins, block,
             RealSort{bin_first.data(), bin_count.data(), copies[places.who].id.data(), order.data()});
  }

  // The own particles into the other copies.
  void gather(const Frame& base, const RealPlaces& places, int block) {
    Frame frame = frame_of(base, places, 1 - places.at);
    for (size_t f = 0; f < places.fields.size(); ++f)
      frame.to_fields[f] = copies[1 - places.fields[f]].fields[f].data();
    Copy& there = copies[1 - places.who];
    for_each(stream, 0, own, block,
             RealGather<Real, Number>{order.data(),
                                      frame,
                                      there.type.data(),
                                      there.id.data(),
                                      listed_at.data(),
                                      near_at.data(),
                                      {listed_x[0].data(), listed_x[1].data(), listed_x[2].data()},
                                      static_cast<int>(places.fields.size())});
  }

  Stream stream;
  Event done;  // what the others may have to wait for
  std::unique_ptr<LoadedKernels> kernels;
  uint32_t own = 0, all = 0;  // with ghosts
  std::array<Copy, 2> copies;
  std::array<Array<int64_t>, 3> listed_x;
  Array<Place> listed_at, near_at;
  Array<uint32_t> bin, order, counts, near_counts, entries, near_entries, bin_count, bin_first, bin_taken,
      most, bond_kind, sent, sent_count;
  Array<uint64_t> sum;
  std::array<std::vector<Array<Real>>, 2> bond_copies;  // by number
  std::vector<Array<Real>> kinds;                       // by round
  std::array<Array<Real>, 3> force;
  Array<RealKind<Real>> types;
  Array<RealFour<Real>> tables;
  Array<RealControl> control;
  Array<RealControl*> others;
  std::vector<RoundsSending> sendings;
  std::vector<RealSlab*> beside;  // those that it sends to, or gets something from
  uint32_t width = 0;

 private:
  bool displaced_, bonded_;
};

}  // namespace cuboct::gpu
