// SPDX-License-Identifier: MIT
#include "emu/machine/shown.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "model/program/integer_program.h"

namespace cuboct::emu {

ShownReader::ShownReader(const Plan& plan) : plan_(plan) {
  if (plan.program && plan.program->rows && plan.program->program.bond_numbers() > 0)
    bond_begin_ = begins_of(*plan.program->rows, plan.program->program.bond_numbers());
}

// A row goes where its particle goes, and but for its numbers nothing changes it.
void ShownReader::check_bonds(const Slot& slot, uint64_t step) const {
  const graph::BondRows& rows = *plan_.program->rows;
  const uint32_t id = slot.body.id;
  const uint64_t first = rows.first[id], bonds = rows.first[id + 1] - first;
  for (size_t k = 0; k < slot.bonds.size(); ++k) {
    const Bond& bond = slot.bonds[k];
    const bool same = k < bonds ? bond.other == rows.other[first + k] && bond.kind == rows.kind[first + k]
                                : bond.other == id;
    if (!same)
      throw std::runtime_error(
          fmt::format("step {}: particle {} holds a bond to {} in place {}", step, id, bond.other, k));
  }
}

Shown ShownReader::read(const Word& word, uint32_t cell, uint64_t step) const {
  Slot slot = unpack_particle(plan_, word);
  const uint32_t id = slot.body.id;
  if (id >= plan_.particles)
    throw std::runtime_error(fmt::format("step {}: holds particle {}, of {}", step, id, plan_.particles));
  if (!slot.bonds.empty()) check_bonds(slot, step);
  Shown shown;
  shown.particle = {.id = id,
                    .type = slot.body.type,
                    .cell = cell,
                    .x = position_of(plan_.rule.widths, slot),
                    .v = slot.body.v,
                    .u = slot.u};
  shown.fields = std::move(slot.body.fields);
  if (!bond_begin_.empty()) {
    shown.bonds = std::move(slot.bond_numbers);
    shown.bonds.resize(bond_begin_[id + 1] - bond_begin_[id]);
  }
  return shown;
}

uint64_t ShownReader::hash(const Shown& shown) const {
  return hash_of(plan_.lattice, shown.particle, shown.fields, shown.bonds);
}

void ShownReader::add(const Shown& shown, State& state) const {
  state.particles.push_back(shown.particle);
  state.fields.insert(state.fields.end(), shown.fields.begin(), shown.fields.end());
  if (bond_begin_.empty()) return;
  if (state.bonds.empty()) state.bonds.resize(bond_begin_.back()), state.bond_begin = bond_begin_;
  std::ranges::copy(shown.bonds,
                    state.bonds.begin() + static_cast<ptrdiff_t>(bond_begin_[shown.particle.id]));
}

void sort_by_id(State& state) {
  const size_t numbers = state.fields.size() / std::max<size_t>(1, state.particles.size());
  std::vector<size_t> order(state.particles.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::sort(order, {}, [&](size_t k) { return state.particles[k].id; });
  State sorted{state.step, {}, {}, std::move(state.bonds), std::move(state.bond_begin)};
  for (const size_t k : order) {
    sorted.particles.push_back(state.particles[k]);
    const auto fields = state.fields.begin() + static_cast<ptrdiff_t>(k * numbers);
    sorted.fields.insert(sorted.fields.end(), fields, fields + static_cast<ptrdiff_t>(numbers));
  }
  state = std::move(sorted);
}

}  // namespace cuboct::emu
