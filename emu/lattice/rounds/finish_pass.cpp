// SPDX-License-Identifier: MIT
#include "emu/lattice/rounds/finish_pass.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace cuboct::emu {
namespace {

using graph::Node;
using graph::Op;
using graph::Source;

}  // namespace

FinishPass::FinishPass(const graph::FixedProgram& program, const graph::Round& round, const KernelRule& rule)
    : program_(program),
      round_(round),
      rule_(rule),
      nodes_(needed_by(round.finish, finish_outputs(program, round))),
      block_(round.finish, {nodes_}, finish_outputs(program, round)) {
  for (const int n : nodes_)
    if (round.finish.nodes[static_cast<size_t>(n)].op == Op::input) inputs_.push_back(n);
}

bool FinishPass::run(Particles& particles, const Block& block, const Active& active, uint64_t step,
                     const Sums& sums, Moves& moves) {
  bool fits = true;
  for (uint32_t begin = block.begin; begin < block.end; begin += VectorBlock::kRoom) {
    const size_t lanes = std::min<size_t>(VectorBlock::kRoom, block.end - begin);
    fill(particles, block.begin, begin, lanes, step, sums);
    if (!wake(particles, begin, lanes, active)) continue;
    fits = block_.run(0, lanes) && fits;
    for (const graph::Write& write : round_.writes)
      keep(block_.values(write.node),
           particles.fields[static_cast<size_t>(program_.place(write.field) + write.component)], begin, lanes,
           particles, active, true);
    if (&round_ != &program_.rounds.back()) continue;
    const graph::Motion& motion = program_.motion;
    for (size_t a = 0; a < motion.v.size(); ++a) {
      keep(block_.values(motion.v[a]), moves.v[a], begin, lanes, particles, active, false);
      keep(block_.values(motion.drift[a]), moves.drift[a], begin, lanes, particles, active, false);
      if (!motion.u.empty())
        keep(block_.values(motion.u[a]), moves.u[a], begin, lanes, particles, active, false);
    }
  }
  return fits;
}

// Particles that sleep have no sums: their lanes become those of one that is awake, so that no check fails by
// them. False where all sleep.
bool FinishPass::wake(const Particles& particles, uint32_t begin, size_t lanes, const Active& active) {
  if (active.awake == nullptr) return true;
  const auto awake = [&](size_t k) { return active.awake[particles.cell[begin + k]] != 0; };
  size_t first = 0;
  while (first < lanes && !awake(first)) ++first;
  if (first == lanes) return false;
  for (const int n : inputs_) {
    double* values = block_.values(n);
    for (size_t k = 0; k < VectorBlock::padded(lanes); ++k)
      if (k >= lanes || !awake(k)) values[k] = values[first];
  }
  return true;
}

void FinishPass::keep(const double* values, PaddedArray<double>& to, uint32_t begin, size_t lanes,
                      const Particles& particles, const Active& active, bool field) const {
  for (size_t k = 0; k < lanes; ++k) {
    const auto p = begin + static_cast<uint32_t>(k);
    if (active.awake != nullptr && active.awake[particles.cell[p]] == 0) continue;
    if (field && active.changed != nullptr && to[p] != values[k]) active.mark(particles.cell[p]);
    to[p] = values[k];
  }
}

void FinishPass::fill(const Particles& particles, uint32_t block_begin, uint32_t begin, size_t lanes,
                      uint64_t step, const Sums& sums) {
  for (const int n : inputs_) {
    const Node& node = round_.finish.nodes[static_cast<size_t>(n)];
    const auto axis = static_cast<size_t>(node.axis), index = static_cast<size_t>(node.index);
    double* out = block_.values(n);
    const auto copy = [&](const PaddedArray<double>& from) { std::copy_n(from.data() + begin, lanes, out); };
    const auto each = [&](auto value) {
      for (size_t k = 0; k < lanes; ++k)
        out[k] = static_cast<double>(value(begin + static_cast<uint32_t>(k)));
    };
    switch (node.source) {
      case Source::sum:
        std::copy_n(sums[static_cast<size_t>(round_.place(node.index)) + axis].data() + (begin - block_begin),
                    lanes, out);
        break;
      case Source::own_x:
        each([&](uint32_t p) {
          const double x = particles.x[axis][p];
          return (x - std::floor(x * rule_.inverse_cell) * rule_.cell) * rule_.guard +
                 particles.residue[axis][p];
        });
        break;
      case Source::own_v:
        copy(particles.v[axis]);
        break;
      case Source::own_u:
        if (particles.u[0].size() == 0)
          std::fill_n(out, lanes, 0.0);
        else
          copy(particles.u[axis]);
        break;
      case Source::own_field:
        copy(particles.fields[static_cast<size_t>(program_.place(node.index)) + axis]);
        break;
      case Source::own_constant:
        each([&](uint32_t p) { return program_.type_constants[index].values[particles.type[p]]; });
        break;
      case Source::own_id:
        each([&](uint32_t p) { return particles.id_of(p); });
        break;
      case Source::step:
        each([&](uint32_t) { return step; });
        break;
      default:
        throw std::logic_error(std::string("a finish has no ") + to_string(node.source));
    }
    std::fill(out + lanes, out + VectorBlock::padded(lanes), out[0]);
  }
}

}  // namespace cuboct::emu
