// SPDX-License-Identifier: MIT
#include "emu/lattice/rounds/jobs.h"

namespace cuboct::emu {

std::vector<double*> pointers(Sums& arrays) {
  std::vector<double*> to;
  for (auto& array : arrays) to.push_back(array.data());
  return to;
}

Jobs::Jobs(const RoundStep& step, const KernelRule& rule, const CodeNumbers& numbers, BondList& bonds)
    : step_(step),
      rule_(rule),
      numbers_(numbers),
      bonds_(bonds),
      fields_(pointers(step.particles.fields)),
      bond_numbers_(pointers(bonds.numbers)) {}

Job Jobs::pairs() const {
  const Particles& particles = step_.particles;
  Job job{};
  job.numbers = numbers_;
  job.step = static_cast<double>(step_.step);
  for (size_t a = 0; a < 3; ++a) job.x[a] = particles.x[a].data(), job.v[a] = particles.v[a].data();
  job.fields = fields_.data();
  job.type = particles.type.data();
  job.id = particles.id.size() > 0 ? particles.id.data() : nullptr;
  job.shift = reinterpret_cast<const double(*)[3]>(particles.shift.data());
  job.begin = step_.block.begin;
  job.bonds = bond_numbers_.data();
  job.kind = bonds_.kind.data();
  job.cell = rule_.cell;
  return job;
}

FinishJob Jobs::finish() const {
  Particles& particles = step_.particles;
  FinishJob job{};
  job.numbers = numbers_;
  job.step = static_cast<double>(step_.step);
  for (size_t a = 0; a < 3; ++a) {
    job.x[a] = particles.x[a].data(), job.v[a] = particles.v[a].data();
    job.residue[a] = particles.residue[a].data();
    job.u[a] = particles.u[a].size() > 0 ? particles.u[a].data() : nullptr;
  }
  job.fields = fields_.data();
  job.type = particles.type.data();
  job.id = particles.id.size() > 0 ? particles.id.data() : nullptr;
  job.begin = step_.block.begin, job.end = step_.block.end;
  job.cell = particles.cell;
  job.awake = step_.active.awake;
  job.edge = rule_.cell, job.inverse_edge = rule_.inverse_cell;
  job.guard = rule_.guard, job.inverse_guard = rule_.inverse_guard;
  job.fastest2 = &step_.block.fastest2;
  return job;
}

}  // namespace cuboct::emu
