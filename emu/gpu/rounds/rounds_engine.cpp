// SPDX-License-Identifier: MIT
#include "emu/gpu/rounds/rounds_engine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "emu/gpu/device/loaded_kernels.h"
#include "emu/gpu/rounds/rounds_interpreter.h"
#include "emu/gpu/rounds/rounds_list.h"
#include "emu/gpu/rounds/rounds_text.h"
#include "emu/gpu/skin.h"
#include "hw/arch/cell_box.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "model/program/integer_program.h"

namespace cuboct::gpu {
namespace {

constexpr double kNearSkin = 0.06;  // of a near list, of what the rule reaches; and at most half the list's
constexpr uint64_t kMostBins = 1u << 26;
constexpr uint32_t kShortestBatch = 4;
constexpr size_t kMostBytesOfBlock = 40 * 1024;  // of registers that are interpreted
constexpr uint32_t kProvenByGolden = 32768;      // particles: more take golden too long

size_t index(int n) { return static_cast<size_t>(n); }

class RoundsEngine final : public IntegerEngine {
 public:
  RoundsEngine(const Plan& plan, const State& initial, const Options& options, const CompileRounds& compile)
      : plan_(plan),
        program_(plan.program->program),
        rows_(plan.program->rows.get()),
        block_(options.block),
        stream_(options.devices.front()),
        code_(stream_, program_),
        count_(static_cast<uint32_t>(initial.particles.size())),
        step_(initial.step),
        numbers_(program_.numbers()),
        guard_(program_.guard),
        frac_(program_.position_frac + program_.guard),
        reach_(reach_of(plan)),
        skin_(reach_, largest_skin(plan, reach_), count_) {
    make_cells();
    make_room();
    upload(initial);
    if (compile) load(compile);
    if (!kernels_) return;
    make_lists();
    prove();
  }

  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override {
    const uint64_t end = step_ + steps;
    while (step_ < end && !interrupted()) {
      if (!listed_) make_lists();
      if (kernels_ && !proven_) prove();
      const auto batch = static_cast<uint32_t>(std::min<uint64_t>(end - step_, batch_));
      const uint32_t done = run(batch, hashes, proven_);
      step_ += done;
      age_ += done;
      if (done == told_.old || (done < batch && age_ > 0)) {
        listed_ = false;  // of a doubt, too: cells have counted particles that left them since
        // The next one may live a little longer.
        batch_ =
            static_cast<uint32_t>(std::clamp<uint64_t>(age_ + age_ / 4 + 1, kShortestBatch, kLongestBatch));
      } else if (done < batch) {
        step_by_golden();
        if (hashes != nullptr) hashes->push_back(hash());
      } else if (batch == batch_) {
        batch_ = std::min(2 * batch_, kLongestBatch);
      }
    }
  }
  uint64_t step_count() const override { return step_; }

  State state() const override {
    State state = slots();
    std::vector<size_t> order(count_);
    std::iota(order.begin(), order.end(), size_t{0});
    std::sort(order.begin(), order.end(),
              [&](size_t a, size_t b) { return state.particles[a].id < state.particles[b].id; });
    State sorted{state.step, {}};
    for (const size_t k : order) {
      sorted.particles.push_back(state.particles[k]);
      for (size_t f = 0; f < index(numbers_); ++f)
        sorted.fields.push_back(state.fields[k * index(numbers_) + f]);
    }
    if (bond_count() > 0) add_bonds(order, sorted);
    return sorted;
  }
  uint64_t hash() const override { return hash_of(plan_.lattice, state()); }
  std::vector<Int3> next_velocities() override {
    // A list that has served may leave a doubt that a new one does not.
    do {
      if (!listed_) make_lists();
      if (kernels_ && !proven_) prove();
      const Places here = places();
      const bool done = run(1, nullptr, proven_) == 1;
      std::vector<Int3> v;
      if (done) v = velocities();
      go_to(here), near_stale_ = true;
      if (done) return v;
      listed_ = age_ == 0;
    } while (!listed_);
    return GoldenIntegers(program_, plan_.lattice, plan_.arch.capacity, state(), plan_.program->rows)
        .next_velocities();
  }
  // Golden's slots are not kept: by id.
  void for_each_slot(const std::function<void(const Particle&)>& see) const override {
    for (const Particle& particle : state().particles) see(particle);
  }
  cuboct::Counters counters() const override {
    return {{"list_builds", static_cast<double>(builds_)},
            {"golden_steps", static_cast<double>(golden_steps_)},
            {"longest_list", static_cast<double>(longest_)},
            {"listed_pairs", listed_pairs_}};
  }
  Notes notes() const override { return {{"kernels", how_}}; }

