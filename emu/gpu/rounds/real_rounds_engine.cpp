// SPDX-License-Identifier: MIT
#include "emu/gpu/rounds/real_rounds_engine.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

#include "emu/gpu/device/memory_words.h"
#include "emu/gpu/messages.h"
#include "emu/gpu/rounds/real_rounds_domain.h"
#include "emu/gpu/rounds/real_rounds_text.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/program/program_rule.h"
#include "model/rules/rounds_rule.h"

namespace cuboct::gpu {
namespace {

constexpr uint32_t kShortestBatch = 4;

size_t index(int n) { return static_cast<size_t>(n); }

// Of a round's pairs, whether they read the input of a partner.
bool reads_of_others(const ProgramRound& round, RealSource source, uint32_t number) {
  return std::ranges::any_of(round.pair.nodes(), [&](const RealNode& node) {
    return node.op == RealOp::input && node.input.source == source &&
           (source != RealSource::other_field || node.input.index == number);
  });
}

template <class Real, class Number>
class RealRoundsEngine final : public RealRounds {
 public:
  using Domain = RealDomain<Real, Number>;
  using Slab = typename Domain::Slab;
  using Frame = typename Slab::Frame;
  static constexpr bool kWide = sizeof(Number) == 8, kDoubles = sizeof(Real) == 8;

  RealRoundsEngine(const Rule& rule, const Body& body, const Periodic& periodic, const Options& options,
                   const CompileRounds& compile, const Memory& memory)
      : rule_(rule),
        program_(*rule.rounds->text()),
        block_(options.block),
        bonded_(program_.declaration.bonds == BondRange::reference),
        count_(static_cast<uint32_t>(body.size())),
        step_(memory.step),
        start_(starts_of(program_, rule, body, periodic)),
        kinds_(bonded_ ? bond_kinds_of(program_, start_) : RealBondKinds()),
        text_(real_text_of(program_, rule, start_, kinds_, {kDoubles, kWide, sizeof(Frame)})),
        domain_(program_, space_of(body, periodic, memory),
                {program_.reach, largest_skin(periodic), double(count_)}, text_.exponents, numbers(), body,
                options) {
    for (uint32_t f = 0; f < numbers(); ++f)
      seen_.push_back(std::ranges::any_of(program_.rounds, [&](const ProgramRound& round) {
        return reads_of_others(round, RealSource::other_field, f);
      }));
    load(compile);
    make_frame();
    domain_.upload(body, start_.particle);
    if (bonded_) {
      domain_.put_bonds(start_, kinds_, text_.kinds);
      listed_ = true;
    }
    start_ = {}, kinds_ = {};
    if (!memory.words.empty()) restore(memory.words);
  }

  void advance(uint64_t steps) override {
    const uint64_t end = step_ + steps;
    while (step_ < end && !interrupted()) {
      if (!listed_) make_lists();
      const auto batch = static_cast<uint32_t>(std::min<uint64_t>(end - step_, batch_));
      const Told told = run(batch);
      const uint32_t failed = std::min(told.lost, told.beyond);
      const uint32_t done = std::min({batch, failed - 1, told.old});
      step_ += done, age_ += done;
      if (done == told.old) {
        listed_ = false;
        // The next one may live a little longer.
        batch_ = static_cast<uint32_t>(
            std::clamp<uint64_t>(age_ + age_ / 4 + 1, kShortestBatch, kRealLongestBatch));
      } else if (done < batch) {
        fail(told);
      } else if (batch == batch_) {
        batch_ = std::min(2 * batch_, kRealLongestBatch);
      }
    }
  }
  uint64_t step_count() const override { return step_; }

  void read(Body& body) const override {
    const std::vector<RealFour<Real>> v = domain_.v();
    for (size_t id = 0; id < count_; ++id)
      for (int a = 0; a < 3; ++a) body.v[id][a] = Domain::si(v[id].at[a], text_.exponents.velocity);
    for (size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<int>(a);
      const std::vector<int64_t> x = domain_.x(a);
      for (size_t id = 0; id < count_; ++id) body.x[id][axis] = domain_.space.metres(x[id], a);
      if (!domain_.displaced()) continue;
      const std::vector<Real> u = domain_.u(a);
      for (size_t id = 0; id < count_; ++id) body.u[id][axis] = Domain::si(u[id], text_.exponents.length);
    }
  }

