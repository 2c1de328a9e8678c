// SPDX-License-Identifier: MIT
// What one device holds of a scene whose rule is text: its own particles, then ghosts, its lists and bonds.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "emu/gpu/device/loaded_kernels.h"
#include "emu/gpu/rounds/rounds_interpreter.h"
#include "emu/gpu/rounds/rounds_list.h"
#include "emu/gpu/rounds/rounds_sending.h"
#include "model/contract/state.h"

namespace cuboct::gpu {

// Which of two copies holds what, the same on all devices.
struct RoundsPlaces {
  size_t at = 0;                      // positions and velocities
  size_t who = 0;                     // types and ids
  std::vector<size_t> fields, bonds;  // by number: a round that writes one makes its other copy
};

class RoundsSlab {
 public:
  struct Copy {
    std::array<Array<int64_t>, 3> x, v, u;
    std::vector<Array<int64_t>> fields;
    Array<RoundsPlace> place;  // not of a bonded program
    Array<uint8_t> type;
    Array<uint32_t> id;
  };
  // `displaced`: particles have displacements. `account` holds the bytes of all slabs.
  RoundsSlab(int device, const graph::FixedProgram& program, bool displaced, uint64_t* account)
      : stream(device),
        code(stream, program),
        numbers_(static_cast<size_t>(program.numbers())),
        displaced_(displaced),
        bonded_(program.bonded) {
    for (Copy& copy : copies) {
      copy.fields.resize(numbers_);
      for (auto* columns : {&copy.x, &copy.v, &copy.u})
        for (Array<int64_t>& a : *columns) a = Array<int64_t>(device, account);
      for (Array<int64_t>& a : copy.fields) a = Array<int64_t>(device, account);
      copy.place = Array<RoundsPlace>(device, account);
      copy.type = Array<uint8_t>(device, account);
      copy.id = Array<uint32_t>(device, account);
    }
    for (auto* a : {&listed_at, &near_at}) *a = Array<RoundsPlace>(device, account);
    for (Array<int32_t>& a : home) a = Array<int32_t>(device, account);
    for (auto* a : {&bin, &order, &entered, &counts, &entries, &near_counts, &near_entries, &bin_count,
                    &bin_first, &bin_taken, &occupancy, &most, &sent, &sent_count, &bond_kind})
      *a = Array<uint32_t>(device, account);
    exists = Array<uint8_t>(device, account);
    planes = Array<uint32_t*>(device, account);
    others = Array<RoundsControl*>(device, account);
    bond_constants = Array<int64_t>(device, account);
    for (auto& copy : bond_copies) {
      copy.resize(static_cast<size_t>(program.bond_numbers()));
      for (Array<int64_t>& a : copy) a = Array<int64_t>(device, account);
    }
    control = Array<RoundsControl>(device, account);
    hashes = Array<uint64_t>(device, account);
    table_entries = Array<TableEntry>(device, account);
    control.resize(1);
    most.resize(1);
    hashes.resize(kLongestBatch + 1);
    sent_count.resize(kMostSlabs);
  }

  // For so many particles, of which the first `kept` stay.
  void make_room(size_t particles, size_t kept) {
    const auto grow = [&](auto& array) { array.grow(stream, particles, kept); };
    for (Copy& copy : copies) {
      for (size_t a = 0; a < 3; ++a) {
        grow(copy.x[a]), grow(copy.v[a]);
        if (displaced_) grow(copy.u[a]);
      }
      for (Array<int64_t>& field : copy.fields) grow(field);
      grow(copy.type), grow(copy.id);
      if (!bonded_) grow(copy.place);
    }
    for (Array<int32_t>& a : home) grow(a);
    for (auto* a : {&bin, &order, &entered, &counts}) grow(*a);
    if (bonded_) return;
    grow(near_counts), grow(listed_at), grow(near_at);
  }
  size_t room() const { return bin.size(); }

