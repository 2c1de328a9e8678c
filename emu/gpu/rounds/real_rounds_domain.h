// SPDX-License-Identifier: MIT
// A scene whose rule is text in floats or doubles on one or more devices: slabs, their ghosts and their
// lists.
//
// A slab owns the particles between its ends when lists are made, and has ghosts of all that its lists may
// reach of others', however thin slabs are. Each pair is computed from both sides, so that ghosts are read
// only. All slabs have the same bins, and a bin's particles stand by id: a particle meets its partners in one
// order, and has the same bits, however many slabs there are. Where bonds are those of the body as packed,
// particles stay with their slab, and ghosts are the partners of its bonds.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

#include "emu/gpu/messages.h"
#include "emu/gpu/rounds/real_rounds_slab.h"
#include "emu/gpu/rounds/real_rounds_text.h"
#include "emu/gpu/rounds/real_space.h"
#include "emu/gpu/skin.h"

namespace cuboct::gpu {

template <class Real, class Number>
class RealDomain {
 public:
  using Slab = RealSlab<Real, Number>;
  using Frame = typename Slab::Frame;
  using Place = typename Slab::Place;

  // `numbers` of fields. Keeps a reference to the program.
  RealDomain(const RuleProgram& program, const RealSpace& space, const Skin& skin,
             const RealExponents& exponents, uint32_t numbers, const Body& body, const Options& options)
      : space(space),
        skin(skin),
        program_(program),
        exponents_(exponents),
        block_(options.block),
        bonded_(program.declaration.bonds == BondRange::reference),
        displaced_(!body.u.empty()),
        count_(static_cast<uint32_t>(body.size())),
        numbers_(numbers) {
    require_devices(options);
    cut(body, static_cast<int>(options.devices.size()));
    share(options.devices);
    for (const int device : options.devices)
      slabs.push_back(std::make_unique<Slab>(device, numbers, displaced_, bonded_));
    for (auto& slab : slabs) {
      std::vector<RealControl*> others;
      for (auto& other : slabs)
        if (other != slab) others.push_back(other->control.data());
      slab->others.set(slab->stream, others);
    }
  }

  bool alone() const { return slabs.size() == 1; }
  bool displaced() const { return displaced_; }
  static double si(Real value, int exponent) { return std::ldexp(static_cast<double>(value), exponent); }
  static Real of_si(double value, int exponent) { return static_cast<Real>(std::ldexp(value, -exponent)); }

  void upload(const Body& body, const std::vector<std::vector<double>>& fields) {
    places = {0, 0, std::vector<size_t>(numbers_), {}};
    for (size_t s = 0; s < slabs.size(); ++s) {
      Slab& slab = *slabs[s];
      std::vector<uint32_t> ids;
      for (uint32_t id = 0; id < count_; ++id)
        if (cut_.owner(cut_.along(space.whole(body.x[id][cut_.axis], index(cut_.axis)))) ==
            static_cast<int>(s))
          ids.push_back(id);
      slab.own = slab.all = static_cast<uint32_t>(ids.size());
      make_room(slab, ids.size(), 0);
      put(slab, ids, body, fields);
    }
  }

  // Particles of a rule with bonds of its own stand by id.
  void put_bonds(const ProgramStart& start, const RealBondKinds& kinds,
                 const std::vector<std::vector<std::vector<double>>>& numbers_of_kinds) {
    rows_ = start.rows;
    owner_.resize(count_), place_.resize(count_);
    std::vector<std::vector<uint32_t>> own;
    for (uint32_t s = 0; s < slabs.size(); ++s) {
      own.push_back(slabs[s]->ids(places));
      for (uint32_t k = 0; k < own[s].size(); ++k) owner_[own[s][k]] = s, place_[own[s][k]] = k;
    }
    const auto ghosts = bonded_ghosts(own, owner_, [&](uint32_t id, const auto& use) {
      for (uint64_t b = rows_.begin(id); b < rows_.end(id); ++b) use(rows_.other[b]);
    });
    const std::vector<bool> written = written_bonds(program_);
    places.bonds.assign(written.size(), 0);
    for (size_t s = 0; s < own.size(); ++s) {
      const std::vector<uint32_t> here = list_ghosts(*slabs[s], s, own[s].size(), place_, ghosts);
      put_rows(*slabs[s], own[s], here, start, kinds, written);
      for (const auto& of_round : numbers_of_kinds) {
        std::vector<Real> numbers;
        for (const std::vector<double>& of_kind : of_round)
          for (const double number : of_kind) numbers.push_back(static_cast<Real>(number));
        slabs[s]->kinds.emplace_back(slabs[s]->stream.device()).set(slabs[s]->stream, numbers);
      }
      longest_list = std::max<uint64_t>(longest_list, slabs[s]->width);
    }
    listed_pairs = static_cast<double>(rows_.other.size()) / count_;
    carry();
  }