 private:
  // What the device told of a batch.
  struct Told {
    uint32_t doubt = kNoStep, old = kNoStep;
  };

  void make_cells() {
    const CellBox box = box_of(plan_.lattice, true);
    uint64_t all = 1;
    for (size_t a = 0; a < 3; ++a) {
      cells_.low[a] = box.low[a];
      cells_.extent[a] = static_cast<int>(box.extent(a));
      cells_.period[a] = plan_.lattice.period()[a];
      all *= static_cast<uint64_t>(box.extent(a));
    }
    if (all > kNoStep / 2) throw InputError("the lattice's box has too many cells for the gpu engine");
    std::vector<uint8_t> exists(all);
    for (uint32_t n = 0; n < plan_.lattice.size(); ++n) {
      const Cell& c = plan_.lattice.cell(n);
      uint64_t at = 0;
      for (size_t a = 3; a-- > 0;)
        at = at * static_cast<uint64_t>(cells_.extent[a]) + static_cast<uint64_t>(c[a] - cells_.low[a]);
      exists[at] = 1;
    }
    exists_.set(stream_, exists);
    occupancy_.resize(all);
    cells_.exists = exists_.data(), cells_.occupancy = occupancy_.data();
    cells_.capacity = static_cast<uint32_t>(plan_.arch.capacity);
  }

  // A difference is rounded along three axes by half a unit, or, where cells are no cubes, by one and the
  // rounding of their shape. Lists take cells as cubes: the reach of an axis whose edge is shorter counts
  // more of these.
  static double reach_of(const Plan& plan) {
    const int frac = plan.rule.widths.difference_frac;
    return (std::sqrt(std::ldexp(static_cast<double>(plan.rule.cutoff2), -2 * frac)) +
            3 * std::ldexp(1.0, -frac)) *
           plan.rule.cell_edge / plan.rule.edges().shortest();
  }
  static constexpr int kLeastBins = 3;  // of a ring: fewer would meet a particle from both sides
  static double largest_skin(const Plan& plan, double reach) {
    double skin = reach;
    for (const int period : plan.lattice.period())
      if (period > 0) skin = std::min(skin, double(period) / kLeastBins - reach);
    return std::max(skin, 0.0);
  }

  // As wide as the list to be made reaches.
  void make_bins() {
    double size = reach_ + skin_.now();
    uint64_t bins = 0;
    for (;; size *= 1.26) {
      bins = 1;
      for (size_t a = 0; a < 3; ++a) {
        bins_.low[a] = int64_t{cells_.low[a]} << program_.position_frac;
        bins_.length[a] = int64_t{cells_.extent[a]} << program_.position_frac;
        bins_.wraps[a] = cells_.period[a] > 0;
        const int least = bins_.wraps[a] ? kLeastBins : 1;
        bins_.count[a] = std::max(least, static_cast<int>(cells_.extent[a] / size));
        bins *= static_cast<uint64_t>(bins_.count[a]);
      }
      if (bins <= kMostBins) break;
    }
    coarse_shift_ = 0;
    for (size_t a = 0; a < 3; ++a)
      while (2 * (bins_.length[a] / bins_.count[a] + 1) >> coarse_shift_ >= int64_t{1} << 31) ++coarse_shift_;
    for (Array<uint32_t>* of : {&bin_count_, &bin_first_, &bin_taken_})
      if (of->size() < bins) of->resize(bins);
  }

  void make_room() {
    if (count_ >= 1u << kPartnerBits)
      throw InputError("more particles than the gpu engine lists for a rule of text: 2^27");
    const bool displaced = !program_.motion.u.empty() || plan_.rule.pd;
    for (Copy& copy : copies_) {
      for (size_t a = 0; a < 3; ++a) {
        copy.x[a].resize(count_), copy.v[a].resize(count_);
        if (displaced) copy.u[a].resize(count_);
      }
      copy.fields.resize(index(numbers_));
      for (Array<int64_t>& field : copy.fields) field.resize(count_);
      copy.type.resize(count_), copy.id.resize(count_);
    }
    for (size_t a = 0; a < 3; ++a) home_[a].resize(count_);
    for (auto* a : {&bin_, &order_, &entered_, &counts_}) a->resize(count_);
    if (rows_ == nullptr) {
      near_counts_.resize(count_);
      for (auto* a : {&copies_[0].place, &copies_[1].place, &listed_at_, &near_at_}) a->resize(count_);
    }
    control_.resize(1);
    most_.resize(1);
    hashes_.resize(kLongestBatch + 1);
  }

