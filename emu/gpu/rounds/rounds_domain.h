// SPDX-License-Identifier: MIT
// A scene whose rule is text on one or more devices: slabs of planes of cells, their ghosts and their lists.
//
// A slab owns the particles in its cells when lists are made, and has ghosts of all that its lists may reach
// of others', however thin slabs are. Each pair is computed from both sides, so that ghosts are read only.
// Where bonds are those of the body as packed, particles stay with their slab, wherever they go, and ghosts
// are the partners of its bonds: both ends keep the bond's numbers, and make the same of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <vector>

#include "emu/gpu/cells.h"
#include "emu/gpu/messages.h"
#include "emu/gpu/rounds/rounds_slab.h"
#include "emu/gpu/skin.h"
#include "hw/arch/cell_box.h"
#include "hw/plan/plan.h"
#include "model/base/error.h"
#include "model/program/integer_program.h"

namespace cuboct::gpu {

class RoundsDomain {
 public:
  RoundsDomain(const Plan& plan, const State& initial, const Options& options)
      : plan_(plan),
        program_(plan.program->program),
        rows_(plan.program->rows.get()),
        block_(options.block),
        count_(static_cast<uint32_t>(initial.particles.size())),
        numbers_(program_.numbers()),
        guard_(program_.guard),
        frac_(program_.position_frac + program_.guard),
        reach_(reach_of(plan)),
        skin_(reach_, largest_skin(plan, reach_), count_) {
    if (count_ >= 1u << kPartnerBits)
      throw InputError("more particles than the gpu engine lists for a rule of text: 2^27");
    require_devices(options);
    make_slabs(initial, options.devices);
    upload(initial);
  }

  void upload(const State& state) {
    places = {0, 0, std::vector<size_t>(index(numbers_)), std::vector<size_t>(index(bond_count()))};
    std::vector<std::vector<uint32_t>> own(slabs.size());
    for (uint32_t k = 0; k < count_; ++k) {
      const Cell& cell = plan_.lattice.cell(state.particles[k].cell);
      own[index(cuts_.owner(cell[index(cuts_.axis)]))].push_back(k);
    }
    for (size_t s = 0; s < slabs.size(); ++s) {
      make_room(*slabs[s], own[s].size(), 0);
      slabs[s]->put(state, own[s], plan_.lattice, frac_);
    }
    if (rows_ != nullptr) put_bonds(state, own);
  }

  // Sorted by id.
  State state(uint64_t step) const {
    State state{step, {}};
    std::vector<size_t> first;  // of each slab's particles
    for (const auto& slab : slabs) {
      first.push_back(state.particles.size());
      slab->add_to(state, places, plan_.lattice, frac_);
    }
    std::vector<size_t> order(count_);
    std::iota(order.begin(), order.end(), size_t{0});
    std::sort(order.begin(), order.end(),
              [&](size_t a, size_t b) { return state.particles[a].id < state.particles[b].id; });
    State sorted{state.step, {}};
    for (const size_t k : order) {
      sorted.particles.push_back(state.particles[k]);
      for (size_t f = 0; f < index(numbers_); ++f)
        sorted.fields.push_back(state.fields[k * index(numbers_) + f]);
    }
    if (bond_count() > 0) add_bonds(order, first, sorted);
    return sorted;
  }

  // By id.
  std::vector<Int3> velocities() const {
    std::vector<Int3> by_id(count_);
    for (const auto& slab : slabs) {
      const std::vector<uint32_t> ids = slab->copies[places.who].id.host(slab->stream, 0, slab->own);
      for (size_t a = 0; a < 3; ++a) {
        const std::vector<int64_t> v = slab->copies[places.at].v[a].host(slab->stream, 0, slab->own);
        for (size_t k = 0; k < v.size(); ++k) by_id[ids[k]][a] = v[k];
      }
    }
    return by_id;
  }