  RealLook look() override {
    if (!listed_) make_lists();
    for (auto& slab : domain_.slabs)
      for (Array<Real>& force : slab->force) force.resize(slab->own);
    const RealPlaces here = domain_.places;
    reset();
    step(1, true);
    const Told told = what_was_told();
    if (told.beyond == 1) domain_.places = here, fail(told);
    near_stale_ = false;
    RealLook look;
    if (!program_.still) {
      look.force.resize(count_);
      for (int a = 0; a < 3; ++a) {
        const std::vector<Real> force = domain_.force(index(a));
        for (size_t id = 0; id < count_; ++id)
          look.force[id][a] = Domain::si(force[id], text_.exponents.force);
      }
    }
    const RealPlaces there = domain_.places;
    for (const ProgramField& field : program_.particle) {
      domain_.places = field.kept ? here : there;
      for (uint32_t k = 0; k < field.numbers() && is_field(field.first); ++k)
        look.fields.push_back(domain_.field(field.first + k));
    }
    domain_.places = here;
    return look;
  }

  std::vector<uint64_t> kept() const override {
    std::vector<uint64_t> words;
    const auto add = [&](const std::vector<double>& values) {
      for (const double value : values) words.push_back(std::bit_cast<uint64_t>(value));
    };
    for (const ProgramField& field : program_.particle)
      for (uint32_t k = 0; field.kept && k < field.numbers(); ++k) add(domain_.field(field.first + k));
    for (const ProgramField& field : program_.bond)
      for (uint32_t k = 0; field.kept && k < field.numbers(); ++k) add(domain_.bond(field.first + k));
    return words;
  }

  std::vector<uint64_t> memory() const override {
    std::vector<uint64_t> words;
    const RealSpace& space = domain_.space;
    put<double>(
        words, {space.low[0], space.low[1], space.low[2], space.length[0], space.length[1], space.length[2]});
    for (size_t a = 0; a < 3; ++a) put(words, domain_.x(a));
    for (size_t a = 0; a < 3; ++a) {
      std::vector<int64_t> listed(bonded_ ? 0 : count_);
      if (listed_ && !bonded_) listed = domain_.listed_x(a);  // before the first list there is none
      put(words, listed);
    }
    put(words, domain_.v());
    for (size_t a = 0; a < 3; ++a) put(words, domain_.displaced() ? domain_.u(a) : std::vector<Real>());
    put<Skin::Memory>(words, {domain_.skin.memory()});
    words.push_back(listed_);
    words.push_back(age_);
    return words;
  }

  cuboct::Counters counters() const override {
    return {{"list_builds", static_cast<double>(builds_)},
            {"longest_list", static_cast<double>(domain_.longest_list)},
            {"listed_pairs", domain_.listed_pairs},
            {"halo_particles", static_cast<double>(ghosts_of(domain_.slabs))}};
  }
  std::string kernels() const override { return how_; }

 private:
  // What the devices told of a batch, as RealControl.
  struct Told {
    uint32_t lost = kRealNoStep, beyond = kRealNoStep, old = kRealNoStep;
  };

  // The force moves, and is not kept.
  bool is_field(uint32_t number) const { return program_.still || number < program_.force; }
  uint32_t numbers() const { return program_.still ? program_.particle_numbers : program_.force; }

  // That of the run's begin.
  RealSpace space_of(const Body& body, const Periodic& periodic, const Memory& memory) const {
    if (memory.words.empty()) return RealSpace(body, periodic, program_.reach, kWide);
    std::span<const uint64_t> words = memory.words;
    const auto of = take<double>(words, 6);
    return RealSpace({of[0], of[1], of[2]}, {of[3], of[4], of[5]}, periodic, program_.reach, kWide);
  }
  double largest_skin(const Periodic& periodic) const {
    double skin = program_.reach;
    for (const double extent : periodic.extent)
      if (extent > 0) skin = std::min(skin, extent / 2 - program_.reach);
    return std::max(skin, 0.0);
  }

  void load(const CompileRounds& compile) {
    try {
      for (auto& slab : domain_.slabs) {
        const std::string architecture = architecture_of(slab->stream);
        slab->kernels =
            std::make_unique<LoadedKernels>(slab->stream, compile(text_.source, architecture), text_.names);
        how_ = "compiled for " + architecture;
      }
    } catch (const std::runtime_error& e) {
      throw_not_compiled(kDoubles ? "double" : "float", e.what());
    }
  }

