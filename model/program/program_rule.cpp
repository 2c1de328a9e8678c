// SPDX-License-Identifier: MIT
#include "model/program/program_rule.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <mutex>
#include <optional>
#include <stdexcept>

#include "model/base/error.h"
#include "model/base/hash.h"
#include "model/graph/noise.h"
#include "model/program/near_rows.h"
#include "model/program/real_block.h"
#include "model/rules/reference_bonds.h"

namespace cuboct {
namespace {

using Source = RealSource;

constexpr size_t kFinishRows = 64;  // particles whose finish is one block

// The bonds of some particles, one after another: as many as fill the loops over lanes.
struct Rows {
  static constexpr size_t kLanes = 256;  // from here on no more particles

  size_t first = 0;              // particle
  std::vector<size_t> begin{0};  // [particle - first]: its first lane; one more at the end
  std::vector<uint32_t> own, other;
  std::array<std::vector<double>, 3> difference, packed;  // m, from own to other
  uint64_t bond = 0;                                      // of the first lane, of bonds that last

  size_t lanes() const { return own.size(); }
  size_t particles() const { return begin.size() - 1; }
  void clear(size_t particle) {
    first = particle;
    begin.assign(1, 0);
    own.clear(), other.clear();
    for (size_t a = 0; a < 3; ++a) difference[a].clear(), packed[a].clear();
  }
};

// Number by number what goes on from step to step: of particles, then of bonds.
template <class Values>
std::vector<Values*> memorable(const RuleProgram& program, Values* particles, Values* bonds) {
  std::vector<Values*> all;
  for (const ProgramField& field : program.particle)
    for (uint32_t k = 0; field.kept && k < field.numbers(); ++k) all.push_back(&particles[field.first + k]);
  for (const ProgramField& field : program.bond)
    for (uint32_t k = 0; field.kept && k < field.numbers(); ++k) all.push_back(&bonds[field.first + k]);
  return all;
}

class ProgramTerms final : public RoundsTerms {
 public:
  ProgramTerms(const RuleProgram& program, const Rule& rule, const Body& body, const Periodic& periodic)
      : program_(program),
        dt_(rule.dt),
        x0_(body.x),
        x_(&x0_),
        v_(body.v),
        force_(body.size(), Vec3::Zero()) {
    for (const uint8_t type : body.type) {
      mass_.push_back(rule.mass_of(type));
      element_.push_back(program.element.empty() ? 1 : program.element[type]);
    }
    if (program.declaration.bonds == BondRange::reference)
      bonds_ = reference_bonds(x0_, periodic, program.reach, program.slits);
    else
      near_.emplace(program.reach, periodic);
    work_.assign(program.particle_numbers, std::vector<double>(body.size(), 0));
    next_ = work_;
    if (near_ && !program.setup.empty()) near_->update(x0_);
    find_regions();
    start_particles();
    start_bonds();
    for (size_t k = 0; k < program.setup.size(); ++k) {
      const ProgramRound& round = program.setup[k];
      pair_of(round, 0, body.size(), true);
      finish_of(round, 0, body.size());
      publish(round);
    }
    kept_ = work_;
    bond_kept_ = bond_;
  }

  void velocities(const std::vector<Vec3>& v) override { v_ = v; }
  void set_box(const Periodic& periodic) override {
    if (near_) near_->set_box(periodic);
  }
  void time(uint64_t step) override { time_ = static_cast<int64_t>(program_.first_step + step); }
  void begin(const std::vector<Vec3>& x) override {
    for (size_t i = 0; i < x.size(); ++i)
      if (!x[i].allFinite())
        throw std::runtime_error(fmt::format("particle {} has a position that is not finite", i));
    x_ = &x;
    if (near_) near_->update(x);
    beyond_.reset();
    take_up();
  }
  void pair(size_t round, size_t begin, size_t end, bool keeps) override {
    pair_of(program_.rounds[round], begin, end, keeps);
  }
  void finish(size_t round, size_t begin, size_t end) override {
    finish_of(program_.rounds[round], begin, end);
  }
  void end(size_t round, bool keeps) override {
    if (beyond_) throw RoundsError(beyond_->told());
    publish(program_.rounds[round]);
    if (round + 1 < program_.rounds.size()) return;
    if (!program_.still)
      for (size_t i = 0; i < force_.size(); ++i)
        for (uint32_t a = 0; a < 3; ++a) force_[i][a] = work_[program_.force + a][i];
    // What was only looked at: fields that go on are those of the last step.
    keeps ? lay_down() : take_up();
  }
  const std::vector<Vec3>& force() const override { return force_; }
  ProgramStart now() const { return {work_, bonds_, bond_}; }

