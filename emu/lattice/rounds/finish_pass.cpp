// SPDX-License-Identifier: MIT
#include "emu/lattice/rounds/finish_pass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "emu/lattice/kernel_rule.h"

namespace cuboct::emu {
namespace {

using graph::Node;
using graph::Op;
using graph::Source;

// The drift is exact: what the residue and the drift make together of visible units goes to x. True where
// something changed; `away` gets the cells that it moved.
bool move_along(const FinishJob& job, size_t a, uint32_t p, double v, double drift, int8_t& away) {
  const double exact = job.residue[a][p] + drift, whole = std::floor(exact * job.inverse_guard);
  const auto left = static_cast<int32_t>(exact - whole * job.guard);
  const double old_x = job.x[a][p], x = old_x + whole;
  away = static_cast<int8_t>(std::floor(x * job.inverse_edge) - std::floor(old_x * job.inverse_edge));
  const bool changed = whole != 0 || left != job.residue[a][p] || v != job.v[a][p];
  job.x[a][p] = x, job.residue[a][p] = left, job.v[a][p] = v;
  return changed;
}

bool displace(const FinishJob& job, size_t a, uint32_t p, double u) {
  if (job.u[a] == nullptr) return false;
  const bool changed = job.u[a][p] != u;
  job.u[a][p] = u;
  return changed;
}

}  // namespace

FinishPass::FinishPass(const graph::FixedProgram& program, const graph::Round& round)
    : program_(program),
      round_(round),
      nodes_(needed_by(round.finish, finish_outputs(program, round))),
      block_(round.finish, {nodes_}, finish_outputs(program, round)) {
  for (const int n : nodes_)
    if (round.finish.nodes[static_cast<size_t>(n)].op == Op::input) inputs_.push_back(n);
}

void FinishPass::run(const FinishJob& job) {
  who_.clear();
  for (uint32_t n = 0; n < job.count; ++n) {
    const uint32_t base = job.begin + (job.chosen != nullptr ? job.chosen[n] : job.first + n) * kGroup;
    for (uint32_t p = base; p < std::min(base + kGroup, job.end); ++p)
      if (job.awake == nullptr || job.awake[job.cell[p]] != 0) who_.push_back(p);
  }
  if (who_.empty()) return;
  fill(job);
  if (block_.run(0, who_.size()))
    write(job);
  else
    for (const uint32_t p : who_) job.misfit(job.owner, p, 1);
}

void FinishPass::write(const FinishJob& job) const {
  const graph::Motion& motion = program_.motion;
  const bool last = &round_ == &program_.rounds.back();
  for (size_t k = 0; k < who_.size(); ++k) {
    const uint32_t p = who_[k];
    bool changed = false;
    for (const graph::Write& write : round_.writes) {
      double& to = job.fields[program_.place(write.field) + write.component][p];
      const double value = block_.values(write.node)[k];
      changed |= to != value;
      to = value;
    }
    std::array<int8_t, 3> away{};
    double speed2 = 0;
    for (size_t a = 0; last && a < motion.v.size(); ++a) {
      const double v = block_.values(motion.v[a])[k];
      changed |= move_along(job, a, p, v, block_.values(motion.drift[a])[k], away[a]);
      changed |= displace(job, a, p, motion.u.empty() ? 0.0 : block_.values(motion.u[a])[k]);
      speed2 += v * v;
    }
    *job.fastest2 = std::max(*job.fastest2, speed2);
    if (away != std::array<int8_t, 3>{}) job.crossed(job.owner, p, away.data());
    if (changed && job.changed != nullptr) job.changed(job.owner, p);
  }
}

void FinishPass::fill(const FinishJob& job) {
  const size_t lanes = who_.size();
  for (const int n : inputs_) {
    const Node& node = round_.finish.nodes[static_cast<size_t>(n)];
    const auto axis = static_cast<size_t>(node.axis), index = static_cast<size_t>(node.index);
    double* out = block_.values(n);
    const auto each = [&](auto value) {
      for (size_t k = 0; k < lanes; ++k) out[k] = static_cast<double>(value(who_[k]));
    };
    const auto copy = [&](const double* from) { each([from](uint32_t p) { return from[p]; }); };
    switch (node.source) {
      case Source::sum:
        each([&, sum = job.sums[static_cast<size_t>(round_.place(node.index)) + axis]](uint32_t p) {
          return sum[(p - job.begin) & job.mask] - kMagic;
        });
        break;
      case Source::own_x:
        each([&](uint32_t p) {
          const double x = job.x[axis][p];
          return (x - std::floor(x * job.inverse_edge) * job.edge) * job.guard + job.residue[axis][p];
        });
        break;
      case Source::own_v:
        copy(job.v[axis]);
        break;
      case Source::own_u:
        if (job.u[axis] == nullptr)
          std::fill_n(out, lanes, 0.0);
        else
          copy(job.u[axis]);
        break;
      case Source::own_field:
        copy(job.fields[static_cast<size_t>(program_.place(node.index)) + axis]);
        break;
      case Source::own_constant:
        each([&](uint32_t p) { return program_.type_constants[index].values[job.type[p]]; });
        break;
      case Source::own_id:
        each([&](uint32_t p) { return job.id != nullptr ? job.id[p] : p; });
        break;
      case Source::step:
        each([&](uint32_t) { return job.step; });
        break;
      default:
        throw std::logic_error(std::string("a finish has no ") + to_string(node.source));
    }
    std::fill(out + lanes, out + VectorBlock::padded(lanes), out[0]);
  }
}

}  // namespace cuboct::emu