  struct Copy {
    std::array<Array<int64_t>, 3> x, v, u;
    std::vector<Array<int64_t>> fields;
    Array<RoundsPlace> place;  // not of a bonded program
    Array<uint8_t> type;
    Array<uint32_t> id;
  };
  // Positions and velocities of copy `k`; types and ids stand in copy `who_`, and each number of the fields
  // where it was written last.
  RoundsView view(int k) {
    RoundsView view{};
    for (size_t a = 0; a < 3; ++a) {
      view.x[a] = copies_[index(k)].x[a].data(), view.v[a] = copies_[index(k)].v[a].data();
      view.u[a] = copies_[index(k)].u[a].data();
    }
    for (size_t f = 0; f < index(numbers_); ++f) view.fields[f] = copies_[field_at_[f]].fields[f].data();
    view.place = copies_[index(k)].place.data();
    view.type = copies_[who_].type.data(), view.id = copies_[who_].id.data();
    return view;
  }

  void upload(const State& state) {
    at_ = 0, who_ = 0;
    field_at_.assign(index(numbers_), 0);
    std::vector<int64_t> column(count_);
    const auto put = [&](Array<int64_t>& array, const auto& value) {
      for (size_t k = 0; k < count_; ++k) column[k] = value(k);
      array.put(stream_, 0, column);
    };
    Copy& copy = copies_[0];
    for (size_t a = 0; a < 3; ++a) {
      put(copy.x[a], [&](size_t k) {
        const Particle& p = state.particles[k];
        return p.x[a] + (int64_t{plan_.lattice.cell(p.cell)[a]} << frac_);
      });
      put(copy.v[a], [&](size_t k) { return state.particles[k].v[a]; });
      if (copy.u[a].size() > 0) put(copy.u[a], [&](size_t k) { return state.particles[k].u[a]; });
    }
    for (size_t f = 0; f < index(numbers_); ++f)
      put(copy.fields[f], [&](size_t k) { return state.fields[k * index(numbers_) + f]; });
    std::vector<uint8_t> types;
    std::vector<uint32_t> ids;
    for (const Particle& p : state.particles) types.push_back(p.type), ids.push_back(p.id);
    copy.type.put(stream_, 0, types);
    copy.id.put(stream_, 0, ids);
    if (rows_ != nullptr) put_bonds(ids, state.bonds);
    listed_ = false;
  }

  int bond_count() const { return program_.bond_numbers(); }