  double energy() const override {
    double sum = 0;
    if (program_.pair_energy_at) {
      RealBlock block(program_.pair_energy);
      for_rows(0, x0_.size(), [&](const Rows& rows) {
        run(block, rows);
        check(program_.pair_energy, block, rows.lanes(), [&](size_t k) { return rows.own[k]; });
        const double* pair = block.of(*program_.pair_energy_at);
        for (size_t k = 0; k < rows.lanes(); ++k) sum += pair[k] / 2;
      });
    }
    if (program_.particle_energy_at) {
      RealBlock block(program_.particle_energy);
      for (size_t i = 0; i < x0_.size(); i += kFinishRows) {
        const size_t count = std::min(kFinishRows, x0_.size() - i);
        block.run(count, [&](const RealInput& input, double* to) { fill_own(input, i, count, to); });
        check(program_.particle_energy, block, count, [&](size_t k) { return i + k; });
        for (size_t k = 0; k < count; ++k) sum += block.of(*program_.particle_energy_at)[k];
      }
    }
    if (beyond_) throw RoundsError(beyond_->told());
    return sum;
  }
  // Half of the virial of the force's terms: the other half is of the other particle.
  Mat3 stress(size_t particle, double volume) const override {
    Mat3 sum = Mat3::Zero();
    if (program_.still) return sum;
    const ProgramRound& round = program_.rounds.back();
    RealBlock block(round.pair);
    Rows rows;
    rows.clear(particle);
    gather(particle, rows);
    run(block, rows);
    for (uint32_t a = 0; a < 3; ++a) {
      for (const auto& [term, minus] : force_terms(round, a))
        for (size_t k = 0; k < rows.lanes(); ++k)
          if (block.of(round.when[term])[k] != 0)
            for (int b = 0; b < 3; ++b) {
              const double part = rows.difference[static_cast<size_t>(b)][k] * block.of(round.terms[term])[k];
              sum(b, a) += minus ? -part : part;
            }
    }
    return sum / (2 * volume);
  }
  std::vector<double> damage() const override {
    std::vector<double> shares(x0_.size(), 0);
    if (!program_.broken_at || bonds_.other.empty()) return shares;
    RealBlock block(program_.broken);
    for_rows(0, x0_.size(), [&](const Rows& rows) {
      block.run(rows.lanes(),
                [&](const RealInput& input, double* to) { fill_bond(input, rows.bond, rows.lanes(), to); });
      const double* broken = block.of(*program_.broken_at);
      for (size_t i = 0; i < rows.particles(); ++i) {
        const size_t first = rows.begin[i], count = rows.begin[i + 1] - first;
        if (count > 0)
          shares[rows.first + i] =
              static_cast<double>(std::count(broken + first, broken + first + count, 1.0)) /
              static_cast<double>(count);
      }
    });
    return shares;
  }
  uint64_t bonds() const override {
    if (!near_) return bonds_.other.size() / 2;
    uint64_t count = 0;
    for_rows(0, x0_.size(), [&](const Rows& rows) { count += rows.lanes(); });
    return count / 2;
  }
  std::vector<std::vector<double>> shown() const override {
    std::vector<std::vector<double>> fields;
    for (const ProgramField& field : program_.particle) {
      if (!field.shown) continue;
      const uint32_t numbers = field.numbers();
      std::vector<double>& values = fields.emplace_back(numbers * x0_.size());
      for (size_t i = 0; i < x0_.size(); ++i)
        for (uint32_t k = 0; k < numbers; ++k) values[numbers * i + k] = work_[field.first + k][i];
    }
    if (program_.shows_damage) fields.push_back(damage());
    return fields;
  }

  std::vector<uint64_t> memory() const override {
    std::vector<uint64_t> words;
    for (const std::vector<double>* values : memorable(program_, kept_.data(), bond_kept_.data()))
      for (const double value : *values) words.push_back(std::bit_cast<uint64_t>(value));
    return words;
  }
  void recall(const std::vector<uint64_t>& words) override {
    const auto all = memorable(program_, kept_.data(), bond_kept_.data());
    size_t at = 0, wanted = 0;
    for (const std::vector<double>* values : all) wanted += values->size();
    if (words.size() != wanted)
      throw InputError(
          fmt::format("the state holds {} numbers of fields, and the rule keeps {}", words.size(), wanted));
    for (std::vector<double>* values : all)
      for (double& value : *values) value = std::bit_cast<double>(words[at++]);
    take_up();
  }
  uint64_t memory_hash() const override {
    Hash hash;
    for (const DeclarationLine& line : program_.settings)
      for (const char c : line.name + line.text) hash.add(c);
    hash.add(static_cast<int64_t>(x0_.size()));
    for (const uint32_t other : bonds_.other) hash.add(other);
    return hash.value();
  }

