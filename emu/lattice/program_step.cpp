// SPDX-License-Identifier: MIT
#include <algorithm>
#include <atomic>
#include <exception>

#include "emu/lattice/impl.h"
#include "model/base/error.h"
#include "model/base/hash.h"
#include "model/base/resources.h"
#include "model/program/integer_program.h"

namespace cuboct::emu {

// Entries after which a compiler's two seconds are won back: the interpreter takes some 80 ns for one.
constexpr double kWorthCompiling = 5e7;

void LatticeEngine::Impl::compile_rounds() {
  const std::string directory = options_.code_directory.empty() ? cache_directory() : options_.code_directory;
  if (directory.empty() && !rounds_->has_kept_code(options_.simd))
    throw InputError("neither XDG_CACHE_HOME nor HOME is set: no place to keep a rule's compiled code");
  if (!shared()) return rounds_->compile(options_.simd, directory);
  // One rank compiles, then the others find what it made. None waits for one that failed.
  std::exception_ptr error;
  std::array<double, 1> failed{};
  for (const bool first : {true, false}) {
    if ((options_.ranks->rank() == 0) == first) try {
        rounds_->compile(options_.simd, directory);
      } catch (...) {
        error = std::current_exception();
        failed[0] = 1;
      }
    options_.ranks->most(failed);
  }
  if (error) std::rethrow_exception(error);
  if (failed[0] > 0) throw InputError("a rule's code is not compiled on another rank");
}

// Before the first step. On all ranks or on none.
void LatticeEngine::Impl::take_kept_code() {
  std::array<double, 1> missing{rounds_->has_kept_code(options_.simd) ? 0.0 : 1.0};
  if (shared()) options_.ranks->most(missing);
  if (missing[0] > 0) return;
  try {
    compile_rounds();
  } catch (const InputError&) {
    may_compile_ = false;
  }
}

// Where there is no compiler, or it is not to be trusted, the rule stays interpreted.
void LatticeEngine::Impl::compile_if_worth() {
  if (rounds_->compiled() || !may_compile_ || options_.rule_code != RuleCode::automatic) return;
  for (const Block& block : blocks_)
    interpreted_ +=
        rounds_->program().rounds.size() * (block.inside.entries.size() + block.beside.pairs.entries.size() +
                                            rounds_->bond_entries(number_of(block)));
  // On all ranks in the same step.
  std::array<double, 1> most{static_cast<double>(interpreted_)};
  if (shared()) options_.ranks->most(most);
  if (most[0] < kWorthCompiling) return;
  may_compile_ = false;
  try {
    compile_rounds();
  } catch (const InputError&) {
  }
}

Stretch LatticeEngine::Impl::fields_of(uint32_t id) const {
  const size_t numbers = particles_.fields.size();
  return {id * numbers, (id + 1) * numbers};
}

std::shared_ptr<const graph::BondRows> LatticeEngine::Impl::rows_of_bonds() const {
  return plan_.program ? plan_.program->rows : nullptr;
}

Stretch LatticeEngine::Impl::bonds_of(uint32_t id) const {
  const auto numbers = static_cast<size_t>(rounds_->program().bond_numbers());
  const std::vector<uint64_t>& first = rows_of_bonds()->first;
  return {first[id] * numbers, first[id + 1] * numbers};
}

void LatticeEngine::Impl::gather(std::vector<int64_t>& numbers,
                                 const std::function<Stretch(uint32_t id)>& of) const {
  if (!shared()) return;
  std::vector<Bytes> to(static_cast<size_t>(options_.ranks->size()));
  for_each_index([&](uint32_t p) {
    const uint32_t id = particles_.id_of(p);
    append(to[0], int64_t{id});
    for (size_t k = of(id).begin; k < of(id).end; ++k) append(to[0], numbers[k]);
  });
  Stretch at{0, 0};
  const auto take = [&](int64_t number) {
    if (at.begin == at.end)
      at = of(static_cast<uint32_t>(number));
    else
      numbers[at.begin++] = number;
  };
  for (const Bytes& bytes : options_.ranks->exchange(to)) for_each_of<int64_t>(bytes, take);
}

std::vector<int64_t> LatticeEngine::Impl::fields() const {
  std::vector<int64_t> fields(particles_.fields.size() * count_);
  for_each_index([&](uint32_t p) {
    auto to = fields.begin() + static_cast<ptrdiff_t>(fields_of(particles_.id_of(p)).begin);
    for (const auto& field : particles_.fields) *to++ = static_cast<int64_t>(field[p]);
  });
  if (!fields.empty()) gather(fields, [&](uint32_t id) { return fields_of(id); });
  return fields;
}

void LatticeEngine::Impl::give_bonds(State& state) const {
  state.bonds = rounds_->give_bonds();
  if (state.bonds.empty()) return;
  gather(state.bonds, [&](uint32_t id) { return bonds_of(id); });
  state.bond_begin = begins_of(*rows_of_bonds(), rounds_->program().bond_numbers());
}

uint64_t LatticeEngine::Impl::program_hash() const {
  const std::vector<int64_t> bonds = rounds_->give_bonds();
  std::atomic<uint64_t> all = 0;
  for_each_part(blocks_.size(), threads_, [&](size_t b, int) {
    uint64_t sum = 0;
    for (uint32_t p = blocks_[b].begin; p < blocks_[b].end; ++p) {
      Hash hash;
      hash.resume(hash_of(lattice_, particle(p)));
      for (const auto& field : particles_.fields) hash.add(static_cast<int64_t>(field[p]));
      if (!bonds.empty()) {
        const Stretch own = bonds_of(particles_.id_of(p));
        for (size_t k = own.begin; k < own.end; ++k) hash.add(bonds[k]);
      }
      sum += hash.value();
    }
    all += sum;
  });
  return all;
}

// What ghosts show in round k: where they are, and the fields that it reads of others.
std::vector<PaddedArray<double>*> LatticeEngine::Impl::halo_of_round(size_t k) {
  std::vector<PaddedArray<double>*> arrays;
  if (k == 0) arrays = halo();
  for (const size_t number : rounds_->read_of_others(k)) arrays.push_back(&particles_.fields[number]);
  return arrays;
}

// All blocks are done with a round before any begins the next. Where something did not fit, the rounds after
// it are not run; ranks that do not know yet go on, and step() has the least fault of the first such round.
void LatticeEngine::Impl::run_rounds() {
  refresh_lists();
  const Active active = quiet_ ? quiet_->next() : Active();
  clear_blocks();
  compile_if_worth();
  const auto all = [&](const auto& work) {
    for_each_block([&](Block& block) {
      work(number_of(block), RoundStep{particles_, block, active, step_});
    });
  };
  const size_t rounds = rounds_->program().rounds.size();
  size_t failed_in = rounds;
  for (size_t k = 0; k < rounds; ++k) {
    if (shared()) exchange(halo_of_round(k));
    if (failed_in < rounds) continue;
    all([&](size_t b, const RoundStep& step) { rounds_->across(k, b, step); });
    all([&](size_t b, const RoundStep& step) { rounds_->inside(k, b, step); });
    if (!failed()) continue;
    failed_in = k;
    if (!shared()) return;
  }
  if (!shared()) return;
  std::array<double, 1> first{-static_cast<double>(failed_in)};
  options_.ranks->most(first);
  if (-first[0] < static_cast<double>(failed_in))
    for (Block& block : blocks_) block.pair_faults.clear(), block.update_faults.clear();
}

bool LatticeEngine::Impl::failed() const {
  return std::ranges::any_of(
      blocks_, [](const Block& b) { return !b.pair_faults.empty() || !b.update_faults.empty(); });
}

void LatticeEngine::Impl::take_rounds() {
  if (!ahead_) {
    run_rounds();
  } else {
    change_places();
    ahead_.reset();
  }
  counters_.compiled_steps += rounds_->compiled();
}

// The state becomes what is ahead, and the other way round.
void LatticeEngine::Impl::change_places() {
  std::swap(particles_.x, ahead_->x), std::swap(particles_.v, ahead_->v);
  std::swap(particles_.u, ahead_->u), std::swap(particles_.residue, ahead_->residue);
  std::swap(particles_.fields, ahead_->fields);
  rounds_->swap_bonds(ahead_->bonds);
}

// Lists may be made anew, and particles be stored anew, but for these the state is what it was.
void LatticeEngine::Impl::look_ahead() {
  refresh_lists();
  Ahead before;
  for (size_t a = 0; a < 3; ++a) {
    before.x[a] = particles_.x[a].copy(), before.v[a] = particles_.v[a].copy();
    before.u[a] = particles_.u[a].copy(), before.residue[a] = particles_.residue[a].copy();
  }
  for (const auto& field : particles_.fields) before.fields.push_back(field.copy());
  before.bonds = rounds_->copy_bonds();
  run_rounds();
  ahead_ = std::move(before);
  change_places();
}

std::vector<Int3> LatticeEngine::Impl::next_velocities() {
  if (!ahead_) look_ahead();
  std::array<double, 1> lost{failed() ? 1.0 : 0.0};
  if (shared()) options_.ranks->most(lost);
  if (lost[0] > 0) return {};
  return by_id([&](uint32_t p) {
    Int3 v;
    for (size_t a = 0; a < 3; ++a) v[a] = static_cast<int64_t>(ahead_->v[a][p]);
    return v;
  });
}

}  // namespace cuboct::emu
