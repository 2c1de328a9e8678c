// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "emu/lattice/hash_particles.h"
#include "emu/lattice/impl.h"
#include "model/base/error.h"
#include "model/contract/pair_program.h"
#include "model/program/integer_program.h"

namespace cuboct::emu {
namespace {

// Below this a barrier costs more than a thread's work.
constexpr uint32_t kLeastPerThread = 1000;

int thread_count(const LatticeOptions& options, uint32_t particles) {
  if (options.threads > 0) return options.threads;
  if (options.ranks != nullptr && options.ranks->size() > 1) return 1;
  return std::clamp(static_cast<int>(particles / kLeastPerThread), 1, usable_cores());
}

// A double holds every position, a period more or less, as a whole number of 2^-P cells.
void check_span(const Lattice& lattice, int position_frac) {
  const auto most = static_cast<int64_t>(std::ldexp(1.0, 52 - position_frac)) - 4;
  for (int a = 0; a < 3; ++a) {
    int64_t reach = lattice.period()[a];
    for (uint32_t n = 0; n < lattice.size(); ++n)
      reach = std::max(reach, std::abs(int64_t{lattice.cell(n)[a]}));
    if (reach > most)
      throw InputError(
          fmt::format("the lattice reaches {} cells along {}: with position_frac = {} the lattice engine "
                      "holds up to {}",
                      reach, "xyz"[a], position_frac, most),
          "use another engine, or fewer fractional bits in the arch file")
          .about({"widths.position_frac", "box.size", "box"});
  }
}

// In cells. Lists take these as cubes: the cutoff is more edges of the shortest axis than of the longest.
double reach_of(const FixedRule& rule) {
  const double cutoff =
      std::ldexp(std::sqrt(static_cast<double>(rule.cutoff2)), -rule.widths.difference_frac);
  if (rule.cubic()) return cutoff;
  // A difference is rounded twice along each axis, by half a unit each, and its share of the longest edge by
  // less: 2.2 units in all.
  const double rounded = std::ldexp(3.0, -rule.widths.difference_frac);
  return (cutoff + rounded) * rule.cell_edge / rule.edges().shortest();
}

// The far list's skin at first: in an FCC packing, cutoff 1.6 pitches, it stays clear of the fourth shell.
constexpr double kFirstSkin = 0.17;

}  // namespace

LatticeEngine::Impl::Impl(const Plan& plan, uint64_t step, uint32_t count, const LatticeOptions& options)
    : plan_(plan),
      lattice_(plan.lattice),
      options_(options),
      rule_(kernel_rule(plan.rule, plan.arch.capacity)),
      cutoff_(reach_of(plan.rule)),
      threads_(thread_count(options, count)),
      step_(step),
      count_(count),
      rows_(plan.lattice),
      skin_(kFirstSkin) {
  check_span(lattice_, plan.rule.widths.position_frac);
  if (!shared()) check_room(count);
  snapshot_.position_frac = plan.rule.widths.position_frac;
  snapshot_.threads = threads_;
  if (!plan.rule.cubic() && plan.program == nullptr)
    own_program_ = pair_program(plan.rule, plan.arch.capacity);
  if (plan.program != nullptr || own_program_) {
    rounds_.emplace(own_program_ ? *own_program_ : plan.program->program, rule_, lattice_,
                    rows_of_bonds().get());
    if (options_.rule_code == RuleCode::compiled) compile_rounds();
    if (options_.rule_code == RuleCode::automatic) take_kept_code();
  }
  const std::vector<Kernels> here = kernels_here(rule_);
  const auto named = std::find_if(here.begin(), here.end(), [&](const Kernels& k) {
    return options_.simd.empty() || k.name == options_.simd;
  });
  if (named == here.end())
    throw InputError(fmt::format("no {} kernels: {}", options_.simd,
                                 rule_.fits ? "not on this machine" : "the plan's widths exceed them"),
                     "leave the choice to the engine");
  kernels_ = *named;
  for (int s = 0; s < 27; ++s)
    for (int a = 0; a < 3; ++a) {
      const int image = (a == 0 ? s % 3 : a == 1 ? s / 3 % 3 : s / 9) - 1;
      particles_.shift[s][a] = image * static_cast<double>(lattice_.period()[a]) * rule_.cell;
    }
}

void LatticeEngine::Impl::fill(const std::function<Particle(uint32_t)>& particle) {
  members_ = Members(lattice_, plan_.arch.capacity, count_);
  std::vector<RunError> faults;
  const auto enter = [&](const Particle& p) {
    if (!members_.append(p.cell, p.id))
      faults.push_back(error(Fault::full_x, p.cell, p.id, plan_.arch.capacity));
  };
  const int guard = plan_.rule.widths.guard;
  const auto put = [&](const Particle& p, uint32_t at) {
    if (particles_.id.size() > 0) particles_.id[at] = p.id;
    if (p.type != 0) particles_.type[at] = p.type;  // zeros are there, and take no memory
    const Cell& cell = lattice_.cell(p.cell);
    for (int a = 0; a < 3; ++a) {
      particles_.x[a][at] = static_cast<double>(p.x[a] >> guard) + cell[a] * rule_.cell;
      particles_.residue[a][at] = static_cast<int32_t>(p.x[a] & ((int64_t{1} << guard) - 1));
      particles_.v[a][at] = static_cast<double>(p.v[a]);
      if (plan_.rule.pd) particles_.u[a][at] = static_cast<double>(p.u[a]);
    }
    fastest_ = std::max(fastest_, std::hypot(particles_.v[0][at], particles_.v[1][at], particles_.v[2][at]));
  };
  if (!shared()) {
    // Stored by id: packings number their sites row by row.
    make_room(groups_of(count_) * kGroup, 0);
    cut_blocks(blocks_, 0, count_);
    for (uint32_t k = 0; k < count_; ++k) {
      const Particle p = particle(k);
      put(p, p.id);
      enter(p);
    }
    fail_if_any(faults);
    particles_.cell = members_.cells();
  } else {
    // Once to know who owns what, once to take what is owned; build() brings it in order.
    for (uint32_t k = 0; k < count_; ++k) enter(particle(k));
    fail_if_any(faults);
    own_cells();
    const auto mine = [&](uint32_t cell) { return owner_[cell] == options_.ranks->rank(); };
    uint32_t held = 0;
    for (uint32_t n = 0; n < lattice_.size(); ++n)
      if (mine(n)) held += static_cast<uint32_t>(members_.count(n));
    make_room(groups_of(held) * kGroup, 0);
    cut_blocks(blocks_, 0, held);
    index_.by_id.assign(count_, kNoParticle);
    uint32_t at = 0;
    for (uint32_t k = 0; k < count_; ++k) {
      const Particle p = particle(k);
      if (!mine(p.cell)) continue;
      put(p, at);
      index_.by_id[p.id] = at++;
    }
    options_.ranks->most({&fastest_, 1});
  }
  const int rounds = rounds_ ? static_cast<int>(rounds_->program().rounds.size()) : 1;
  if (options_.quiescence && !(rounds_ && rounds_->knows_time())) quiet_.emplace(lattice_, rows_, rounds);
}

void LatticeEngine::Impl::fill_fields(const std::vector<int64_t>& fields) {
  const size_t numbers = particles_.fields.size();
  for_each_index([&](uint32_t p) {
    for (size_t f = 0; f < numbers; ++f)
      particles_.fields[f][p] = static_cast<double>(fields[particles_.id_of(p) * numbers + f]);
  });
}

Particle LatticeEngine::Impl::particle(uint32_t index) const {
  Particle p;
  p.id = particles_.id_of(index);
  p.type = particles_.type[index];
  p.cell = members_.cells()[p.id];
  const Widths& widths = plan_.rule.widths;
  const int64_t mask = (int64_t{1} << widths.velocity_frac()) - 1;
  const Int3 x = exact_position(particles_, index, widths.guard);
  for (int a = 0; a < 3; ++a) {
    p.x[a] = x[a] & mask;
    p.v[a] = static_cast<int64_t>(particles_.v[a][index]);
    if (plan_.rule.pd) p.u[a] = static_cast<int64_t>(particles_.u[a][index]);
  }
  return p;
}

std::vector<Particle> LatticeEngine::Impl::everyone() const {
  std::vector<Particle> all;
  if (!shared()) {
    all.resize(count_);
    for_each_part(blocks_.size(), threads_, [&](size_t b, int) {
      for (uint32_t p = blocks_[b].begin; p < blocks_[b].end; ++p) all[particles_.id_of(p)] = particle(p);
    });
    return all;
  }
  std::vector<Bytes> to(static_cast<size_t>(options_.ranks->size()));
  for_each_index([&](uint32_t p) { append(to[0], particle(p)); });
  const std::vector<Bytes> from = options_.ranks->exchange(to);
  if (options_.ranks->rank() != 0) return all;
  all.resize(count_);
  for (const Bytes& bytes : from)
    for_each_of<Particle>(bytes, [&](const Particle& one) { all[one.id] = one; });
  return all;
}

// Sums of the state at hand, on every rank; false where some pair does not fit.
bool LatticeEngine::Impl::sum_pairs() {
  refresh_lists();
  clear_blocks();
  sums_.resize(particles_.x[0].size());
  Active active;
  active.sums = sums_.data();
  forces_and_update(active);
  std::array<double, 1> failed{};
  for (const Block& block : blocks_)
    if (!block.pair_faults.empty()) failed[0] = 1;
  if (shared()) options_.ranks->most(failed);
  return failed[0] == 0;
}

std::vector<Int3> LatticeEngine::Impl::kicks() {
  if (rounds_) return {};
  if (!summed_) summed_ = sum_pairs();
  if (!summed_) return {};
  return by_id([&](uint32_t p) { return sums_[p]; });
}

std::vector<Int3> LatticeEngine::Impl::by_id(const std::function<Int3(uint32_t)>& of) const {
  std::vector<Int3> all(count_);
  if (!shared()) {
    for_each_index([&](uint32_t p) { all[particles_.id_of(p)] = of(p); });
    return all;
  }
  struct One {
    uint32_t id;
    Int3 value;
  };
  std::vector<Bytes> to(static_cast<size_t>(options_.ranks->size()));
  for_each_index([&](uint32_t p) { append(to[0], One{particles_.id_of(p), of(p)}); });
  const std::vector<Bytes> from = options_.ranks->exchange(to);
  for (const Bytes& bytes : from) for_each_of<One>(bytes, [&](const One& one) { all[one.id] = one.value; });
  return all;
}

LatticeEngine::LatticeEngine(const Plan& plan, uint64_t step, uint32_t count,
                             const std::function<Particle(uint32_t)>& particle, const LatticeOptions& options,
                             const ProgramNumbers& kept)
    : impl_(std::make_unique<Impl>(plan, step, count, options)) {
  impl_->fill(particle);
  if (!impl_->rounds_) return;
  impl_->fill_fields(kept.fields);
  impl_->rounds_->take_bonds(kept.bonds);
}

LatticeEngine::~LatticeEngine() = default;

void LatticeEngine::step() { impl_->step(); }
uint64_t LatticeEngine::step_count() const { return impl_->step_; }
uint32_t LatticeEngine::size() const { return impl_->count_; }
const LatticeCounters& LatticeEngine::counters() const { return impl_->counters_; }
int LatticeEngine::threads() const { return impl_->threads_; }
const std::string& LatticeEngine::simd() const { return impl_->kernels_.name; }
std::span<const Leaving> LatticeEngine::leaving() const { return impl_->leaving_; }

std::vector<Int3> LatticeEngine::kicks() { return impl_->kicks(); }
std::vector<Int3> LatticeEngine::next_velocities() { return impl_->next_velocities(); }

bool LatticeEngine::kicks(std::span<const uint32_t> ids, std::span<Int3> to) {
  if (impl_->rounds_) return false;
  if (!impl_->summed_) impl_->summed_ = impl_->sum_pairs();
  if (!impl_->summed_) return false;
  for (size_t k = 0; k < ids.size(); ++k) to[k] = impl_->sums_[impl_->index_(ids[k])];
  return true;
}

Particle LatticeEngine::particle(uint32_t id) const { return impl_->particle(impl_->index_(id)); }

double LatticeEngine::largest_speed() const {
  const Impl& impl = *impl_;
  std::vector<double> most(impl.blocks_.size() + 1);
  for_each_part(impl.blocks_.size(), impl.threads_, [&](size_t b, int) {
    for (const auto& v : impl.particles_.v)
      for (uint32_t p = impl.blocks_[b].begin; p < impl.blocks_[b].end; ++p)
        most[b] = std::max(most[b], std::abs(v[p]));
  });
  return std::ldexp(*std::ranges::max_element(most), -impl.plan_.rule.widths.velocity_frac());
}

State LatticeEngine::state() const {
  State state{impl_->step_, impl_->everyone(), impl_->fields()};
  if (impl_->rounds_ && impl_->rounds_->bonded()) impl_->give_bonds(state);
  return state;
}

void LatticeEngine::for_each_slot(const std::function<void(const Particle&)>& see) const {
  if (!impl_->shared()) {
    for (uint32_t n = 0; n < impl_->lattice_.size(); ++n)
      impl_->members_.for_each(n, [&](uint32_t id) { see(impl_->particle(impl_->index_(id))); });
    return;
  }
  const std::vector<Particle> all = impl_->everyone();
  if (all.empty()) return;
  for (uint32_t n = 0; n < impl_->lattice_.size(); ++n)
    impl_->members_.for_each(n, [&](uint32_t id) { see(all[id]); });
}

uint64_t LatticeEngine::hash() const {
  const Impl& impl = *impl_;
  std::atomic<uint64_t> all = 0;
  if (impl.rounds_)
    all = impl.program_hash();
  else
    for_each_part(impl.blocks_.size(), impl.threads_, [&](size_t b, int) {
      all += hash_particles(impl.particles_, impl.lattice_, impl.members_.cells(), impl.plan_.rule.widths,
                            impl.blocks_[b].begin, impl.blocks_[b].end);
    });
  uint64_t sum = all;
  if (impl_->shared()) impl_->options_.ranks->sum({&sum, 1});
  return sum;
}

Int3 LatticeEngine::momentum() const {
  const FixedRule& rule = impl_->plan_.rule;
  std::vector<Int3> by_type(rule.types.size(), Int3{});
  for (int a = 0; a < 3; ++a)
    impl_->for_each_index([&](uint32_t p) {
      by_type[impl_->particles_.type[p]][a] += static_cast<int64_t>(impl_->particles_.v[a][p]);
    });
  if (impl_->shared())
    for (Int3& sum : by_type)
      for (int64_t& s : sum) {
        auto modulo = static_cast<uint64_t>(s);
        impl_->options_.ranks->sum({&modulo, 1});
        s = static_cast<int64_t>(modulo);
      }
  return cuboct::momentum(rule, by_type);
}

void LatticeEngine::slots(CellSlots& out) const {
  const uint32_t cells = impl_->lattice_.size();
  out.first.resize(cells + 1);
  uint32_t at = 0;
  for (uint32_t n = 0; n < cells; ++n) {
    out.first[n] = at;
    at += static_cast<uint32_t>(impl_->members_.count(n));
  }
  out.first[cells] = at;
  for (auto& x : out.x) x.resize(at);
  const bool bonded = impl_->plan_.program && impl_->plan_.program->rows;
  if (bonded) out.id.resize(at);
  const int64_t mask = (int64_t{1} << impl_->plan_.rule.widths.position_frac) - 1;
  const auto write = [&](size_t begin, size_t end) {
    for (auto n = static_cast<uint32_t>(begin); n < end; ++n) {
      uint32_t k = out.first[n];
      impl_->members_.for_each(n, [&](uint32_t id) {
        const uint32_t p = impl_->index_(id);
        if (bonded) out.id[k] = id;
        for (int a = 0; a < 3; ++a)
          out.x[a][k] = static_cast<int32_t>(static_cast<int64_t>(impl_->particles_.x[a][p]) & mask);
        ++k;
      });
    }
  };
  for_each_range(cells, 1, write, impl_->threads_);
}

}  // namespace cuboct::emu
