// SPDX-License-Identifier: MIT
#include "model/contract/program_run.h"

#include <numeric>
#include <stdexcept>

namespace cuboct {
namespace {

using graph::FixedProgram;
using graph::Node;
using graph::Op;
using graph::Source;

size_t at(int k) { return static_cast<size_t>(k); }

// What is the same for all pairs of a particle, and for a particle alone.
int64_t own_value(const FixedProgram& program, const Node& node, const Seen& own, uint64_t step) {
  const auto axis = at(node.axis);
  switch (node.source) {
    case Source::own_x:
      return own.particle->x[axis];
    case Source::own_v:
      return own.particle->v[axis];
    case Source::own_u:
      return own.particle->u[axis];
    case Source::own_constant:
      return program.type_constants[at(node.index)].values[own.particle->type];
    case Source::own_field:
      return own.fields[program.place(node.index) + node.axis];
    case Source::own_id:
      return own.particle->id;
    case Source::step:
      return static_cast<int64_t>(step);
    default:
      throw std::logic_error(std::string("golden has no ") + to_string(node.source));
  }
}

// Of each partner in turn; `partner(k)` is that of lane k.
template <class Partner>
void fill_input(const FixedProgram& program, const Node& node, const Seen& own, uint64_t step, size_t lanes,
                int64_t* out, Partner partner) {
  const auto axis = at(node.axis);
  const auto each = [&](auto value) {
    for (size_t k = 0; k < lanes; ++k) out[k] = value(partner(k));
  };
  switch (node.source) {
    case Source::apart:
      return each([&, x = own.x[axis]](const Seen& j) { return j.x[axis] - x; });
    case Source::other_v:
      return each([&](const Seen& j) { return j.particle->v[axis]; });
    case Source::other_id:
      return each([&](const Seen& j) { return int64_t{j.particle->id}; });
    case Source::other_field:
      return each([&, n = program.place(node.index) + node.axis](const Seen& j) { return j.fields[n]; });
    case Source::other_constant:
      return each([&, c = program.type_constants[at(node.index)].values.data()](const Seen& j) {
        return c[j.particle->type];
      });
    case Source::bond_field:
      return each([&, n = program.bond_place(node.index) + node.axis](const Seen& j) { return j.bond[n]; });
    case Source::bond_constant:
      return each([&](const Seen& j) { return j.bond_constants[node.index]; });
    case Source::pair_constant:
      return each(
          [&, row = program.pair_constants[at(node.index)].values.data() +
                    at(own.particle->type * program.types)](const Seen& j) { return row[j.particle->type]; });
    default:
      std::fill_n(out, lanes, own_value(program, node, own, step));
  }
}

}  // namespace

bool is_broken(const FixedProgram& program, const Seen& bond) {
  if (program.broken_at < 0) return false;
  const graph::Graph& graph = program.broken;
  graph::Block<int64_t> block(graph, 1);
  const std::vector<int> nodes = needed_by(graph, {program.broken_at});
  for (const int n : nodes)
    if (graph.nodes[at(n)].op == Op::input)
      fill_input(program, graph.nodes[at(n)], {}, 0, 1, block.values(n),
                 [&](size_t) -> const Seen& { return bond; });
  block.run(nodes, 1);
  return block.values(program.broken_at)[0] != 0;
}

PairRun::PairRun(const FixedProgram& program, const graph::Round& round, uint64_t step, size_t room)
    : program_(program),
      round_(round),
      graph_(round.pair),
      step_(step),
      room_(room),
      when_(round.when),
      terms_(terms_of(round)),
      block_(round.pair, room) {
  std::vector<bool> early(graph_.nodes.size()), kept(graph_.nodes.size());
  for (const int n : needed_by(graph_, {when_})) {
    early[at(n)] = true;
    (graph_.nodes[at(n)].op == Op::input ? early_inputs_ : early_).push_back(n);
  }
  const std::vector<int> outputs = pair_outputs(round);
  const auto keep = [&](int n) { kept[at(n)] = early[at(n)] && graph_.nodes[at(n)].op != Op::constant; };
  for (const int n : outputs) keep(n);
  for (const int n : needed_by(graph_, outputs)) {
    if (early[at(n)]) continue;
    for (const int input : graph_.nodes[at(n)].inputs) keep(input);
    (graph_.nodes[at(n)].op == Op::input ? late_inputs_ : late_).push_back(n);
  }
  for (int n = 0; n < static_cast<int>(kept.size()); ++n)
    if (kept[at(n)]) kept_.push_back(n);
}

void PairRun::add(const Seen& own, std::span<const Seen> partners, std::span<int64_t> sums) {
  faults_.clear();
  counted_ = 0;
  for (size_t k = 0; k < partners.size(); k += room_)
    add_block(own, partners.subspan(k, std::min(room_, partners.size() - k)), sums);
}

void PairRun::fill(const std::vector<int>& inputs, const Seen& own, std::span<const Seen> partners,
                   std::span<const uint32_t> chosen) {
  for (const int n : inputs) {
    const Node& node = graph_.nodes[at(n)];
    if (chosen.empty())
      fill_input(program_, node, own, step_, partners.size(), block_.values(n),
                 [&](size_t k) -> const Seen& { return partners[k]; });
    else
      fill_input(program_, node, own, step_, chosen.size(), block_.values(n),
                 [&](size_t k) -> const Seen& { return partners[chosen[k]]; });
  }
}

void PairRun::add_block(const Seen& own, std::span<const Seen> partners, std::span<int64_t> sums) {
  fill(early_inputs_, own, partners, {});
  block_.run(early_, partners.size());
  const int64_t* when = block_.values(when_);
  chosen_.clear();
  for (uint32_t k = 0; k < partners.size(); ++k)
    if (when[k] && partners[k].particle != own.particle) chosen_.push_back(k);
  counted_ += chosen_.size();
  if (chosen_.empty()) return;
  block_.compress(kept_, chosen_);
  fill(late_inputs_, own, partners, chosen_);
  block_.clear_faults();
  block_.run(late_, chosen_.size());
  for (size_t t = 0; t < terms_.size(); ++t) {
    const int64_t* term = block_.values(terms_[t]);
    sums[t] = std::accumulate(term, term + chosen_.size(), sums[t]);
  }
  for (const graph::Write& write : round_.bond_writes) {
    const int64_t* value = block_.values(write.node);
    const int place = program_.bond_place(write.field) + write.component;
    for (size_t k = 0; k < chosen_.size(); ++k) partners[chosen_[k]].bond[place] = value[k];
  }
  faults_.insert(faults_.end(), block_.faults().begin(), block_.faults().end());
}

FinishRun::FinishRun(const FixedProgram& program, const graph::Round& round, uint64_t step, size_t room)
    : program_(program),
      round_(round),
      step_(step),
      nodes_(needed_by(round.finish, finish_outputs(program, round))),
      block_(round.finish, room) {}

void FinishRun::run(std::span<const Seen> particles, std::span<const int64_t> sums) {
  for (const int n : nodes_) {
    const Node& node = round_.finish.nodes[at(n)];
    if (node.op != Op::input) continue;
    int64_t* out = block_.values(n);
    const bool sum = node.source == Source::sum;
    const size_t numbers = at(round_.numbers()), place = sum ? at(round_.place(node.index) + node.axis) : 0;
    for (size_t k = 0; k < particles.size(); ++k)
      out[k] = sum ? sums[k * numbers + place] : own_value(program_, node, particles[k], step_);
  }
  block_.clear_faults();
  block_.run(nodes_, particles.size());
}

}  // namespace cuboct
