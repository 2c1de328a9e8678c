// SPDX-License-Identifier: MIT
#include "emu/gpu/rounds/real_rounds_engine.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "emu/gpu/device/loaded_kernels.h"
#include "emu/gpu/device/memory_words.h"
#include "emu/gpu/messages.h"
#include "emu/gpu/rounds/real_rounds_list.h"
#include "emu/gpu/rounds/real_rounds_text.h"
#include "emu/gpu/rounds/real_space.h"
#include "emu/gpu/rounds/rounds_list.h"
#include "emu/gpu/skin.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/program/program_rule.h"
#include "model/rules/rounds_rule.h"

namespace cuboct::gpu {
namespace {

constexpr double kNearSkin = 0.06;  // of a near list, of what the rule reaches; and at most half the list's
constexpr uint64_t kMostBins = 1u << 26;
constexpr uint32_t kShortestBatch = 4;
// What is compared with a square of a length is rounded, and so is the length.
constexpr double kRounding = 1e-5;

size_t index(int n) { return static_cast<size_t>(n); }

template <class Real, class Number>
class RealRoundsEngine final : public RealRounds {
 public:
  using Frame = RealFrame<Real, Number>;
  using Place = RealPlace<Number>;
  static constexpr bool kWide = sizeof(Number) == 8, kDoubles = sizeof(Real) == 8;

  RealRoundsEngine(const Rule& rule, const Body& body, const Periodic& periodic, const Options& options,
                   const CompileRounds& compile, const Memory& memory)
      : rule_(rule),
        program_(*rule.rounds->text()),
        block_(options.block),
        bonded_(program_.declaration.bonds == BondRange::reference),
        stream_(options.devices.front()),
        count_(static_cast<uint32_t>(body.size())),
        step_(memory.step),
        space_(space_of(body, periodic, memory)),
        skin_(program_.reach, largest_skin(periodic), count_) {
    const ProgramStart start = starts_of(program_, rule, body, periodic);
    const RealBondKinds kinds = bonded_ ? bond_kinds_of(program_, start) : RealBondKinds();
    text_ = real_text_of(program_, rule, start, kinds, {kDoubles, kWide, sizeof(Frame)});
    load(compile);
    make_frame();
    make_room(!body.u.empty());
    upload(body, start);
    if (bonded_) put_bonds(start, kinds);
    if (!memory.words.empty()) restore(memory.words);
  }

  void advance(uint64_t steps) override {
    const uint64_t end = step_ + steps;
    while (step_ < end && !interrupted()) {
      if (!listed_) make_lists();
      const auto batch = static_cast<uint32_t>(std::min<uint64_t>(end - step_, batch_));
      const RealControl control = run(batch);
      const uint32_t failed = std::min(control.lost, control.beyond);
      const uint32_t done = std::min({batch, failed - 1, control.old});
      step_ += done, age_ += done;
      if (done == control.old) {
        listed_ = false;
        // The next one may live a little longer.
        batch_ = static_cast<uint32_t>(
            std::clamp<uint64_t>(age_ + age_ / 4 + 1, kShortestBatch, kRealLongestBatch));
      } else if (done < batch) {
        fail(control);
      } else if (batch == batch_) {
        batch_ = std::min(2 * batch_, kRealLongestBatch);
      }
    }
  }
  uint64_t step_count() const override { return step_; }

  void read(Body& body) const override {
    const std::vector<uint32_t> ids = this->ids();
    const std::vector<RealFour<Real>> v = state().v.host(stream_, 0, count_);
    for (size_t k = 0; k < count_; ++k)
      for (int a = 0; a < 3; ++a) body.v[ids[k]][a] = si(v[k].at[a], text_.exponents.velocity);
    for (size_t a = 0; a < 3; ++a) {
      const std::vector<int64_t> x = state().x[a].host(stream_, 0, count_);
      for (size_t k = 0; k < count_; ++k) body.x[ids[k]][static_cast<int>(a)] = space_.metres(x[k], a);
      if (!displaced_) continue;
      const std::vector<Real> u = state().u[a].host(stream_, 0, count_);
      for (size_t k = 0; k < count_; ++k)
        body.u[ids[k]][static_cast<int>(a)] = si(u[k], text_.exponents.length);
    }
  }