  // Lists serve from now on. `age`: steps that those before have served.
  void make_lists(uint64_t age) {
    skin.aged(age);
    const RealBins bins = this->bins();
    const bool moves = !alone();
    if (moves) send([&](Slab& slab, int s) { return RealLeavers{cut_, s, x_of(slab)}; });
    for (size_t s = 0; s < slabs.size(); ++s) {
      Slab& slab = *slabs[s];
      slab.put_in_bins(places, moves ? slab.all : slab.own, bins, cut_, moves ? static_cast<int>(s) : -1,
                       block_);
      slab.own = slab.all - (moves ? sent_in_all(slab.sendings) : 0);
      slab.gather(frame, places, block_);
      slab.all = slab.own;
    }
    places.at = 1 - places.at, places.who = 1 - places.who;
    for (size_t& at : places.fields) at = 1 - at;
    if (moves) {
      const double reach = (program_.reach + skin.now()) * (1 + kRounding) / space.length[cut_.axis];
      send([&](Slab& slab, int s) { return RealReached{cut_, s, x_of(slab), reach + kRounding * reach}; });
      for (auto& slab : slabs) slab->put_in_bins(places, slab->all, bins, cut_, -1, block_);
    }
    list_pairs(bins);
  }

  // What a round and a step made that pairs read of partners, from copies that the state is about to be in.
  // `moved`: the step's last round, of a rule that moves.
  void push(Slab& slab, const std::vector<uint32_t>& made, bool moved, uint32_t number) {
    for (const RoundsSending& sending : slab.sendings) {
      Slab& other = *slabs[sending.to];
      RealPush<Real, Number> push{};
      push.sent = slab.sent.data() + sending.first, push.first = sending.at;
      push.number = number, push.control = slab.control.data();
      for (const uint32_t f : made) {
        const size_t to = 1 - places.fields[f];
        push.from[push.columns] = slab.copies[to].fields[f].data();
        push.to[push.columns++] = other.copies[to].fields[f].data();
      }
      if (moved) {
        const auto &from = slab.copies[1 - places.at], &to = other.copies[1 - places.at];
        push.place_from = from.place.data(), push.place_to = to.place.data();
        push.v_from = from.v.data(), push.v_to = to.v.data();
      }
      if (push.columns > 0 || moved) for_each(slab.stream, 0, sending.count, block_, push);
    }
  }

  // By id. `values(slab)`: of its own particles, in its order.
  template <class T, class Values>
  std::vector<T> by_id(const Values& values) const {
    std::vector<T> sorted(count_);
    for (const auto& slab : slabs) {
      const std::vector<uint32_t> ids = slab->ids(places);
      const std::vector<T> here = values(*slab);
      for (size_t k = 0; k < ids.size(); ++k) sorted[ids[k]] = here[k];
    }
    return sorted;
  }
  std::vector<int64_t> x(size_t axis) const {
    return by_id<int64_t>(
        [&](Slab& slab) { return slab.copies[places.at].x[axis].host(slab.stream, 0, slab.own); });
  }
  std::vector<int64_t> listed_x(size_t axis) const {
    return by_id<int64_t>([&](Slab& slab) { return slab.listed_x[axis].host(slab.stream, 0, slab.own); });
  }
  std::vector<RealFour<Real>> v() const {
    return by_id<RealFour<Real>>(
        [&](Slab& slab) { return slab.copies[places.at].v.host(slab.stream, 0, slab.own); });
  }
  std::vector<Real> u(size_t axis) const {
    return by_id<Real>(
        [&](Slab& slab) { return slab.copies[places.at].u[axis].host(slab.stream, 0, slab.own); });
  }
  std::vector<Real> force(size_t axis) const {
    return by_id<Real>([&](Slab& slab) { return slab.force[axis].host(slab.stream, 0, slab.own); });
  }
  std::vector<double> field(uint32_t number) const {
    const std::vector<Real> values = by_id<Real>([&](Slab& slab) {
      return slab.copies[places.fields[number]].fields[number].host(slab.stream, 0, slab.own);
    });
    std::vector<double> numbers(count_);
    for (size_t k = 0; k < count_; ++k) numbers[k] = si(values[k], exponents_.field[number]);
    return numbers;
  }
  std::vector<double> bond(uint32_t number) const {
    std::vector<std::vector<Real>> slots;
    for (const auto& slab : slabs) {
      const Array<Real>& from = slab->bond_copies[places.bonds[number]][number];
      slots.push_back(from.host(slab->stream, 0, from.size()));
    }
    std::vector<double> values;
    for (size_t i = 0; i < count_; ++i)
      for (uint64_t b = rows_.begin(i); b < rows_.end(i); ++b)
        values.push_back(si(slots[owner_[i]][(b - rows_.begin(i)) * slabs[owner_[i]]->own + place_[i]],
                            exponents_.bond[number]));
    return values;
  }