  // Types and ids stand in copy `who`, and each number of the fields where it was written last.
  RoundsView view(const RoundsPlaces& places) { return view(places, places.at); }
  RoundsView view(const RoundsPlaces& places, size_t at) {
    RoundsView view = moving(at);
    for (size_t f = 0; f < numbers_; ++f) view.fields[f] = copies[places.fields[f]].fields[f].data();
    view.type = copies[places.who].type.data(), view.id = copies[places.who].id.data();
    return view;
  }
  // The other copy of everything.
  RoundsView spare(const RoundsPlaces& places) {
    RoundsView view = moving(1 - places.at);
    for (size_t f = 0; f < numbers_; ++f) view.fields[f] = copies[1 - places.fields[f]].fields[f].data();
    return view;
  }

  // Particles of a state, in this order, at copy 0.
  void put(const State& state, const std::vector<uint32_t>& which, const Lattice& lattice, int frac) {
    own = all = static_cast<uint32_t>(which.size());
    sendings.clear();
    if (own > room()) make_room(own, 0);
    std::vector<int64_t> column(own);
    const auto put = [&](Array<int64_t>& array, const auto& value) {
      for (size_t k = 0; k < own; ++k) column[k] = value(which[k]);
      array.put(stream, 0, column);
    };
    Copy& copy = copies[0];
    for (size_t a = 0; a < 3; ++a) {
      put(copy.x[a], [&](size_t k) {
        const Particle& p = state.particles[k];
        return p.x[a] + (int64_t{lattice.cell(p.cell)[a]} << frac);
      });
      put(copy.v[a], [&](size_t k) { return state.particles[k].v[a]; });
      if (displaced_) put(copy.u[a], [&](size_t k) { return state.particles[k].u[a]; });
    }
    for (size_t f = 0; f < numbers_; ++f)
      put(copy.fields[f], [&](size_t k) { return state.fields[k * numbers_ + f]; });
    std::vector<uint8_t> types;
    std::vector<uint32_t> ids;
    for (const uint32_t k : which)
      types.push_back(state.particles[k].type), ids.push_back(state.particles[k].id);
    copy.type.put(stream, 0, types);
    copy.id.put(stream, 0, ids);
  }

  // Appends the own particles, in the order of the device.
  void add_to(State& state, const RoundsPlaces& places, const Lattice& lattice, int frac) {
    const size_t first = state.particles.size();
    state.particles.resize(first + own);
    const Copy& copy = copies[places.at];
    const std::vector<uint8_t> types = copies[places.who].type.host(stream, 0, own);
    const std::vector<uint32_t> ids = copies[places.who].id.host(stream, 0, own);
    std::vector<Cell> cell(own);
    const Cell& period = lattice.period();
    for (size_t a = 0; a < 3; ++a) {
      const std::vector<int64_t> x = copy.x[a].host(stream, 0, own), v = copy.v[a].host(stream, 0, own);
      std::vector<int64_t> u(own);
      if (displaced_) u = copy.u[a].host(stream, 0, own);
      for (size_t k = 0; k < own; ++k) {
        Particle& p = state.particles[first + k];
        p.x[a] = x[k] & ((int64_t{1} << frac) - 1);
        p.v[a] = v[k], p.u[a] = u[k];
        cell[k][a] = static_cast<int32_t>(x[k] >> frac);
        if (period[a] > 0) cell[k][a] = ((cell[k][a] % period[a]) + period[a]) % period[a];
      }
    }
    for (size_t k = 0; k < own; ++k) {
      Particle& p = state.particles[first + k];
      p.type = types[k], p.id = ids[k];
      p.cell = lattice.find(cell[k]);
    }
    state.fields.resize((first + own) * numbers_);
    for (size_t f = 0; f < numbers_; ++f) {
      const std::vector<int64_t> values = copies[places.fields[f]].fields[f].host(stream, 0, own);
      for (size_t k = 0; k < own; ++k) state.fields[(first + k) * numbers_ + f] = values[k];
    }
  }