  // What no step changes.
  void make_frame() {
    const RealExponents& e = text_.exponents;
    const auto of_si = Domain::of_si;
    const RealSpace& space = domain_.space;
    Frame& frame = domain_.frame;
    for (size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<int>(a);
      frame.unit[a] = of_si(space.place_unit(a), e.length);
      frame.x_unit[a] = of_si(space.unit[axis], e.length);
      frame.origin[a] = of_si(space.origin[axis], e.length);
      frame.drift[a] = static_cast<Real>(std::ldexp(rule_.dt, e.velocity) / space.unit[axis]);
      frame.furthest[a] = static_cast<Real>(space.furthest(a, kWide));
      frame.bound[a] = space.bound[a], frame.ring[a] = space.ring[a];
    }
    frame.reach2 = of_si(program_.reach * program_.reach, 2 * e.length);
    frame.other_count = static_cast<int>(domain_.slabs.size()) - 1;
    std::vector<RealKind<Real>> types;
    for (size_t t = 0; t < rule_.types.size(); ++t) {
      const ParticleType& from = rule_.types[t];
      const double mass = rule_.mass_of(static_cast<int>(t));
      RealKind<Real> type{};
      type.mass = of_si(mass, e.mass);
      type.element = static_cast<Real>(program_.element.empty() ? 1 : program_.element[t]);
      type.kick = of_si(rule_.dt / mass, e.velocity - e.force);
      for (int a = 0; a < 3; ++a) {
        type.gravity[a] = of_si(from.gravity[a] * rule_.dt, e.velocity);
        type.velocity[a] = of_si(from.velocity[a], e.velocity);
        type.imposed |= static_cast<uint32_t>(from.imposed[index(a)]) << a;
      }
      type.held = from.pd;
      type.spring = of_si(from.kp, e.force - e.length);
      type.drag = of_si(from.kd, e.force - e.velocity);
      type.follow = of_si(rule_.dt, e.length - e.velocity);
      types.push_back(type);
    }
    std::vector<RealFour<Real>> tables;
    for (const std::array<double, 4>& entry : text_.tables)
      tables.push_back({{static_cast<Real>(entry[0]), static_cast<Real>(entry[1]),
                         static_cast<Real>(entry[2]), static_cast<Real>(entry[3])}});
    for (auto& slab : domain_.slabs)
      slab->types.set(slab->stream, types), slab->tables.set(slab->stream, tables);
  }

  void restore(std::span<const uint64_t> words) {
    take<double>(words, 6);
    std::array<std::vector<int64_t>, 3> x, listed;
    for (auto& axis : x) axis = take<int64_t>(words, count_);
    for (auto& axis : listed) axis = take<int64_t>(words, bonded_ ? 0 : count_);
    const auto v = take<RealFour<Real>>(words, count_);
    std::array<std::vector<Real>, 3> u;
    for (auto& axis : u) axis = take<Real>(words, domain_.displaced() ? count_ : 0);
    const Skin::Memory skin = take<Skin::Memory>(words, 1).front();
    if (words.size() != 2) throw DamagedMemory("its lists have other lengths");
    if (!domain_.skin.recall(skin)) throw DamagedMemory("no pair list has such a skin");
    if (words[0] != 0 && !bonded_) {
      domain_.set_x(listed);
      make_lists();
    }
    domain_.set_x(x);
    domain_.set_motion(v, u);
    if (listed_) domain_.refresh_ghosts();
    age_ = words[1];
  }

  void make_lists() {
    domain_.make_lists(age_);
    near_stale_ = listed_ = true;
    ++builds_;
    age_ = 0;
  }

  void reset() {
    for (auto& slab : domain_.slabs) {
      for_each(slab->stream, 0, 1, 32, RealReset{slab->control.data(), near_stale_});
      slab->stream.record(slab->done);
    }
  }
  // Waits for the devices.
  Told what_was_told() {
    Told told;
    controls_.clear();
    wait_for_all(domain_.slabs);
    for (auto& slab : domain_.slabs) {
      controls_.push_back(slab->control.host(slab->stream, 0, 1)[0]);
      told.lost = std::min(told.lost, controls_.back().lost);
      told.beyond = std::min(told.beyond, controls_.back().beyond);
      told.old = std::min(told.old, controls_.back().old);
    }
    return told;
  }

  Told run(uint32_t steps) {
    reset();
    std::vector<RealPlaces> after{domain_.places};
    for (uint32_t n = 1; n <= steps; ++n) {
      step(n, false);
      after.push_back(domain_.places);
    }
    const Told told = what_was_told();
    const uint32_t done = std::min({steps, std::min(told.lost, told.beyond) - 1, told.old});
    domain_.places = after[done];
    // A step that was begun in vain may have left some particles a new near list.
    near_stale_ = done < steps || std::ranges::any_of(controls_, [&](const RealControl& control) {
                    return control.near_stale[done + 1] != 0;
                  });
    return told;
  }

