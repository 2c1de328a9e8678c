// SPDX-License-Identifier: MIT
#include "study/bench/bench_tersoff.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <random>

#include "model/atoms/bond_order/atom_cell.h"
#include "model/atoms/bond_order/atom_motion.h"
#include "model/base/parallel.h"
#include "study/bench/timed.h"

namespace cuboct {
namespace {

AtomCell shaken(AtomCell cell, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> move(-0.01, 0.01);  // angstrom
  for (Vec3& x : cell.x) x += Vec3(move(random), move(random), move(random));
  return cell;
}

void report(benchmark::State& state, size_t atoms, uint64_t steps, const std::string& how) {
  state.counters["particle_steps"] =
      benchmark::Counter(static_cast<double>(atoms * steps), benchmark::Counter::kIsRate);
  state.SetLabel(fmt::format("{} atoms, {}, {}, {} steps per repeat", atoms, how, bond_simd(), steps));
}

struct Motion {
  explicit Motion(double seconds) : timed(seconds) {}
  std::unique_ptr<AtomMotion> motion;
  Timed timed;
};

// Velocity Verlet at constant energy; mass in g/mol.
void run_motion(benchmark::State& state, Motion& bed, const AtomCell& cell, const char* set, double mass,
                int threads) {
  constexpr double kGram = 1.036426966e-4;  // eV ps^2/angstrom^2 of a g/mol
  if (!bed.motion)
    bed.motion =
        std::make_unique<AtomMotion>(tersoff_set(set), AtomSystem{cell.box, cell.x, {}, {}, {mass * kGram}},
                                     AtomMotionOptions{.dt = 1e-3, .skin = 0.3, .threads = threads});
  bed.timed.run(state, [&] { bed.motion->step(); });
  report(state, cell.x.size(), bed.timed.steps(), fmt::format("{} threads", threads));
}

// Forces of many samples of one crystal, each with atoms and a list of its own, shared out to threads.
class Samples {
 public:
  Samples(size_t count, double seconds, int threads) : timed_(seconds), threads_(threads) {
    const Tersoff tersoff = tersoff_set("si_1989");
    for (size_t k = 0; k < count; ++k) {
      cells_.push_back(shaken(diamond_block(5.432115, 2, 2, 2), k + 1));
      lists_.emplace_back(tersoff.cutoff(), 0.5, bond_lanes());
    }
    for (int k = 0; k < threads; ++k) forces_.emplace_back(tersoff);
    f_.resize(count, std::vector<Vec3>(cells_[0].x.size()));
  }
  void run(benchmark::State& state) {
    timed_.run(state, [&] {
      for_each_part(cells_.size(), threads_, [&](size_t k, int member) {
        lists_[k].update(cells_[k].box, cells_[k].x);
        forces_[static_cast<size_t>(member)].evaluate(lists_[k], cells_[k].box, cells_[k].x, f_[k]);
      });
    });
    report(state, cells_.size() * cells_[0].x.size(), timed_.steps(),
           fmt::format("{} samples of {}, {} threads", cells_.size(), cells_[0].x.size(), threads_));
  }

 private:
  Timed timed_;
  int threads_;
  std::vector<AtomCell> cells_;
  std::vector<BondList> lists_;
  std::vector<TersoffForces> forces_;
  std::vector<std::vector<Vec3>> f_;
};

}  // namespace

std::vector<Bench> tersoff_benches(double seconds, int all) {
  std::vector<Bench> list;
  for (const bool cores : {false, true}) {
    const int threads = cores ? all : 1;
    const std::string tail = cores ? "all_cores" : "1_thread",
                      how = cores ? "a thread per core" : "one thread";
    const auto sheet = std::make_shared<Motion>(seconds);
    list.push_back({"tersoff.graphene_52k." + tail, "molecular dynamics of graphene, 52200 atoms, " + how,
                    [=](benchmark::State& s) {
                      run_motion(s, *sheet, shaken(graphene_sheet(1.460601, 3.35, 150, 87), 1), "c_1989",
                                 12.011, threads);
                    }});
    const auto block = std::make_shared<Motion>(seconds);
    list.push_back({"tersoff.silicon_33k." + tail, "molecular dynamics of silicon, 32768 atoms, " + how,
                    [=](benchmark::State& s) {
                      run_motion(s, *block, shaken(diamond_block(5.432115, 16, 16, 16), 1), "si_1989",
                                 28.0855, threads);
                    }});
    const auto samples = std::make_shared<std::optional<Samples>>();
    list.push_back({"tersoff.samples_64." + tail, "forces of 1000 samples of silicon, 64 atoms each, " + how,
                    [=](benchmark::State& s) {
                      if (!*samples) samples->emplace(1000, seconds, threads);
                      (*samples)->run(s);
                    }});
  }
  return list;
}

}  // namespace cuboct