  RealLook look() override {
    if (!listed_) make_lists();
    for (Array<Real>& force : force_) force.resize(count_);
    const Places here = places();
    for_each(stream_, 0, 1, 32, RealReset{control_.data(), near_stale_});
    step(1, true);
    const RealControl control = control_.host(stream_, 0, 1)[0];
    if (control.beyond == 1) go_to(here), fail(control);
    near_stale_ = false;
    RealLook look;
    const std::vector<uint32_t> ids = this->ids();
    if (!program_.still) {
      look.force.resize(count_);
      for (int a = 0; a < 3; ++a) {
        const std::vector<Real> force = force_[index(a)].host(stream_, 0, count_);
        for (size_t k = 0; k < count_; ++k) look.force[ids[k]][a] = si(force[k], text_.exponents.force);
      }
    }
    const Places there = places();
    for (const ProgramField& field : program_.particle) {
      go_to(field.kept ? here : there);
      for (uint32_t k = 0; k < field.numbers() && is_field(field.first); ++k)
        look.fields.push_back(field_by_id(field.first + k));
    }
    go_to(here);
    return look;
  }

  std::vector<uint64_t> kept() const override {
    std::vector<uint64_t> words;
    const auto add = [&](const std::vector<double>& values) {
      for (const double value : values) words.push_back(std::bit_cast<uint64_t>(value));
    };
    for (const ProgramField& field : program_.particle)
      for (uint32_t k = 0; field.kept && k < field.numbers(); ++k) add(field_by_id(field.first + k));
    for (const ProgramField& field : program_.bond)
      for (uint32_t k = 0; field.kept && k < field.numbers(); ++k) add(bond_by_id(field.first + k));
    return words;
  }

  std::vector<uint64_t> memory() const override {
    std::vector<uint64_t> words;
    put<double>(words, {space_.low[0], space_.low[1], space_.low[2], space_.length[0], space_.length[1],
                        space_.length[2]});
    const std::vector<uint32_t> ids = this->ids();
    for (const Array<int64_t>& axis : state().x) put(words, by_id(axis.host(stream_, 0, axis.size()), ids));
    // Before the first list there is none.
    for (const Array<int64_t>& axis : listed_x_)
      put(words, listed_ ? by_id(axis.host(stream_, 0, axis.size()), ids) : std::vector<int64_t>(count_));
    put(words, by_id(state().v.host(stream_, 0, count_), ids));
    for (const Array<Real>& axis : state().u) put(words, by_id(axis.host(stream_, 0, axis.size()), ids));
    put<Skin::Memory>(words, {skin_.memory()});
    words.push_back(listed_);
    words.push_back(age_);
    return words;
  }

  cuboct::Counters counters() const override {
    return {{"list_builds", static_cast<double>(builds_)},
            {"longest_list", static_cast<double>(longest_)},
            {"listed_pairs", listed_pairs_}};
  }
  std::string kernels() const override { return how_; }

 private:
  struct Copy {
    std::array<Array<int64_t>, 3> x;
    std::array<Array<Real>, 3> u;
    std::vector<Array<Real>> fields;
    Array<RealFour<Real>> v;
    Array<Place> place;
    Array<uint8_t> type;
    Array<uint32_t> id;
  };
  // Where the state is: positions, and each number of a field or a bond in one of two copies.
  struct Places {
    size_t at;
    std::vector<size_t> fields, bonds;
  };