  // `ids`: of the particles as they stand, and will stand.
  void put_bonds(const std::vector<uint32_t>& ids, const std::vector<int64_t>& bonds) {
    std::vector<uint32_t> place(count_);
    for (uint32_t k = 0; k < count_; ++k) place[ids[k]] = k;
    width_ = static_cast<uint32_t>(rows_->longest());
    const size_t slots = size_t{width_} * count_;
    std::vector<uint32_t> entries(slots), kinds(slots), counts(count_);
    std::vector<std::vector<int64_t>> numbers(index(bond_count()), std::vector<int64_t>(slots));
    for (uint32_t k = 0; k < count_; ++k) {
      const uint64_t first = rows_->first[ids[k]], end = rows_->first[ids[k] + 1];
      counts[k] = static_cast<uint32_t>(end - first);
      for (uint64_t b = first; b < end; ++b) {
        const size_t slot = (b - first) * count_ + k;
        entries[slot] = place[rows_->other[b]] | kNoImage << kPartnerBits;
        kinds[slot] = rows_->kind[b];
        for (size_t n = 0; n < numbers.size(); ++n) numbers[n][slot] = bonds[b * numbers.size() + n];
      }
    }
    entries_.set(stream_, entries);
    counts_.set(stream_, counts);
    bond_kind_.set(stream_, kinds);
    bond_constants_.set(stream_, rows_->constants);
    bond_at_.assign(numbers.size(), 0);
    for (auto& copy : bond_copies_) copy.resize(numbers.size());
    for (size_t n = 0; n < numbers.size(); ++n) {
      bond_copies_[0][n].set(stream_, numbers[n]);
      bond_copies_[1][n].resize(bond_copies_[0][n].size());
    }
  }
  RoundsBonds bonds() const {
    RoundsBonds bonds{};
    bonds.on = rows_ != nullptr;
    for (size_t n = 0; n < bond_at_.size(); ++n) bonds.from[n] = bond_copies_[bond_at_[n]][n].data();
    bonds.kind = bond_kind_.data(), bonds.constants = bond_constants_.data();
    bonds.numbers = bond_count();
    bonds.constant_count = static_cast<int>(program_.bond_constants.size());
    bonds.position_frac = program_.position_frac;
    for (int a = 0; a < 3; ++a) bonds.period[a] = int64_t{cells_.period[a]} << program_.position_frac;
    return bonds;
  }
  // `order`: by id, where the particle stands.
  void add_bonds(const std::vector<size_t>& order, State& state) const {
    std::vector<std::vector<int64_t>> numbers;
    for (size_t n = 0; n < bond_at_.size(); ++n) {
      const Array<int64_t>& from = bond_copies_[bond_at_[n]][n];
      numbers.push_back(from.host(stream_, 0, from.size()));
    }
    for (size_t id = 0; id < order.size(); ++id)
      for (uint64_t b = rows_->first[id]; b < rows_->first[id + 1]; ++b)
        for (const auto& values : numbers)
          state.bonds.push_back(values[(b - rows_->first[id]) * count_ + order[id]]);
    state.bond_begin = begins_of(*rows_, bond_count());
  }

  // Of copy `at_`, by id.
  std::vector<Int3> velocities() const {
    std::vector<Int3> by_id(count_);
    const std::vector<uint32_t> ids = copies_[who_].id.host(stream_, 0, count_);
    for (size_t a = 0; a < 3; ++a) {
      const std::vector<int64_t> v = copies_[index(at_)].v[a].host(stream_, 0, count_);
      for (size_t k = 0; k < count_; ++k) by_id[ids[k]][a] = v[k];
    }
    return by_id;
  }

  // Of copy `at_`, in the order of the device.
  State slots() const {
    State state{step_, std::vector<Particle>(count_)};
    const Copy& copy = copies_[index(at_)];
    const std::vector<uint8_t> types = copies_[who_].type.host(stream_, 0, count_);
    const std::vector<uint32_t> ids = copies_[who_].id.host(stream_, 0, count_);
    std::vector<Cell> cell(count_);
    const Cell& period = plan_.lattice.period();
    for (size_t a = 0; a < 3; ++a) {
      const std::vector<int64_t> x = copy.x[a].host(stream_, 0, count_),
                                 v = copy.v[a].host(stream_, 0, count_);
      std::vector<int64_t> u(count_);
      if (copy.u[a].size() > 0) u = copy.u[a].host(stream_, 0, count_);
      for (size_t k = 0; k < count_; ++k) {
        Particle& p = state.particles[k];
        p.x[a] = x[k] & ((int64_t{1} << frac_) - 1);
        p.v[a] = v[k], p.u[a] = u[k];
        cell[k][a] = static_cast<int32_t>(x[k] >> frac_);
        if (period[a] > 0) cell[k][a] = ((cell[k][a] % period[a]) + period[a]) % period[a];
      }
    }
    for (size_t k = 0; k < count_; ++k) {
      state.particles[k].type = types[k], state.particles[k].id = ids[k];
      state.particles[k].cell = plan_.lattice.find(cell[k]);
    }
    state.fields.resize(count_ * index(numbers_));
    for (size_t f = 0; f < index(numbers_); ++f) {
      const std::vector<int64_t> values = copies_[field_at_[f]].fields[f].host(stream_, 0, count_);
      for (size_t k = 0; k < count_; ++k) state.fields[k * index(numbers_) + f] = values[k];
    }
    return state;
  }