  // Lists serve from now on. `age`: steps that those before have served.
  void make_lists(uint64_t age) {
    if (rows_ == nullptr) skin_.aged(age);
    make_bins();
    const bool moves = rows_ == nullptr && !alone();
    if (moves) migrate();
    for (auto& slab : slabs) slab->bin_count.zero(slab->stream), slab->occupancy.zero(slab->stream);
    if (!alone()) wait_for_all(slabs);  // a slab may count in another one's cells
    for (size_t s = 0; s < slabs.size(); ++s) {
      RoundsSlab& slab = *slabs[s];
      for_each(slab.stream, 0, moves ? slab.all : slab.own, block_,
               RoundsSettle{slab.view(places), bins_, slab.cells, cuts_, moves ? static_cast<int>(s) : -1,
                            guard_, frac_, slab.bin.data(), slab.bin_count.data()});
    }
    if (rows_ != nullptr) return serve_bonds();
    for (auto& slab : slabs) {
      const uint32_t before = slab->all;
      slab->own = before - (moves ? sent_in_all(slab->sendings) : 0);
      slab->sort(places, before, bin_total_, guard_, frac_, coarse_shift_, block_);
      slab->all = slab->own;
    }
    places.at = 1 - places.at, places.who = 1 - places.who;
    for (size_t& at : places.fields) at = 1 - at;
    if (moves) {
      mirror();
      for (auto& slab : slabs) put_all_in_bins(*slab);
    }
    list_pairs();
  }

  RoundsBonds bonds(const RoundsSlab& slab) const {
    RoundsBonds bonds{};
    bonds.on = rows_ != nullptr;
    for (size_t n = 0; n < places.bonds.size(); ++n)
      bonds.from[n] = slab.bond_copies[places.bonds[n]][n].data();
    bonds.kind = slab.bond_kind.data(), bonds.constants = slab.bond_constants.data();
    bonds.numbers = bond_count();
    bonds.constant_count = static_cast<int>(program_.bond_constants.size());
    bonds.position_frac = program_.position_frac;
    for (int a = 0; a < 3; ++a) bonds.period[a] = int64_t{slab.cells.period[a]} << program_.position_frac;
    return bonds;
  }

  uint64_t bytes = 0, longest_list = 0;  // of all devices' memory; partners of one particle
  std::vector<std::unique_ptr<RoundsSlab>> slabs;
  RoundsPlaces places;
  double listed_pairs = 0;  // entries per particle

 private:
  // Of a near list, as a share of what the rule reaches; and at most half the list's.
  static constexpr double kNearSkin = 0.06;
  static constexpr uint64_t kMostBins = 1u << 26;
  static constexpr double kSpare = 1.1;  // room of several slabs, beyond what they hold at a time

  static size_t index(int n) { return static_cast<size_t>(n); }

  bool alone() const { return slabs.size() == 1; }
  int bond_count() const { return program_.bond_numbers(); }

  void make_slabs(const State& initial, const std::vector<int>& devices) {
    const CellBox box = box_of(plan_.lattice, true);
    RoundsCells cells{};
    uint64_t all = 1;
    for (size_t a = 0; a < 3; ++a) {
      cells.low[a] = box.low[a];
      cells.extent[a] = static_cast<int>(box.extent(a));
      cells.period[a] = plan_.lattice.period()[a];
      all *= static_cast<uint64_t>(box.extent(a));
      if (cells.extent[a] > cells.extent[cells.axis]) cells.axis = static_cast<int>(a);
    }
    if (all > kNoStep / 2) throw InputError("the lattice's box has too many cells for the gpu engine");
    cells.capacity = static_cast<uint32_t>(plan_.arch.capacity);
    cut(initial, cells, static_cast<int>(devices.size()));
    std::vector<uint8_t> exists(all);
    for (uint32_t n = 0; n < plan_.lattice.size(); ++n) {
      const Cell& c = plan_.lattice.cell(n);
      uint64_t at = 0;
      for (size_t a = 3; a-- > 0;)
        at = at * static_cast<uint64_t>(cells.extent[a]) + static_cast<uint64_t>(c[a] - cells.low[a]);
      exists[at] = 1;
    }
    share(devices);
    const bool displaced = !program_.motion.u.empty() || plan_.rule.pd;
    for (const int device : devices) {
      slabs.push_back(std::make_unique<RoundsSlab>(device, program_, displaced, &bytes));
      slabs.back()->exists.set(slabs.back()->stream, exists);
      slabs.back()->occupancy.resize(all);
    }
    std::vector<uint32_t*> planes;
    for (int plane = 0; plane < cells.extent[cells.axis]; ++plane)
      planes.push_back(slabs[index(cuts_.owner(plane + cells.low[cells.axis]))]->occupancy.data());
    for (auto& slab : slabs) {
      slab->planes.set(slab->stream, planes);
      slab->cells = cells;
      slab->cells.exists = slab->exists.data(), slab->cells.occupancy = slab->planes.data();
      std::vector<RoundsControl*> others;
      for (auto& other : slabs)
        if (other != slab) others.push_back(other->control.data());
      slab->others.set(slab->stream, others);
    }
  }