  static double si(Real value, int exponent) { return std::ldexp(static_cast<double>(value), exponent); }
  static Real of_si(double value, int exponent) { return static_cast<Real>(std::ldexp(value, -exponent)); }
  // The force moves, and is not kept.
  bool is_field(uint32_t number) const { return program_.still || number < program_.force; }
  uint32_t numbers() const { return program_.still ? program_.particle_numbers : program_.force; }
  const Copy& state() const { return copies_[at_]; }
  std::vector<uint32_t> ids() const { return copies_[who_].id.host(stream_, 0, count_); }

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
    const std::string architecture = architecture_of(stream_);
    try {
      kernels_ = std::make_unique<LoadedKernels>(stream_, compile(text_.source, architecture), text_.names);
    } catch (const std::runtime_error& e) {
      throw_not_compiled(kDoubles ? "double" : "float", e.what());
    }
    how_ = "compiled for " + architecture;
  }

  // What no step changes.
  void make_frame() {
    const RealExponents& e = text_.exponents;
    for (size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<int>(a);
      frame_.unit[a] = of_si(space_.place_unit(a), e.length);
      frame_.x_unit[a] = of_si(space_.unit[axis], e.length);
      frame_.origin[a] = of_si(space_.origin[axis], e.length);
      frame_.drift[a] = static_cast<Real>(std::ldexp(rule_.dt, e.velocity) / space_.unit[axis]);
      frame_.furthest[a] = static_cast<Real>(space_.furthest(a, kWide));
      frame_.bound[a] = space_.bound[a], frame_.ring[a] = space_.ring[a];
    }
    frame_.reach2 = square(program_.reach);
    frame_.stride = count_;
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
    types_.set(stream_, types);
    std::vector<RealFour<Real>> tables;
    for (const std::array<double, 4>& entry : text_.tables)
      tables.push_back({{static_cast<Real>(entry[0]), static_cast<Real>(entry[1]),
                         static_cast<Real>(entry[2]), static_cast<Real>(entry[3])}});
    tables_.set(stream_, tables);
    control_.resize(1), most_.resize(1), sum_.resize(1);
    frame_.types = types_.data(), frame_.tables = tables_.data(), frame_.control = control_.data();
  }
  Real square(double length) const { return of_si(length * length, 2 * text_.exponents.length); }

  void make_room(bool displaced) {
    displaced_ = displaced;
    for (Copy& copy : copies_) {
      for (size_t a = 0; a < 3; ++a) {
        copy.x[a].resize(count_);
        if (displaced) copy.u[a].resize(count_);
      }
      copy.fields.resize(numbers());
      for (Array<Real>& field : copy.fields) field.resize(count_);
      copy.v.resize(count_), copy.place.resize(count_), copy.type.resize(count_), copy.id.resize(count_);
    }
    if (bonded_) return;
    for (auto* a : {&bin_, &order_, &counts_, &near_counts_}) a->resize(count_);
    for (Array<int64_t>& axis : listed_x_) axis.resize(count_);
    listed_at_.resize(count_), near_at_.resize(count_);
  }

  void upload(const Body& body, const ProgramStart& start) {
    Copy& copy = copies_[0];
    at_ = 0, who_ = 0;
    field_at_.assign(numbers(), 0);
    const RealExponents& e = text_.exponents;
    std::vector<RealFour<Real>> v(count_);
    std::vector<Place> place(count_);
    for (size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<int>(a);
      std::vector<int64_t> x(count_);
      for (size_t k = 0; k < count_; ++k) {
        x[k] = space_.whole(body.x[k][axis], a);
        v[k].at[a] = of_si(body.v[k][axis], e.velocity);
        place[k].x[a] = space_.ring[a].template place<Number>(x[k]);
        place[k].type = body.type[k];
      }
      copy.x[a].put(stream_, 0, x);
      if (!displaced_) continue;
      std::vector<Real> u(count_);
      for (size_t k = 0; k < count_; ++k) u[k] = of_si(body.u[k][axis], e.length);
      copy.u[a].put(stream_, 0, u);
    }
    copy.v.put(stream_, 0, v), copy.place.put(stream_, 0, place);
    for (size_t f = 0; f < numbers(); ++f) {
      std::vector<Real> values(count_);
      for (size_t k = 0; k < count_; ++k) values[k] = of_si(start.particle[f][k], e.field[f]);
      copy.fields[f].put(stream_, 0, values);
    }
    copy.type.put(stream_, 0, body.type);
    std::vector<uint32_t> id(count_);
    std::iota(id.begin(), id.end(), 0);
    copy.id.put(stream_, 0, id);
  }

