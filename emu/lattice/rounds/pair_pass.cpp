// SPDX-License-Identifier: MIT
#include "emu/lattice/rounds/pair_pass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "model/contract/program_run.h"
#include "model/graph/parity.h"

namespace cuboct::emu {
namespace {

using graph::Graph;
using graph::Node;
using graph::Op;
using graph::Source;

bool is_input(const Graph& graph, int n) { return graph.nodes[static_cast<size_t>(n)].op == Op::input; }

std::vector<int> all_terms(const graph::Round& round) {
  std::vector<int> terms;
  for (const graph::Sum& sum : round.sums) terms.insert(terms.end(), sum.terms.begin(), sum.terms.end());
  return terms;
}

// All that a pair's graph is run for.
std::vector<int> all_outputs(const graph::Round& round) {
  std::vector<int> outputs = all_terms(round);
  for (const graph::Write& write : round.bond_writes) outputs.push_back(write.node);
  return outputs;
}

std::vector<int> inputs_of(const Graph& graph, const std::vector<int>& nodes) {
  std::vector<int> inputs;
  std::ranges::copy_if(nodes, std::back_inserter(inputs), [&](int n) { return is_input(graph, n); });
  return inputs;
}

// What the terms need beside these.
std::vector<int> beyond(const Graph& graph, const std::vector<int>& terms, const std::vector<int>& early) {
  std::vector<int> late;
  std::ranges::set_difference(needed_by(graph, terms), early, std::back_inserter(late));
  return late;
}

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

// What `when` needs, and the differences of positions: a row is followed once.
std::vector<int> early_nodes(const graph::Round& round, const std::vector<int>& terms) {
  std::vector<int> roots{round.when};
  for (const int n : needed_by(round.pair, terms))
    if (const Node& node = round.pair.nodes[static_cast<size_t>(n)];
        node.op == Op::input && node.source == Source::apart)
      roots.push_back(n);
  return needed_by(round.pair, roots);
}

// By term: of the other end.
std::vector<double> signs_of(const graph::Round& round) {
  const std::vector<graph::Parity> parity = parities_of(round.pair);
  std::vector<double> signs;
  for (const int term : all_terms(round)) signs.push_back(is_odd(parity[static_cast<size_t>(term)]) ? -1 : 1);
  return signs;
}

std::vector<int> with(std::vector<int> nodes, int node) {
  nodes.push_back(node);
  return nodes;
}

}  // namespace

bool PairPass::is_mutual(const graph::Round& round) {
  const std::vector<graph::Parity> parity = parities_of(round.pair);
  const auto mutual = [&](int node) {
    return is_odd(parity[static_cast<size_t>(node)]) || is_even(parity[static_cast<size_t>(node)]);
  };
  return mutual(round.when) && std::ranges::all_of(all_terms(round), mutual);
}

PairPass::PairPass(const graph::FixedProgram& program, const graph::Round& round, bool once)
    : program_(program),
      round_(round),
      graph_(round.pair),
      when_(round.when),
      terms_(all_terms(round)),
      signs_(once ? signs_of(round) : std::vector<double>()),
      early_(early_nodes(round, all_outputs(round))),
      late_(beyond(graph_, all_outputs(round), early_)),
      early_inputs_(inputs_of(graph_, early_)),
      late_inputs_(inputs_of(graph_, late_)),
      kept_(read_of(graph_, early_, late_, all_outputs(round))),
      block_(graph_, {early_, late_}, with(all_outputs(round), when_)),
      own_(VectorBlock::kRoom),
      other_(VectorBlock::kRoom),
      chosen_(VectorBlock::kRoom),
      bond_(VectorBlock::kRoom) {
  for (const int n : early_inputs_)
    if (const Node& node = graph_.nodes[static_cast<size_t>(n)]; node.source == Source::apart)
      apart_.emplace_back(static_cast<size_t>(node.axis), block_.values(n));
}

bool PairPass::run(const Particles& particles, const PartnerList& list, const Block& block,
                   const Active& active, uint64_t step, std::vector<PaddedArray<double>>& sums,
                   const Bonds& bonds) {
  for (auto& sum : sums) std::fill(sum.data() + block.begin, sum.data() + block.end, 0.0);
  fits_ = true;
  const uint8_t* wanted = signs_.empty() ? active.awake : active.near;
  for (uint32_t i = block.begin; i < block.end; ++i) {
    if (wanted != nullptr && wanted[particles.cell[i]] == 0) continue;
    const PartnerList::Row& row = list.row(i - block.begin);
    for (uint32_t k = row.begin; k < row.near;) {
      const uint32_t end = std::min(row.near, k + static_cast<uint32_t>(VectorBlock::kRoom - count_));
      if (bonds.rows == nullptr)
        for (; k < end; ++k) meet(particles, i, list.partners()[k]);
      else
        for (; k < end; ++k)
          meet_bond(particles, i, Partner::index(list.partners()[k]), row.bond + (k - row.begin), bonds);
      if (count_ == VectorBlock::kRoom) flush(particles, block, active, step, sums, bonds);
    }
  }
  flush(particles, block, active, step, sums, bonds);
  return fits_;
}

inline void PairPass::meet(const Particles& particles, uint32_t own, uint32_t partner) {
  const uint32_t other = Partner::index(partner);
  own_[count_] = own;
  other_[count_] = other;
  const auto& shift = particles.shift[Partner::shift(partner)];
  for (const auto& [axis, lanes] : apart_)
    lanes[count_] = particles.x[axis][other] - particles.x[axis][own] + shift[axis];
  ++count_;
}

// Of the partner's images the one in the 27 cells around own. Where both are within a cell's edge, their
// cells are neighbours.
inline void PairPass::meet_bond(const Particles& particles, uint32_t own, uint32_t other, uint64_t bond,
                                const Bonds& bonds) {
  std::array<double, 3> apart;
  bool met = true;
  for (size_t a = 0; a < 3; ++a) {
    apart[a] = particles.x[a][other] - particles.x[a][own];
    if (bonds.period[a] > 0) apart[a] -= std::round(apart[a] / bonds.period[a]) * bonds.period[a];
    if (std::abs(apart[a]) < bonds.cell) continue;
    const double x = particles.x[a][own];
    met = met && std::abs(std::floor((x + apart[a]) / bonds.cell) - std::floor(x / bonds.cell)) <= 1;
  }
  if (!met) {
    fits_ = fits_ && is_broken(bond, bonds);
    return;
  }
  own_[count_] = own;
  other_[count_] = other;
  bond_[count_] = bond;
  for (const auto& [axis, lanes] : apart_) lanes[count_] = apart[axis];
  ++count_;
}

// Rare: golden's own.
bool PairPass::is_broken(uint64_t bond, const Bonds& bonds) {
  std::vector<int64_t> numbers;
  for (const auto& values : *bonds.numbers) numbers.push_back(static_cast<int64_t>(values[bond]));
  const auto constants =
      bonds.rows->constants.data() + bonds.rows->kind[bond] * program_.bond_constants.size();
  return cuboct::is_broken(program_, {.bond = numbers.data(), .bond_constants = constants});
}

void PairPass::write_bonds(size_t lanes, const Particles& particles, const Active& active,
                           const Bonds& bonds) {
  for (const graph::Write& write : round_.bond_writes) {
    const double* value = block_.values(write.node);
    PaddedArray<double>& to =
        (*bonds.numbers)[static_cast<size_t>(program_.bond_place(write.field) + write.component)];
    for (size_t k = 0; k < lanes; ++k) {
      if (active.changed != nullptr && to[bond_[k]] != value[k]) active.mark(particles.cell[own_[k]]);
      to[bond_[k]] = value[k];
    }
  }
}

void PairPass::repeat_first(const std::vector<int>& nodes, size_t lanes) {
  const size_t end = VectorBlock::padded(lanes);
  for (auto* index : {&own_, &other_}) std::fill(index->data() + lanes, index->data() + end, (*index)[0]);
  std::fill(bond_.data() + lanes, bond_.data() + end, bond_[0]);
  for (const int n : nodes) {
    double* values = block_.values(n);
    std::fill(values + lanes, values + end, values[0]);
  }
}

void PairPass::flush(const Particles& particles, const Block& block, const Active& active, uint64_t step,
                     std::vector<PaddedArray<double>>& sums, const Bonds& bonds) {
  if (count_ == 0) return;
  repeat_first(early_inputs_, count_);
  fill(early_inputs_, particles, count_, step, bonds);
  fits_ = block_.run(0, count_) && fits_;
  if (const size_t lanes = choose(count_); lanes > 0) {
    fill(late_inputs_, particles, lanes, step, bonds);
    fits_ = block_.run(1, lanes) && fits_;
    add(lanes, block, sums);
    write_bonds(lanes, particles, active, bonds);
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
  move(bond_.data());
  for (const int n : kept_) move(block_.values(n));
  repeat_first(kept_, count);
  return count;
}

void PairPass::fill(const std::vector<int>& inputs, const Particles& particles, size_t lanes, uint64_t step,
                    const Bonds& bonds) {
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
        each([&](size_t) { return step; });
        break;
      case Source::bond_field: {
        const auto place = static_cast<size_t>(program_.bond_place(node.index)) + axis;
        each([from = (*bonds.numbers)[place].data(), this](size_t k) { return from[bond_[k]]; });
        break;
      }
      case Source::bond_constant: {
        const graph::BondRows& rows = *bonds.rows;
        const size_t numbers = program_.bond_constants.size();
        each([&](size_t k) { return rows.constants[rows.kind[bond_[k]] * numbers + index]; });
        break;
      }
      default:
        throw std::logic_error(std::string("a pair has no ") + to_string(node.source));
    }
  }
}

// Pairs of one particle stand together. Whole numbers below 2^51 in any order.
void PairPass::add(size_t lanes, const Block& block, std::vector<PaddedArray<double>>& sums) {
  for (size_t begin = 0, end; begin < lanes; begin = end) {
    const uint32_t own = own_[begin];
    for (end = begin + 1; end < lanes && own_[end] == own;) ++end;
    for (size_t t = 0; t < terms_.size(); ++t) {
      const double* term = block_.values(terms_[t]);
      std::array<double, 4> part{sums[t][own], 0, 0, 0};
      size_t k = begin;
      for (; k + 4 <= end; k += 4)
        for (size_t way = 0; way < 4; ++way) part[way] += term[k + way];
      for (; k < end; ++k) part[0] += term[k];
      sums[t][own] = part[0] + part[1] + part[2] + part[3];
    }
  }
  for (size_t t = 0; t < signs_.size(); ++t) {
    const double* term = block_.values(terms_[t]);
    double* sum = sums[t].data();
    for (size_t k = 0; k < lanes; ++k)
      if (other_[k] >= block.begin && other_[k] < block.end) sum[other_[k]] += signs_[t] * term[k];
  }
}

}  // namespace cuboct::emu