  // All by id.
  void set_x(const std::array<std::vector<int64_t>, 3>& x) {
    for (auto& slab : slabs) {
      auto& copy = slab->copies[places.at];
      const std::vector<uint32_t> ids = slab->ids(places);
      std::vector<Place> place = copy.place.host(slab->stream, 0, slab->own);
      for (size_t a = 0; a < 3; ++a) {
        const std::vector<int64_t> here = in_order_of(x[a], ids);
        for (size_t k = 0; k < here.size(); ++k)
          place[k].x[a] = space.ring[a].template place<Number>(here[k]);
        copy.x[a].put(slab->stream, 0, here);
      }
      copy.place.put(slab->stream, 0, place);
    }
  }
  void set_motion(const std::vector<RealFour<Real>>& v, const std::array<std::vector<Real>, 3>& u) {
    for (auto& slab : slabs) {
      auto& copy = slab->copies[places.at];
      const std::vector<uint32_t> ids = slab->ids(places);
      copy.v.put(slab->stream, 0, in_order_of(v, ids));
      for (size_t a = 0; displaced_ && a < 3; ++a) copy.u[a].put(slab->stream, 0, in_order_of(u[a], ids));
    }
  }
  // What ghosts are seen by is made anew from their owners' numbers.
  void refresh_ghosts() {
    if (!alone()) carry();
  }

  RealSpace space;
  Skin skin;      // m
  Frame frame{};  // what is no array of a slab's
  std::vector<std::unique_ptr<Slab>> slabs;
  RealPlaces places;
  uint64_t longest_list = 0;  // partners of one particle
  double listed_pairs = 0;    // entries per particle

 private:
  static constexpr double kNearSkin =
      0.06;  // of a near list, of what the rule reaches; and at most half the list's
  static constexpr uint64_t kMostBins = 1u << 26;
  // What is compared with a square of a length is rounded, and so is the length.
  static constexpr double kRounding = 1e-5;
  static constexpr double kSpare = 1.1;  // room of several slabs, beyond what they hold at a time

  static size_t index(int n) { return static_cast<size_t>(n); }
  Real square(double length) const { return of_si(length * length, 2 * exponents_.length); }
  const int64_t* x_of(Slab& slab) const { return slab.copies[places.at].x[index(cut_.axis)].data(); }
  template <class T>
  static std::vector<T> in_order_of(const std::vector<T>& by_id, const std::vector<uint32_t>& ids) {
    std::vector<T> values;
    for (const uint32_t id : ids) values.push_back(by_id[id]);
    return values;
  }

  // Into slabs with about equal numbers of particles, along the longest axis.
  void cut(const Body& body, int parts) {
    int axis = 0;
    for (int a = 1; a < 3; ++a)
      if (space.length[a] > space.length[axis]) axis = a;
    const size_t a = index(axis);
    cut_ = {axis,
            parts,
            space.wraps[a],
            space.ring[a],
            (space.low[axis] - space.origin[axis]) / space.unit[axis],
            space.unit[axis] / space.length[axis],
            {}};
    std::vector<double> at;
    for (const Vec3& x : body.x) at.push_back(cut_.along(space.whole(x[axis], a)));
    std::sort(at.begin(), at.end());
    for (int s = 0; s < parts; ++s)
      cut_.end[s] = s + 1 == parts ? 1 : at[at.size() * index(s + 1) / index(parts)];
  }