  // Particles of a rule with bonds of its own stand by id, and stay.
  void put_bonds(const ProgramStart& start, const RealBondKinds& kinds) {
    rows_ = start.rows;
    uint64_t width = 0;
    for (size_t i = 0; i < count_; ++i) width = std::max(width, rows_.end(i) - rows_.begin(i));
    const size_t slots = width * count_;
    std::vector<uint32_t> entries(slots), kind(slots), counts(count_);
    const std::vector<bool> written = written_bonds(program_);
    std::vector<std::vector<Real>> values(written.size());
    for (size_t n = 0; n < written.size(); ++n)
      if (written[n]) values[n].resize(slots);
    for (size_t i = 0; i < count_; ++i) {
      counts[i] = static_cast<uint32_t>(rows_.end(i) - rows_.begin(i));
      for (uint64_t b = rows_.begin(i); b < rows_.end(i); ++b) {
        const size_t slot = (b - rows_.begin(i)) * count_ + i;
        entries[slot] = rows_.other[b], kind[slot] = kinds.of[b];
        for (size_t n = 0; n < written.size(); ++n)
          if (written[n]) values[n][slot] = of_si(start.bond[n][b], text_.exponents.bond[n]);
      }
    }
    entries_.set(stream_, entries), counts_.set(stream_, counts), bond_kind_.set(stream_, kind);
    bond_at_.assign(written.size(), 0);
    for (auto& copy : bond_copies_) copy.resize(written.size());
    for (size_t n = 0; n < written.size(); ++n) {
      bond_copies_[0][n].set(stream_, values[n]);
      bond_copies_[1][n].resize(values[n].size());
    }
    for (const auto& of_round : text_.kinds) {
      std::vector<Real> numbers;
      for (const std::vector<double>& of_kind : of_round)
        for (const double number : of_kind) numbers.push_back(static_cast<Real>(number));
      kinds_.emplace_back().set(stream_, numbers);
    }
    frame_.entries = entries_.data(), frame_.counts = counts_.data(), frame_.bond_kind = bond_kind_.data();
    longest_ = width, listed_pairs_ = static_cast<double>(rows_.other.size()) / count_;
    listed_ = true;
  }

