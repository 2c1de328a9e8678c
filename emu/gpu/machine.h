// SPDX-License-Identifier: MIT
// The engine of both arithmetics on one or more devices.
//
// Space is cut into slabs, one per device or more. Particles are stored by cell; a pair list with a skin
// holds each one's partners until some particle has moved half the skin, and a near list those of them that
// are near now (step.h). One kernel does a step of a particle, from one of two copies of the state to the
// other. Steps go in batches without the host: kernels note up to which step all was good, and those beyond
// it do nothing. A slab's borders have a stream of their own: they are written into the neighbours' memory as
// well, while the inner particles are computed. A slab that has to stop tells the others, which may then be
// one step ahead: the state that all have reached is still in one of their two copies.
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "emu/gpu/cells.h"
#include "emu/gpu/device/device.h"
#include "emu/gpu/device/storage.h"
#include "emu/gpu/engine.h"
#include "emu/gpu/messages.h"
#include "emu/gpu/skin.h"
#include "emu/gpu/step.h"

namespace cuboct::gpu {

// Bytes of device memory for a particle, about: what a card must hold is known before it is asked for.
template <class Policy>
constexpr double bytes_per_particle(bool pd, int residue_bits, double listed) {
  const double state = sizeof(typename Policy::Position) + sizeof(typename Policy::Velocity) +
                       4 * static_cast<double>(Residues<Policy::kFixed>::words_for(residue_bits)) +
                       (pd ? sizeof(typename Policy::Extra) : 0);
  const double order = 2 * (sizeof(CellAt) + 4) + 8 + (Policy::kFixed ? 8 : 0) + 4;
  const double anchored = Policy::kFixed ? 0 : sizeof(typename Policy::Position);
  return 2 * state + anchored + order + 8 * listed + 8;
}

// A state on the host, in the numbers of the devices; in no order.
template <class Policy>
struct HostParticles {
  std::vector<typename Policy::Position> x;
  std::vector<typename Policy::Velocity> v;
  std::vector<typename Policy::Extra> u;  // empty unless the rule has PD types
  std::vector<Three<uint32_t>> residue;   // empty in real engines
  std::vector<CellAt> cell;
  std::vector<uint32_t> id;
  size_t size() const { return x.size(); }
};

// What a real engine's bits depend on besides its state: the order of sums is that of the last list, which
// depends on the positions of its making, and the time of the next one on those and on the skin.
template <class Policy>
struct Kept {
  HostParticles<Policy> state;
  std::vector<typename Policy::Position> listed;  // positions when the list was made
  Skin::Memory skin;
  uint64_t age = 0;
};

template <class Policy>
class Machine {
 public:
  using Rule = typename Policy::Rule;
  using View = typename Policy::View;

  struct Setup {
    Geometry geometry;
    double radius = 1;           // of the interaction, in the unit of the geometry's edges
    double rounding = 0;         // that the rule's own differences may bring pairs nearer
    double largest_skin = 0;     // what the reach of the cells leaves room for
    uint32_t capacity = kNever;  // of a cell (fixed)
    bool pd = false, damped = false;
    int residue_bits = 0;  // of a position (fixed)
    // Of energies: see ReadEnergies.
    std::array<double, 3> edge{}, origin{};
    double unit = 1;
  };
  // `make_rule(stream)` puts the rule on a stream's device.
  template <class MakeRule>
  Machine(const Options& options, const Setup& setup, const EnergyTables& energies,
          const HostParticles<Policy>& state, const MakeRule& make_rule);

  // One batch of at most `steps`; how many were done, and why it ended. A hash for each where `hashes`.
  enum class End : uint8_t { full, near_list, list, doubt, crowded };
  struct Outcome {
    uint64_t done = 0;
    End end = End::full;
  };
  Outcome run(uint64_t steps, std::vector<uint64_t>* hashes);

  // New lists; particles are stored anew.
  void make_lists();
  // Steps since then.
  uint64_t age() const { return age_; }

  void upload(const HostParticles<Policy>& state);
  HostParticles<Policy> download();
  // Of real engines.
  Kept<Policy> keep();
  // False where the skin cannot be one of this machine's.
  bool restore(const Kept<Policy>& kept);

  uint64_t hash();
  // A new list comes first where the old one no longer serves.
  void probe(const std::vector<uint32_t>& ids);
  std::vector<Found<Policy>> read_probed();
  Sums read_energies();

  Counters counters;

