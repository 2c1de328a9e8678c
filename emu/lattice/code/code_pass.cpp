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
  for (auto& sum : sums)
    if (scope.active.near == nullptr)
      std::fill(sum.data() - kGroup, sum.data() + sum.size() + kGroup, kMagic);
    else
      for (const uint32_t k : scope.wanted.awake)
        std::fill_n(sum.data() + size_t{k} * kGroup, kGroup, kMagic);
}

void give_list(Job& job, const Entry* entries, const std::vector<EntryGroup>& groups,
               const uint32_t* group_of) {
  job.entries = entries;
  job.groups = groups.data();
  job.group_of = group_of;
  job.count = static_cast<uint32_t>(groups.size());
}

}  // namespace

WantedGroups::WantedGroups(const Particles& particles, const Block& block, const Active& active) {
  if (active.near == nullptr) return;
  is_near.resize(block.groups());
  for (uint32_t k = 0; k < block.groups(); ++k) {
    if (!any_flag(active.near, particles, block.first_group() + k)) continue;
    is_near[k] = 1;
    near.push_back(k);
    if (any_flag(active.awake, particles, block.first_group() + k)) awake.push_back(k);
  }
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
  const bool some_rest = scope.active.near != nullptr;
  bool fits = true;
  // A group for each of the block.
  const auto all_groups = [&](Ends ends, const Entry* entries, const std::vector<EntryGroup>& groups) {
    give_list(job, entries, groups, nullptr);
    job.chosen = some_rest ? scope.wanted.near.data() : nullptr, job.wanted = nullptr;
    if (some_rest) job.count = static_cast<uint32_t>(scope.wanted.near.size());
    fits = library_.meet(round_, ends)(job) && fits;
  };
  if (bonded) {
    if (once_) all_groups(Ends::both, bonds.entries.data(), bonds.both);
    all_groups(Ends::own, bonds.entries.data(), bonds.own);
    return fits;
  }
  for (const Ends ends : {Ends::own, Ends::other, Ends::both})
    if ((ends == Ends::both) == once_) all_groups(ends, block.inside.entries.data(), block.inside.groups);
  for (const Edge* edge : {&block.beside, &block.ghosts}) {
    give_list(job, edge->pairs.entries.data(), edge->pairs.groups, edge->group.data());
    job.chosen = nullptr, job.wanted = some_rest ? scope.wanted.is_near.data() : nullptr;
    fits = library_.meet(round_, Ends::own)(job) && fits;
  }
  return fits;
}

}  // namespace cuboct::emu
