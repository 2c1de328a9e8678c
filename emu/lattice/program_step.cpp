// SPDX-License-Identifier: MIT
#include <algorithm>
#include <atomic>
#include <stdexcept>

#include "emu/lattice/impl.h"
#include "model/base/error.h"
#include "model/base/resources.h"
#include "model/contract/golden.h"

namespace cuboct::emu {

// Entries after which a compiler's two seconds are won back: the interpreter takes some 80 ns for one.
constexpr uint64_t kWorthCompiling = 50'000'000;

void LatticeEngine::Impl::keep_fields() {
  rounds_->keep_bonds();
  for (size_t f = 0; f < particles_.fields.size(); ++f)
    for_each_block([&](Block& block) {
      std::copy(particles_.fields[f].data() + block.begin, particles_.fields[f].data() + block.end,
                fields_before_[f].data() + block.begin);
    });
}

RuleCode rule_code_of(const std::string& name) {
  if (name == "automatic") return RuleCode::automatic;
  if (name == "interpreted") return RuleCode::interpreted;
  if (name == "compiled") return RuleCode::compiled;
  throw InputError("'" + name + "' is no way to run a rule of text", "automatic, interpreted or compiled");
}

void LatticeEngine::Impl::compile_rounds() {
  const std::string directory = options_.code_directory.empty() ? cache_directory() : options_.code_directory;
  if (directory.empty())
    throw InputError("neither XDG_CACHE_HOME nor HOME is set: no place to keep a rule's compiled code");
  rounds_->compile(options_.simd, directory);
}

// Where there is no compiler, or it is not to be trusted, the rule stays interpreted.
void LatticeEngine::Impl::compile_if_worth() {
  if (rounds_->compiled() || !may_compile_ || options_.rule_code != RuleCode::automatic) return;
  for (const Block& block : blocks_)
    interpreted_ +=
        rounds_->program().rounds.size() * (block.inside.entries.size() + block.beside.pairs.entries.size() +
                                            rounds_->bond_entries(number_of(block)));
  if (interpreted_ < kWorthCompiling) return;
  may_compile_ = false;
  try {
    compile_rounds();
  } catch (const InputError&) {
  }
}

// No particle moves before every round is done, so a fault finds the state as the step did, but for fields.
void LatticeEngine::Impl::run_rounds(const Active& active) {
  compile_if_worth();
  counters_.compiled_steps += rounds_->compiled();
  keep_fields();
  std::atomic<bool> fits = true;
  const auto all = [&](const auto& work) {
    for_each_block([&](Block& block) {
      if (!work(block)) fits = false;
    });
    if (!fits) fail_as_golden();
  };
  for (size_t k = 0; k < rounds_->program().rounds.size(); ++k) {
    all([&](Block& block) { return rounds_->meet(k, number_of(block), {particles_, block, active, step_}); });
    all([&](Block& block) { return rounds_->finish(k, number_of(block), block, particles_, active, step_); });
  }
  for_each_block([&](Block& block) { rounds_->move(block, particles_, active); });
}

// Golden takes the same step, and says what does not fit.
void LatticeEngine::Impl::fail_as_golden() const {
  State begin{step_, {}};
  for (uint32_t n = 0; n < lattice_.size(); ++n)
    members_.for_each(n, [&](uint32_t id) {
      begin.particles.push_back(particle(index_(id)));
      for (const auto& field : fields_before_)
        begin.fields.push_back(static_cast<int64_t>(field[index_(id)]));
    });
  begin.bonds = rounds_->bonds_before();
  Golden(rounds_->program(), lattice_, plan_.arch.capacity, begin, plan_.program->rows).step();
  throw std::logic_error("the lattice engine finds a fault that golden does not");
}

}  // namespace cuboct::emu