 private:
  // What is asked of a table beyond its end: of the first particle of those that do, whoever finds it.
  struct Beyond {
    size_t particle;
    const TableCurve* table;
    double at;
    std::string told() const {
      return fmt::format("particle {}: the {} is asked for at {:.6g}, and its table ends at {:.6g}", particle,
                         table->what(), at, table->end());
    }
  };

  // What the last step left becomes what the rounds work on, and back.
  void take_up() {
    for (const ProgramField& field : program_.particle)
      for (uint32_t k = 0; field.kept && k < field.numbers(); ++k)
        work_[field.first + k] = kept_[field.first + k];
    if (writes_bonds()) bond_ = bond_kept_;
  }
  void lay_down() {
    for (const ProgramField& field : program_.particle)
      for (uint32_t k = 0; field.kept && k < field.numbers(); ++k)
        kept_[field.first + k] = work_[field.first + k];
    if (writes_bonds()) bond_kept_ = bond_;
  }
  bool writes_bonds() const { return std::ranges::any_of(program_.bond, &ProgramField::kept); }
  // The sums that the force is made of.
  std::vector<std::pair<size_t, bool>> force_terms(const ProgramRound& round, uint32_t axis) const {
    std::vector<std::pair<size_t, bool>> terms;
    const auto write = std::ranges::find(round.made, program_.force + axis, &ProgramWrite::number);
    for (const Addend& part : addends_of(round.finish, write->node)) {
      const RealNode& node = round.finish.at(part.node);
      if (node.op == RealOp::input && node.input.source == Source::sum)
        terms.emplace_back(node.input.index, part.minus);
    }
    return terms;
  }

  // Calls work(rows) for the particles [begin, end), in ascending order.
  template <class Work>
  void for_rows(size_t begin, size_t end, const Work& work) const {
    Rows rows;
    for (size_t i = begin; i < end;) {
      rows.clear(i);
      while (i < end && rows.lanes() < Rows::kLanes) gather(i++, rows);
      work(rows);
    }
  }
  void gather(size_t i, Rows& rows) const {
    near_ ? gather_near(i, rows) : gather_bonds(i, rows);
    rows.own.resize(rows.other.size(), static_cast<uint32_t>(i));
    rows.begin.push_back(rows.lanes());
  }
  void gather_near(size_t i, Rows& rows) const {
    const std::vector<Vec3>& x = *x_;
    const double reach2 = near_->reach() * near_->reach();
    for (const uint32_t j : near_->row(i)) {
      const Vec3 d = near_->difference(x[i], x[j]);
      if (d.squaredNorm() >= reach2) continue;
      rows.other.push_back(j);
      for (size_t a = 0; a < 3; ++a) rows.difference[a].push_back(d[static_cast<int>(a)]);
    }
  }
  void gather_bonds(size_t i, Rows& rows) const {
    const std::vector<Vec3>& x = *x_;
    const uint64_t begin = bonds_.begin(i), count = bonds_.end(i) - begin;
    const size_t lane = rows.lanes();
    if (lane == 0) rows.bond = begin;
    rows.other.insert(rows.other.end(), bonds_.other.begin() + static_cast<ptrdiff_t>(begin),
                      bonds_.other.begin() + static_cast<ptrdiff_t>(begin + count));
    for (size_t a = 0; a < 3; ++a) {
      rows.difference[a].resize(lane + count), rows.packed[a].resize(lane + count);
      const auto axis = static_cast<int>(a);
      const double moved = x[i][axis] - x0_[i][axis];
      for (uint64_t k = 0; k < count; ++k) {
        const uint32_t j = rows.other[lane + k];
        rows.packed[a][lane + k] = bonds_.vector[begin + k][axis];
        rows.difference[a][lane + k] = bonds_.vector[begin + k][axis] + ((x[j][axis] - x0_[j][axis]) - moved);
      }
    }
  }

