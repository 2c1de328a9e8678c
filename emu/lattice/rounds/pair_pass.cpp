// SPDX-License-Identifier: MIT
#include "emu/lattice/rounds/pair_pass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace cuboct::emu {
namespace {

using graph::Graph;
using graph::Node;
using graph::Op;
using graph::Source;

// Those of `early`, constants apart, that `late` or the outputs read.
std::vector<int> read_of(const Graph& graph, const std::vector<int>& early, const std::vector<int>& late,
                         const std::vector<int>& outputs) {
  std::vector<int> read = outputs;
  for (const int n : late) {
    const Node& node = graph.nodes[static_cast<size_t>(n)];
    read.insert(read.end(), node.inputs.begin(), node.inputs.end());
  }
  std::vector<int> kept;
  for (const int n : early)
    if (graph.nodes[static_cast<size_t>(n)].op != Op::constant && std::ranges::count(read, n) > 0)
      kept.push_back(n);
  return kept;
}

std::vector<int> with(std::vector<int> nodes, int node) {
  nodes.push_back(node);
  return nodes;
}

}  // namespace

PairPass::PairPass(const graph::FixedProgram& program, const graph::Round& round, const BondSpace& space,
                   bool once)
    : program_(program),
      round_(round),
      graph_(round.pair),
      space_(space),
      once_(once),
      when_(round.when),
      parts_(round),
      early_inputs_(inputs_of(graph_, parts_.early)),
      late_inputs_(inputs_of(graph_, parts_.late)),
      kept_(read_of(graph_, parts_.early, parts_.late, parts_.outputs)),
      block_(graph_, {parts_.early, parts_.late}, with(parts_.outputs, when_)),
      own_(VectorBlock::kRoom),
      other_(VectorBlock::kRoom),
      chosen_(VectorBlock::kRoom),
      slot_(VectorBlock::kRoom) {
  for (const int n : early_inputs_)
    if (const Node& node = graph_.nodes[static_cast<size_t>(n)]; node.source == Source::apart)
      apart_.emplace_back(static_cast<size_t>(node.axis), block_.values(n));
}

bool PairPass::run(const Scope& scope, BondList& bonds, Sums& sums) {
  for (auto& sum : sums) std::fill_n(sum.data(), sum.size(), 0.0);
  fits_ = true;
  if (space_.rows == nullptr)
    meet_pairs(scope, sums);
  else
    meet_bonds(scope, bonds, sums);
  return fits_;
}

void PairPass::meet_pairs(const Scope& scope, Sums& sums) {
  BondList none;
  const auto all = [&](const PairList& list, size_t k, uint32_t group, bool turned) {
    const uint32_t base = scope.block.begin + group * kGroup;
    if (scope.active.near != nullptr && !any_flag(scope.active.near, scope.particles, base / kGroup)) return;
    const PairList::Group& of = list.groups[k];
    for (uint32_t e = of.begin; e < of.begin + of.near; ++e) {
      if (count_ + 2 * kGroup > VectorBlock::kRoom)
        flush(scope, once_ && turned ? Ends::both : Ends::own, none, sums);
      const size_t from = count_;
      meet(scope, base, list.entries[e]);
      if (turned && !once_) turn(from);
    }
  };
  for (uint32_t k = 0; k < scope.block.groups(); ++k) all(scope.block.inside, k, k, true);
  flush(scope, once_ ? Ends::both : Ends::own, none, sums);
  for (const Edge* edge : {&scope.block.beside, &scope.block.ghosts})
    for (size_t k = 0; k < edge->group.size(); ++k) all(edge->pairs, k, edge->group[k], false);
  flush(scope, Ends::own, none, sums);
}

// From its lower particle's end.
inline void PairPass::meet(const Scope& scope, uint32_t base, const Entry& entry) {
  const Particles& particles = scope.particles;
  const auto& shift = particles.shift[entry.shift];
  const auto first = static_cast<uint32_t>(entry.first);
  if (entry.lanes == 0xff) {
    for (uint32_t l = 0; l < kGroup; ++l) own_[count_ + l] = base + l, other_[count_ + l] = first + l;
    for (const auto& [axis, lanes] : apart_) {
      const double *own = particles.x[axis].data() + base, *other = particles.x[axis].data() + entry.first;
      for (uint32_t l = 0; l < kGroup; ++l) lanes[count_ + l] = other[l] - own[l] + shift[axis];
    }
    count_ += kGroup;
    return;
  }
  for (uint32_t l = 0; l < kGroup; ++l) {
    if ((entry.lanes >> l & 1) == 0) continue;
    own_[count_] = base + l;
    other_[count_] = first + l;
    for (const auto& [axis, lanes] : apart_)
      lanes[count_] = particles.x[axis][first + l] - particles.x[axis][base + l] + shift[axis];
    ++count_;
  }
}

