// SPDX-License-Identifier: MIT
// Machine: where particles are stored, which device owns them, and their pair lists.
#pragma once

#include "emu/gpu/machine.h"

namespace cuboct::gpu {

template <class Policy>
template <class MakeRule>
Machine<Policy>::Machine(const Options& options, const Setup& setup, const EnergyTables& energies,
                         const HostParticles<Policy>& state, const MakeRule& make_rule)
    : options_(options),
      setup_(setup),
      particles_(state.size()),
      skin_(setup.radius, setup.largest_skin, static_cast<double>(state.size())) {
  require_devices(options);
  const int slabs = static_cast<int>(options.devices.size());
  std::array<std::vector<uint64_t>, 3> per_plane;
  const Geometry& g = setup.geometry;
  for (int a = 0; a < 3; ++a) {
    per_plane[a].assign(static_cast<size_t>(g.total[a]), 0);
    for (const CellAt& c : state.cell)
      ++per_plane[a][static_cast<size_t>(modulo(c.c[a] - g.low[a], g.total[a]))];
  }
  cells_ = make_cells(g, per_plane, slabs);
  uint64_t cells = 0;
  for (const SlabCells& slab : cells_.slabs)
    cells = std::max<uint64_t>(cells, slab.rank.size() + 4ull * slab.ranks);
  require_memory(options, particles_, cells,
                 bytes_per_particle<Policy>(setup.pd, setup.residue_bits, entries_expected(state.cell)));
  share(options.devices);
  for (int s = 0; s < slabs; ++s) {
    slabs_.push_back(
        std::make_unique<Slab>(options.devices[static_cast<size_t>(s)], s, &counters.device_bytes));
    Slab& slab = *slabs_.back();
    const SlabCells& of = cells_.slabs[static_cast<size_t>(s)];
    slab.rule = make_rule(slab.stream);
    require_tables(options, slab.rule->cache_words() * 4);
    slab.rank.set(slab.stream, of.rank);
    for (auto* array : {&slab.count, &slab.first, &slab.taken, &slab.occupancy}) array->resize(of.ranks);
    slab.notes.resize(8);
    // The first hash asks before the first step.
    slab.control.set(slab.stream, {{0, kNever, kNever, kNever, kNever, kNever}});
    slab.hashes.resize(kLongest + 1);
    slab.energy_node.set(slab.stream, energies.node);
    slab.energy_strength.set(slab.stream, energies.strength);
    slab.energy_weight.set(slab.stream, energies.weight);
    slab.energy_free.set(slab.stream, energies.free);
    slab.energy_mass.set(slab.stream, energies.mass);
    slab.energy = energies.rule(slab.energy_node.data(), slab.energy_strength.data(),
                                slab.energy_weight.data(), slab.energy_free.data(), slab.energy_mass.data());
  }
  upload(state);
}

// The longest list, by how full the cells of some particles are.
template <class Policy>
double Machine<Policy>::entries_expected(const std::vector<CellAt>& cells) const {
  constexpr size_t kSampled = 500;
  // Lists are as wide as their longest, which is longer than most.
  constexpr double kLongest = 1.35, kLeast = 24;
  std::map<std::array<int32_t, 3>, uint64_t> some;
  for (size_t i = 0; i < cells.size(); i += cells.size() / kSampled + 1)
    some[{cells[i].c[0], cells[i].c[1], cells[i].c[2]}] = 0;
  uint64_t all = 0;
  for (const CellAt& cell : cells)
    if (some.count({cell.c[0], cell.c[1], cell.c[2]}) > 0) ++all;
  const auto& edge = setup_.geometry.edge;
  const double density =
      static_cast<double>(all) / static_cast<double>(some.size()) / (edge[0] * edge[1] * edge[2]);
  const double reach = setup_.radius + setup_.largest_skin;
  return std::max(kLeast, kLongest * density * 4 / 3 * 3.14159265 * reach * reach * reach);
}

template <class Policy>
GridView Machine<Policy>::grid(const Slab& slab) const {
  GridView view{};
  const Geometry& g = setup_.geometry;
  const SlabCells& of = cells_of(slab);
  for (int a = 0; a < 3; ++a) {
    view.low[a] = g.low[a];
    view.total[a] = view.local[a] = g.total[a];
    view.wraps[a] = g.wraps[a];
    view.edge[a] = static_cast<float>(g.edge[a]);
  }
  view.axis = cells_.axis;
  view.local[view.axis] = of.local_planes;
  view.local_first = of.local_first;
  view.folds = g.folds;
  view.rank = slab.rank.data();
  return view;
}

template <class Policy>
void Machine<Policy>::make_room(Slab& slab, size_t particles) {
  if (particles <= slab.room) return;
  const auto room =
      static_cast<size_t>(static_cast<double>(particles) * (slab.room > 0 ? kSpare : 1.0)) + 256;
  if (room > kPlaceMask<Policy::kReach>) throw_too_many(particles, kPlaceMask<Policy::kReach>);
  const size_t kept = slab.room;
  for (int k = 0; k < 2; ++k) {
    slab.x[k].grow(slab.stream, room, kept);
    slab.v[k].grow(slab.stream, room, kept);
    if (setup_.pd) slab.u[k].grow(slab.stream, room, kept);
    slab.residue[k].grow(slab.stream, room * residue_words(), kept * residue_words());
    slab.graph[k].drop();
  }
  if (!Policy::kFixed) slab.listed.grow(slab.stream, room, kept);
  for (auto* array : {&slab.id, &slab.spare_id, &slab.rank_of, &slab.order})
    array->grow(slab.stream, room, kept);
  if (Policy::kFixed) slab.entered.grow(slab.stream, room, kept);
  for (auto* array : {&slab.cell, &slab.spare_cell}) array->grow(slab.stream, room, kept);
  slab.room = room;
}

template <class Policy>
void Machine<Policy>::scatter(const HostParticles<Policy>& state) {
  std::vector<std::vector<uint32_t>> of(slabs_.size());
  for (uint32_t i = 0; i < state.size(); ++i) {
    const int owner =
        cells_.owner(cells_.plane({state.cell[i].c[0], state.cell[i].c[1], state.cell[i].c[2]}));
    of[static_cast<size_t>(owner)].push_back(i);
  }
  const auto some = [](const auto& all, const std::vector<uint32_t>& which) {
    auto few = std::remove_cvref_t<decltype(all)>();
    few.reserve(which.size());
    for (const uint32_t i : which) few.push_back(all[i]);
    return few;
  };
  for (size_t s = 0; s < slabs_.size(); ++s) {
    Slab& slab = *slabs_[s];
    slab.own = static_cast<uint32_t>(of[s].size());
    make_room(slab, of[s].size() + 1);
    slab.x[at_].put(slab.stream, 0, some(state.x, of[s]));
    slab.v[at_].put(slab.stream, 0, some(state.v, of[s]));
    if (setup_.pd) slab.u[at_].put(slab.stream, 0, some(state.u, of[s]));
    if constexpr (Policy::kFixed) {
      std::vector<uint32_t> words(of[s].size() * residue_words());
      const Residues<true> packed{words.data(), setup_.residue_bits};
      for (size_t k = 0; k < of[s].size(); ++k) packed.store(k, state.residue[of[s][k]]);
      slab.residue[at_].put(slab.stream, 0, words);
    }
    slab.cell.put(slab.stream, 0, some(state.cell, of[s]));
    slab.id.put(slab.stream, 0, some(state.id, of[s]));
  }
}

template <class Policy>
void Machine<Policy>::upload(const HostParticles<Policy>& state) {
  scatter(state);
  make_lists();
}

template <class Policy>
HostParticles<Policy> Machine<Policy>::download() {
  HostParticles<Policy> state;
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  for (auto& slab : slabs_) {
    append(state.x, slab->x[at_].host(slab->stream, 0, slab->own));
    append(state.v, slab->v[at_].host(slab->stream, 0, slab->own));
    if (setup_.pd) append(state.u, slab->u[at_].host(slab->stream, 0, slab->own));
    if constexpr (Policy::kFixed) {
      std::vector<uint32_t> words = slab->residue[at_].host(slab->stream, 0, slab->own * residue_words());
      const Residues<true> packed{words.data(), setup_.residue_bits};
      for (size_t k = 0; k < slab->own; ++k) state.residue.push_back(packed.load(k));
    }
    append(state.cell, slab->cell.host(slab->stream, 0, slab->own));
    append(state.id, slab->id.host(slab->stream, 0, slab->own));
  }
  return state;
}

// Each particle in the slab that owns the cell from which its position counts.
template <class Policy>
void Machine<Policy>::settle(const HostParticles<Policy>& state) {
  wait_for_all();
  scatter(state);
  for (auto& slab : slabs_)
    for_each(slab->stream, 0, slab->own, options_.block, KeepAll{slab->rank_of.data()});
  wait_for_all();
}

// Each slab's particles where they are now, `own` of them with gaps of rank kGone.
template <class Policy>
void Machine<Policy>::resettle() {
  for (auto& slab : slabs_) {
    Slab& s = *slab;
    const uint32_t room = alone() ? 0 : s.own / 8 + 1024;
    for (int side = 0; side < 2; ++side)
      if (s.leaving[side].size() < room) s.leaving[side].resize(room);
    s.notes.zero(s.stream);
    Resettle<Policy> f{};
    f.view = s.rule->view(), f.grid = grid(s), f.at = at(s, at_), f.cell = s.cell.data(), f.id = s.id.data();
    f.rank = s.rank_of.data(), f.alone = alone(), f.room = room;
    f.own = {cells_of(s).first, cells_of(s).planes};
    for (int side = 0; side < 2; ++side) {
      if (const Slab* other = beside(s, side))
        f.beside[side] = {cells_of(*other).first, cells_of(*other).planes};
      f.leaving[side] = s.leaving[side].data();
    }
    f.leaving_count = s.notes.data(), f.lost = s.notes.data() + 2;
    for_each(s.stream, 0, s.own, options_.block, f);
  }
  if (alone()) return;
  std::vector<std::array<uint32_t, 2>> leavers;
  bool lost = false;
  for (auto& slab : slabs_) {
    const std::vector<uint32_t> notes = slab->notes.host(slab->stream, 0, 3);
    leavers.push_back({notes[0], notes[1]});
    lost |= notes[2] > 0;
  }
  if (lost) return settle(download());  // seldom: through the host
  for (auto& slab : slabs_) {
    Slab& s = *slab;
    for (int side = 0; side < 2; ++side) {
      Slab* other = beside(s, side);
      // Both neighbours may be one: what left it for its own other side.
      if (!other) continue;
      const uint32_t coming = leavers[static_cast<size_t>(other->number)][1 - side];
      if (coming == 0) continue;
      make_room(s, s.own + coming);
      if (s.arriving.size() < coming) s.arriving.resize(coming);
      copy(s.stream, s.arriving.data(), s.device, other->leaving[1 - side].data(), other->device,
           coming * sizeof(Traveller<Policy>));
      Arrive<Policy> f{s.arriving.data(), at(s, at_), s.cell.data(), s.id.data(), s.rank_of.data(), s.own};
      for_each(s.stream, 0, coming, options_.block, f);
      s.own += coming;
      s.stream.synchronize();
    }
  }
}

template <class Policy>
void Machine<Policy>::sort() {
  for (auto& slab : slabs_) {
    Slab& s = *slab;
    s.count.zero(s.stream), s.taken.zero(s.stream);
    for_each(s.stream, 0, s.own, options_.block,
             CountByCell{grid(s), s.cell.data(), s.rank_of.data(), s.count.data()});
  }
  if (!alone()) wait_for_all();
  for (auto& slab : slabs_) {  // the counts of the copies
    Slab& s = *slab;
    const SlabCells& mine = cells_of(s);
    if (const Slab* lower = beside(s, 0))
      copy(s.stream, s.count.data() + mine.own_end, s.device,
           lower->count.data() + cells_of(*lower).inner_end, lower->device,
           (mine.lower_copy_end - mine.own_end) * sizeof(uint32_t));
    if (const Slab* upper = beside(s, 1))
      copy(s.stream, s.count.data() + mine.lower_copy_end, s.device, upper->count.data(), upper->device,
           (mine.ranks - mine.lower_copy_end) * sizeof(uint32_t));
    exclusive_sums(s.stream, s.count.data(), s.first.data(), mine.ranks);
    if (Policy::kFixed)
      copy(s.stream, s.occupancy.data(), s.device, s.count.data(), s.device, mine.own_end * sizeof(uint32_t));
    // Where each part of the storage ends: the number of particles before a rank.
    if (!alone())
      for_each(s.stream, 0, 1, 32,
               PartEnds{s.first.data(),
                        s.count.data(),
                        s.notes.data(),
                        {mine.low_end, mine.inner_end, mine.own_end, mine.lower_copy_end, mine.ranks}});
  }
  for (auto& slab : slabs_) {
    Slab& s = *slab;
    const uint32_t before = s.own;
    if (alone()) {
      s.low_end = 0, s.high_begin = s.lower_copy_end = s.all = s.own;
    } else {
      const std::vector<uint32_t> ends = s.notes.host(s.stream, 0, 5);
      s.low_end = ends[0], s.high_begin = ends[1], s.own = ends[2], s.lower_copy_end = ends[3],
      s.all = ends[4];
      make_room(s, s.all);
    }
    for_each(s.stream, 0, before, options_.block,
             Order{s.rank_of.data(), s.first.data(), s.taken.data(), s.order.data()});
    // By id in what gets the new ids after: each is read before it is written over.
    for_each(s.stream, 0, s.own, options_.block,
             OrderInCell{s.first.data(), s.count.data(), s.id.data(), s.rank_of.data(), s.order.data(),
                         s.spare_id.data()});
    Gather<Policy> f{s.rule->view(),    grid(s),
                     s.spare_id.data(), at(s, at_),
                     at(s, 1 - at_),    s.cell.data(),
                     s.id.data(),       s.spare_cell.data(),
                     s.spare_id.data(), Policy::kFixed ? s.entered.data() : nullptr};
    for_each(s.stream, 0, s.own, options_.block, f);
    std::swap(s.cell, s.spare_cell), std::swap(s.id, s.spare_id);
  }
  at_ = 1 - at_;
  if (!alone()) wait_for_all();
}

// Calls use(slab beside, place in its arrays, place of its copies here, count) for each border of a slab.
template <class Policy>
template <class Use>
void Machine<Policy>::each_copy(const Slab& s, const Use& use) {
  for (int side = 0; side < 2; ++side) {
    const Slab* other = beside(s, side);
    if (!other) continue;
    const uint32_t to = side == 0 ? s.own : s.lower_copy_end;
    use(*other, side == 0 ? other->high_begin : 0, to, (side == 0 ? s.lower_copy_end : s.all) - to);
  }
}

// The neighbours' borders into one's own copies.
template <class Policy>
void Machine<Policy>::mirror() {
  counters.halo_particles = 0;
  for (auto& slab : slabs_) {
    Slab& s = *slab;
    counters.halo_particles += s.all - s.own;
    each_copy(s, [&](const Slab& other, uint32_t from, uint32_t to, size_t count) {
      copy(s.stream, s.x[at_].data() + to, s.device, other.x[at_].data() + from, other.device,
           count * sizeof(typename Policy::Position));
      // Velocities into both of the slab's states: with them go anchors, which a list's steps leave as they
      // are.
      for (int state = 0; state < 2; ++state)
        copy(s.stream, s.v[state].data() + to, s.device, other.v[at_].data() + from, other.device,
             count * sizeof(typename Policy::Velocity));
      copy(s.stream, s.cell.data() + to, s.device, other.cell.data() + from, other.device,
           count * sizeof(CellAt));
    });
  }
  if (!alone()) wait_for_all();
}

// What steps do not send, for energies between what devices own.
template <class Policy>
void Machine<Policy>::mirror_residues() {
  const size_t words = residue_words();
  wait_for_all();
  for (auto& slab : slabs_) {
    Slab& s = *slab;
    each_copy(s, [&](const Slab& other, uint32_t from, uint32_t to, size_t count) {
      copy(s.stream, s.residue[at_].data() + to * words, s.device, other.residue[at_].data() + from * words,
           other.device, count * words * sizeof(uint32_t));
    });
  }
}

template <class Policy>
void Machine<Policy>::list_pairs(Slab& s) {
  s.stride = (s.own + 31) / 32 * 32;
  for (auto* counts : {&s.counts, &s.near_counts})
    if (counts->size() < s.own) counts->resize(s.room);
  for (auto* entries : {&s.entries, &s.near_entries})
    if (entries->size() < s.stride * s.width) entries->resize(s.stride * s.width);
  s.notes.zero(s.stream);
  MakeList<Policy> f{};
  f.view = s.rule->view(), f.grid = grid(s);
  f.radius = reach_of(skin_.now()), f.near = reach_of(near_skin());
  f.x = s.x[at_].data(), f.cell = s.cell.data(), f.first = s.first.data(), f.count = s.count.data();
  f.entries = s.entries.data(), f.counts = s.counts.data(), f.width = s.width, f.stride = s.stride;
  if (particles_ <= kMostTogether)  // too few to keep a device busy with a thread each
    max_shared<PairLanes<32>>(s.stream, s.own, options_.block, f, s.notes.data());
  else
    max_each(s.stream, 0, s.own, options_.block, f, s.notes.data());
  s.hashes.zero(s.stream);
  sum_each(s.stream, 0, s.own, options_.block, CountEntries{s.counts.data()}, s.hashes.data());
}

template <class Policy>
void Machine<Policy>::list_pairs() {
  uint64_t entries = 0;
  for (auto& slab : slabs_) list_pairs(*slab);
  for (auto& slab : slabs_) {
    for (;;) {
      const uint32_t longest = slab->notes.host(slab->stream, 0, 1)[0];
      counters.longest_list = std::max<uint64_t>(counters.longest_list, longest);
      if (longest <= slab->width) break;
      slab->width = longest + longest / 16 + 1;
      if (slab->width > kNearMask) throw_too_dense(longest);
      list_pairs(*slab);
    }
    entries += slab->hashes.host(slab->stream, 0, 1)[0];
  }
  counters.listed_pairs = static_cast<double>(entries) / static_cast<double>(particles_);
  skin_.listed(counters.listed_pairs);
  ++counters.list_builds;
}

template <class Policy>
void Machine<Policy>::make_lists() {
  skin_.aged(age_);
  resettle();
  list_here();
  age_ = 0;
}

template <class Policy>
void Machine<Policy>::list_here() {
  sort();
  mirror();
  list_pairs();
  if (!Policy::kFixed)
    for (auto& slab : slabs_)
      copy(slab->stream, slab->listed.data(), slab->device, slab->x[at_].data(), slab->device,
           slab->own * sizeof(typename Policy::Position));
  // Graphs hold the number of particles and the skin.
  for (auto& slab : slabs_)
    for (Graph& graph : slab->graph) graph.drop();
  near_age_ = kNever;
}

template <class Policy>
Kept<Policy> Machine<Policy>::keep() {
  Kept<Policy> kept{download(), {}, skin_.memory(), age_};
  for (auto& slab : slabs_) {
    const auto listed = slab->listed.host(slab->stream, 0, slab->own);
    kept.listed.insert(kept.listed.end(), listed.begin(), listed.end());
  }
  return kept;
}

// The list is made as it was made, then its particles go on to where they were.
template <class Policy>
bool Machine<Policy>::restore(const Kept<Policy>& kept) {
  if (!skin_.recall(kept.skin)) return false;
  HostParticles<Policy> then = kept.state;
  then.x = kept.listed;
  settle(then);
  list_here();
  age_ = kept.age;
  place(kept);
  mirror();
  return true;
}

template <class Policy>
void Machine<Policy>::place(const Kept<Policy>& kept) {
  std::vector<uint32_t> at(kept.state.size());  // of an id
  for (uint32_t k = 0; k < kept.state.size(); ++k) at[kept.state.id[k]] = k;
  for (auto& slab : slabs_) {
    auto x = slab->x[at_].host(slab->stream, 0, slab->own);
    auto v = slab->v[at_].host(slab->stream, 0, slab->own);  // with the anchors
    std::vector<typename Policy::Extra> u;
    const std::vector<uint32_t> id = slab->id.host(slab->stream, 0, slab->own);
    for (size_t k = 0; k < id.size(); ++k) {
      const size_t from = at[id[k]];
      x[k] = kept.state.x[from];
      std::copy_n(kept.state.v[from].at, 3, v[k].at);
      if (setup_.pd) u.push_back(kept.state.u[from]);
    }
    slab->x[at_].put(slab->stream, 0, x);
    slab->v[at_].put(slab->stream, 0, v);
    slab->u[at_].put(slab->stream, 0, u);
  }
}

}  // namespace cuboct::gpu