  double own_of(const RealInput& input, size_t i) const {
    switch (input.source) {
      case Source::own_velocity:
      case Source::other_velocity:
        return v_[i][input.index];
      case Source::own_mass:
      case Source::other_mass:
        return mass_[i];
      case Source::own_field:
      case Source::other_field:
        return work_[input.index][i];
      case Source::position:
        return (*x_)[i][input.index];
      case Source::own_element:
      case Source::other_element:
        return element_[i];
      case Source::own_region:
      case Source::other_region:
        return inside_[input.index][i];
      case Source::noise:
        return noise(input.index, i, i);
      default:
        return dt_;
    }
  }
  double noise(uint32_t stream, size_t i, size_t j) const {
    const int64_t drawn =
        graph::noise_of(stream, static_cast<int64_t>(i), static_cast<int64_t>(j), time_, graph::kNoiseBits);
    return static_cast<double>(2 * drawn + 1) * graph::kNoiseUnit;
  }
  void fill_own(const RealInput& input, size_t begin, size_t count, double* to) const {
    for (size_t k = 0; k < count; ++k) to[k] = own_of(input, begin + k);
  }
  void fill_bond(const RealInput& input, uint64_t begin, size_t count, double* to) const {
    std::copy_n(bond_[input.index].begin() + static_cast<ptrdiff_t>(begin), count, to);
  }
  void run(RealBlock& block, const Rows& rows, bool makes = false) const {
    block.run(rows.lanes(), [&](const RealInput& input, double* to) {
      switch (input.source) {
        case Source::difference:
          std::ranges::copy(rows.difference[input.index], to);
          break;
        case Source::packed:
          std::ranges::copy(rows.packed[input.index], to);
          break;
        case Source::made:
          std::fill_n(to, rows.lanes(), makes);
          break;
        case Source::bond_field:
          fill_bond(input, rows.bond, rows.lanes(), to);
          break;
        case Source::noise:
          for (size_t k = 0; k < rows.lanes(); ++k) to[k] = noise(input.index, rows.own[k], rows.other[k]);
          break;
        case Source::other_velocity:
        case Source::other_mass:
        case Source::other_field:
        case Source::other_element:
        case Source::other_region:
          fill_at(input, rows.other, to);
          break;
        default:
          fill_at(input, rows.own, to);
      }
    });
  }
  void fill_at(const RealInput& input, const std::vector<uint32_t>& ids, double* to) const {
    if (input.source == Source::own_field || input.source == Source::other_field) {
      const double* values = work_[input.index].data();
      for (size_t k = 0; k < ids.size(); ++k) to[k] = values[ids[k]];
    } else {
      for (size_t k = 0; k < ids.size(); ++k) to[k] = own_of(input, ids[k]);
    }
  }

  // Sums by ascending id of the other. A row writes its own sums and its own bonds.
  void pair_of(const ProgramRound& round, size_t begin, size_t end, bool makes) {
    RealBlock block(round.pair);
    for_rows(begin, end, [&](const Rows& rows) {
      run(block, rows, makes);
      check(round.pair, block, rows.lanes(), [&](size_t k) { return rows.own[k]; });
      for (const ProgramWrite& write : round.bonds)
        std::copy_n(block.of(write.node), rows.lanes(),
                    bond_[write.number].begin() + static_cast<ptrdiff_t>(rows.bond));
      for (size_t n = 0; n < round.terms.size(); ++n)
        sum_up(rows, block.of(round.terms[n]), block.of(round.when[n]), sums_[n].data() + rows.first);
    });
  }
  static void sum_up(const Rows& rows, const double* term, const double* when, double* sums) {
    for (size_t i = 0; i < rows.particles(); ++i) {
      double sum = 0;
      for (size_t k = rows.begin[i]; k < rows.begin[i + 1]; ++k)
        if (when[k] != 0) sum += term[k];
      sums[i] = sum;
    }
  }

