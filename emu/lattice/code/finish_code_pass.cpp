// SPDX-License-Identifier: MIT
#include "emu/lattice/code/finish_code_pass.h"

#include <cstddef>

namespace cuboct::emu {
namespace {

// Who the code tells what particles do.
struct Told {
  const Particles& particles;
  const Active& active;
  Block& block;
};

void note_change(void* owner, uint32_t particle) {
  const Told& told = *static_cast<const Told*>(owner);
  told.active.mark(told.particles.cell[particle]);
}

void note_crossing(void* owner, uint32_t particle, const int8_t away[3]) {
  static_cast<Told*>(owner)->block.crossings.push_back({particle, {away[0], away[1], away[2]}});
}

}  // namespace

bool FinishCodePass::run(Particles& particles, Block& block, const Step& step) const {
  return call(library_.finish(round_), particles, block, step);
}

bool FinishCodePass::fits(Particles& particles, Block& block, const Step& step) const {
  return call(library_.fits(round_), particles, block, step);
}

bool FinishCodePass::call(FinishCode code, Particles& particles, Block& block, const Step& step) const {
  Told told{particles, step.active, block};
  std::vector<double*> fields;
  std::vector<const double*> sums;
  for (auto& field : particles.fields) fields.push_back(field.data());
  for (const auto& sum : step.sums) sums.push_back(sum.data());

  FinishJob job{};
  job.numbers = library_.numbers();
  job.step = static_cast<double>(step.step);
  for (size_t a = 0; a < 3; ++a) {
    job.x[a] = particles.x[a].data(), job.v[a] = particles.v[a].data();
    job.residue[a] = particles.residue[a].data();
    job.u[a] = particles.u[a].size() > 0 ? particles.u[a].data() : nullptr;
  }
  job.fields = fields.data();
  job.type = particles.type.data();
  job.id = particles.id.size() > 0 ? particles.id.data() : nullptr;
  job.begin = block.begin, job.end = block.end;
  job.sums = sums.data();
  job.count = block.groups();
  if (step.active.awake != nullptr)
    job.chosen = step.wanted.awake.data(), job.count = static_cast<uint32_t>(step.wanted.awake.size());
  job.cell = particles.cell;
  job.awake = step.active.awake;
  job.edge = rule_.cell, job.inverse_edge = rule_.inverse_cell;
  job.guard = rule_.guard, job.inverse_guard = rule_.inverse_guard;
  job.owner = &told;
  job.changed = step.active.changed != nullptr ? note_change : nullptr;
  job.crossed = note_crossing;
  job.fastest2 = &block.fastest2;
  return code(job);
}

}  // namespace cuboct::emu
