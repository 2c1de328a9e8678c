// SPDX-License-Identifier: MIT
#include "emu/lattice/code/code_pass.h"

#include <algorithm>
#include <cstddef>

namespace cuboct::emu {
namespace {

// Who the code asks of bonds.
struct Owner {
  const CodeScope& scope;
  const graph::FixedProgram& program;
  const BondSpace& space;
  const BondList& bonds;
};

bool meet(void* owner, uint32_t own, uint64_t slot, double apart[3], bool* fits) {
  const Owner& of = *static_cast<const Owner*>(owner);
  std::array<double, 3> ends{apart[0], apart[1], apart[2]};
  const auto& x = of.scope.particles.x;
  if (!of.space.meets({x[0][own], x[1][own], x[2][own]}, ends)) {
    *fits = of.bonds.is_broken(of.program, of.space, slot);
    return false;
  }
  std::ranges::copy(ends, apart);
  return true;
}

void mark(void* owner, uint32_t own, uint32_t other) {
  const CodeScope& scope = static_cast<const Owner*>(owner)->scope;
  for (const uint32_t end : {own, other}) scope.active.mark(scope.particles.cell[end]);
}

template <typename Double, typename Arrays>
std::vector<Double*> pointers(Arrays& arrays) {
  std::vector<Double*> to;
  for (auto& array : arrays) to.push_back(array.data());
  return to;
}

// Sums of groups where all are at rest are read by nobody.
void clear(const CodeScope& scope, Sums& sums) {
  const std::vector<uint8_t>& awake = scope.wanted.awake;
  for (auto& sum : sums) {
    const auto end = static_cast<ptrdiff_t>(sum.size()) + kGroup;
    if (awake.empty()) {
      std::fill(sum.data() - kGroup, sum.data() + end, kMagic);
      continue;
    }
    for (size_t k = 0; k < awake.size(); ++k)
      if (awake[k] != 0) std::fill_n(sum.data() + k * kGroup, kGroup, kMagic);
  }
}

void give_list(Job& job, const Entry* entries, const std::vector<EntryGroup>& groups,
               const uint32_t* group_of) {
  job.entries = entries;
  job.groups = groups.data();
  job.group_of = group_of;
  job.group_count = static_cast<uint32_t>(groups.size());
}

}  // namespace

WantedGroups::WantedGroups(const Particles& particles, const Block& block, const Active& active) {
  const auto flags = [&](const uint8_t* cells, std::vector<uint8_t>& groups) {
    for (uint32_t k = 0; cells != nullptr && k < block.groups(); ++k)
      groups.push_back(any_flag(cells, particles, block.first_group() + k));
  };
  flags(active.near, near);
  flags(active.awake, awake);
}

CodePass::CodePass(const CodeLibrary& library, const graph::FixedProgram& program, const BondSpace& space,
                   size_t round, bool once)
    : library_(library), program_(program), space_(space), round_(round), once_(once) {
  if (space.rows != nullptr)
    bond_constants_.assign(space.rows->constants.begin(), space.rows->constants.end());
}

bool CodePass::run(const CodeScope& scope, BondList& bonds, Sums& sums) const {
  clear(scope, sums);
  const Particles& particles = scope.particles;
  const bool bonded = space_.rows != nullptr;
  Owner owner{scope, program_, space_, bonds};
  const auto fields = pointers<const double>(particles.fields);
  const auto sum_pointers = pointers<double>(sums), numbers = pointers<double>(bonds.numbers);

  Job job{};
  for (size_t a = 0; a < 3; ++a) job.x[a] = particles.x[a].data(), job.v[a] = particles.v[a].data();
  job.fields = fields.data();
  job.type = particles.type.data();
  job.id = particles.id.size() > 0 ? particles.id.data() : nullptr;
  job.shift = reinterpret_cast<const double(*)[3]>(particles.shift.data());
  job.begin = scope.block.begin;
  job.sums = sum_pointers.data();
  job.wanted = scope.wanted.near.empty() ? nullptr : scope.wanted.near.data();
  job.step = static_cast<double>(scope.step);
  job.numbers = library_.numbers();
  job.bonds = numbers.data();
  job.kind = bonds.kind.data();
  job.bond_constants = bond_constants_.data();
  job.bond_constant_count = static_cast<int64_t>(program_.bond_constants.size());
  job.cell = space_.cell;
  job.owner = &owner;
  job.meet = meet;
  job.changed = scope.active.changed != nullptr ? mark : nullptr;

  const Block& block = scope.block;
  bool fits = true;
  if (bonded)
    give_list(job, bonds.entries.data(), bonds.both, nullptr);
  else
    give_list(job, block.inside.entries.data(), block.inside.groups, nullptr);
  if (once_)
    fits = library_.meet(round_, Ends::both)(job);
  else if (!bonded)
    for (const Ends ends : {Ends::own, Ends::other}) fits = library_.meet(round_, ends)(job) && fits;
  const auto across = [&](const Entry* entries, const std::vector<EntryGroup>& groups, const uint32_t* of) {
    give_list(job, entries, groups, of);
    fits = library_.meet(round_, Ends::own)(job) && fits;
  };
  if (bonded)
    across(bonds.entries.data(), bonds.own, nullptr);
  else
    for (const Edge* edge : {&block.beside, &block.ghosts})
      across(edge->pairs.entries.data(), edge->pairs.groups, edge->group.data());
  return fits;
}

}  // namespace cuboct::emu