  // Into slabs with about equal numbers of particles.
  void cut(const State& initial, const RoundsCells& cells, int parts) {
    const size_t axis = index(cells.axis);
    const int planes = cells.extent[axis];
    if (planes < parts) throw_few_planes(parts, planes);
    std::vector<uint64_t> per_plane(index(planes));
    for (const Particle& p : initial.particles)
      ++per_plane[index(plan_.lattice.cell(p.cell)[axis] - cells.low[axis])];
    cuts_ = {cells.axis, parts, frac_, cells.low[axis], cells.period[axis], {}};
    const std::vector<int> ends = slab_ends(per_plane, parts, 1);
    for (int s = 0; s < parts; ++s) cuts_.end[s] = ends[index(s)] + cells.low[axis];
  }

  // A difference is rounded along three axes by half a unit, or, where cells are no cubes, by one and the
  // rounding of their shape. Lists take cells as cubes: the reach of an axis whose edge is shorter counts
  // more of these.
  static double reach_of(const Plan& plan) {
    const int frac = plan.rule.widths.difference_frac;
    return (std::sqrt(std::ldexp(static_cast<double>(plan.rule.cutoff2), -2 * frac)) +
            3 * std::ldexp(1.0, -frac)) *
           plan.rule.cell_edge / plan.rule.edges().shortest();
  }
  static constexpr int kLeastBins = 3;  // of a ring: fewer would meet a particle from both sides
  static double largest_skin(const Plan& plan, double reach) {
    double skin = reach;
    for (const int period : plan.lattice.period())
      if (period > 0) skin = std::min(skin, double(period) / kLeastBins - reach);
    return std::max(skin, 0.0);
  }

  // As wide as the list to be made reaches.
  void make_bins() {
    const RoundsCells& cells = slabs.front()->cells;
    double size = reach_ + skin_.now();
    uint64_t bins = 0;
    for (;; size *= 1.26) {
      bins = 1;
      for (size_t a = 0; a < 3; ++a) {
        bins_.low[a] = int64_t{cells.low[a]} << program_.position_frac;
        bins_.length[a] = int64_t{cells.extent[a]} << program_.position_frac;
        bins_.wraps[a] = cells.period[a] > 0;
        const int least = bins_.wraps[a] ? kLeastBins : 1;
        bins_.count[a] = std::max(least, static_cast<int>(cells.extent[a] / size));
        bins *= static_cast<uint64_t>(bins_.count[a]);
      }
      if (bins <= kMostBins) break;
    }
    coarse_shift_ = 0;
    for (size_t a = 0; a < 3; ++a)
      while (2 * (bins_.length[a] / bins_.count[a] + 1) >> coarse_shift_ >= int64_t{1} << 31) ++coarse_shift_;
    bin_total_ = static_cast<uint32_t>(bins);
    for (auto& slab : slabs)
      for (Array<uint32_t>* of : {&slab->bin_count, &slab->bin_first, &slab->bin_taken})
        if (of->size() < bins) of->resize(bins);
  }

  void make_room(RoundsSlab& slab, size_t particles, size_t kept) const {
    if (particles >= size_t{1} << kPartnerBits) throw_too_many(particles, size_t{1} << kPartnerBits);
    if (particles <= slab.room()) return;
    slab.make_room(alone() ? particles : static_cast<size_t>(static_cast<double>(particles) * kSpare), kept);
  }

  // `own`: of each slab the particles as they stand, and will stand.
  void put_bonds(const State& state, const std::vector<std::vector<uint32_t>>& own) {
    std::vector<uint32_t> owner(count_), place(count_);  // by id
    for (uint32_t s = 0; s < own.size(); ++s)
      for (uint32_t k = 0; k < own[s].size(); ++k) {
        const uint32_t id = state.particles[own[s][k]].id;
        owner[id] = s, place[id] = k;
      }
    std::vector<std::vector<uint32_t>> ids(own.size());
    for (size_t s = 0; s < own.size(); ++s)
      for (const uint32_t k : own[s]) ids[s].push_back(state.particles[k].id);
    const auto ghosts = bonded_ghosts(ids, owner, [&](uint32_t id, const auto& use) {
      for (uint64_t b = rows_->first[id]; b < rows_->first[id + 1]; ++b) use(rows_->other[b]);
    });
    for (size_t s = 0; s < own.size(); ++s)
      put_rows(*slabs[s], ids[s], list_ghosts(*slabs[s], s, own[s].size(), place, ghosts), state.bonds);
    carry();
  }