 private:
  struct Slab {
    Slab(int device, int number, uint64_t* account)
        : device(device), number(number), stream(device), edge(device, true) {
      for (auto* a : {&x[0], &x[1], &listed}) *a = Array<typename Policy::Position>(device, account);
      for (auto* a : {&v[0], &v[1]}) *a = Array<typename Policy::Velocity>(device, account);
      for (auto* a : {&u[0], &u[1]}) *a = Array<typename Policy::Extra>(device, account);
      for (auto* a :
           {&residue[0], &residue[1], &id, &spare_id, &rank_of, &order, &entered, &rank, &count, &first,
            &taken, &occupancy, &entries, &counts, &near_entries, &near_counts, &notes, &slot, &found_here})
        *a = Array<uint32_t>(device, account);
      for (auto* a : {&cell, &spare_cell}) *a = Array<CellAt>(device, account);
      for (auto* a : {&leaving[0], &leaving[1], &arriving}) *a = Array<Traveller<Policy>>(device, account);
      control = Array<Control>(device, account);
      hashes = Array<uint64_t>(device, account);
      found = Array<Found<Policy>>(device, account);
      sums = Array<Sums>(device, account);
      for (auto* a : {&energy_node, &energy_strength, &energy_weight, &energy_free, &energy_mass})
        *a = Array<double>(device, account);
    }
    int device, number;
    Stream stream;
    Stream edge;                                    // for the borders
    Event begun[2], border_done[2], inner_done[2];  // of a step, by its number's last bit
    std::unique_ptr<Rule> rule;
    Array<typename Policy::Position> x[2], listed;  // listed: when the list was made (real)
    Array<typename Policy::Velocity> v[2];
    Array<typename Policy::Extra> u[2];
    Array<uint32_t> residue[2];
    Array<uint32_t> id, spare_id, rank_of, order, entered;
    Array<CellAt> cell, spare_cell;
    Array<uint32_t> rank, count, first, taken, occupancy;  // of cells
    Array<uint32_t> entries, counts, near_entries, near_counts;
    Array<uint32_t> notes;  // two counts of leavers, lost ones, longest list
    Array<Traveller<Policy>> leaving[2], arriving;
    Array<Control> control;
    Meeting meeting{device};
    Array<uint64_t> hashes;
    Array<uint32_t> slot, found_here;
    Array<Found<Policy>> found;
    Array<Sums> sums;
    Array<double> energy_node, energy_strength, energy_weight, energy_free, energy_mass;
    EnergyRule energy;
    Graph graph[2];  // kGraphSteps steps from either copy
    // Places: own [0, own), of them the lower border [0, low_end) and the upper one [high_begin, own); then
    // the copies up to `lower_copy_end` and `all`.
    uint32_t own = 0, low_end = 0, high_begin = 0, lower_copy_end = 0, all = 0;
    size_t room = 0;    // of the arrays
    size_t stride = 0;  // of the list
    uint32_t width = 24;
  };

  // Particles that a slab has room for, beyond what it holds at a time.
  static constexpr double kSpare = 1.1;
  static constexpr uint32_t kLongest = 512;  // steps of a batch
  // Share of the interaction's radius. Thinner ones hold fewer pairs and are made more often.
  static constexpr double kNearSkin = 0.06;
  static constexpr uint32_t kNearLongest = 16;  // steps of a near list
  static constexpr uint32_t kGraphSteps = 16;   // even: it ends at the copy where it began

  bool alone() const { return slabs_.size() == 1; }
  const SlabCells& cells_of(const Slab& slab) const { return cells_.slabs[static_cast<size_t>(slab.number)]; }
  Slab* beside(const Slab& slab, int side) {
    const int other = side == 0 ? cells_of(slab).lower : cells_of(slab).upper;
    return other < 0 ? nullptr : slabs_[static_cast<size_t>(other)].get();
  }
  GridView grid(const Slab& slab) const;
  ParticlesView<Policy> at(Slab& slab, int copy) const {
    return {slab.x[copy].data(),
            slab.v[copy].data(),
            setup_.pd ? slab.u[copy].data() : nullptr,
            {slab.residue[copy].data(), setup_.residue_bits}};
  }
  size_t residue_words() const { return Residues<Policy::kFixed>::words_for(setup_.residue_bits); }
  // How far a particle may move before a new list is due: what an anchor does not tell is taken off.
  double farthest() const {
    const auto& edge = setup_.geometry.edge;
    return std::max(
        skin_.now() / 2 - static_cast<double>(kAnchorError) * std::max({edge[0], edge[1], edge[2]}), 0.0);
  }
  // Of near anchors: a particle that has just left its list's bounds is still within.
  double range() const { return 1.02 * skin_.now() / 2 + 1e-3 * setup_.radius; }
  double near_skin() const { return std::min(kNearSkin * setup_.radius, skin_.now()); }
  // How far two may have moved together since their near list was made.
  double near_allowed() const {
    return std::max(near_skin() - 2 * static_cast<double>(kNearAnchorError) * range(), 0.0);
  }
  // What a list of that skin reaches.
  float reach_of(double skin) const {
    return static_cast<float>((setup_.radius + setup_.rounding + skin) * (1 + 1e-6));
  }
  List list(const Slab& slab) const {
    return {slab.entries.data(), slab.counts.data(), slab.stride, slab.width};
  }

  double entries_expected(const std::vector<CellAt>& cells) const;
  void make_room(Slab& slab, size_t particles);
  void resettle();
  void sort();
  void mirror();
  template <class Use>
  void each_copy(const Slab& s, const Use& use);
  void mirror_residues();
  void list_pairs();
  void list_pairs(Slab& slab);
  void scatter(const HostParticles<Policy>& state);
  void settle(const HostParticles<Policy>& state);
  void list_here();
  void place(const Kept<Policy>& kept);
  template <class Step>
  Step filled(Slab& slab);
  void step(uint32_t number, bool hash, bool makes_near);
  bool run_together(uint32_t steps, bool hash);
  bool next_makes_near();
  void plan_near_lists(const Outcome& outcome);
  void start_batch(uint32_t steps, bool hash);
  void wait_for_all() {
    for (auto& slab : slabs_) {
      slab->edge.synchronize();
      slab->stream.synchronize();
    }
  }

  Options options_;
  Setup setup_;
  Cells cells_;
  std::vector<std::unique_ptr<Slab>> slabs_;
  uint64_t particles_;
  Skin skin_;
  int at_ = 0;  // which copy holds the state
  uint64_t age_ = 0;
  uint32_t batch_ = 16;
  // Near lists are made every so many steps, a power of two; in the step before the next one they are so old.
  uint32_t near_every_ = 8, near_age_ = kNever;
  uint32_t near_good_ = 0,
           near_patience_ = 16;  // near lists that served to their end; after so many a longer life is tried
  size_t probed_ = 0;
};

}  // namespace cuboct::gpu

#include "emu/gpu/machine_lists.h"
#include "emu/gpu/machine_read.h"
#include "emu/gpu/machine_steps.h"