  void make_lists() {
    if (rows_ == nullptr) skin_.aged(age_);
    make_bins();
    bin_count_.zero(stream_), bin_taken_.zero(stream_), occupancy_.zero(stream_);
    for (size_t a = 0; a < 3; ++a) cells_.home[a] = home_[a].data();
    cells_.entered = entered_.data();
    for_each(stream_, 0, count_, block_,
             RoundsSettle{view(at_), bins_, cells_, guard_, frac_, bin_.data(), bin_count_.data()});
    if (rows_ != nullptr) return serve_bonds();
    const int bins = bins_.count[0] * bins_.count[1] * bins_.count[2];
    exclusive_sums(stream_, bin_count_.data(), bin_first_.data(), static_cast<uint32_t>(bins));
    for_each(stream_, 0, count_, block_,
             RoundsOrder{bin_.data(), bin_first_.data(), bin_taken_.data(), order_.data()});
    gather();
    const double unit = std::ldexp(1.0, program_.position_frac);
    RoundsMakeList make{bins_,
                        {view(at_).x[0], view(at_).x[1], view(at_).x[2]},
                        guard_,
                        near_at_.data(),
                        coarse_shift_,
                        bin_first_.data(),
                        bin_count_.data(),
                        coarse_reach2(),
                        entries_.data(),
                        counts_.data(),
                        width_,
                        count_};
    longest_ =
        std::max<uint64_t>(longest_, fill_list(stream_, count_, block_, make, most_, entries_, width_));
    near_entries_.resize(entries_.size());
    listed_pairs_ = mean_of(counts_);
    skin_.listed(listed_pairs_);
    // Both of a pair move, and both were rounded to a visible unit, then and now.
    const auto allowed2 = [&](double skin) {
      const double allowed = skin * unit / 2 - 4;
      return allowed > 0 ? allowed * allowed : -1;
    };
    const double near_skin = std::min(kNearSkin * reach_, skin_.now() / 2);
    near_ = {near_entries_.data(), near_counts_.data(), near_at_.data(),
             std::pow((reach_ + near_skin) * unit, 2), allowed2(near_skin)};
    serve(allowed2(skin_.now()));
  }
  // Coarse places are rounded down: a distance may be off by the root of three of their units.
  uint64_t coarse_reach2() const {
    const double reach = std::ldexp(reach_ + skin_.now(), program_.position_frac - coarse_shift_) + 2;
    return static_cast<uint64_t>(reach * reach);
  }
  double mean_of(const Array<uint32_t>& counts) {
    for_each(stream_, 0, 1, 32, RoundsZero{hashes_.data()});
    sum_each(stream_, 0, count_, block_, RoundsCount{counts.data()}, hashes_.data());
    return static_cast<double>(hashes_.host(stream_, 0, 1)[0]) / std::max(count_, 1u);
  }
  void serve(double allowed2) {
    list_.entries = entries_.data(), list_.counts = counts_.data(), list_.stride = count_;
    for (int s = 0; s < 27; ++s)
      for (int a = 0; a < 3; ++a)
        list_.shift[s][a] = static_cast<uint32_t>(((a == 0   ? s % 3
                                                    : a == 1 ? s / 3 % 3
                                                             : s / 9) -
                                                   1) *
                                                  bins_.length[a]);
    list_.listed = listed_at_.data();
    near_stale_ = true;
    list_.allowed2 = allowed2;
    ++builds_;
    age_ = 0;
    listed_ = true;
  }
  // Partners stay, wherever they go; cells are counted anew.
  void serve_bonds() {
    RoundsMark mark{view(at_), entered_.data(), {}, frac_};
    for (size_t a = 0; a < 3; ++a) mark.home[a] = home_[a].data();
    for_each(stream_, 0, count_, block_, mark);
    serve(std::numeric_limits<double>::infinity());
  }

  void gather() {
    const int to = 1 - at_;
    RoundsView target{};
    Copy& copy = copies_[index(to)];
    for (size_t a = 0; a < 3; ++a) {
      target.x[a] = copy.x[a].data(), target.v[a] = copy.v[a].data();
      target.u[a] = copy.u[a].data();
    }
    target.place = copy.place.data();
    // The numbers of the fields move between their own two copies.
    for (size_t f = 0; f < index(numbers_); ++f)
      target.fields[f] = copies_[1 - field_at_[f]].fields[f].data();
    Copy& others = copies_[1 - who_];
    RoundsGather gather{order_.data(),
                        view(at_),
                        target,
                        others.type.data(),
                        others.id.data(),
                        entered_.data(),
                        listed_at_.data(),
                        near_at_.data(),  // near lists begin anew
                        {},
                        guard_,
                        frac_,
                        coarse_shift_,
                        numbers_};
    for (size_t a = 0; a < 3; ++a) gather.home[a] = home_[a].data();
    for_each(stream_, 0, count_, block_, gather);
    at_ = to, who_ = 1 - who_;
    for (size_t& at : field_at_) at = 1 - at;
  }