  void put_rows(RoundsSlab& slab, const std::vector<uint32_t>& ids, const std::vector<uint32_t>& place,
                const std::vector<int64_t>& bonds) const {
    slab.width = static_cast<uint32_t>(rows_->longest());
    const size_t own = ids.size(), slots = slab.width * own;
    std::vector<uint32_t> entries(slots), kinds(slots), counts(own);
    std::vector<std::vector<int64_t>> numbers(index(bond_count()), std::vector<int64_t>(slots));
    for (size_t k = 0; k < own; ++k) {
      const uint64_t first = rows_->first[ids[k]], end = rows_->first[ids[k] + 1];
      counts[k] = static_cast<uint32_t>(end - first);
      for (uint64_t b = first; b < end; ++b) {
        const size_t slot = (b - first) * own + k;
        entries[slot] = place[rows_->other[b]] | kNoImage << kPartnerBits;
        kinds[slot] = rows_->kind[b];
        for (size_t n = 0; n < numbers.size(); ++n) numbers[n][slot] = bonds[b * numbers.size() + n];
      }
    }
    slab.entries.set(slab.stream, entries);
    slab.counts.put(slab.stream, 0, counts);
    slab.bond_kind.set(slab.stream, kinds);
    slab.bond_constants.set(slab.stream, rows_->constants);
    for (size_t n = 0; n < numbers.size(); ++n) {
      slab.bond_copies[0][n].set(slab.stream, numbers[n]);
      slab.bond_copies[1][n].resize(slab.bond_copies[0][n].size());
    }
  }

  // `order`: by id, where the particle stands among those of all slabs, each of which begins at `first`.
  void add_bonds(const std::vector<size_t>& order, const std::vector<size_t>& first, State& state) const {
    std::vector<std::vector<std::vector<int64_t>>> numbers(slabs.size());
    for (size_t s = 0; s < slabs.size(); ++s)
      for (size_t n = 0; n < places.bonds.size(); ++n) {
        const Array<int64_t>& from = slabs[s]->bond_copies[places.bonds[n]][n];
        numbers[s].push_back(from.host(slabs[s]->stream, 0, from.size()));
      }
    for (size_t id = 0; id < order.size(); ++id) {
      const auto after = std::upper_bound(first.begin(), first.end(), order[id]);
      const auto s = static_cast<size_t>(after - first.begin()) - 1;
      for (uint64_t b = rows_->first[id]; b < rows_->first[id + 1]; ++b)
        for (const auto& values : numbers[s])
          state.bonds.push_back(values[(b - rows_->first[id]) * slabs[s]->own + order[id] - first[s]]);
    }
    state.bond_begin = begins_of(*rows_, bond_count());
  }

  // Sends the particles that `choice(slab, number)` picks, into the places behind those that slabs have.
  template <class Choose>
  void send(const Choose& choose) {
    list_sent(slabs, cuts_.count, block_, choose);
    carry();
  }

  void carry() {
    place_sendings(slabs, [&](RoundsSlab& slab, size_t all, size_t kept) { make_room(slab, all, kept); });
    for (auto& slab : slabs)
      for (const RoundsSending& sending : slab->sendings) {
        RoundsSlab& to = *slabs[sending.to];
        RoundsSlab::Copy& who = to.copies[places.who];
        for_each(
            slab->stream, 0, sending.count, block_,
            RoundsCarry{slab->sent.data() + sending.first, sending.at, slab->view(places), to.view(places),
                        who.type.data(), who.id.data(), rows_ == nullptr ? to.near_at.data() : nullptr,
                        guard_, coarse_shift_, numbers_});
      }
    wait_for_all(slabs);
  }

  // Particles go to the slabs that own their cells. They stand behind those that were there.
  void migrate() {
    const auto x = [&](RoundsSlab& slab) { return slab.view(places).x[cuts_.axis]; };
    if (cuts_.ring > 0)
      for (auto& slab : slabs)
        for_each(slab->stream, 0, slab->own, block_, RoundsWrap{x(*slab), int64_t{cuts_.ring} << frac_});
    send([&](RoundsSlab& slab, int s) { return RoundsLeavers{cuts_, s, x(slab)}; });
  }

  // Ghosts of all that lists of other slabs may reach.
  void mirror() {
    const double reach = std::ldexp(reach_ + skin_.now(), frac_) + std::ldexp(4, guard_ + coarse_shift_);
    send([&](RoundsSlab& slab, int s) {
      return RoundsReached{cuts_, s, slab.view(places).x[cuts_.axis], static_cast<int64_t>(reach)};
    });
  }