  void make_room(Slab& slab, size_t particles, size_t kept) const {
    if (particles <= slab.room()) return;
    slab.make_room(alone() ? particles : static_cast<size_t>(static_cast<double>(particles) * kSpare) + 1,
                   kept);
  }

  void put(Slab& slab, const std::vector<uint32_t>& ids, const Body& body,
           const std::vector<std::vector<double>>& fields) {
    typename Slab::Copy& copy = slab.copies[0];
    std::vector<RealFour<Real>> v(ids.size());
    std::vector<Place> place(ids.size());
    for (size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<int>(a);
      std::vector<int64_t> x(ids.size());
      for (size_t k = 0; k < ids.size(); ++k) {
        x[k] = space.whole(body.x[ids[k]][axis], a);
        v[k].at[a] = of_si(body.v[ids[k]][axis], exponents_.velocity);
        place[k].x[a] = space.ring[a].template place<Number>(x[k]);
        place[k].type = body.type[ids[k]];
      }
      copy.x[a].put(slab.stream, 0, x);
      if (!displaced_) continue;
      std::vector<Real> u;
      for (const uint32_t id : ids) u.push_back(of_si(body.u[id][axis], exponents_.length));
      copy.u[a].put(slab.stream, 0, u);
    }
    copy.v.put(slab.stream, 0, v), copy.place.put(slab.stream, 0, place);
    for (size_t f = 0; f < numbers_; ++f) {
      std::vector<Real> values;
      for (const uint32_t id : ids) values.push_back(of_si(fields[f][id], exponents_.field[f]));
      copy.fields[f].put(slab.stream, 0, values);
    }
    copy.type.put(slab.stream, 0, in_order_of(body.type, ids));
    copy.id.put(slab.stream, 0, ids);
  }

  // `place`: by id, of own particles and ghosts.
  void put_rows(Slab& slab, const std::vector<uint32_t>& ids, const std::vector<uint32_t>& place,
                const ProgramStart& start, const RealBondKinds& kinds, const std::vector<bool>& written) {
    uint64_t width = 0;
    for (const uint32_t id : ids) width = std::max(width, rows_.end(id) - rows_.begin(id));
    slab.width = static_cast<uint32_t>(width);
    const size_t own = ids.size(), slots = width * own;
    std::vector<uint32_t> entries(slots), kind(slots), counts(own);
    std::vector<std::vector<Real>> values(written.size());
    for (size_t n = 0; n < written.size(); ++n)
      if (written[n]) values[n].resize(slots);
    for (size_t k = 0; k < own; ++k) {
      const uint64_t first = rows_.begin(ids[k]), end = rows_.end(ids[k]);
      counts[k] = static_cast<uint32_t>(end - first);
      for (uint64_t b = first; b < end; ++b) {
        const size_t slot = (b - first) * own + k;
        entries[slot] = place[rows_.other[b]], kind[slot] = kinds.of[b];
        for (size_t n = 0; n < written.size(); ++n)
          if (written[n]) values[n][slot] = of_si(start.bond[n][b], exponents_.bond[n]);
      }
    }
    slab.entries.set(slab.stream, entries), slab.counts.set(slab.stream, counts);
    slab.bond_kind.set(slab.stream, kind);
    for (auto& copy : slab.bond_copies)
      for (size_t n = 0; n < written.size(); ++n) copy.emplace_back(slab.stream.device());
    for (size_t n = 0; n < written.size(); ++n) {
      slab.bond_copies[0][n].set(slab.stream, values[n]);
      slab.bond_copies[1][n].resize(values[n].size());
    }
  }

  // Sends the particles that `choose(slab, number)` picks, into the places behind those that slabs have.
  template <class Choose>
  void send(const Choose& choose) {
    list_sent(slabs, cut_.count, block_, choose);
    carry();
  }

