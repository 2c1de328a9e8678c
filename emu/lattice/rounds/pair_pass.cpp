// SPDX-License-Identifier: MIT
#include "emu/lattice/rounds/pair_pass.h"

#include <algorithm>
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

PairPass::PairPass(const graph::FixedProgram& program, const graph::Round& round)
    : program_(program),
      round_(round),
      graph_(round.pair),
      when_(round.when),
      parts_(round),
      early_inputs_(inputs_of(graph_, parts_.early)),
      late_inputs_(inputs_of(graph_, parts_.late)),
      kept_(read_of(graph_, parts_.early, parts_.late, parts_.outputs)),
      block_(graph_, {parts_.early, parts_.late}, with(parts_.outputs, when_), true),
      own_(VectorBlock::kRoom),
      other_(VectorBlock::kRoom),
      own_place_(VectorBlock::kRoom),
      other_place_(VectorBlock::kRoom),
      chosen_(VectorBlock::kRoom),
      slot_(VectorBlock::kRoom),
      entry_(VectorBlock::kRoom) {
  for (const int n : early_inputs_)
    if (const Node& node = graph_.nodes[static_cast<size_t>(n)]; node.source == Source::apart)
      apart_.emplace_back(static_cast<size_t>(node.axis), block_.values(n));
}

void PairPass::run(const Job& job, Ends ends) {
  for (uint32_t n = 0; n < job.count; ++n) {
    const uint32_t g = job.chosen != nullptr ? job.chosen[n] : job.first + n;
    const uint32_t group = job.group_of != nullptr ? job.group_of[g] : g;
    if (job.wanted != nullptr && job.wanted[group] == 0) continue;
    const uint32_t place = (job.group_of != nullptr ? g : group) * kGroup & job.mask;
    const EntryGroup of = job.groups[g];
    for (uint32_t e = of.begin; e != of.begin + of.near; ++e) {
      if (count_ + kGroup > VectorBlock::kRoom) flush(job, ends);
      const size_t from = count_;
      meet(job, place, job.begin + group * kGroup, job.entries[e], uint64_t{e} * kGroup, ends);
      if (ends == Ends::other) turn(from);
    }
  }
  flush(job, ends);
}

// From its lower particle's end.
inline void PairPass::meet(const Job& job, uint32_t place, uint32_t base, const Entry& entry, uint64_t slot,
                           Ends ends) {
  const double* const shift = job.shift[entry.shift];
  const auto first = static_cast<uint32_t>(entry.first);
  for (uint32_t l = 0; l < kGroup; ++l) {
    if ((entry.lanes >> l & 1) == 0) continue;
    const size_t k = count_;
    own_[k] = base + l, other_[k] = first + l;
    own_place_[k] = place + l;
    other_place_[k] = ends == Ends::own ? 0 : (first + l - job.begin) & job.mask;
    slot_[k] = slot + l;
    entry_[k] = &entry;
    for (const auto& [axis, lanes] : apart_)
      lanes[k] = job.x[axis][other_[k]] - job.x[axis][own_[k]] + shift[axis];
    if (!program_.bonded || meet_bond(job, k, entry)) ++count_;
  }
}

// Where both are within a cell's edge, their cells are neighbours.
inline bool PairPass::meet_bond(const Job& job, size_t k, const Entry& entry) {
  double apart[3];
  bool within = true;
  for (size_t a = 0; a < 3; ++a) {
    apart[a] = job.x[a][other_[k]] - job.x[a][own_[k]] + job.shift[entry.shift][a];
    within = within && std::abs(apart[a]) < job.cell;
  }
  if (within) return true;
  if (!job.meet(job.owner, own_[k], other_[k], slot_[k], apart)) return false;
  for (const auto& [axis, lanes] : apart_) lanes[k] = apart[axis];
  return true;
}

// The lanes from there on become those from the other end.
void PairPass::turn(size_t from) {
  for (size_t k = from; k < count_; ++k) {
    std::swap(own_[k], other_[k]);
    std::swap(own_place_[k], other_place_[k]);
    for (const auto& [axis, lanes] : apart_) lanes[k] = -lanes[k];
  }
}

