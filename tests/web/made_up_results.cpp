// SPDX-License-Identifier: MIT
#include "tests/web/made_up_results.h"

#include <fmt/format.h>

#include <cmath>

#include "tests/support/dice.h"
#include "tests/support/hostile.h"

namespace cuboct::test {
namespace {

using study::Arithmetic, study::Outcome, study::Results, study::Settings, study::Status;

constexpr double kLimit = 2.1e-7;  // s, of a stable time step
constexpr uint32_t kParticles = 3456;

class Maker {
 public:
  // `force`: relative error of forces by rounding and tables; `rate`: particle-steps per second of one
  // thread.
  void point(const Settings& settings, double safety, double force, double rate, double bit_products,
             int index_bits) {
    Outcome o;
    o.settings = settings;
    o.dt = safety * kLimit;
    o.pitch = 6.425e-4;
    o.particles = kParticles;
    o.steps = static_cast<uint64_t>(std::llround(9e-5 / o.dt));
    const bool fixed = settings.arithmetic == Arithmetic::fixed;
    o.halo_bits = fixed ? 92 : 0;
    o.table_bits = fixed ? (1 << index_bits) * 2 * 20 : 0;
    o.cost = bit_products * kParticles * 9 / o.dt;
    o.errors.force_median = force * noise();
    o.errors.force_999 = 14 * force * noise();
    o.errors.force_max = 90 * force * noise();
    o.speed.particle_steps = rate * std::pow(settings.threads, 0.9) * noise();
    o.speed.simulated_seconds = o.speed.particle_steps / kParticles * o.dt;
    o.speed.spread = 0.01 * dice_.draw(1, 60) / 10;
    o.speed.repeats = 3;
    o.errors.momentum = fixed                                        ? 0
                        : settings.arithmetic == Arithmetic::float32 ? 3e-6 * noise()
                                                                     : 2e-15 * noise();
    if (safety >= 1) {
      o.status = Status::unstable;
      o.why = fmt::format("left the truth by {:.3g} pitches at the horizon", 40 * safety);
    } else {
      const double step = 0.02 * safety * safety, rest = 3 * force;
      o.errors.trajectory = (step + rest) * noise();
      o.errors.drift_per_step = (1e-9 * safety + 1e-3 * force) * noise();
      o.errors.drift_per_oscillation = o.errors.drift_per_step * 6 / safety;
      for (const double truth : {3.01e9, 5.6e7}) {
        const double relative = 0.7 * o.errors.trajectory * noise();
        o.errors.figures.push_back(relative);
        o.errors.values.push_back(truth * (1 + relative));
      }
    }
    results.outcomes.push_back(o);
  }

  void refused(const Settings& settings, const std::string& why) {
    Outcome o;
    o.settings = settings;
    o.status = Status::refused;
    o.why = why;
    results.outcomes.push_back(o);
  }

  Results results;

