// SPDX-License-Identifier: MIT
#include "emu/lattice/rounds/misfits.h"

#include <cmath>

#include "model/contract/program_run.h"

namespace cuboct::emu {

Misfits::Misfits(const graph::FixedProgram& program, const graph::Round& round, const KernelRule& rule,
                 const BondSpace& space, const BondList& bonds, const RoundStep& step)
    : program_(program), round_(round), rule_(rule), space_(space), bonds_(bonds), step_(step) {}

// Its place counts from the corner of its own cell.
Particle Misfits::particle(uint32_t p) const {
  const Particles& from = step_.particles;
  Particle to{.id = from.id_of(p), .type = from.type[p]};
  for (size_t a = 0; a < 3; ++a) {
    const double x = from.x[a][p];
    const auto inside = static_cast<int64_t>(x - std::floor(x * rule_.inverse_cell) * rule_.cell);
    to.x[a] = inside * static_cast<int64_t>(rule_.guard);
    if (p < from.residue[a].size()) to.x[a] += from.residue[a][p];
    to.v[a] = static_cast<int64_t>(from.v[a][p]);
    if (p < from.u[a].size()) to.u[a] = static_cast<int64_t>(from.u[a][p]);
  }
  return to;
}

std::vector<int64_t> Misfits::fields(uint32_t p) const {
  std::vector<int64_t> values;
  for (const auto& field : step_.particles.fields) values.push_back(static_cast<int64_t>(field[p]));
  return values;
}

void Misfits::add_end(uint32_t own, uint32_t other, const std::array<double, 3>& apart, uint64_t slot,
                      uint64_t bond) const {
  const Particle mine = particle(own), partner = particle(other);
  const std::vector<int64_t> my_fields = fields(own), its_fields = fields(other);
  std::vector<int64_t> numbers, sums(static_cast<size_t>(round_.numbers()));
  for (const auto& values : bonds_.numbers) numbers.push_back(static_cast<int64_t>(values[slot]));
  Seen seen{&partner, {}, its_fields.data(), numbers.data(), nullptr};
  for (size_t a = 0; a < 3; ++a) seen.x[a] = static_cast<int64_t>(apart[a]);
  if (program_.bonded)
    seen.bond_constants =
        space_.rows->constants.data() + space_.rows->kind[bond] * program_.bond_constants.size();
  PairRun run(program_, round_, step_.step);
  run.add({&mine, {}, my_fields.data()}, std::span(&seen, 1), sums);
  for (const graph::LaneFault& f : run.faults()) step_.block.pair_faults.push_back({f.fault, own, f.number});
}

void Misfits::add_pair(uint32_t own, uint32_t other, const Entry& entry, uint64_t slot, bool both) const {
  const auto& x = step_.particles.x;
  std::array<double, 3> apart, back;
  for (size_t a = 0; a < 3; ++a) apart[a] = x[a][other] - x[a][own] + step_.particles.shift[entry.shift][a];
  if (program_.bonded) space_.meets({x[0][own], x[1][own], x[2][own]}, apart);
  for (size_t a = 0; a < 3; ++a) back[a] = -apart[a];
  add_end(own, other, apart, slot, program_.bonded ? bonds_.bond[slot] : 0);
  if (both) add_end(other, own, back, slot, program_.bonded ? bonds_.twin[slot] : 0);
}

void Misfits::add_lost(uint32_t own, uint32_t other, bool both) const {
  auto& faults = step_.block.pair_faults;
  faults.push_back({Fault::bond_lost, own, step_.particles.id_of(other)});
  if (both) faults.push_back({Fault::bond_lost, other, step_.particles.id_of(own)});
}

void Misfits::add_finish(const FinishJob& job, uint32_t first, uint32_t count) const {
  FinishRun run(program_, round_, step_.step);
  std::vector<int64_t> sums(static_cast<size_t>(round_.numbers()));
  for (uint32_t p = first; p < std::min(first + count, job.end); ++p) {
    if (job.awake != nullptr && job.awake[job.cell[p]] == 0) continue;
    for (size_t t = 0; t < sums.size(); ++t)
      sums[t] = static_cast<int64_t>(job.sums[t][(p - job.begin) & job.mask] - kMagic);
    const Particle one = particle(p);
    const std::vector<int64_t> values = fields(p);
    const Seen seen{&one, {}, values.data()};
    run.run(std::span(&seen, 1), sums);
    for (const graph::LaneFault& f : run.faults())
      step_.block.update_faults.push_back({f.fault, p, f.number});
  }
}

}  // namespace cuboct::emu
