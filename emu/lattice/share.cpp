// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "emu/lattice/cut.h"
#include "emu/lattice/impl.h"
#include "model/base/error.h"

namespace cuboct::emu {
namespace {

// All of a particle that moves to another rank.
struct Moving {
  uint32_t id, type;
  int32_t residue[3];
  double x[3], v[3], u[3];
};

// Pairs reach no farther than two cells, also from where particles stood when the far list was made.
constexpr int kGhostHops = 2;

// With 100,000 particles per block, 1 pair in 15 crosses its border (a cube of millions of particles).
constexpr uint32_t kRoomyBlock = 100000;
constexpr uint32_t kMostPerThread = 2;

}  // namespace

void LatticeEngine::Impl::check_room(uint64_t particles) {
  constexpr uint64_t kMost = std::numeric_limits<int32_t>::max() - 2 * kGroup;  // entries hold signed indices
  if (particles > kMost)
    throw InputError(
        fmt::format("{} particles in one process: the lattice engine holds up to {}", particles, kMost),
        "share the scene between more ranks");
}

void LatticeEngine::Impl::make_room(uint32_t stored, uint32_t ghosts) {
  check_room(uint64_t{stored} + ghosts);
  stored_ = stored;
  const uint32_t room = stored + ghosts;
  for (auto& x : particles_.x) x = PaddedArray<double>(room);
  for (auto& residue : particles_.residue) residue = PaddedArray<int32_t>(stored);
  for (auto& v : particles_.v) v = PaddedArray<double>(room);
  if (plan_.rule.pd)
    for (auto& u : particles_.u) u = PaddedArray<double>(room);
  if (shared()) particles_.id = PaddedArray<uint32_t>(room, kNoParticle);
  particles_.type = PaddedArray<uint8_t>(room);
  if (rounds_) {
    const auto numbers = static_cast<size_t>(rounds_->program().numbers());
    particles_.fields.clear();
    for (size_t f = 0; f < numbers; ++f) particles_.fields.emplace_back(room);
  }
  snapshot_.room = room;
}

// Appends blocks of equal size for the places [begin, end): one per thread, or several where the pairs
// between them, which are worked out twice, are few beside those inside. Threads then share rest and work
// more evenly.
void LatticeEngine::Impl::cut_blocks(std::vector<Block>& blocks, uint32_t begin, uint32_t end) const {
  const uint32_t groups = groups_of(end - begin);
  const auto threads = static_cast<uint32_t>(threads_);
  const uint32_t fine =
      threads == 1 ? 1 : std::clamp((end - begin) / kRoomyBlock, threads, kMostPerThread * threads);
  const uint32_t parts = std::min(groups, fine);
  for (uint32_t b = 0; b < parts; ++b) {
    Block& block = blocks.emplace_back();
    block.begin = begin + static_cast<uint32_t>(uint64_t{groups} * b / parts) * kGroup;
    block.end = std::min(end, begin + static_cast<uint32_t>(uint64_t{groups} * (b + 1) / parts) * kGroup);
  }
}

// Positions go back into the cells of the rings.
void LatticeEngine::Impl::wrap() {
  if (lattice_.period() == Cell{}) return;
  for_each_block([&](Block& block) {
    for (uint32_t p = block.begin; p < block.end; ++p) {
      const Cell& cell = lattice_.cell(members_.cells()[particles_.id_of(p)]);
      for (int a = 0; a < 3; ++a) {
        double& x = particles_.x[a][p];
        x += (cell[a] - std::floor(x * rule_.inverse_cell)) * rule_.cell;
      }
    }
  });
}

// Where particles no longer stand in rows they are stored cell by cell, so that neighbours stay near in
// memory.
void LatticeEngine::Impl::store_by_cell() {
  std::vector<uint32_t> from;  // by new index, the old one
  from.reserve(count_);
  for (uint32_t n = 0; n < lattice_.size(); ++n)
    members_.for_each(n, [&](uint32_t id) { from.push_back(index_(id)); });
  const auto reorder = [&](auto& array) {
    const auto copy = array.copy();
    for (uint32_t k = 0; k < count_; ++k) array[k] = copy[from[k]];
  };
  for (int a = 0; a < 3; ++a) {
    reorder(particles_.x[a]);
    reorder(particles_.residue[a]);
    reorder(particles_.v[a]);
    if (plan_.rule.pd) reorder(particles_.u[a]);
  }
  for (auto& field : particles_.fields) reorder(field);
  if (particles_.id.size() == 0) {
    particles_.id = PaddedArray<uint32_t>(stored_, kNoParticle);
    std::iota(particles_.id.data(), particles_.id.data() + count_, 0u);
  }
  reorder(particles_.id);
  reorder(particles_.type);
  index_.by_id.resize(count_);
  if (cell_.size() == 0) cell_ = PaddedArray<uint32_t>(stored_);
  for (uint32_t k = 0; k < count_; ++k) {
    index_.by_id[particles_.id[k]] = k;
    cell_[k] = members_.cells()[particles_.id[k]];
  }
  particles_.cell = cell_.data();
}

void LatticeEngine::Impl::own_cells() {
  const int ranks = options_.ranks->size();
  owner_ = cut_cells(lattice_, members_.counts(), ranks, options_.cut);
  for (int r = 0; r < ranks; ++r) {
    CellSet own(lattice_, rows_), reach(lattice_, rows_);
    for (uint32_t n = 0; n < lattice_.size(); ++n) own.flags()[n] = owner_[n] == r;
    own.survey(rows_);
    for (int hop = 0; hop < kGhostHops; ++hop) {
      reach.dilate(own, lattice_, rows_);
      own = reach;
    }
    reach_.push_back(std::move(reach));
  }
  peers_.resize(static_cast<size_t>(ranks));
}

// Particles go to the ranks that own their cells; those that others see as ghosts are stored last.
void LatticeEngine::Impl::redistribute() {
  Ranks& ranks = *options_.ranks;
  const int me = ranks.rank();
  std::vector<Bytes> to(peers_.size()), fields_to(peers_.size());
  for_each_index([&](uint32_t p) {
    const uint32_t id = particles_.id_of(p);
    const int owner = owner_[members_.cells()[id]];
    if (owner == me) return;
    for (const auto& field : particles_.fields) append(fields_to[static_cast<size_t>(owner)], field[p]);
    Moving moving{id, particles_.type[p], {}, {}, {}, {}};
    for (int a = 0; a < 3; ++a) {
      moving.x[a] = particles_.x[a][p];
      moving.residue[a] = particles_.residue[a][p];
      moving.v[a] = particles_.v[a][p];
      if (plan_.rule.pd) moving.u[a] = particles_.u[a][p];
    }
    append(to[static_cast<size_t>(owner)], moving);
  });
  const std::vector<Bytes> from = ranks.exchange(to);
  const std::vector<Bytes> fields_from = rounds_ ? ranks.exchange(fields_to) : fields_to;

  std::vector<uint32_t> rim, core;  // ids
  for (uint32_t n = 0; n < lattice_.size(); ++n) {
    if (owner_[n] != me) continue;
    bool seen = false;
    for (size_t q = 0; q < reach_.size(); ++q)
      seen = seen || (static_cast<int>(q) != me && reach_[q].flags()[n] != 0);
    members_.for_each(n, [&](uint32_t id) { (seen ? rim : core).push_back(id); });
  }
  if (!listed_ || crystal())  // else they stay in the order of cells
    for (auto* ids : {&rim, &core}) std::sort(ids->begin(), ids->end());
  const uint32_t core_room = groups_of(core.size()) * kGroup, rim_room = groups_of(rim.size()) * kGroup;

  // By rank, the ids of ghosts: those of its cells that this rank may need.
  std::vector<std::vector<uint32_t>> ghosts(peers_.size()), given(peers_.size());
  for (uint32_t n = 0; n < lattice_.size(); ++n)
    for (size_t q = 0; q < peers_.size(); ++q) {
      if (static_cast<int>(q) == me) continue;
      const bool take = owner_[n] == q && reach_[static_cast<size_t>(me)].flags()[n] != 0;
      const bool give = owner_[n] == me && reach_[q].flags()[n] != 0;
      if (take) members_.for_each(n, [&](uint32_t id) { ghosts[q].push_back(id); });
      if (give) members_.for_each(n, [&](uint32_t id) { given[q].push_back(id); });
    }
  size_t ghost_count = 0;
  for (size_t q = 0; q < peers_.size(); ++q) {
    std::sort(ghosts[q].begin(), ghosts[q].end());
    std::sort(given[q].begin(), given[q].end());
    ghost_count += ghosts[q].size();
  }

  const Particles old = std::move(particles_);
  particles_ = {};
  particles_.shift = old.shift;
  const Index old_index = std::move(index_);
  // Behind them are ghosts, which have no residues: all of one that is now this rank's comes from its rank.
  const uint32_t old_stored = stored_;
  make_room(core_room + rim_room, static_cast<uint32_t>(ghost_count));
  cell_ = PaddedArray<uint32_t>(snapshot_.room);
  particles_.cell = cell_.data();
  index_.by_id.assign(count_, kNoParticle);
  const auto place = [&](const std::vector<uint32_t>& ids, uint32_t begin) {
    for (const uint32_t id : ids) {
      index_.by_id[id] = begin;
      particles_.id[begin] = id;
      cell_[begin] = members_.cells()[id];
      if (const uint32_t p = old_index(id); p < old_stored && old.id[p] == id) {
        particles_.type[begin] = old.type[p];
        for (int a = 0; a < 3; ++a) {
          particles_.x[a][begin] = old.x[a][p];
          particles_.residue[a][begin] = old.residue[a][p];
          particles_.v[a][begin] = old.v[a][p];
          if (plan_.rule.pd) particles_.u[a][begin] = old.u[a][p];
        }
        for (size_t f = 0; f < old.fields.size(); ++f) particles_.fields[f][begin] = old.fields[f][p];
      }
      ++begin;
    }
  };
  place(core, 0);
  place(rim, core_room);
  for (size_t q = 0; q < from.size(); ++q) {
    std::vector<double> fields;
    for_each_of<double>(fields_from[q], [&](double number) { fields.push_back(number); });
    auto number = fields.begin();
    for_each_of<Moving>(from[q], [&](const Moving& moving) {
      const uint32_t p = index_(moving.id);
      for (auto& field : particles_.fields) field[p] = *number++;
      particles_.type[p] = static_cast<uint8_t>(moving.type);
      for (int a = 0; a < 3; ++a) {
        particles_.x[a][p] = moving.x[a];
        particles_.residue[a][p] = moving.residue[a];
        particles_.v[a][p] = moving.v[a];
        if (plan_.rule.pd) particles_.u[a][p] = moving.u[a];
      }
    });
  }
  blocks_.clear();
  cut_blocks(blocks_, 0, static_cast<uint32_t>(core.size()));
  cut_blocks(blocks_, core_room, core_room + static_cast<uint32_t>(rim.size()));

  // The ghosts' types and positions.
  uint32_t at = stored_;
  std::vector<Bytes> types(peers_.size());
  for (size_t q = 0; q < peers_.size(); ++q) {
    Peer& peer = peers_[q];
    peer.give.clear();
    for (const uint32_t id : given[q]) {
      peer.give.push_back(index_(id));
      types[q].push_back(static_cast<std::byte>(particles_.type[index_(id)]));
    }
    peer.take_from = at;
    peer.take_count = static_cast<uint32_t>(ghosts[q].size());
    for (const uint32_t id : ghosts[q]) {
      index_.by_id[id] = at;
      particles_.id[at] = id;
      cell_[at++] = members_.cells()[id];
    }
  }
  const std::vector<Bytes> their_types = ranks.exchange(types);
  for (size_t q = 0; q < peers_.size(); ++q)
    for (uint32_t k = 0; k < peers_[q].take_count; ++k)
      particles_.type[peers_[q].take_from + k] = static_cast<uint8_t>(their_types[q][k]);
  exchange(halo());
}

// Positions, and velocities where they matter.
std::vector<PaddedArray<double>*> LatticeEngine::Impl::halo() {
  std::vector<PaddedArray<double>*> arrays;
  for (auto& x : particles_.x) arrays.push_back(&x);
  if (plan_.rule.damped || (rounds_ && rounds_->reads_velocities()))
    for (auto& v : particles_.v) arrays.push_back(&v);
  return arrays;
}

// Of each other rank what its ghosts have.
void LatticeEngine::Impl::start_halo(const std::vector<PaddedArray<double>*>& arrays) {
  std::vector<std::span<const double>> out;
  std::vector<std::span<double>> in;
  for (Peer& peer : peers_) {
    peer.out.resize(peer.give.size() * arrays.size());
    peer.in.resize(peer.take_count * arrays.size());
    double* to = peer.out.data();
    for (const PaddedArray<double>* array : arrays)
      for (const uint32_t p : peer.give) *to++ = (*array)[p];
    out.emplace_back(peer.out);
    in.emplace_back(peer.in);
  }
  options_.ranks->start(out, in);
}

void LatticeEngine::Impl::finish_halo(const std::vector<PaddedArray<double>*>& arrays) {
  options_.ranks->finish();
  for (const Peer& peer : peers_) {
    const double* from = peer.in.data();
    for (PaddedArray<double>* array : arrays) {
      std::copy(from, from + peer.take_count, array->data() + peer.take_from);
      from += peer.take_count;
    }
  }
}

void LatticeEngine::Impl::exchange(const std::vector<PaddedArray<double>*>& arrays) {
  start_halo(arrays);
  finish_halo(arrays);
}

}  // namespace cuboct::emu
