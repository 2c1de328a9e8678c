// SPDX-License-Identifier: MIT
#include "emu/lattice/engine.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "emu/lattice/kernel.h"
#include "emu/lattice/members.h"
#include "emu/lattice/pair_list.h"
#include "emu/lattice/quiet.h"
#include "model/error.h"
#include "model/fixed_math.h"

namespace cuboct::emu {
namespace {

// Two lists, as in Verlet's method: the far one holds pairs up to the cutoff plus kFirstSkin, in cells; it is
// searched anew when some particle may have moved half of that. The near one is what the far one leaves within
// the cutoff plus a thinner skin, and is taken from it every few steps (a dual pair list: Pall and Hess 2013).
// The far skin grows while its lists hold for less than kShortLife steps.
constexpr double kFirstSkin = 0.17;
constexpr double kMostSkin = 0.5;
constexpr uint64_t kShortLife = 20;
// A list is mended where at most this share of the particles moved farther than this share of the skin.
constexpr double kMostMended = 0.1;
constexpr double kMendFrom = 0.125;
// The near list's skin: at least so many cells, and enough for so many steps.
constexpr double kNearSkin = 0.04;
constexpr double kNearSteps = 4;
// At most this share of the far skin.
constexpr double kMostNear = 0.4;
// A near list this much wider than need be is made anew everywhere.
constexpr double kWaste = 0.7;
// Entries with fewer pairs than this on average are not what storage in rows is for: particles are stored by
// node then.
constexpr double kFewLanes = 2.5;

auto order(const RunError& e) { return std::tuple(e.fault, e.particle, e.number); }

// Below this a barrier costs more than a thread's work.
constexpr uint32_t kLeastPerThread = 1000;

int thread_count(int wanted, uint32_t particles) {
  if (wanted > 0) return wanted;
  return std::clamp(static_cast<int>(particles / kLeastPerThread), 1, omp_get_num_procs());
}

}  // namespace

struct LatticeEngine::Impl {
  Impl(const Plan& plan, uint64_t step, uint32_t count, const LatticeOptions& options);
  void fill(const std::function<Particle(uint32_t)>& particle);
  void step();
  void refresh_lists();
  void build();
  bool mend();
  void prune(double skin);
  void cut();
  double displacement() const;
  template <typename See>
  void for_each_moved(const See& see) const;
  void find_group_nodes();
  void widen_group_nodes(uint32_t particle);
  bool crystal() const;
  void store_by_node(Bins& bins);
  double reach_of_step() const;
  Particle particle(uint32_t index) const;
  template <typename Work>
  void for_each_block(const Work& work);
  RunError error(Fault fault, uint32_t node, uint32_t index, int64_t number) const;
  void fail_if_any(const std::vector<RunError>& faults) const;
  void fail_if_any(std::vector<Found> Block::*faults);

  const Plan& plan_;
  const Lattice& lattice_;
  LatticeOptions options_;
  KernelRule rule_;
  Kernels kernels_;
  double cutoff_;  // cells
  int threads_;
  uint64_t step_;
  uint32_t count_;
  Particles particles_;
  std::vector<Block> blocks_;
  Members members_;
  Rows rows_;
  Snapshot snapshot_;
  std::optional<Quiet> quiet_;
  std::vector<Leaving> leaving_;
  LatticeCounters counters_;