  void step(uint32_t number, bool looks) {
    const size_t rounds = program_.rounds.size();
    for (size_t k = 0; k < rounds; ++k) {
      begin_round(domain_.slabs, k == 0);
      const ProgramRound& of = program_.rounds[k];
      std::vector<uint32_t> seen;
      for (const ProgramWrite& write : of.made)
        if (is_field(write.number) && seen_[write.number]) seen.push_back(write.number);
      for (auto& slab : domain_.slabs) {
        slab->kernels->launch(slab->stream, k, slab->own, block_, frame_of(*slab, k, number, looks));
        domain_.push(*slab, seen, k + 1 == rounds && !program_.still && !looks, number);
        slab->stream.record(slab->done);
      }
      RealPlaces& places = domain_.places;
      for (const ProgramWrite& write : of.made)
        if (is_field(write.number)) places.fields[write.number] = 1 - places.fields[write.number];
      for (const ProgramWrite& write : of.bonds) places.bonds[write.number] = 1 - places.bonds[write.number];
    }
    if (!program_.still && !looks) domain_.places.at = 1 - domain_.places.at;
  }
  Frame frame_of(Slab& slab, size_t round, uint32_t number, bool looks) {
    const RealPlaces& places = domain_.places;
    Frame frame = slab.frame_of(domain_.frame, places, 1 - places.at);
    frame.first = round == 0, frame.number = number;
    frame.time = static_cast<int64_t>(program_.first_step + step_ + number - 1);
    for (size_t a = 0; looks && a < 3; ++a) frame.force[a] = slab.force[a].data();
    if (bonded_) frame.kinds = slab.kinds[round].data();
    // What a round writes it makes in the other copy, as others may still read this one.
    for (const ProgramWrite& write : program_.rounds[round].made)
      if (is_field(write.number))
        frame.to_fields[write.number] =
            slab.copies[1 - places.fields[write.number]].fields[write.number].data();
    for (const ProgramWrite& write : program_.rounds[round].bonds)
      frame.to_bonds[write.number] = slab.bond_copies[1 - places.bonds[write.number]][write.number].data();
    return frame;
  }

  // The state is that before the step that cannot be.
  [[noreturn]] void fail(const Told& told) const {
    if (told.beyond <= told.lost) throw TableEnds(table_ends_text(step_ + 1));
    Body body;
    body.x.resize(count_), body.v.resize(count_), body.u.resize(count_);
    read(body);
    size_t fastest = 0;
    for (size_t i = 0; i < count_; ++i)
      if (!(body.v[i].squaredNorm() <= body.v[fastest].squaredNorm())) fastest = i;
    throw_not_finite(step_, static_cast<uint32_t>(fastest), body.v[fastest].norm());
  }

  const Rule& rule_;
  const RuleProgram& program_;
  int block_;
  bool bonded_;
  uint32_t count_;
  uint64_t step_;
  ProgramStart start_;   // until it is on the devices
  RealBondKinds kinds_;  // likewise
  RealRoundsText text_;
  Domain domain_;
  std::vector<bool> seen_;  // by number of the fields: pairs read it of partners
  std::string how_;
  std::vector<RealControl> controls_;  // of the last batch, by slab
  uint32_t batch_ = kRealLongestBatch;
  bool listed_ = false, near_stale_ = true;
  uint64_t age_ = 0;  // steps that the list has served
  uint64_t builds_ = 0;
};

}  // namespace

std::unique_ptr<RealRounds> make_real_rounds(const Rule& rule, const Body& body, const Periodic& periodic,
                                             bool doubles, const Options& options,
                                             const CompileRounds& compile, const Memory& memory) {
  // A bond may be longer than places of 32 bits tell.
  const bool bonded = rule.rounds->text()->declaration.bonds == BondRange::reference;
  const auto made = [&]<class Real, class Number>(Real, Number) -> std::unique_ptr<RealRounds> {
    return std::make_unique<RealRoundsEngine<Real, Number>>(rule, body, periodic, options, compile, memory);
  };
  if (doubles) return made(double(), uint64_t());
  return bonded ? made(float(), uint64_t()) : made(float(), uint32_t());
}

}  // namespace cuboct::gpu