  // Where the state is after a step that began at these copies: each number of a field that some round writes
  // is in its other copy. So is one of a bond.
  struct Places {
    int at;
    std::vector<size_t> fields, bonds;
  };
  Places places() const { return {at_, field_at_, bond_at_}; }
  void go_to(const Places& places) { at_ = places.at, field_at_ = places.fields, bond_at_ = places.bonds; }

  void load(const CompileRounds& compile) {
    const RoundsText text = text_of(program_, sizeof(RoundsFrame));
    const std::string architecture = architecture_of(stream_);
    try {
      kernels_ = std::make_unique<LoadedKernels>(stream_, compile(text.source, architecture), text.names);
      table_entries_.set(stream_, text.entries);
      how_ = "compiled for " + architecture;
    } catch (const std::runtime_error& e) {
      how_ = std::string("interpreted: ") + e.what();
    }
  }
  // One step of the state at hand, taken from there both ways, and by golden too where that is soon done.
  // Where it is none for the interpreter, the next batch may have one that is.
  void prove() {
    const Places here = places();
    const bool stale = near_stale_;
    const auto hash_of_step = [&](bool compiled) {
      std::vector<uint64_t> hashes;
      run(1, &hashes, compiled);
      go_to(here), near_stale_ = stale;
      return hashes;
    };
    const std::vector<uint64_t> expected = hash_of_step(false);
    if (expected.empty()) return;
    proven_ = hash_of_step(true) == expected;
    if (proven_ && count_ <= kProvenByGolden) {
      GoldenIntegers golden(program_, plan_.lattice, plan_.arch.capacity, state(), plan_.program->rows);
      golden.advance(1, nullptr);
      proven_ = golden.hash() == expected.front();
    }
    if (proven_) return;
    kernels_.reset();
    how_ = "interpreted: compiled ones take step " + std::to_string(step_ + 1) + " otherwise";
  }

  uint32_t run(uint32_t steps, std::vector<uint64_t>* hashes, bool compiled) {
    for_each(stream_, 0, 1, 32, RoundsReset{control_.data(), near_stale_});
    if (hashes != nullptr) hashes_.zero(stream_);
    std::vector<Places> after{places()};
    for (uint32_t n = 1; n <= steps; ++n) {
      step(n, compiled);
      after.push_back(places());
      if (hashes == nullptr) continue;
      RoundsHash hash{view(at_),      {cells_.period[0], cells_.period[1], cells_.period[2]},
                      frac_,          numbers_,
                      bonds(),        counts_.data(),
                      count_,         n,
                      control_.data()};
      sum_each(stream_, 0, count_, block_, hash, hashes_.data() + n);
    }
    const RoundsControl control = control_.host(stream_, 0, 1)[0];
    told_ = {control.doubt, control.old};
    uint32_t done = steps;
    if (told_.doubt <= steps) done = told_.doubt - 1;
    done = std::min(done, told_.old);
    go_to(after[done]);
    // A step that was begun in vain may have left some particles a new near list.
    near_stale_ = done < steps || control.near_stale[done + 1] != 0;
    if (hashes != nullptr) {
      const std::vector<uint64_t> sums = hashes_.host(stream_, 1, done);
      hashes->insert(hashes->end(), sums.begin(), sums.end());
    }
    return done;
  }

  void launch(size_t k, const RoundsFrame& frame, bool compiled) {
    const RoundCode& code = code_.rounds()[k];
    if (compiled)
      kernels_->launch(stream_, k, count_, block_, frame);
    else if (rows_ != nullptr)
      interpret<true>(frame, code);
    else
      interpret<false>(frame, code);
  }
  template <bool Bonded>
  void interpret(const RoundsFrame& frame, const RoundCode& code) {
    // Smaller blocks leave less of a processor's memory unused.
    auto threads = static_cast<uint32_t>(block_);
    while (threads > 32 && code.bytes(threads) > kMostBytesOfBlock) threads -= 32;
    const InterpretedBlock<Bonded> block{{frame, {code}}, count_, threads};
    for_each_block(stream_, (count_ + threads - 1) / threads, static_cast<int>(threads), code.bytes(threads),
                   block);
  }