void PairPass::write_bonds(const Job& job, size_t lanes) const {
  for (const graph::Write& write : round_.bond_writes) {
    const double* value = block_.values(write.node);
    double* const to = job.bonds[program_.bond_place(write.field) + write.component];
    for (size_t k = 0; k < lanes; ++k) {
      if (job.changed != nullptr && to[slot_[k]] != value[k]) job.changed(job.owner, own_[k], other_[k]);
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

void PairPass::flush(const Job& job, Ends ends) {
  if (count_ == 0) return;
  repeat_first(early_inputs_, count_);
  fill(job, early_inputs_, count_);
  bool fits = block_.run(0, count_);
  if (const size_t lanes = choose(count_); lanes > 0) {
    fill(job, late_inputs_, lanes);
    fits = block_.run(1, lanes) && fits;
    if (!fits) tell_misfits(job, ends, lanes);
    add(job, ends, lanes);
    write_bonds(job, lanes);
  }
  count_ = 0;
}

// Some pair of these has a check that failed. An entry is told from its lower end.
void PairPass::tell_misfits(const Job& job, Ends ends, size_t lanes) const {
  const auto &lower = ends == Ends::other ? other_ : own_, &higher = ends == Ends::other ? own_ : other_;
  for (size_t k = 0; k < lanes; ++k) job.misfit(job.owner, lower[k], higher[k], *entry_[k], slot_[k]);
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
  for (auto* index : {&own_, &other_, &own_place_, &other_place_}) move(index->data());
  move(slot_.data());
  move(entry_.data());
  for (const int n : kept_) move(block_.values(n));
  repeat_first(kept_, count);
  return count;
}

void PairPass::fill(const Job& job, const std::vector<int>& inputs, size_t lanes) {
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
    const auto of = [&](const double* from, const uint32_t* whose) {
      each([from, whose](size_t k) { return from[whose[k]]; });
    };
    const auto field = [&] { return job.fields[static_cast<size_t>(program_.place(node.index)) + axis]; };
    const auto id = [&](uint32_t p) { return job.id != nullptr ? job.id[p] : p; };
    switch (node.source) {
      case Source::apart:
        break;  // meet() has it
      case Source::own_v:
        of(job.v[axis], own);
        break;
      case Source::other_v:
        of(job.v[axis], other);
        break;
      case Source::own_field:
        of(field(), own);
        break;
      case Source::other_field:
        of(field(), other);
        break;
      case Source::own_constant:
        each([&](size_t k) { return program_.type_constants[index].values[job.type[own[k]]]; });
        break;
      case Source::other_constant:
        each([&](size_t k) { return program_.type_constants[index].values[job.type[other[k]]]; });
        break;
      case Source::pair_constant:
        each([&](size_t k) {
          return program_.pair_constants[index].values[job.type[own[k]] * types + job.type[other[k]]];
        });
        break;
      case Source::own_id:
        each([&](size_t k) { return id(own[k]); });
        break;
      case Source::other_id:
        each([&](size_t k) { return id(other[k]); });
        break;
      case Source::step:
        each([&](size_t) { return job.step; });
        break;
      case Source::bond_field: {
        const auto place = static_cast<size_t>(program_.bond_place(node.index)) + axis;
        each([from = job.bonds[place], this](size_t k) { return from[slot_[k]]; });
        break;
      }
      case Source::bond_constant: {
        const size_t numbers = program_.bond_constants.size();
        each([&](size_t k) { return job.bond_constants[job.kind[slot_[k]] * numbers + index]; });
        break;
      }
      default:
        throw std::logic_error(std::string("a pair has no ") + to_string(node.source));
    }
  }
}

// Whole numbers below 2^51 in any order.
void PairPass::add(const Job& job, Ends ends, size_t lanes) const {
  for (size_t t = 0; t < parts_.terms.size(); ++t) {
    const double* term = block_.values(parts_.terms[t]);
    double* sum = job.sums[t];
    for (size_t k = 0; k < lanes; ++k) sum[own_place_[k]] += term[k];
    if (ends != Ends::both) continue;
    for (size_t k = 0; k < lanes; ++k) sum[other_place_[k]] += parts_.signs[t] * term[k];
  }
}

}  // namespace cuboct::emu