  void carry() {
    place_sendings(slabs, [&](Slab& slab, size_t all, size_t kept) { make_room(slab, all, kept); });
    for (auto& slab : slabs)
      for (const RoundsSending& sending : slab->sendings) {
        Slab& to = *slabs[sending.to];
        Frame both = slab->frame_of(frame, places, places.at);
        const typename Slab::Copy& there = to.copies[places.at];
        for (size_t a = 0; a < 3; ++a) both.to_x[a] = there.x[a].data(), both.to_u[a] = there.u[a].data();
        both.to_place = there.place.data(), both.to_v = there.v.data();
        for (size_t f = 0; f < places.fields.size(); ++f)
          both.to_fields[f] = to.copies[places.fields[f]].fields[f].data();
        typename Slab::Copy& who = to.copies[places.who];
        for_each(slab->stream, 0, sending.count, block_,
                 RealCarry<Real, Number>{slab->sent.data() + sending.first, sending.at, both, who.type.data(),
                                         who.id.data(), static_cast<int>(places.fields.size())});
      }
    wait_for_all(slabs);
  }
  // As wide as the list to be made reaches.
  RealBins bins() {
    RealBins bins{};
    double size = program_.reach + skin.now();
    for (;; size *= 1.26) {
      uint64_t all = 1;
      for (size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<int>(a);
        bins.count[a] = std::max(1, static_cast<int>(space.length[axis] / size));
        all *= static_cast<uint64_t>(bins.count[a]);
        bins.wraps[a] = space.wraps[a], bins.ring[a] = space.ring[a];
        bins.low[a] = (space.low[axis] - space.origin[axis]) / space.unit[axis];
        bins.per_unit[a] = space.wraps[a] ? std::ldexp(bins.count[a], -64)
                                          : bins.count[a] * space.unit[axis] / space.length[axis];
      }
      if (all <= kMostBins) break;
    }
    const auto all = static_cast<size_t>(bins.count[0]) * index(bins.count[1]) * index(bins.count[2]);
    for (auto& slab : slabs)
      for (Array<uint32_t>* of : {&slab->bin_count, &slab->bin_first, &slab->bin_taken})
        if (of->size() < all) of->resize(all);
    return bins;
  }

  void list_pairs(const RealBins& bins) {
    const double reach = program_.reach + skin.now();
    uint64_t pairs = 0;
    for (auto& slab : slabs) {
      const typename Slab::Copy& here = slab->copies[places.at];
      RealMakeList<Real, Number> make{bins,
                                      {here.x[0].data(), here.x[1].data(), here.x[2].data()},
                                      {frame.unit[0], frame.unit[1], frame.unit[2]},
                                      square(reach * (1 + kRounding)),
                                      slab->bin_first.data(),
                                      slab->bin_count.data(),
                                      alone() ? nullptr : slab->order.data(),
                                      nullptr,
                                      slab->counts.data(),
                                      0,
                                      slab->own};
      if (slab->entries.size() < size_t{slab->width} * slab->own)
        slab->entries.resize(size_t{slab->width} * slab->own);
      longest_list = std::max<uint64_t>(longest_list, fill_list(slab->stream, slab->own, block_, make,
                                                                slab->most, slab->entries, slab->width));
      slab->near_entries.resize(slab->entries.size());
      for_each(slab->stream, 0, 1, 32, RoundsZero{slab->sum.data()});
      sum_each(slab->stream, 0, slab->own, block_, RoundsCount{slab->counts.data()}, slab->sum.data());
      pairs += slab->sum.host(slab->stream, 0, 1)[0];
    }
    listed_pairs = static_cast<double>(pairs) / std::max(count_, 1u);
    skin.listed(listed_pairs);
    // Both of a pair move.
    const auto allowed2 = [&](double skin) { return square(skin / 2 * (1 - 10 * kRounding)); };
    const double near_skin = std::min(kNearSkin * program_.reach, skin.now() / 2);
    frame.allowed2 = allowed2(skin.now()), frame.near_allowed2 = allowed2(near_skin);
    frame.near_reach2 = square((program_.reach + near_skin) * (1 + kRounding));
  }

  const RuleProgram& program_;
  const RealExponents exponents_;
  int block_;
  bool bonded_, displaced_;
  uint32_t count_, numbers_;
  RealCut cut_{};
  ReferenceBonds rows_{{0}, {}, {}};
  std::vector<uint32_t> owner_, place_;  // by id, of a rule with bonds of its own
};

}  // namespace cuboct::gpu
