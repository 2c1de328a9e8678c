// SPDX-License-Identifier: MIT
#include <algorithm>
#include <atomic>
#include <exception>
#include <stdexcept>

#include "emu/lattice/impl.h"
#include "model/base/error.h"
#include "model/base/hash.h"
#include "model/base/resources.h"
#include "model/contract/golden.h"

namespace cuboct::emu {

// Entries after which a compiler's two seconds are won back: the interpreter takes some 80 ns for one.
constexpr double kWorthCompiling = 5e7;

void LatticeEngine::Impl::keep_fields() {
  rounds_->keep_bonds();
  for (size_t f = 0; f < particles_.fields.size(); ++f)
    for_each_block([&](Block& block) {
      std::copy(particles_.fields[f].data() + block.begin, particles_.fields[f].data() + block.end,
                fields_before_[f].data() + block.begin);
    });
}

void LatticeEngine::Impl::compile_rounds() {
  const std::string directory = options_.code_directory.empty() ? cache_directory() : options_.code_directory;
  if (directory.empty())
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

std::vector<int64_t> LatticeEngine::Impl::own_fields(const std::vector<PaddedArray<double>>& from) const {
  std::vector<int64_t> fields(from.size() * count_);
  for_each_index([&](uint32_t p) {
    auto to = fields.begin() + static_cast<ptrdiff_t>(fields_of(particles_.id_of(p)).begin);
    for (const auto& field : from) *to++ = static_cast<int64_t>(field[p]);
  });
  return fields;
}

void LatticeEngine::Impl::gather(std::vector<int64_t>& numbers, const std::function<Stretch(uint32_t id)>& of,
                                 To whom) const {
  if (!shared()) return;
  std::vector<Bytes> to(static_cast<size_t>(options_.ranks->size()));
  for_each_index([&](uint32_t p) {
    const uint32_t id = particles_.id_of(p);
    append(to[0], int64_t{id});
    for (size_t k = of(id).begin; k < of(id).end; ++k) append(to[0], numbers[k]);
  });
  Bytes all;
  if (whom == To::all)
    all = options_.ranks->all(to[0]);
  else
    for (const Bytes& bytes : options_.ranks->exchange(to)) all.insert(all.end(), bytes.begin(), bytes.end());
  Stretch at{0, 0};
  for_each_of<int64_t>(all, [&](int64_t number) {
    if (at.begin == at.end)
      at = of(static_cast<uint32_t>(number));
    else
      numbers[at.begin++] = number;
  });
}

std::vector<int64_t> LatticeEngine::Impl::fields() const {
  std::vector<int64_t> fields = own_fields(fields_now());
  if (!fields.empty())
    gather(
        fields, [&](uint32_t id) { return fields_of(id); }, To::first);
  return fields;
}

void LatticeEngine::Impl::give_bonds(State& state) const {
  state.bonds = bonds_now();
  if (state.bonds.empty()) return;
  gather(
      state.bonds, [&](uint32_t id) { return bonds_of(id); }, To::first);
  state.bond_begin = begins_of(*rows_of_bonds(), rounds_->program().bond_numbers());
}

uint64_t LatticeEngine::Impl::program_hash() const {
  const std::vector<int64_t> bonds = bonds_now();
  const std::vector<PaddedArray<double>>& fields = fields_now();
  std::atomic<uint64_t> all = 0;
  for_each_part(blocks_.size(), threads_, [&](size_t b, int) {
    uint64_t sum = 0;
    for (uint32_t p = blocks_[b].begin; p < blocks_[b].end; ++p) {
      Hash hash;
      hash.resume(hash_of(lattice_, particle(p)));
      for (const auto& field : fields) hash.add(static_cast<int64_t>(field[p]));
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

// No particle moves before every round is done, so a fault finds the state as the step did, but for fields
// and bonds. False, on all ranks, where something does not fit.
bool LatticeEngine::Impl::run_rounds() {
  compile_if_worth();
  counters_.compiled_steps += rounds_->compiled();
  keep_fields();
  std::atomic<bool> fits = true;
  const auto all = [&](const auto& work) {
    if (fits || shared())
      for_each_block([&](Block& block) {
        if (!work(block)) fits = false;
      });
  };
  for (size_t k = 0; k < rounds_->program().rounds.size(); ++k) {
    if (shared()) exchange(halo_of_round(k));
    all([&](Block& block) {
      return rounds_->meet(k, number_of(block), {particles_, block, active_, step_});
    });
    all([&](Block& block) {
      return rounds_->finish(k, number_of(block), block, particles_, active_, step_);
    });
  }
  std::array<double, 1> failed{fits ? 0.0 : 1.0};
  if (shared()) options_.ranks->most(failed);
  return failed[0] == 0;
}

void LatticeEngine::Impl::begin_step() {
  refresh_lists();
  active_ = quiet_ ? quiet_->next() : Active();
  clear_blocks();
  begun_ = run_rounds();
}

void LatticeEngine::Impl::end_step() {
  if (!begun_) begin_step();
  if (!*begun_) fail_as_golden();
  begun_.reset();
  for_each_block([&](Block& block) { rounds_->move(block, particles_, active_); });
}

std::vector<Int3> LatticeEngine::Impl::next_velocities() {
  if (!begun_) begin_step();
  if (!*begun_) return {};
  const Moves& moves = rounds_->moves();
  return by_id([&](uint32_t p) {
    Int3 v = particle(p).v;
    if (active_.awake == nullptr || active_.awake[particles_.cell[p]] != 0)
      for (size_t a = 0; a < static_cast<size_t>(moves.axes); ++a) v[a] = static_cast<int64_t>(moves.v[a][p]);
    return v;
  });
}

const std::vector<PaddedArray<double>>& LatticeEngine::Impl::fields_now() const {
  return begun_ ? fields_before_ : particles_.fields;
}

std::vector<int64_t> LatticeEngine::Impl::bonds_now() const {
  return begun_ ? rounds_->bonds_before() : rounds_->give_bonds();
}

// Golden takes the same step, on each rank, and says what does not fit.
void LatticeEngine::Impl::fail_as_golden() const {
  std::vector<Particle> by_id(count_);
  Bytes mine;
  for_each_index([&](uint32_t p) { append(mine, particle(p)); });
  for_each_of<Particle>(shared() ? options_.ranks->all(mine) : mine,
                        [&](const Particle& one) { by_id[one.id] = one; });
  std::vector<int64_t> fields = own_fields(fields_before_), bonds = rounds_->bonds_before();
  if (!fields.empty())
    gather(
        fields, [&](uint32_t id) { return fields_of(id); }, To::all);
  if (!bonds.empty())
    gather(
        bonds, [&](uint32_t id) { return bonds_of(id); }, To::all);
  State begin{step_, {}};
  for (uint32_t n = 0; n < lattice_.size(); ++n)
    members_.for_each(n, [&](uint32_t id) {
      begin.particles.push_back(by_id[id]);
      for (size_t k = fields_of(id).begin; k < fields_of(id).end; ++k) begin.fields.push_back(fields[k]);
    });
  begin.bonds = std::move(bonds);
  Golden(rounds_->program(), lattice_, plan_.arch.capacity, begin, rows_of_bonds()).step();
  throw std::logic_error("the lattice engine finds a fault that golden does not");
}

}  // namespace cuboct::emu