  void step(uint32_t number, bool compiled) {
    const int from = at_;
    for (size_t k = 0; k < code_.rounds().size(); ++k) {
      RoundsFrame round{};
      round.from = view(from), round.to = view(1 - from);
      round.list = list_, round.near = near_, round.cells = cells_, round.bonds = bonds();
      round.entries = table_entries_.data();
      round.type_constants = code_.type_constants(), round.pair_constants = code_.pair_constants();
      round.guard = guard_, round.frac = frac_;
      round.first = k == 0, round.last = k + 1 == code_.rounds().size();
      round.step = step_ + number - 1, round.number = number, round.control = control_.data();
      // What a round writes it makes in the other copy, as others may still read this one.
      std::vector<bool> written(index(numbers_));
      for (const graph::Write& write : program_.rounds[k].writes)
        written[index(program_.place(write.field) + write.component)] = true;
      for (size_t f = 0; f < written.size(); ++f) {
        if (written[f]) round.to.fields[f] = copies_[1 - field_at_[f]].fields[f].data();
      }
      std::vector<bool> bond_written(bond_at_.size());
      for (const graph::Write& write : program_.rounds[k].bond_writes)
        bond_written[index(program_.bond_place(write.field) + write.component)] = true;
      for (size_t n = 0; n < bond_at_.size(); ++n)
        if (bond_written[n]) round.bonds.to[n] = bond_copies_[1 - bond_at_[n]][n].data();
      launch(k, round, compiled);
      for (size_t n = 0; n < bond_at_.size(); ++n)
        if (bond_written[n]) bond_at_[n] = 1 - bond_at_[n];
      for (size_t f = 0; f < written.size(); ++f)
        if (written[f]) field_at_[f] = 1 - field_at_[f];
    }
    at_ = 1 - from;
  }
  // Throws where the step cannot be done.
  void step_by_golden() {
    const State before = state();
    GoldenIntegers golden(program_, plan_.lattice, plan_.arch.capacity, before, plan_.program->rows);
    golden.advance(1, nullptr);
    ++golden_steps_;
    ++step_;
    upload(golden.state());
  }

  const Plan& plan_;
  const graph::FixedProgram& program_;
  const graph::BondRows* rows_;  // null: the program is not bonded
  int block_;
  mutable Stream stream_;
  ProgramOnDevice code_;
  uint32_t count_;
  uint64_t step_;
  int numbers_, guard_, frac_;
  int coarse_shift_ = 0;
  double reach_;  // cells
  Skin skin_;     // cells
  RoundsCells cells_{};
  RoundsBins bins_{};
  RoundsList list_{};
  RoundsNear near_{};
  std::array<Copy, 2> copies_;
  int at_ = 0;
  size_t who_ = 0;
  std::vector<size_t> field_at_;  // by number
  Array<RoundsPlace> listed_at_, near_at_;
  std::array<Array<int32_t>, 3> home_;
  Array<uint32_t> bin_, order_, entered_, counts_, entries_, near_counts_, near_entries_, bin_count_,
      bin_first_, bin_taken_, occupancy_, most_;
  Array<uint8_t> exists_;
  std::array<std::vector<Array<int64_t>>, 2> bond_copies_;  // by number
  std::vector<size_t> bond_at_;
  Array<uint32_t> bond_kind_;
  Array<int64_t> bond_constants_;
  Array<RoundsControl> control_;
  Array<uint64_t> hashes_;
  std::unique_ptr<LoadedKernels> kernels_;  // null: interpreted
  Array<TableEntry> table_entries_;
  bool proven_ = false;
  std::string how_ = "interpreted";
  uint32_t width_ = 0, batch_ = kLongestBatch;
  double listed_pairs_ = 0;
  Told told_;
  bool listed_ = false, near_stale_ = true;
  uint64_t age_ = 0;  // steps that the list has served
  uint64_t builds_ = 0, golden_steps_ = 0, longest_ = 0;
};

}  // namespace

std::unique_ptr<IntegerEngine> make_rounds_engine(const Plan& plan, const State& initial,
                                                  const Options& options, const CompileRounds& compile) {
  if (options.devices.size() > 1)
    throw InputError("a rule of text runs on one GPU", "--gpus 1").about({"rule.file", "rule"});
  return std::make_unique<RoundsEngine>(plan, initial, options, compile);
}

}  // namespace cuboct::gpu