// The lanes from there on again, from the other end.
void PairPass::turn(size_t from) {
  const size_t end = count_;
  for (size_t k = from; k < end; ++k, ++count_) {
    own_[count_] = other_[k];
    other_[count_] = own_[k];
    for (const auto& [axis, lanes] : apart_) lanes[count_] = -lanes[k];
  }
}

void PairPass::meet_bonds(const Scope& scope, BondList& bonds, Sums& sums) {
  for (const Ends ends : {Ends::both, Ends::own}) {
    const std::vector<EntryGroup>& groups = ends == Ends::both ? bonds.both : bonds.own;
    for (uint32_t k = 0; k < scope.block.groups(); ++k) {
      const uint32_t base = scope.block.begin + k * kGroup;
      if (scope.active.near != nullptr && !any_flag(scope.active.near, scope.particles, base / kGroup))
        continue;
      for (uint32_t e = groups[k].begin; e < groups[k].begin + groups[k].count; ++e) {
        if (count_ + kGroup > VectorBlock::kRoom) flush(scope, ends, bonds, sums);
        const Entry& entry = bonds.entries[e];
        for (uint32_t l = 0; l < kGroup; ++l)
          if (entry.lanes >> l & 1) meet_bond(scope, base, entry, l, BondList::slot(e, l), bonds);
      }
    }
    flush(scope, ends, bonds, sums);
  }
}

// Where both are within a cell's edge, their cells are neighbours.
inline void PairPass::meet_bond(const Scope& scope, uint32_t base, const Entry& entry, uint32_t lane,
                                size_t slot, const BondList& bonds) {
  const Particles& particles = scope.particles;
  const uint32_t own = base + lane, other = static_cast<uint32_t>(entry.first) + lane;
  std::array<double, 3> apart;
  bool within = true;
  for (size_t a = 0; a < 3; ++a) {
    apart[a] = particles.x[a][other] - particles.x[a][own] + particles.shift[entry.shift][a];
    within = within && std::abs(apart[a]) < space_.cell;
  }
  if (!within && !space_.meets({particles.x[0][own], particles.x[1][own], particles.x[2][own]}, apart)) {
    fits_ = fits_ && bonds.is_broken(program_, space_, slot);
    return;
  }
  own_[count_] = own;
  other_[count_] = other;
  slot_[count_] = slot;
  for (const auto& [axis, lanes] : apart_) lanes[count_] = apart[axis];
  ++count_;
}

void PairPass::write_bonds(const Scope& scope, size_t lanes, BondList& bonds) {
  for (const graph::Write& write : round_.bond_writes) {
    const double* value = block_.values(write.node);
    PaddedArray<double>& to =
        bonds.numbers[static_cast<size_t>(program_.bond_place(write.field) + write.component)];
    for (size_t k = 0; k < lanes; ++k) {
      if (scope.active.changed != nullptr && to[slot_[k]] != value[k])
        for (const uint32_t end : {own_[k], other_[k]}) scope.active.mark(scope.particles.cell[end]);
      to[slot_[k]] = value[k];
    }
  }
}

void PairPass::repeat_first(const std::vector<int>& nodes, size_t lanes) {
  const size_t end = VectorBlock::padded(lanes);
  for (auto* index : {&own_, &other_}) std::fill(index->data() + lanes, index->data() + end, (*index)[0]);
  std::fill(slot_.data() + lanes, slot_.data() + end, slot_[0]);
  for (const int n : nodes) {
    double* values = block_.values(n);
    std::fill(values + lanes, values + end, values[0]);
  }
}