  void put_all_in_bins(RoundsSlab& slab) {
    slab.bin_count.zero(slab.stream);
    const RoundsView view = slab.view(places);
    for_each(slab.stream, 0, slab.all, block_,
             RoundsBinAll{
                 {view.x[0], view.x[1], view.x[2]}, bins_, guard_, slab.bin.data(), slab.bin_count.data()});
    slab.put_in_bins(slab.all, bin_total_, block_);
  }

  void list_pairs() {
    const auto start = [&](RoundsSlab& slab) {
      const RoundsView view = slab.view(places);
      slab.start_list({bins_,
                       {view.x[0], view.x[1], view.x[2]},
                       guard_,
                       slab.near_at.data(),
                       coarse_shift_,
                       slab.bin_first.data(),
                       slab.bin_count.data(),
                       alone() ? nullptr : slab.order.data(),
                       coarse_reach2(),
                       nullptr,
                       nullptr,
                       0,
                       0},
                      block_);
    };
    for (auto& slab : slabs) start(*slab);
    for (auto& slab : slabs) {
      while (!slab->list_fits()) start(*slab);
      longest_list = std::max<uint64_t>(longest_list, slab->longest);
      if (slab->near_entries.size() < slab->entries.size()) slab->near_entries.resize(slab->entries.size());
    }
    listed_pairs = mean_count();
    skin_.listed(listed_pairs);
    // Both of a pair move, and both were rounded to a visible unit, then and now.
    const double unit = std::ldexp(1.0, program_.position_frac);
    const auto allowed2 = [&](double skin) {
      const double allowed = skin * unit / 2 - 4;
      return allowed > 0 ? allowed * allowed : -1;
    };
    const double near_skin = std::min(kNearSkin * reach_, skin_.now() / 2);
    for (auto& slab : slabs)
      slab->near = {slab->near_entries.data(), slab->near_counts.data(), slab->near_at.data(),
                    std::pow((reach_ + near_skin) * unit, 2), allowed2(near_skin)};
    serve(allowed2(skin_.now()));
  }

  // Coarse places are rounded down: a distance may be off by the root of three of their units.
  uint64_t coarse_reach2() const {
    const double reach = std::ldexp(reach_ + skin_.now(), program_.position_frac - coarse_shift_) + 2;
    return static_cast<uint64_t>(reach * reach);
  }
  double mean_count() {
    for (auto& slab : slabs) {
      for_each(slab->stream, 0, 1, 32, RoundsZero{slab->hashes.data()});
      sum_each(slab->stream, 0, slab->own, block_, RoundsCount{slab->counts.data()}, slab->hashes.data());
    }
    uint64_t sum = 0;
    for (auto& slab : slabs) sum += slab->hashes.host(slab->stream, 0, 1)[0];
    return static_cast<double>(sum) / std::max(count_, 1u);
  }

  void serve(double allowed2) {
    for (auto& slab : slabs) {
      RoundsList& list = slab->list;
      list.entries = slab->entries.data(), list.counts = slab->counts.data(), list.stride = slab->own;
      for (int s = 0; s < 27; ++s)
        for (int a = 0; a < 3; ++a)
          list.shift[s][a] = static_cast<uint32_t>(((a == 0   ? s % 3
                                                     : a == 1 ? s / 3 % 3
                                                              : s / 9) -
                                                    1) *
                                                   bins_.length[a]);
      list.listed = slab->listed_at.data();
      for (size_t a = 0; a < 3; ++a) slab->cells.home[a] = slab->home[a].data();
      slab->cells.entered = slab->entered.data();
      list.allowed2 = allowed2;
    }
  }

  // Partners stay, wherever they go; cells are counted anew.
  void serve_bonds() {
    for (auto& slab : slabs) {
      RoundsMark mark{slab->view(places), slab->entered.data(), {}, frac_};
      for (size_t a = 0; a < 3; ++a) mark.home[a] = slab->home[a].data();
      for_each(slab->stream, 0, slab->own, block_, mark);
    }
    serve(std::numeric_limits<double>::infinity());
  }

  const Plan& plan_;
  const graph::FixedProgram& program_;
  const graph::BondRows* rows_;  // null: the program is not bonded
  int block_;
  RoundsSlabs cuts_{};
  uint32_t count_;
  int numbers_, guard_, frac_;
  int coarse_shift_ = 0;
  double reach_;  // cells
  Skin skin_;     // cells
  RoundsBins bins_{};
  uint32_t bin_total_ = 0;
};

}  // namespace cuboct::gpu