  void restore(std::span<const uint64_t> words) {
    take<double>(words, 6);
    std::array<std::vector<int64_t>, 3> x, listed;
    for (auto& axis : x) axis = take<int64_t>(words, count_);
    for (auto& axis : listed) axis = take<int64_t>(words, bonded_ ? 0 : count_);
    const auto v = take<RealFour<Real>>(words, count_);
    std::array<std::vector<Real>, 3> u;
    for (auto& axis : u) axis = take<Real>(words, displaced_ ? count_ : 0);
    const Skin::Memory skin = take<Skin::Memory>(words, 1).front();
    if (words.size() != 2) throw DamagedMemory("its lists have other lengths");
    if (!skin_.recall(skin)) throw DamagedMemory("no pair list has such a skin");
    const bool has_list = words[0] != 0 && !bonded_;
    if (has_list) {
      for (size_t a = 0; a < 3; ++a) copies_[at_].x[a].put(stream_, 0, listed[a]);
      make_lists();
    }
    const std::vector<uint32_t> ids = this->ids();
    Copy& copy = copies_[at_];
    std::vector<Place> place = copy.place.host(stream_, 0, count_);
    for (size_t a = 0; a < 3; ++a) {
      std::vector<int64_t> in_order(count_);
      for (size_t k = 0; k < count_; ++k) {
        in_order[k] = x[a][ids[k]];
        place[k].x[a] = space_.ring[a].template place<Number>(in_order[k]);
      }
      copy.x[a].put(stream_, 0, in_order);
      if (displaced_) copy.u[a].put(stream_, 0, in_order_of(u[a], ids));
    }
    copy.place.put(stream_, 0, place);
    copy.v.put(stream_, 0, in_order_of(v, ids));
    age_ = words[1];
  }
  template <class T>
  static std::vector<T> in_order_of(const std::vector<T>& by_id, const std::vector<uint32_t>& ids) {
    std::vector<T> values;
    for (const uint32_t id : ids) values.push_back(by_id[id]);
    return values;
  }
  template <class T>
  static std::vector<T> by_id(const std::vector<T>& values, const std::vector<uint32_t>& ids) {
    std::vector<T> sorted(values.size());
    for (size_t k = 0; k < values.size(); ++k) sorted[ids[k]] = values[k];
    return sorted;
  }
  std::vector<double> field_by_id(uint32_t number) const {
    const std::vector<Real> values = copies_[field_at_[number]].fields[number].host(stream_, 0, count_);
    const std::vector<uint32_t> ids = this->ids();
    std::vector<double> sorted(count_);
    for (size_t k = 0; k < count_; ++k) sorted[ids[k]] = si(values[k], text_.exponents.field[number]);
    return sorted;
  }
  std::vector<double> bond_by_id(uint32_t number) const {
    const Array<Real>& from = bond_copies_[bond_at_[number]][number];
    const std::vector<Real> slots = from.host(stream_, 0, from.size());
    std::vector<double> values;
    for (size_t i = 0; i < count_; ++i)
      for (uint64_t b = rows_.begin(i); b < rows_.end(i); ++b)
        values.push_back(si(slots[(b - rows_.begin(i)) * count_ + i], text_.exponents.bond[number]));
    return values;
  }

  // As wide as the list to be made reaches.
  RealBins bins() {
    RealBins bins{};
    double size = program_.reach + skin_.now();
    for (;; size *= 1.26) {
      uint64_t all = 1;
      for (size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<int>(a);
        bins.count[a] = std::max(1, static_cast<int>(space_.length[axis] / size));
        all *= static_cast<uint64_t>(bins.count[a]);
        bins.wraps[a] = space_.wraps[a], bins.ring[a] = space_.ring[a];
        bins.low[a] = (space_.low[axis] - space_.origin[axis]) / space_.unit[axis];
        bins.per_unit[a] = space_.wraps[a] ? std::ldexp(bins.count[a], -64)
                                           : bins.count[a] * space_.unit[axis] / space_.length[axis];
      }
      if (all <= kMostBins) break;
    }
    const auto all = static_cast<size_t>(bins.count[0]) * index(bins.count[1]) * index(bins.count[2]);
    for (Array<uint32_t>* of : {&bin_count_, &bin_first_, &bin_taken_})
      if (of->size() < all) of->resize(all);
    return bins;
  }