void PairPass::flush(const Scope& scope, Ends ends, BondList& bonds, Sums& sums) {
  if (count_ == 0) return;
  repeat_first(early_inputs_, count_);
  fill(scope, early_inputs_, count_, bonds);
  fits_ = block_.run(0, count_) && fits_;
  if (const size_t lanes = choose(count_); lanes > 0) {
    fill(scope, late_inputs_, lanes, bonds);
    fits_ = block_.run(1, lanes) && fits_;
    add(scope, ends, lanes, sums);
    write_bonds(scope, lanes, bonds);
  }
  count_ = 0;
}

// The lanes that count move to the front.
size_t PairPass::choose(size_t lanes) {
  const double* when = block_.values(when_);
  size_t count = 0;
  for (size_t k = 0; k < lanes; ++k) {
    chosen_[count] = static_cast<uint32_t>(k);
    count += when[k] != 0;
  }
  if (count == lanes || count == 0) return count;
  const auto move = [&](auto* values) {
    for (size_t k = 0; k < count; ++k) values[k] = values[chosen_[k]];
  };
  move(own_.data());
  move(other_.data());
  move(slot_.data());
  for (const int n : kept_) move(block_.values(n));
  repeat_first(kept_, count);
  return count;
}

void PairPass::fill(const Scope& scope, const std::vector<int>& inputs, size_t lanes, const BondList& bonds) {
  const Particles& particles = scope.particles;
  const size_t padded = VectorBlock::padded(lanes);
  const auto types = static_cast<size_t>(program_.types);
  for (const int n : inputs) {
    const Node& node = graph_.nodes[static_cast<size_t>(n)];
    const auto axis = static_cast<size_t>(node.axis), index = static_cast<size_t>(node.index);
    double* __restrict out = block_.values(n);
    const uint32_t *own = own_.data(), *other = other_.data();
    const auto each = [&](auto value) {
      for (size_t k = 0; k < padded; ++k) out[k] = static_cast<double>(value(k));
    };
    const auto of = [&](const PaddedArray<double>& values, const uint32_t* whose) {
      each([from = values.data(), whose](size_t k) { return from[whose[k]]; });
    };
    const auto field = [&]() -> const PaddedArray<double>& {
      return particles.fields[static_cast<size_t>(program_.place(node.index)) + axis];
    };
    switch (node.source) {
      case Source::apart:
        break;  // meet() has it
      case Source::own_v:
        of(particles.v[axis], own);
        break;
      case Source::other_v:
        of(particles.v[axis], other);
        break;
      case Source::own_field:
        of(field(), own);
        break;
      case Source::other_field:
        of(field(), other);
        break;
      case Source::own_constant:
        each([&](size_t k) { return program_.type_constants[index].values[particles.type[own[k]]]; });
        break;
      case Source::other_constant:
        each([&](size_t k) { return program_.type_constants[index].values[particles.type[other[k]]]; });
        break;
      case Source::pair_constant:
        each([&](size_t k) {
          return program_.pair_constants[index]
              .values[particles.type[own[k]] * types + particles.type[other[k]]];
        });
        break;
      case Source::own_id:
        each([&](size_t k) { return particles.id_of(own[k]); });
        break;
      case Source::other_id:
        each([&](size_t k) { return particles.id_of(other[k]); });
        break;
      case Source::step:
        each([&](size_t) { return scope.step; });
        break;
      case Source::bond_field: {
        const auto place = static_cast<size_t>(program_.bond_place(node.index)) + axis;
        each([from = bonds.numbers[place].data(), this](size_t k) { return from[slot_[k]]; });
        break;
      }
      case Source::bond_constant: {
        const size_t numbers = program_.bond_constants.size();
        each([&](size_t k) { return space_.rows->constants[bonds.kind[slot_[k]] * numbers + index]; });
        break;
      }
      default:
        throw std::logic_error(std::string("a pair has no ") + to_string(node.source));
    }
  }
}

// Whole numbers below 2^51 in any order.
void PairPass::add(const Scope& scope, Ends ends, size_t lanes, Sums& sums) {
  const uint32_t begin = scope.block.begin;
  for (size_t t = 0; t < parts_.terms.size(); ++t) {
    const double* term = block_.values(parts_.terms[t]);
    double* sum = sums[t].data();
    for (size_t k = 0; k < lanes; ++k) sum[own_[k] - begin] += term[k];
    if (ends == Ends::own) continue;
    for (size_t k = 0; k < lanes; ++k) sum[other_[k] - begin] += parts_.signs[t] * term[k];
  }
}

}  // namespace cuboct::emu