  // Into the order of bins, in the other copies. `before`: particles that stand here, those that leave too.
  void sort(const RoundsPlaces& places, uint32_t before, uint32_t bins, int guard, int frac, int coarse_shift,
            int block) {
    put_in_bins(before, bins, block);
    RoundsGather gather{order.data(),
                        view(places),
                        spare(places),
                        copies[1 - places.who].type.data(),
                        copies[1 - places.who].id.data(),
                        entered.data(),
                        listed_at.data(),
                        near_at.data(),  // near lists begin anew
                        {},
                        guard,
                        frac,
                        coarse_shift,
                        static_cast<int>(numbers_)};
    for (size_t a = 0; a < 3; ++a) gather.home[a] = home[a].data();
    for_each(stream, 0, own, block, gather);
  }
  void put_in_bins(uint32_t particles, uint32_t bins, int block) {
    bin_taken.zero(stream);
    exclusive_sums(stream, bin_count.data(), bin_first.data(), bins);
    for_each(stream, 0, particles, block,
             RoundsOrder{bin.data(), bin_first.data(), bin_taken.data(), order.data()});
  }

  // A list of `width` rows. list_fits() says whether it holds all partners; if not, the next one is wider.
  void start_list(RoundsMakeList make, int block) {
    if (entries.size() < size_t{width} * own) entries.resize(size_t{width} * own);
    make.entries = entries.data(), make.counts = counts.data(), make.width = width, make.stride = own;
    most.zero(stream);
    max_each(stream, 0, own, block, make, most.data());
  }
  bool list_fits() {
    longest = most.host(stream, 0, 1)[0];
    if (longest <= width) return true;
    width = (longest + 7) / 8 * 8;
    return false;
  }

  void launch(const RoundsFrame& frame, size_t round, int block) {
    if (compiled && kernels)
      kernels->launch(stream, round, own, block, frame);
    else if (bonded_)
      interpret<true>(frame, code.rounds()[round], block);
    else
      interpret<false>(frame, code.rounds()[round], block);
  }

  Stream stream;
  Event done;  // what the others may have to wait for
  ProgramOnDevice code;
  std::unique_ptr<LoadedKernels> kernels;  // null: interpreted
  bool compiled = false;                   // whether the next steps are
  uint32_t own = 0, all = 0;               // with ghosts
  std::array<Copy, 2> copies;
  RoundsCells cells{};
  RoundsList list{};
  RoundsNear near{};
  Array<RoundsPlace> listed_at, near_at;
  std::array<Array<int32_t>, 3> home;
  Array<uint32_t> bin, order, entered, counts, entries, near_counts, near_entries, bin_count, bin_first,
      bin_taken, occupancy, most, sent, sent_count, bond_kind;
  Array<uint8_t> exists;
  Array<uint32_t*> planes;  // RoundsCells::occupancy
  Array<RoundsControl*> others;
  std::array<std::vector<Array<int64_t>>, 2> bond_copies;  // by number
  Array<int64_t> bond_constants;
  Array<RoundsControl> control;
  Array<uint64_t> hashes;
  Array<TableEntry> table_entries;
  std::vector<RoundsSending> sendings;
  std::vector<RoundsSlab*> beside;  // those that it sends to, or gets something from
  uint32_t width = 0, longest = 0;

 private:
  static constexpr size_t kMostBytesOfBlock = 40 * 1024;  // of registers that are interpreted

  RoundsView moving(size_t at) {
    RoundsView view{};
    for (size_t a = 0; a < 3; ++a) {
      view.x[a] = copies[at].x[a].data(), view.v[a] = copies[at].v[a].data();
      view.u[a] = copies[at].u[a].data();
    }
    view.place = copies[at].place.data();
    return view;
  }
  template <bool Bonded>
  void interpret(const RoundsFrame& frame, const RoundCode& of, int block) {
    // Smaller blocks leave less of a processor's memory unused.
    auto threads = static_cast<uint32_t>(block);
    while (threads > 32 && of.bytes(threads) > kMostBytesOfBlock) threads -= 32;
    const InterpretedBlock<Bonded> interpreted{{frame, {of}}, own, threads};
    for_each_block(stream, (own + threads - 1) / threads, static_cast<int>(threads), of.bytes(threads),
                   interpreted);
  }

  size_t numbers_;
  bool displaced_, bonded_;
};

}  // namespace cuboct::gpu