 private:
  double noise() { return 1 + 0.01 * dice_.draw(-8, 8); }
  Dice dice_{1};
};

Settings settings_of(const std::string& engine, Arithmetic arithmetic, double safety, int threads = 1) {
  Settings s;
  s.engine = engine;
  s.arithmetic = arithmetic;
  s.threads = threads;
  s.scene = {{"run.dt_safety", fmt::format("{}", safety)}};
  return s;
}

}  // namespace

study::Results made_up_results() {
  Maker maker;
  Results& results = maker.results;
  results.title = "Made-up numbers: a <small> coupon & its engines";
  results.scene = "ASTM D638 Type V coupon, 3456 particles, pulled along [110] for 0.09 ms";
  results.machine = "no machine: made-up numbers, 4 cores";
  results.figure_names = {"Young's modulus", "strength"};
  results.figure_units = {"Pa", "Pa"};
  results.truth.figures = {3.01e9, 5.6e7};
  results.truth.lyapunov_time = 2.2e-5;
  results.truth.floor = 3e-5;
  results.truth.largest_frequency = 9.5e6;
  results.truth.converged = true;
  results.truth.notes = {"strength changes by 2.3 % if every second sample is left out: more 'samples'",
                         "a <second> note & more"};
  for (int k = 0; k < 6; ++k) {
    study::Rung rung;
    rung.dt = 0.5 * kLimit / (1 << k);
    rung.cutoff = 9.09e-4;
    const double error = 4e-3 / (1 << (2 * k));
    rung.figures = {3.01e9 * (1 + 0.7 * error), 5.6e7 * (1 - 0.4 * error)};
    rung.trajectory = k == 0 ? study::kNotMeasured : 3 * error;
    rung.change = k == 0 ? study::kNotMeasured : 2.1 * error;
    results.truth.rungs.push_back(rung);
  }

  const double safeties[] = {0.03, 0.06, 0.12, 0.25, 0.5, 0.8, 1.1};
  for (const double safety : safeties)
    for (const int threads : {1, 4}) {
      for (const Integrator integrator : {Integrator::semi_implicit_euler, Integrator::velocity_verlet}) {
        Settings s = settings_of("reference", Arithmetic::float64, safety, threads);
        s.integrator = integrator;
        maker.point(s, safety, 2e-16, 1.1e6, 30000, 0);
        s.arithmetic = Arithmetic::float32;
        maker.point(s, safety, 3e-7, 1.5e6, 9000, 0);
      }
      // Presets of widths, each with its own table, and beside them one setting at a time.
      for (const int position : {14, 17, 20, 23}) {
        Settings s = settings_of("lattice", Arithmetic::fixed, safety, threads);
        const int difference = position - 4;
        s.arch = {{"widths.position_frac", std::to_string(position)},
                  {"widths.difference_frac", std::to_string(difference)}};
        maker.point(s, safety, 0.5 / std::exp2(difference) + 8e-5, 4.6e7 - 6e5 * position,
                    3.0 * difference * difference + 400, 9);
      }
    }
  for (const double safety : {0.06, 0.25, 0.5})
    for (const int degree : {1, 2})
      for (int index_bits = 5; index_bits <= 12; ++index_bits)
        for (const int strength : {14, 18, 22}) {
          Settings s = settings_of("lattice", Arithmetic::fixed, safety, 4);
          s.arch = {{"table.degree", std::to_string(degree)},
                    {"table.index_bits", std::to_string(index_bits)},
                    {"widths.strength_bits", std::to_string(strength)}};
          const double table = std::exp2(-(degree + 1) * index_bits) * 20;
          maker.point(s, safety, table + 12 / std::exp2(strength), 4.4e7 - 4e6 * degree,
                      700 + 30.0 * strength + 900 * degree, index_bits);
        }
  for (const int strength : {8, 9}) {
    Settings s = settings_of("lattice", Arithmetic::fixed, 0.25, 4);
    s.arch = {{"table.index_bits", "12"}, {"widths.strength_bits", std::to_string(strength)}};
    maker.refused(s, "the law's strongest pull takes 10 bits <strength_bits & sign>: more than it has");
  }
  for (const double safety : {0.12, 0.25, 0.5}) {
    maker.point(settings_of("gpu", Arithmetic::float32, safety), safety, 3e-7, 2.4e9, 9000, 0);
    results.outcomes.back().speed.machine = "a <made-up> GPU";
  }
  for (const double safety : {0.12, 0.25, 0.5, 1.1})
    maker.point(settings_of("fpga", Arithmetic::fixed, safety), safety, 1.2e-4, 9e8, 1100, 9);
  return std::move(results);
}

study::Results hostile_results() {
  const std::string evil = hostile_text();
  Results results = made_up_results();
  results.title = results.scene = results.machine = evil;
  results.figure_names = {evil, "strength"};
  results.figure_units = {evil, evil};
  results.truth.notes = {evil};
  std::vector<Outcome> outcomes;
  for (size_t n = 0; n < 8; ++n)
    // A name and a number's unit, each swept by itself: directories, quotes, a template of the charts'
    // library.
    for (const auto& [name, number] : {std::pair{evil, "1 "}, {"{b}" + evil, "1 "}, {evil, "2 "}}) {
      Outcome& o = outcomes.emplace_back(results.outcomes[n]);
      o.why = evil;
      o.settings.scene.push_back({"regions.../../" + evil + ".size", name});
      o.settings.arch.push_back({"\" onload=\"alert(3)", number + evil});
      if (n % 4 == 3) o.settings.engine = evil, o.speed.machine = evil;
    }
  results.outcomes = outcomes;
  return results;
}

}  // namespace cuboct::test
