// SPDX-License-Identifier: MIT
#include "emu/gpu/rounds/rounds_engine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "emu/gpu/cells.h"
#include "emu/gpu/messages.h"
#include "emu/gpu/rounds/rounds_slab.h"
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
constexpr uint32_t kProvenByGolden = 32768;  // particles: more take golden too long
constexpr double kSpare = 1.1;               // room of several slabs, beyond what they hold at a time

size_t index(int n) { return static_cast<size_t>(n); }

// Whether some pair's graph reads it of a partner.
bool read_of_others(const graph::FixedProgram& program, graph::Source source, int place) {
  for (const graph::Round& round : program.rounds)
    for (const graph::Node& node : round.pair.nodes)
      if (node.op == graph::Op::input && node.source == source &&
          (source != graph::Source::other_field || program.place(node.index) + node.axis == place))
        return true;
  return false;
}

class RoundsEngine final : public IntegerEngine {
 public:
  RoundsEngine(const Plan& plan, const State& initial, const Options& options, const CompileRounds& compile)
      : plan_(plan),
        program_(plan.program->program),
        rows_(plan.program->rows.get()),
        block_(options.block),
        count_(static_cast<uint32_t>(initial.particles.size())),
        step_(initial.step),
        numbers_(program_.numbers()),
        guard_(program_.guard),
        frac_(program_.position_frac + program_.guard),
        reach_(reach_of(plan)),
        skin_(reach_, largest_skin(plan, reach_), count_) {
    if (count_ >= 1u << kPartnerBits)
      throw InputError("more particles than the gpu engine lists for a rule of text: 2^27");
    require_devices(options);
    for (int f = 0; f < numbers_; ++f)
      seen_.push_back(read_of_others(program_, graph::Source::other_field, f));
    seen_v_ = read_of_others(program_, graph::Source::other_v, 0);
    make_slabs(initial, options.devices);
    upload(initial);
    if (compile) load(compile);
    if (!has_kernels_) return;
    make_lists();
    prove();
  }

  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override {
    const uint64_t end = step_ + steps;
    while (step_ < end && !interrupted()) {
      if (!listed_) make_lists();
      if (has_kernels_ && !proven_) prove();
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
    State state{step_, {}};
    std::vector<size_t> first;  // of each slab's particles
    for (const auto& slab : slabs_) {
      first.push_back(state.particles.size());
      slab->add_to(state, places_, plan_.lattice, frac_);
    }
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
    if (bond_count() > 0) add_bonds(order, first, sorted);
    return sorted;
  }
  uint64_t hash() const override { return hash_of(plan_.lattice, state()); }
  // Golden's slots are not kept: by id.
  void for_each_slot(const std::function<void(const Particle&)>& see) const override {
    for (const Particle& particle : state().particles) see(particle);
  }
  cuboct::Counters counters() const override {
    uint64_t ghosts = 0;
    for (const auto& slab : slabs_) ghosts += slab->all - slab->own;
    return {
        {"list_builds", static_cast<double>(builds_)},   {"golden_steps", static_cast<double>(golden_steps_)},
        {"longest_list", static_cast<double>(longest_)}, {"listed_pairs", listed_pairs_},
        {"halo_particles", static_cast<double>(ghosts)}, {"device_bytes", static_cast<double>(bytes_)}};
  }
  Notes notes() const override { return {{"kernels", how_}}; }

 private:
  // What the devices told of a batch.
  struct Told {
    uint32_t doubt = kNoStep, old = kNoStep;
  };

  bool alone() const { return slabs_.size() == 1; }
  void wait_for_all() const {
    for (const auto& slab : slabs_) slab->stream.synchronize();
  }

  void make_slabs(const State& initial, const std::vector<int>& devices) {
    const CellBox box = box_of(plan_.lattice, true);
    RoundsCells cells{};
    uint64_t all = 1;
    for (size_t a = 0; a < 3; ++a) {
      cells.low[a] = box.low[a];
      cells.extent[a] = static_cast<int>(box.extent(a));
      cells.period[a] = plan_.lattice.period()[a];
      all *= static_cast<uint64_t>(box.extent(a));
      if (cells.extent[a] > cells.extent[cells.axis]) cells.axis = static_cast<int>(a);
    }
    if (all > kNoStep / 2) throw InputError("the lattice's box has too many cells for the gpu engine");
    cells.capacity = static_cast<uint32_t>(plan_.arch.capacity);
    cut(initial, cells, static_cast<int>(devices.size()));
    std::vector<uint8_t> exists(all);
    for (uint32_t n = 0; n < plan_.lattice.size(); ++n) {
      const Cell& c = plan_.lattice.cell(n);
      uint64_t at = 0;
      for (size_t a = 3; a-- > 0;)
        at = at * static_cast<uint64_t>(cells.extent[a]) + static_cast<uint64_t>(c[a] - cells.low[a]);
      exists[at] = 1;
    }
    share(devices);
    const bool displaced = !program_.motion.u.empty() || plan_.rule.pd;
    for (const int device : devices) {
      slabs_.push_back(std::make_unique<RoundsSlab>(device, program_, displaced, &bytes_));
      slabs_.back()->exists.set(slabs_.back()->stream, exists);
      slabs_.back()->occupancy.resize(all);
    }
    std::vector<uint32_t*> planes;
    for (int plane = 0; plane < cells.extent[cells.axis]; ++plane)
      planes.push_back(slabs_[index(cuts_.owner(plane + cells.low[cells.axis]))]->occupancy.data());
    for (auto& slab : slabs_) {
      slab->planes.set(slab->stream, planes);
      slab->cells = cells;
      slab->cells.exists = slab->exists.data(), slab->cells.occupancy = slab->planes.data();
      std::vector<RoundsControl*> others;
      for (auto& other : slabs_)
        if (other != slab) others.push_back(other->control.data());
      slab->others.set(slab->stream, others);
    }
  }

  // Into slabs with about equal numbers of particles.
  void cut(const State& initial, const RoundsCells& cells, int slabs) {
    const size_t axis = index(cells.axis);
    const int planes = cells.extent[axis];
    if (planes < slabs) throw_few_planes(slabs, planes);
    std::vector<uint64_t> per_plane(index(planes));
    for (const Particle& p : initial.particles)
      ++per_plane[index(plan_.lattice.cell(p.cell)[axis] - cells.low[axis])];
    cuts_ = {cells.axis, slabs, frac_, cells.low[axis], cells.period[axis], {}};
    const std::vector<int> ends = slab_ends(per_plane, slabs, 1);
    for (int s = 0; s < slabs; ++s) cuts_.end[s] = ends[index(s)] + cells.low[axis];
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
    const RoundsCells& cells = slabs_.front()->cells;
    double size = reach_ + skin_.now();
    uint64_t bins = 0;
    for (;; size *= 1.26) {
      bins = 1;
      for (size_t a = 0; a < 3; ++a) {
        bins_.low[a] = int64_t{cells.low[a]} << program_.position_frac;
        bins_.length[a] = int64_t{cells.extent[a]} << program_.position_frac;
        bins_.wraps[a] = cells.period[a] > 0;
        const int least = bins_.wraps[a] ? kLeastBins : 1;
        bins_.count[a] = std::max(least, static_cast<int>(cells.extent[a] / size));
        bins *= static_cast<uint64_t>(bins_.count[a]);
      }
      if (bins <= kMostBins) break;
    }
    coarse_shift_ = 0;
    for (size_t a = 0; a < 3; ++a)
      while (2 * (bins_.length[a] / bins_.count[a] + 1) >> coarse_shift_ >= int64_t{1} << 31) ++coarse_shift_;
    bin_total_ = static_cast<uint32_t>(bins);
    for (auto& slab : slabs_)
      for (Array<uint32_t>* of : {&slab->bin_count, &slab->bin_first, &slab->bin_taken})
        if (of->size() < bins) of->resize(bins);
  }

  void upload(const State& state) {
    places_ = {0, 0, std::vector<size_t>(index(numbers_)), std::vector<size_t>(index(bond_count()))};
    std::vector<std::vector<uint32_t>> own(slabs_.size());
    for (uint32_t k = 0; k < count_; ++k) {
      const Cell& cell = plan_.lattice.cell(state.particles[k].cell);
      own[index(cuts_.owner(cell[index(cuts_.axis)]))].push_back(k);
    }
    for (size_t s = 0; s < slabs_.size(); ++s) {
      make_room(*slabs_[s], own[s].size(), 0);
      slabs_[s]->put(state, own[s], plan_.lattice, frac_);
    }
    if (rows_ != nullptr) put_bonds(state, own);
    listed_ = false;
  }
  void make_room(RoundsSlab& slab, size_t particles, size_t kept) const {
    if (particles >= size_t{1} << kPartnerBits) throw_too_many(particles, size_t{1} << kPartnerBits);
    if (particles <= slab.room()) return;
    slab.make_room(alone() ? particles : static_cast<size_t>(static_cast<double>(particles) * kSpare), kept);
  }

  int bond_count() const { return program_.bond_numbers(); }

  // `own`: of each slab the particles as they stand, and will stand.
  void put_bonds(const State& state, const std::vector<std::vector<uint32_t>>& own) {
    std::vector<uint32_t> owner(count_), place(count_);  // by id
    for (uint32_t s = 0; s < own.size(); ++s)
      for (uint32_t k = 0; k < own[s].size(); ++k) {
        const uint32_t id = state.particles[own[s][k]].id;
        owner[id] = s, place[id] = k;
      }
    const auto ids = [&](size_t s) {
      std::vector<uint32_t> ids;
      for (const uint32_t k : own[s]) ids.push_back(state.particles[k].id);
      return ids;
    };
    // Of each slab the others' particles that its bonds go to, by owner.
    std::vector<std::vector<std::vector<uint32_t>>> ghosts(own.size());
    for (size_t s = 0; s < own.size(); ++s) {
      ghosts[s].resize(own.size());
      for (const uint32_t id : ids(s))
        for (uint64_t b = rows_->first[id]; b < rows_->first[id + 1]; ++b)
          if (const uint32_t other = rows_->other[b]; owner[other] != s)
            ghosts[s][owner[other]].push_back(other);
      for (std::vector<uint32_t>& of : ghosts[s]) {
        std::sort(of.begin(), of.end());
        of.erase(std::unique(of.begin(), of.end()), of.end());
      }
    }
    for (size_t s = 0; s < own.size(); ++s) {
      std::vector<uint32_t> sent;
      for (uint32_t to = 0; to < own.size(); ++to) {
        const std::vector<uint32_t>& of = ghosts[to][s];
        if (of.empty()) continue;
        slabs_[s]->sendings.push_back(
            {to, static_cast<uint32_t>(sent.size()), static_cast<uint32_t>(of.size()), 0});
        for (const uint32_t id : of) sent.push_back(place[id]);
      }
      slabs_[s]->sent.set(slabs_[s]->stream, sent);
    }
    for (size_t s = 0; s < own.size(); ++s) {
      std::vector<uint32_t> here = place;  // by id
      auto next = static_cast<uint32_t>(own[s].size());
      for (const std::vector<uint32_t>& of : ghosts[s])
        for (const uint32_t id : of) here[id] = next++;
      put_rows(*slabs_[s], ids(s), here, state.bonds);
    }
    carry();
  }
  void put_rows(RoundsSlab& slab, const std::vector<uint32_t>& ids, const std::vector<uint32_t>& place,
                const std::vector<int64_t>& bonds) const {
    slab.width = static_cast<uint32_t>(rows_->longest());
    const size_t own = ids.size(), slots = slab.width * own;
    std::vector<uint32_t> entries(slots), kinds(slots), counts(own);
    std::vector<std::vector<int64_t>> numbers(index(bond_count()), std::vector<int64_t>(slots));
    for (size_t k = 0; k < own; ++k) {
      const uint64_t first = rows_->first[ids[k]], end = rows_->first[ids[k] + 1];
      counts[k] = static_cast<uint32_t>(end - first);
      for (uint64_t b = first; b < end; ++b) {
        const size_t slot = (b - first) * own + k;
        entries[slot] = place[rows_->other[b]] | kNoImage << kPartnerBits;
        kinds[slot] = rows_->kind[b];
        for (size_t n = 0; n < numbers.size(); ++n) numbers[n][slot] = bonds[b * numbers.size() + n];
      }
    }
    slab.entries.set(slab.stream, entries);
    slab.counts.put(slab.stream, 0, counts);
    slab.bond_kind.set(slab.stream, kinds);
    slab.bond_constants.set(slab.stream, rows_->constants);
    for (size_t n = 0; n < numbers.size(); ++n) {
      slab.bond_copies[0][n].set(slab.stream, numbers[n]);
      slab.bond_copies[1][n].resize(slab.bond_copies[0][n].size());
    }
  }
  RoundsBonds bonds(const RoundsSlab& slab) const {
    RoundsBonds bonds{};
    bonds.on = rows_ != nullptr;
    for (size_t n = 0; n < places_.bonds.size(); ++n)
      bonds.from[n] = slab.bond_copies[places_.bonds[n]][n].data();
    bonds.kind = slab.bond_kind.data(), bonds.constants = slab.bond_constants.data();
    bonds.numbers = bond_count();
    bonds.constant_count = static_cast<int>(program_.bond_constants.size());
    bonds.position_frac = program_.position_frac;
    for (int a = 0; a < 3; ++a) bonds.period[a] = int64_t{slab.cells.period[a]} << program_.position_frac;
    return bonds;
  }
  // `order`: by id, where the particle stands among those of all slabs, each of which begins at `first`.
  void add_bonds(const std::vector<size_t>& order, const std::vector<size_t>& first, State& state) const {
    std::vector<std::vector<std::vector<int64_t>>> numbers(slabs_.size());
    for (size_t s = 0; s < slabs_.size(); ++s)
      for (size_t n = 0; n < places_.bonds.size(); ++n) {
        const Array<int64_t>& from = slabs_[s]->bond_copies[places_.bonds[n]][n];
        numbers[s].push_back(from.host(slabs_[s]->stream, 0, from.size()));
      }
    for (size_t id = 0; id < order.size(); ++id) {
      const auto after = std::upper_bound(first.begin(), first.end(), order[id]);
      const auto s = static_cast<size_t>(after - first.begin()) - 1;
      for (uint64_t b = rows_->first[id]; b < rows_->first[id + 1]; ++b)
        for (const auto& values : numbers[s])
          state.bonds.push_back(values[(b - rows_->first[id]) * slabs_[s]->own + order[id] - first[s]]);
    }
    state.bond_begin = begins_of(*rows_, bond_count());
  }

  // Sends the particles that `choice(slab, number)` picks, into the places behind those that slabs have.
  template <class Choose>
  void send(const Choose& choose) {
    for (int s = 0; s < cuts_.count; ++s) slabs_[index(s)]->count_sent(choose(*slabs_[index(s)], s), block_);
    for (int s = 0; s < cuts_.count; ++s) slabs_[index(s)]->list_sent(choose(*slabs_[index(s)], s), block_);
    carry();
  }
  void carry() {
    std::vector<size_t> all;
    for (auto& slab : slabs_) all.push_back(slab->own);
    for (auto& slab : slabs_)
      for (RoundsSlab::Sending& sending : slab->sendings) {
        sending.at = static_cast<uint32_t>(all[sending.to]);
        all[sending.to] += sending.count;
      }
    // What is written there is written after this.
    wait_for_all();
    for (size_t s = 0; s < slabs_.size(); ++s) {
      make_room(*slabs_[s], all[s], slabs_[s]->own);
      slabs_[s]->all = static_cast<uint32_t>(all[s]);
    }
    for (auto& slab : slabs_)
      for (const RoundsSlab::Sending& sending : slab->sendings) {
        RoundsSlab& to = *slabs_[sending.to];
        RoundsSlab::Copy& who = to.copies[places_.who];
        for_each(
            slab->stream, 0, sending.count, block_,
            RoundsCarry{slab->sent.data() + sending.first, sending.at, slab->view(places_), to.view(places_),
                        who.type.data(), who.id.data(), rows_ == nullptr ? to.near_at.data() : nullptr,
                        guard_, coarse_shift_, numbers_});
      }
    wait_for_all();
  }
  // Particles go to the slabs that own their cells. They stand behind those that were there.
  void migrate() {
    const auto x = [&](RoundsSlab& slab) { return slab.view(places_).x[cuts_.axis]; };
    if (cuts_.ring > 0)
      for (auto& slab : slabs_)
        for_each(slab->stream, 0, slab->own, block_, RoundsWrap{x(*slab), int64_t{cuts_.ring} << frac_});
    send([&](RoundsSlab& slab, int s) { return RoundsLeavers{cuts_, s, x(slab)}; });
  }
  // Ghosts of all that lists of other slabs may reach.
  void mirror() {
    const double reach = std::ldexp(reach_ + skin_.now(), frac_) + std::ldexp(4, guard_ + coarse_shift_);
    send([&](RoundsSlab& slab, int s) {
      return RoundsReached{cuts_, s, slab.view(places_).x[cuts_.axis], static_cast<int64_t>(reach)};
    });
  }

  void make_lists() {
    if (rows_ == nullptr) skin_.aged(age_);
    make_bins();
    const bool moves = rows_ == nullptr && !alone();
    if (moves) migrate();
    for (auto& slab : slabs_) {
      slab->bin_count.zero(slab->stream), slab->occupancy.zero(slab->stream);
    }
    if (!alone()) wait_for_all();  // a slab may count in another one's cells
    for (size_t s = 0; s < slabs_.size(); ++s) {
      RoundsSlab& slab = *slabs_[s];
      for_each(slab.stream, 0, moves ? slab.all : slab.own, block_,
               RoundsSettle{slab.view(places_), bins_, slab.cells, cuts_, moves ? static_cast<int>(s) : -1,
                            guard_, frac_, slab.bin.data(), slab.bin_count.data()});
    }
    if (rows_ != nullptr) return serve_bonds();
    for (auto& slab : slabs_) {
      const uint32_t before = slab->all;
      slab->own = before - (moves ? slab->sent_in_all() : 0);
      slab->sort(places_, before, bin_total_, guard_, frac_, coarse_shift_, block_);
      slab->all = slab->own;
    }
    places_.at = 1 - places_.at, places_.who = 1 - places_.who;
    for (size_t& at : places_.fields) at = 1 - at;
    if (moves) {
      mirror();
      for (auto& slab : slabs_) put_all_in_bins(*slab);
    }
    list_pairs();
  }
  void put_all_in_bins(RoundsSlab& slab) {
    slab.bin_count.zero(slab.stream);
    const RoundsView view = slab.view(places_);
    for_each(slab.stream, 0, slab.all, block_,
             RoundsBinAll{
                 {view.x[0], view.x[1], view.x[2]}, bins_, guard_, slab.bin.data(), slab.bin_count.data()});
    slab.put_in_bins(slab.all, bin_total_, block_);
  }
  void list_pairs() {
    const auto start = [&](RoundsSlab& slab) {
      const RoundsView view = slab.view(places_);
      slab.start_list({bins_,
                       {view.x[0], view.x[1], view.x[2]},
                       guard_,
                       slab.near_at.data(),
                       coarse_shift_,
                       slab.bin_first.data(),
                       slab.bin_count.data(),
                       alone() ? nullptr : slab.order.data(),
                       coarse_reach2(),
                       nullptr,
                       nullptr,
                       0,
                       0},
                      block_);
    };
    for (auto& slab : slabs_) start(*slab);
    for (auto& slab : slabs_) {
      while (!slab->list_fits()) start(*slab);
      longest_ = std::max<uint64_t>(longest_, slab->longest);
      if (slab->near_entries.size() < slab->entries.size()) slab->near_entries.resize(slab->entries.size());
    }
    listed_pairs_ = mean_count();
    skin_.listed(listed_pairs_);
    // Both of a pair move, and both were rounded to a visible unit, then and now.
    const double unit = std::ldexp(1.0, program_.position_frac);
    const auto allowed2 = [&](double skin) {
      const double allowed = skin * unit / 2 - 4;
      return allowed > 0 ? allowed * allowed : -1;
    };
    const double near_skin = std::min(kNearSkin * reach_, skin_.now() / 2);
    for (auto& slab : slabs_)
      slab->near = {slab->near_entries.data(), slab->near_counts.data(), slab->near_at.data(),
                    std::pow((reach_ + near_skin) * unit, 2), allowed2(near_skin)};
    serve(allowed2(skin_.now()));
  }
  // Coarse places are rounded down: a distance may be off by the root of three of their units.
  uint64_t coarse_reach2() const {
    const double reach = std::ldexp(reach_ + skin_.now(), program_.position_frac - coarse_shift_) + 2;
    return static_cast<uint64_t>(reach * reach);
  }
  double mean_count() {
    for (auto& slab : slabs_) {
      for_each(slab->stream, 0, 1, 32, RoundsZero{slab->hashes.data()});
      sum_each(slab->stream, 0, slab->own, block_, RoundsCount{slab->counts.data()}, slab->hashes.data());
    }
    uint64_t sum = 0;
    for (auto& slab : slabs_) sum += slab->hashes.host(slab->stream, 0, 1)[0];
    return static_cast<double>(sum) / std::max(count_, 1u);
  }
  void serve(double allowed2) {
    for (auto& slab : slabs_) {
      RoundsList& list = slab->list;
      list.entries = slab->entries.data(), list.counts = slab->counts.data(), list.stride = slab->own;
      for (int s = 0; s < 27; ++s)
        for (int a = 0; a < 3; ++a)
          list.shift[s][a] = static_cast<uint32_t>(((a == 0   ? s % 3
                                                     : a == 1 ? s / 3 % 3
                                                              : s / 9) -
                                                    1) *
                                                   bins_.length[a]);
      list.listed = slab->listed_at.data();
      for (size_t a = 0; a < 3; ++a) slab->cells.home[a] = slab->home[a].data();
      slab->cells.entered = slab->entered.data();
      list.allowed2 = allowed2;
    }
    near_stale_ = true;
    ++builds_;
    age_ = 0;
    listed_ = true;
  }
  // Partners stay, wherever they go; cells are counted anew.
  void serve_bonds() {
    for (auto& slab : slabs_) {
      RoundsMark mark{slab->view(places_), slab->entered.data(), {}, frac_};
      for (size_t a = 0; a < 3; ++a) mark.home[a] = slab->home[a].data();
      for_each(slab->stream, 0, slab->own, block_, mark);
    }
    serve(std::numeric_limits<double>::infinity());
  }

  void load(const CompileRounds& compile) {
    const RoundsText text = text_of(program_, sizeof(RoundsFrame));
    try {
      for (auto& slab : slabs_) {
        const std::string architecture = architecture_of(slab->stream);
        slab->kernels =
            std::make_unique<LoadedKernels>(slab->stream, compile(text.source, architecture), text.names);
        slab->table_entries.set(slab->stream, text.entries);
        how_ = "compiled for " + architecture;
      }
      has_kernels_ = true;
    } catch (const std::runtime_error& e) {
      how_ = std::string("interpreted: ") + e.what();
    }
  }
  // One step of the state at hand, taken from there both ways, and by golden too where that is soon done.
  // Where it is none for the interpreter, the next batch may have one that is.
  void prove() {
    const RoundsPlaces here = places_;
    const bool stale = near_stale_;
    const auto hash_of_step = [&](bool compiled) {
      std::vector<uint64_t> hashes;
      run(1, &hashes, compiled);
      places_ = here, near_stale_ = stale;
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
    has_kernels_ = false;
    how_ = "interpreted: compiled ones take step " + std::to_string(step_ + 1) + " otherwise";
  }

  uint32_t run(uint32_t steps, std::vector<uint64_t>* hashes, bool compiled) {
    for (auto& slab : slabs_) {
      slab->compiled = compiled;
      for_each(slab->stream, 0, 1, 32, RoundsReset{slab->control.data(), near_stale_});
      if (hashes != nullptr) slab->hashes.zero(slab->stream);
      slab->stream.record(slab->done);
    }
    std::vector<RoundsPlaces> after{places_};
    for (uint32_t n = 1; n <= steps; ++n) {
      step(n);
      after.push_back(places_);
      if (hashes != nullptr)
        for (auto& slab : slabs_) add_hashes(*slab, n);
    }
    wait_for_all();
    told_ = {};
    std::vector<RoundsControl> controls;
    for (auto& slab : slabs_) {
      controls.push_back(slab->control.host(slab->stream, 0, 1)[0]);
      told_.doubt = std::min(told_.doubt, controls.back().doubt);
      told_.old = std::min(told_.old, controls.back().old);
    }
    uint32_t done = steps;
    if (told_.doubt <= steps) done = told_.doubt - 1;
    done = std::min(done, told_.old);
    places_ = after[done];
    // A step that was begun in vain may have left some particles a new near list.
    near_stale_ = done < steps;
    for (const RoundsControl& control : controls)
      near_stale_ = near_stale_ || control.near_stale[done + 1] != 0;
    if (hashes != nullptr) {
      std::vector<uint64_t> sums(done);
      for (auto& slab : slabs_) {
        const std::vector<uint64_t> part = slab->hashes.host(slab->stream, 1, done);
        for (uint32_t k = 0; k < done; ++k) sums[k] += part[k];
      }
      hashes->insert(hashes->end(), sums.begin(), sums.end());
    }
    return done;
  }
  void add_hashes(RoundsSlab& slab, uint32_t number) {
    const RoundsCells& cells = slab.cells;
    const RoundsHash hash{slab.view(places_),
                          {cells.period[0], cells.period[1], cells.period[2]},
                          frac_,
                          numbers_,
                          bonds(slab),
                          slab.counts.data(),
                          slab.own,
                          number,
                          slab.control.data()};
    sum_each(slab.stream, 0, slab.own, block_, hash, slab.hashes.data() + number);
  }

  // What a round makes of each particle and each bond.
  struct Made {
    std::vector<bool> fields, bonds;
  };
  Made made_by(const graph::Round& round) const {
    Made made{std::vector<bool>(index(numbers_)), std::vector<bool>(index(bond_count()))};
    for (const graph::Write& write : round.writes)
      made.fields[index(program_.place(write.field) + write.component)] = true;
    for (const graph::Write& write : round.bond_writes)
      made.bonds[index(program_.bond_place(write.field) + write.component)] = true;
    return made;
  }

  void step(uint32_t number) {
    const size_t rounds = program_.rounds.size();
    for (size_t k = 0; k < rounds; ++k) {
      const Made made = made_by(program_.rounds[k]);
      const bool last = k + 1 == rounds;
      // A slab begins when all others are done with the round before. So what they send is there; none still
      // reads the ghosts that this one goes on to write; and a step that one of them found impossible is
      // known before the next one writes over the state that it began with.
      for (auto& slab : slabs_)
        for (const auto& other : slabs_)
          if (other != slab) slab->stream.wait(other->done);
      for (auto& slab : slabs_) {
        slab->launch(frame(*slab, made, k, number), k, block_);
        push(*slab, made, last, number);
        slab->stream.record(slab->done);
      }
      for (size_t f = 0; f < made.fields.size(); ++f)
        if (made.fields[f]) places_.fields[f] = 1 - places_.fields[f];
      for (size_t n = 0; n < made.bonds.size(); ++n)
        if (made.bonds[n]) places_.bonds[n] = 1 - places_.bonds[n];
    }
    places_.at = 1 - places_.at;
  }
  RoundsFrame frame(RoundsSlab& slab, const Made& made, size_t round, uint32_t number) {
    RoundsFrame frame{};
    frame.from = slab.view(places_), frame.to = slab.view(places_, 1 - places_.at);
    frame.list = slab.list, frame.near = slab.near, frame.cells = slab.cells, frame.bonds = bonds(slab);
    frame.entries = slab.table_entries.data();
    frame.type_constants = slab.code.type_constants(), frame.pair_constants = slab.code.pair_constants();
    frame.guard = guard_, frame.frac = frac_;
    frame.first = round == 0, frame.last = round + 1 == program_.rounds.size();
    frame.step = step_ + number - 1, frame.number = number, frame.control = slab.control.data();
    frame.others = slab.others.data(), frame.other_count = cuts_.count - 1;
    // What a round writes it makes in the other copy, as others may still read this one.
    for (size_t f = 0; f < made.fields.size(); ++f)
      if (made.fields[f]) frame.to.fields[f] = slab.copies[1 - places_.fields[f]].fields[f].data();
    for (size_t n = 0; n < made.bonds.size(); ++n)
      if (made.bonds[n]) frame.bonds.to[n] = slab.bond_copies[1 - places_.bonds[n]][n].data();
    return frame;
  }
  // What the round made and pairs read of partners goes to the ghosts.
  void push(RoundsSlab& slab, const Made& made, bool last, uint32_t number) {
    for (const RoundsSlab::Sending& sending : slab.sendings) {
      RoundsSlab& other = *slabs_[sending.to];
      RoundsPush push{};
      push.sent = slab.sent.data() + sending.first, push.first = sending.at;
      push.number = number, push.control = slab.control.data();
      const auto add = [&](const Array<int64_t>& from, const Array<int64_t>& to) {
        push.from[push.columns] = from.data(), push.to[push.columns++] = to.data();
      };
      for (size_t f = 0; f < made.fields.size(); ++f) {
        const size_t to = 1 - places_.fields[f];
        if (made.fields[f] && seen_[f]) add(slab.copies[to].fields[f], other.copies[to].fields[f]);
      }
      const RoundsSlab::Copy& from = slab.copies[1 - places_.at];
      const RoundsSlab::Copy& to = other.copies[1 - places_.at];
      for (size_t a = 0; last && a < 3; ++a) {
        if (rows_ != nullptr) add(from.x[a], to.x[a]);
        if (seen_v_) add(from.v[a], to.v[a]);
      }
      if (last && rows_ == nullptr) push.place_from = from.place.data(), push.place_to = to.place.data();
      if (push.columns > 0 || push.place_from != nullptr)
        for_each(slab.stream, 0, sending.count, block_, push);
    }
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
  uint64_t bytes_ = 0;
  std::vector<std::unique_ptr<RoundsSlab>> slabs_;
  RoundsSlabs cuts_{};
  uint32_t count_;
  uint64_t step_;
  int numbers_, guard_, frac_;
  std::vector<bool> seen_;  // by number: pairs read it of partners
  bool seen_v_ = false;
  int coarse_shift_ = 0;
  double reach_;  // cells
  Skin skin_;     // cells
  RoundsBins bins_{};
  uint32_t bin_total_ = 0;
  RoundsPlaces places_;
  bool has_kernels_ = false, proven_ = false;
  std::string how_ = "interpreted";
  uint32_t batch_ = kLongestBatch;
  double listed_pairs_ = 0;
  Told told_;
  bool listed_ = false, near_stale_ = true;
  uint64_t age_ = 0;  // steps that the list has served
  uint64_t builds_ = 0, golden_steps_ = 0, longest_ = 0;
};

}  // namespace

std::unique_ptr<IntegerEngine> make_rounds_engine(const Plan& plan, const State& initial,
                                                  const Options& options, const CompileRounds& compile) {
  return std::make_unique<RoundsEngine>(plan, initial, options, compile);
}

}  // namespace cuboct::gpu