  void make_lists() {
    skin_.aged(age_);
    const RealBins bins = this->bins();
    bin_count_.zero(stream_), bin_taken_.zero(stream_);
    const Copy& now = state();
    for_each(stream_, 0, count_, block_,
             RealSettle{
                 bins, {now.x[0].data(), now.x[1].data(), now.x[2].data()}, bin_.data(), bin_count_.data()});
    const auto all = static_cast<uint32_t>(bins.count[0] * bins.count[1] * bins.count[2]);
    exclusive_sums(stream_, bin_count_.data(), bin_first_.data(), all);
    for_each(stream_, 0, count_, block_,
             RoundsOrder{bin_.data(), bin_first_.data(), bin_taken_.data(), order_.data()});
    for_each(stream_, 0, all, block_,
             RealSort{bin_first_.data(), bin_count_.data(), copies_[who_].id.data(), order_.data()});
    gather();
    const Copy& here = state();
    RealMakeList<Real, Number> make{bins,
                                    {here.x[0].data(), here.x[1].data(), here.x[2].data()},
                                    {frame_.unit[0], frame_.unit[1], frame_.unit[2]},
                                    square((program_.reach + skin_.now()) * (1 + kRounding)),
                                    bin_first_.data(),
                                    bin_count_.data(),
                                    entries_.data(),
                                    counts_.data(),
                                    width_,
                                    count_};
    longest_ =
        std::max<uint64_t>(longest_, fill_list(stream_, count_, block_, make, most_, entries_, width_));
    near_entries_.resize(entries_.size());
    for_each(stream_, 0, 1, 32, RoundsZero{sum_.data()});
    sum_each(stream_, 0, count_, block_, RoundsCount{counts_.data()}, sum_.data());
    listed_pairs_ = static_cast<double>(sum_.host(stream_, 0, 1)[0]) / std::max(count_, 1u);
    skin_.listed(listed_pairs_);
    serve();
  }
  void serve() {
    // Both of a pair move.
    const auto allowed2 = [&](double skin) { return square(skin / 2 * (1 - 10 * kRounding)); };
    const double near_skin = std::min(kNearSkin * program_.reach, skin_.now() / 2);
    frame_.entries = entries_.data(), frame_.counts = counts_.data(), frame_.listed = listed_at_.data();
    frame_.near_entries = near_entries_.data(), frame_.near_counts = near_counts_.data();
    frame_.near_listed = near_at_.data();
    frame_.allowed2 = allowed2(skin_.now()), frame_.near_allowed2 = allowed2(near_skin);
    frame_.near_reach2 = square((program_.reach + near_skin) * (1 + kRounding));
    near_stale_ = listed_ = true;
    ++builds_;
    age_ = 0;
  }
  void gather() {
    const size_t to = 1 - at_;
    Frame frame = frame_of(to);
    for (size_t f = 0; f < numbers(); ++f) frame.to_fields[f] = copies_[1 - field_at_[f]].fields[f].data();
    Copy& others = copies_[1 - who_];
    for_each(stream_, 0, count_, block_,
             RealGather<Real, Number>{order_.data(),
                                      frame,
                                      others.type.data(),
                                      others.id.data(),
                                      listed_at_.data(),
                                      near_at_.data(),
                                      {listed_x_[0].data(), listed_x_[1].data(), listed_x_[2].data()},
                                      static_cast<int>(numbers())});
    at_ = to, who_ = 1 - who_;
    for (size_t& at : field_at_) at = 1 - at;
  }

  // From the state at hand into copy `to`.
  Frame frame_of(size_t to) {
    Frame frame = frame_;
    const Copy& here = copies_[at_];
    Copy& there = copies_[to];
    for (size_t a = 0; a < 3; ++a) {
      frame.x[a] = here.x[a].data(), frame.u[a] = here.u[a].data();
      frame.to_x[a] = there.x[a].data(), frame.to_u[a] = there.u[a].data();
    }
    frame.place = here.place.data(), frame.v = here.v.data();
    frame.to_place = there.place.data(), frame.to_v = there.v.data();
    frame.type = copies_[who_].type.data(), frame.id = copies_[who_].id.data();
    for (size_t f = 0; f < numbers(); ++f) frame.fields[f] = copies_[field_at_[f]].fields[f].data();
    for (size_t n = 0; n < bond_at_.size(); ++n) frame.bonds[n] = bond_copies_[bond_at_[n]][n].data();
    return frame;
  }

  Places places() const { return {at_, field_at_, bond_at_}; }
  void go_to(const Places& places) { at_ = places.at, field_at_ = places.fields, bond_at_ = places.bonds; }

  RealControl run(uint32_t steps) {
    for_each(stream_, 0, 1, 32, RealReset{control_.data(), near_stale_});
    std::vector<Places> after{places()};
    for (uint32_t n = 1; n <= steps; ++n) {
      step(n, false);
      after.push_back(places());
    }
    const RealControl control = control_.host(stream_, 0, 1)[0];
    const uint32_t done = std::min({steps, std::min(control.lost, control.beyond) - 1, control.old});
    go_to(after[done]);
    // A step that was begun in vain may have left some particles a new near list.
    near_stale_ = done < steps || control.near_stale[done + 1] != 0;
    return control;
  }