  void finish_of(const ProgramRound& round, size_t begin, size_t end) {
    RealBlock block(round.finish);
    for (size_t first = begin; first < end; first += kFinishRows) {
      const size_t count = std::min(kFinishRows, end - first);
      block.run(count, [&](const RealInput& input, double* to) {
        if (input.source == Source::sum)
          std::copy_n(sums_[input.index].begin() + static_cast<ptrdiff_t>(first), count, to);
        else
          fill_own(input, first, count, to);
      });
      check(round.finish, block, count, [&](size_t k) { return first + k; });
      for (const ProgramWrite& write : round.made)
        std::copy_n(block.of(write.node), count, next_[write.number].begin() + static_cast<ptrdiff_t>(first));
    }
  }
  template <class ParticleOf>
  void check(const RealGraph& graph, const RealBlock& block, size_t count,
             const ParticleOf& particle_of) const {
    if (!program_.potential) return;
    for (const RealNode& node : graph.nodes()) {
      if (!is_curve(node.op) || !node.table->bounded()) continue;
      const double* at = block.of(node.of[0]);
      for (size_t k = 0; k < count; ++k)
        if (node.table->beyond(at[k])) {
          const std::lock_guard lock(found_);
          const size_t particle = particle_of(k);
          if (!beyond_ || particle < beyond_->particle) beyond_ = {particle, node.table, at[k]};
        }
    }
  }
  void publish(const ProgramRound& round) {
    for (const ProgramWrite& write : round.made) work_[write.number].swap(next_[write.number]);
  }

  void find_regions() {
    inside_.resize(program_.regions.size());
    for (const uint32_t k : regions_of_starts(program_))
      for (const Vec3& x : x0_) inside_[k].push_back(program_.regions[k](x) ? 1 : 0);
  }
  void start_particles() {
    size_t most = 0;
    for (const auto* rounds : {&program_.setup, &program_.rounds})
      for (const ProgramRound& round : *rounds) most = std::max(most, round.terms.size());
    sums_.assign(most, std::vector<double>(x0_.size(), 0));
    // A start may use those before it, so each is a pass of its own.
    for (const ProgramField& field : program_.particle)
      for (size_t k = 0; k < field.start.size(); ++k) {
        RealBlock block(program_.start);
        for (size_t first = 0; first < x0_.size(); first += kFinishRows) {
          const size_t count = std::min(kFinishRows, x0_.size() - first);
          block.run(count, [&](const RealInput& input, double* to) { fill_own(input, first, count, to); });
          std::copy_n(block.of(field.start[k]), count,
                      work_[field.first + k].begin() + static_cast<ptrdiff_t>(first));
        }
      }
  }
  void start_bonds() {
    bond_.assign(program_.bond_numbers, std::vector<double>(bonds_.other.size(), 0));
    for (const ProgramField& field : program_.bond)
      for (size_t k = 0; k < field.start.size(); ++k) {
        RealBlock block(program_.bond_start);
        for_rows(0, bonds_.other.empty() ? 0 : x0_.size(), [&](const Rows& rows) {
          run(block, rows);
          std::copy_n(block.of(field.start[k]), rows.lanes(),
                      bond_[field.first + k].begin() + static_cast<ptrdiff_t>(rows.bond));
        });
      }
  }

  const RuleProgram& program_;
  double dt_;
  int64_t time_ = graph::kNoTime;
  std::vector<Vec3> x0_;
  const std::vector<Vec3>* x_;
  std::vector<Vec3> v_, force_;
  std::vector<double> mass_, element_;
  std::vector<std::vector<double>> inside_;  // [region][particle], of those that starts name
  ReferenceBonds bonds_{{0}, {}, {}};
  std::optional<NearRows> near_;
  mutable std::mutex found_;
  mutable std::optional<Beyond> beyond_;
  // [number][particle] and [number][bond]: what the rounds work on, what a finish makes of it, and what the
  // last step left. A row's sums are read by its own finish alone, so all rounds share them.
  std::vector<std::vector<double>> work_, next_, kept_, sums_, bond_, bond_kept_;
};

}  // namespace

double ProgramRule::bond_reach() const {
  return program_.broken_at ? program_.reach : std::numeric_limits<double>::infinity();
}

double ProgramRule::stable_time_step(double mass, double) const {
  return program_.stiffness > 0 ? 2 / std::sqrt(program_.stiffness / mass) : 0;
}

std::unique_ptr<RoundsTerms> ProgramRule::bind(const Rule& rule, const Body& body, const Periodic& periodic,
                                               int) const {
  auto terms = std::make_unique<ProgramTerms>(program_, rule, body, periodic);
  return terms;
}

ProgramStart starts_of(const RuleProgram& program, const Rule& rule, const Body& body,
                       const Periodic& periodic) {
  Body packed = body;
  if (body.bonds) packed.x = body.bonds->packed;
  ProgramTerms terms(program, rule, packed, periodic);
  recall_bonds(terms, body);
  return terms.now();
}

}  // namespace cuboct