  bool listed_ = false;
  double skin_ = kFirstSkin;  // cells
  double moved_ = 0;          // cells: no particle is farther from where the far list found it
  double near_skin_ = 0, near_moved_ = 0;  // the same of the near list
  double near_floor_ = -1;                 // all groups were pruned with at least this skin
  double fastest_ = 0;                     // largest |v| after the last step, P+G fractional bits
  uint64_t listed_at_ = 0;                 // step
};

LatticeEngine::Impl::Impl(const Plan& plan, uint64_t step, uint32_t count, const LatticeOptions& options)
    : plan_(plan),
      lattice_(plan.lattice),
      options_(options),
      rule_(kernel_rule(plan.rule, plan.arch.capacity)),
      cutoff_(std::ldexp(std::sqrt(static_cast<double>(plan.rule.cutoff2)), -plan.rule.widths.difference_frac)),
      threads_(thread_count(options.threads, count)),
      step_(step),
      count_(count),
      rows_(plan.lattice) {
  snapshot_.position_frac = plan.rule.widths.position_frac;
  snapshot_.threads = threads_;
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

// Blocks of equal size, one per thread.
void LatticeEngine::Impl::cut() {
  const uint32_t groups = (count_ + kGroup - 1) / kGroup;
  const auto blocks = static_cast<uint32_t>(std::clamp<int64_t>(groups, 1, threads_));
  blocks_.resize(blocks);
  for (uint32_t b = 0; b < blocks; ++b) {
    blocks_[b].begin = static_cast<uint32_t>(uint64_t{groups} * b / blocks) * kGroup;
    blocks_[b].end = std::min(count_, static_cast<uint32_t>(uint64_t{groups} * (b + 1) / blocks) * kGroup);
  }
}

void LatticeEngine::Impl::fill(const std::function<Particle(uint32_t)>& particle) {
  cut();
  const size_t room = (count_ + kGroup - 1) / kGroup * kGroup;
  for (auto& x : particles_.x) x = PaddedArray<double>(room);
  for (auto& v : particles_.v) v = PaddedArray<double>(room);
  if (plan_.rule.pd)
    for (auto& u : particles_.u) u = PaddedArray<double>(room);
  particles_.id = PaddedArray<uint32_t>(room, kNoParticle);
  particles_.node = PaddedArray<uint32_t>(room);
  particles_.type = PaddedArray<uint8_t>(room);
  members_ = Members(lattice_, plan_.arch.capacity, room);
  std::vector<RunError> faults;
  for (uint32_t k = 0; k < count_; ++k) {
    // Stored by id: packings number their sites row by row.
    const Particle p = particle(k);
    const uint32_t at = p.id;
    particles_.id[at] = p.id;
    particles_.type[at] = p.type;
    particles_.node[at] = p.node;
    const Cell& cell = lattice_.cell(p.node);
    for (int a = 0; a < 3; ++a) {
      particles_.x[a][at] = static_cast<double>(p.x[a]) + cell[a] * rule_.cell;
      particles_.v[a][at] = static_cast<double>(p.v[a]);
      if (plan_.rule.pd) particles_.u[a][at] = static_cast<double>(p.u[a]);
    }
    fastest_ = std::max(fastest_, std::hypot(particles_.v[0][at], particles_.v[1][at], particles_.v[2][at]));
    if (!members_.append(p.node, at)) faults.push_back(error(Fault::full_x, p.node, at, plan_.arch.capacity));
  }
  fail_if_any(faults);
  if (options_.quiescence) quiet_.emplace(lattice_, rows_);
}

RunError LatticeEngine::Impl::error(Fault fault, uint32_t node, uint32_t index, int64_t number) const {
  const Cell& c = lattice_.cell(node);
  return {fault, step_,  node, particles_.id[index],
          number, fmt::format(" at cell ({}, {}, {})", c[0], c[1], c[2])};
}

void LatticeEngine::Impl::fail_if_any(const std::vector<RunError>& faults) const {
  if (faults.empty()) return;
  throw *std::min_element(faults.begin(), faults.end(),
                          [](const auto& a, const auto& b) { return order(a) < order(b); });
}

void LatticeEngine::Impl::fail_if_any(std::vector<Found> Block::*faults) {
  std::vector<RunError> errors;
  for (const Block& block : blocks_)
    for (const Found& f : block.*faults)
      errors.push_back(error(f.fault, particles_.node[f.particle], f.particle, f.number));
  fail_if_any(errors);
}

Particle LatticeEngine::Impl::particle(uint32_t index) const {
  Particle p;
  p.id = particles_.id[index];
  p.type = particles_.type[index];
  p.node = particles_.node[index];
  const int64_t mask = (int64_t{1} << plan_.rule.widths.position_frac) - 1;
  for (int a = 0; a < 3; ++a) {
    p.x[a] = static_cast<int64_t>(particles_.x[a][index]) & mask;
    p.v[a] = static_cast<int64_t>(particles_.v[a][index]);
    if (plan_.rule.pd) p.u[a] = static_cast<int64_t>(particles_.u[a][index]);
  }
  return p;
}

template <typename Work>
void LatticeEngine::Impl::for_each_block(const Work& work) {
#pragma omp parallel for schedule(static, 1) num_threads(threads_)
  for (size_t b = 0; b < blocks_.size(); ++b) work(blocks_[b]);
}

// Cells that a particle can have moved in the last step.
double LatticeEngine::Impl::reach_of_step() const {
  return std::ldexp(fastest_ + 2 * std::ldexp(1.0, plan_.rule.widths.guard), -plan_.rule.widths.velocity_frac());
}

// Calls see(particle) for each that may have moved since the far list was made.
template <typename See>
void LatticeEngine::Impl::for_each_moved(const See& see) const {
  if (const NodeSet* moved = quiet_ ? quiet_->moved() : nullptr)
    moved->for_each(rows_, [&](uint32_t n) { members_.for_each(n, see); });
  else
    for (uint32_t p = 0; p < count_; ++p) see(p);
}

double LatticeEngine::Impl::displacement() const {
  if (!quiet_ || quiet_->moved() == nullptr) return snapshot_.displacement(particles_);
  double most = 0;
  for_each_moved([&](uint32_t p) { most = std::max(most, snapshot_.moved(particles_, p)); });
  return most;
}

// The span of nodes of each group.
void LatticeEngine::Impl::find_group_nodes() {
  const uint32_t groups = (count_ + kGroup - 1) / kGroup;
  particles_.group_nodes.assign(groups + 1, {0, 0});  // an entry may overhang the last group
#pragma omp parallel for num_threads(threads_)
  for (uint32_t g = 0; g < groups; ++g) {
    const uint32_t* node = &particles_.node[g * kGroup];
    const auto [low, high] = std::minmax_element(node, node + std::min(kGroup, count_ - g * kGroup));
    particles_.group_nodes[g] = {*low, *high - *low + 1};
  }
}

void LatticeEngine::Impl::widen_group_nodes(uint32_t particle) {
  auto& [low, span] = particles_.group_nodes[particle / kGroup];
  const uint32_t node = particles_.node[particle], high = std::max(low + span - 1, node);
  low = std::min(low, node);
  span = high - low + 1;
}

// Whether the order of storage lets an entry hold several pairs.
bool LatticeEngine::Impl::crystal() const {
  size_t entries = 0, pairs = 0;
  for (const Block& block : blocks_) {
    entries += block.inside.entries.size();
    for (const Entry& e : block.inside.entries) pairs += static_cast<size_t>(std::popcount(e.lanes));
  }
  return static_cast<double>(pairs) >= kFewLanes * static_cast<double>(entries);
}

void LatticeEngine::Impl::store_by_node(Bins& bins) {
  std::vector<uint32_t> renamed(members_.room());
  for (uint32_t k = 0; k < count_; ++k) renamed[bins.particle[k]] = k;
  const auto reorder = [&](auto& array) {
    const auto copy = array.copy();
    for (uint32_t k = 0; k < count_; ++k) array[k] = copy[bins.particle[k]];
  };
  for (int a = 0; a < 3; ++a) {
    reorder(particles_.x[a]);
    reorder(particles_.v[a]);
    if (plan_.rule.pd) reorder(particles_.u[a]);
  }
  reorder(particles_.id);
  reorder(particles_.node);
  reorder(particles_.type);
  members_.rename(renamed);
  for (uint32_t k = 0; k < count_; ++k) bins.particle[k] = k;
}

void LatticeEngine::Impl::build() {
  if (listed_ && step_ - listed_at_ < kShortLife) skin_ = std::min(kMostSkin, skin_ * 1.3);
  Bins bins(lattice_, members_, particles_, snapshot_.position_frac, threads_);
  if (listed_ && !crystal()) store_by_node(bins);
  for_each_block([&](Block& block) {
    build_list(rule_, particles_, Search(lattice_, rows_, cutoff_ + skin_, bins), block);
  });
  bins.release_to(snapshot_);
  ++counters_.list_builds;
  listed_ = true;
  listed_at_ = step_;
  moved_ = 0;
  near_floor_ = -1;
  if (quiet_) {
    quiet_->forget_moved();
    find_group_nodes();
  }
}

// Where few particles moved far, as around a crack or an impact: lists anew the groups of those, and of all
// around where they are now. False where that is not worth it.
bool LatticeEngine::Impl::mend() {
  std::vector<uint32_t> strays;
  for_each_moved([&](uint32_t p) {
    if (snapshot_.astray(lattice_, particles_, p, kMendFrom * skin_)) strays.push_back(p);
  });
  if (static_cast<double>(strays.size()) > kMostMended * count_) return false;
  for (const uint32_t p : strays)
    for (int a = 0; a < 3; ++a)  // beyond the seam of a ring: the shifts of its entries no longer hold
      if (std::floor(particles_.x[a][p] * rule_.inverse_cell) != lattice_.cell(particles_.node[p])[a]) return false;
  for (const uint32_t p : strays) snapshot_.look(particles_, p);
  std::vector<uint8_t> only((count_ + kGroup - 1) / kGroup);
  Search search(lattice_, rows_, cutoff_ + skin_, members_, snapshot_);
  for (const uint32_t p : strays)
    for (const auto& hit : search.around(particles_.node[p], {snapshot_.at[0][p], snapshot_.at[1][p], snapshot_.at[2][p]}))
      only[hit.particle / kGroup] = 1;
  for_each_block([&](Block& block) { mend_list(particles_, snapshot_, search, only, block); });
  ++counters_.list_mends;
  moved_ = displacement();
  return true;
}

// Every pair within the cutoff plus `skin` cells comes into the near list.
void LatticeEngine::Impl::prune(double skin) {
  // Groups far from all that changed since the last time keep what they have, if that was as wide.
  const uint8_t* only = quiet_ ? quiet_->take_touched() : nullptr;
  if (skin > near_floor_ || skin < kWaste * near_floor_) only = nullptr;
  if (only == nullptr) near_floor_ = skin;
  near_skin_ = skin;
  near_moved_ = 0;
  const double reach = (cutoff_ + near_floor_) * rule_.cell * (1 + 1e-9);
  for_each_block([&](Block& block) { kernels_.prune(particles_, reach, only, block); });
}

// Makes sure that the near list holds every pair inside the cutoff.
void LatticeEngine::Impl::refresh_lists() {
  if (listed_ && near_moved_ <= near_skin_ / 2) return;
  // The far list must hold every pair within the near list's reach.
  const auto room = [&] { return skin_ - 2 * moved_; };
  const double least = 2 * reach_of_step();
  double wanted = std::min(std::max(kNearSkin, 2 * kNearSteps * reach_of_step()), kMostNear * skin_);
  if (!listed_ || room() < wanted) {
    if (listed_) moved_ = displacement();
    if (!listed_ || room() < std::max(least, wanted / 2)) {
      if (!listed_ || !mend() || room() < least) build();
    }
    wanted = std::min(wanted, room());
  }
  prune(wanted);
}

void LatticeEngine::Impl::step() {
  refresh_lists();
  Active active;
  if (quiet_) active = quiet_->next();
  for (Block& block : blocks_) {
    block.crossings.clear();
    block.pair_faults.clear();
    block.update_faults.clear();
    block.fastest2 = 0;
  }
  for_each_block([&](Block& block) { kernels_.across(rule_, particles_, active, block); });
  for_each_block([&](Block& block) { kernels_.inside(rule_, particles_, active, block); });
  fail_if_any(&Block::pair_faults);
  fail_if_any(&Block::update_faults);

  std::vector<Crossing> crossings;
  for (const Block& block : blocks_)
    crossings.insert(crossings.end(), block.crossings.begin(), block.crossings.end());
  std::vector<RunError> faults;
  for (const Refused& r : members_.migrate(crossings, particles_.node, leaving_))
    faults.push_back(error(r.fault, r.node, r.particle,
                           r.fault == Fault::full_x || r.fault == Fault::full_y || r.fault == Fault::full_z
                               ? plan_.arch.capacity
                               : 0));
  fail_if_any(faults);
  if (quiet_) {
    for (const Crossing& c : crossings) {
      quiet_->changed(particles_.node[c.particle]);
      widen_group_nodes(c.particle);
    }
    quiet_->done();
  }

  fastest_ = 0;
  for (const Block& block : blocks_) fastest_ = std::max(fastest_, std::sqrt(block.fastest2));
  moved_ += reach_of_step();
  near_moved_ += reach_of_step();
  counters_.node_steps += lattice_.size();
  if (quiet_) counters_.quiet_node_steps += quiet_->quiet_nodes();
  ++step_;
}

LatticeEngine::LatticeEngine(const Plan& plan, uint64_t step, uint32_t count,
                             const std::function<Particle(uint32_t)>& particle, const LatticeOptions& options)
    : impl_(std::make_unique<Impl>(plan, step, count, options)) {
  impl_->fill(particle);
}

LatticeEngine::~LatticeEngine() = default;

void LatticeEngine::step() { impl_->step(); }
uint64_t LatticeEngine::step_count() const { return impl_->step_; }
uint32_t LatticeEngine::size() const { return impl_->count_; }
const LatticeCounters& LatticeEngine::counters() const { return impl_->counters_; }
int LatticeEngine::threads() const { return impl_->threads_; }
const std::string& LatticeEngine::simd() const { return impl_->kernels_.name; }
std::span<const Leaving> LatticeEngine::leaving() const { return impl_->leaving_; }

State LatticeEngine::state() const {
  State state{impl_->step_, std::vector<Particle>(impl_->count_)};
  for (uint32_t k = 0; k < impl_->count_; ++k) {
    const Particle p = impl_->particle(k);
    state.particles[p.id] = p;
  }
  return state;
}

void LatticeEngine::for_each_slot(const std::function<void(const Particle&)>& see) const {
  for (uint32_t n = 0; n < impl_->lattice_.size(); ++n)
    impl_->members_.for_each(n, [&](uint32_t p) { see(impl_->particle(p)); });
}

uint64_t LatticeEngine::hash() const {
  uint64_t sum = 0;
#pragma omp parallel for reduction(+ : sum) num_threads(impl_->threads_)
  for (uint32_t k = 0; k < impl_->count_; ++k) sum += hash_of(impl_->lattice_, impl_->particle(k));
  return sum;
}

Int3 LatticeEngine::momentum() const {
  Int3 sum{};
  for (int a = 0; a < 3; ++a)
    for (uint32_t k = 0; k < impl_->count_; ++k) sum[a] += static_cast<int64_t>(impl_->particles_.v[a][k]);
  return sum;
}

void LatticeEngine::slots(NodeSlots& out) const {
  const uint32_t nodes = impl_->lattice_.size();
  out.first.resize(nodes + 1);
  uint32_t at = 0;
  for (uint32_t n = 0; n < nodes; ++n) {
    out.first[n] = at;
    at += static_cast<uint32_t>(impl_->members_.count(n));
  }
  out.first[nodes] = at;
  for (auto& x : out.x) x.resize(at);
  const int64_t mask = (int64_t{1} << impl_->plan_.rule.widths.position_frac) - 1;
#pragma omp parallel for num_threads(impl_->threads_)
  for (uint32_t n = 0; n < nodes; ++n) {
    uint32_t k = out.first[n];
    impl_->members_.for_each(n, [&](uint32_t p) {
      for (int a = 0; a < 3; ++a)
        out.x[a][k] = static_cast<int32_t>(static_cast<int64_t>(impl_->particles_.x[a][p]) & mask);
      ++k;
    });
  }
}

}  // namespace cuboct::emu