  void step(uint32_t number, bool looks) {
    for (size_t k = 0; k < program_.rounds.size(); ++k) {
      Frame round = frame_of(1 - at_);
      const ProgramRound& of = program_.rounds[k];
      round.first = k == 0, round.number = number;
      round.time = static_cast<int64_t>(program_.first_step + step_ + number - 1);
      if (looks)
        for (size_t a = 0; a < 3; ++a) round.force[a] = force_[a].data();
      if (bonded_) round.kinds = kinds_[k].data();
      // What a round writes it makes in the other copy, as others may still read this one.
      for (const ProgramWrite& write : of.made)
        if (is_field(write.number))
          round.to_fields[write.number] = copies_[1 - field_at_[write.number]].fields[write.number].data();
      for (const ProgramWrite& write : of.bonds)
        round.to_bonds[write.number] = bond_copies_[1 - bond_at_[write.number]][write.number].data();
      kernels_->launch(stream_, k, count_, block_, round);
      for (const ProgramWrite& write : of.made)
        if (is_field(write.number)) field_at_[write.number] = 1 - field_at_[write.number];
      for (const ProgramWrite& write : of.bonds) bond_at_[write.number] = 1 - bond_at_[write.number];
    }
    if (!program_.still && !looks) at_ = 1 - at_;
  }

  // The state is that before the step that cannot be.
  [[noreturn]] void fail(const RealControl& control) const {
    if (control.beyond <= control.lost) throw TableEnds(table_ends_text(step_ + 1));
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
  bool bonded_, displaced_ = false;
  mutable Stream stream_;
  uint32_t count_;
  uint64_t step_;
  RealSpace space_;
  Skin skin_;  // m
  RealRoundsText text_;
  std::unique_ptr<LoadedKernels> kernels_;
  std::string how_;
  Frame frame_{};
  std::array<Copy, 2> copies_;
  size_t at_ = 0, who_ = 0;  // of positions; of types and ids
  std::vector<size_t> field_at_, bond_at_;
  std::array<Array<int64_t>, 3> listed_x_;
  Array<Place> listed_at_, near_at_;
  Array<uint32_t> bin_, order_, counts_, near_counts_, entries_, near_entries_, bin_count_, bin_first_,
      bin_taken_, most_, bond_kind_;
  Array<uint64_t> sum_;
  ReferenceBonds rows_{{0}, {}, {}};
  std::array<std::vector<Array<Real>>, 2> bond_copies_;  // by number
  std::vector<Array<Real>> kinds_;                       // by round
  std::array<Array<Real>, 3> force_;
  Array<RealKind<Real>> types_;
  Array<RealFour<Real>> tables_;
  Array<RealControl> control_;
  uint32_t width_ = 0, batch_ = kRealLongestBatch;
  bool listed_ = false, near_stale_ = true;
  uint64_t age_ = 0;  // steps that the list has served
  uint64_t builds_ = 0, longest_ = 0;
  double listed_pairs_ = 0;
};

}  // namespace

std::unique_ptr<RealRounds> make_real_rounds(const Rule& rule, const Body& body, const Periodic& periodic,
                                             bool doubles, const Options& options,
                                             const CompileRounds& compile, const Memory& memory) {
  if (options.devices.size() > 1)
    throw InputError("a rule of text runs on one GPU", "--gpus 1").about({"rule.file", "rule"});
  // A bond may be longer than places of 32 bits tell.
  const bool bonded = rule.rounds->text()->declaration.bonds == BondRange::reference;
  const auto made = [&]<class Real, class Number>(Real, Number) -> std::unique_ptr<RealRounds> {
    return std::make_unique<RealRoundsEngine<Real, Number>>(rule, body, periodic, options, compile, memory);
  };
  if (doubles) return made(double(), uint64_t());
  return bonded ? made(float(), uint64_t()) : made(float(), uint32_t());
}

}  // namespace cuboct::gpu
