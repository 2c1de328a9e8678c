// SPDX-License-Identifier: MIT
#include "study/sweep/measure_speed.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>

#include "emu/lattice/run.h"
#include "hw/engine/engine_kind.h"
#include "model/base/clock.h"
#include "model/base/error.h"
#include "model/base/interrupt.h"
#include "study/sweep/gpu_program.h"
#include "study/sweep/measure_run.h"

namespace cuboct::study {
namespace {

// An engine that begins again at will.
class Stepper {
 public:
  explicit Stepper(Case c) : c_(std::move(c)) {
    const bool fixed = c_.settings.arithmetic == Arithmetic::fixed;
    const bool half = c_.settings.integrator == Integrator::semi_implicit_euler;
    c_.scene.body = started_body(c_.scene, half);
    if (fixed) plan_.emplace(lattice_plan(c_.scene, c_.arch));
    begin();
  }

  void begin() {
    step_ = {};
    if (plan_) {
      emu::LatticeOptions options;
      options.threads = c_.settings.threads;
      if (plan_->program) {
        std::shared_ptr<IntegerEngine> engine =
            emu::integer_lattice(*plan_, begin_of(c_.scene, *plan_, nullptr), options);
        step_ = [engine] { engine->advance(1, nullptr); };
        return;
      }
      auto engine = std::make_shared<emu::LatticeEngine>(
          *plan_, 0, plan_->particles,
          [&](uint32_t id) {
            return fixed_particle(c_.scene.body, id, plan_->rule, plan_->lattice, plan_->origin);
          },
          options);
      step_ = [engine] { engine->step(); };
      return;
    }
    RealOptions options;
    options.integrator = c_.settings.integrator;
    options.precision =
        c_.settings.arithmetic == Arithmetic::float32 ? Precision::float32 : Precision::float64;
    options.threads = c_.settings.threads;
    auto reference = std::make_shared<Reference>(c_.scene.rule, c_.scene.body, c_.scene.periodic, options);
    step_ = [reference] { reference->step(); };
  }

  // Seconds that `count` steps take; the time to begin again is not counted.
  double timed(uint64_t count) {
    double seconds = 0;
    while (count > 0) {
      if (done_ == c_.scene.steps) begin(), done_ = 0;
      const uint64_t now = std::min(count, c_.scene.steps - done_);
      const auto start = Clock::now();
      for (uint64_t k = 0; k < now; ++k) {
        step_();
        if (interrupted()) throw Interrupted();
      }
      seconds += seconds_since(start);
      done_ += now;
      count -= now;
    }
    return seconds;
  }

 private:
  Case c_;
  std::optional<Plan> plan_;
  std::function<void()> step_;
  uint64_t done_ = 0;
};

// Steps per second, once per repeat.
std::vector<double> rates_here(Case c, const Study& study) {
  Stepper stepper(std::move(c));
  // Memory is touched and lists are made; then the length of a repeat is found, which warms up as well.
  stepper.timed(3);
  uint64_t steps = 1;
  for (double seconds = stepper.timed(steps); seconds < study.seconds / 4; seconds = stepper.timed(steps))
    steps = std::max(steps + 1, static_cast<uint64_t>(static_cast<double>(steps) *
                                                      std::min(10.0, 0.3 * study.seconds / seconds)));
  std::vector<double> rates;
  for (int repeat = 0; repeat < study.repeats; ++repeat) {
    uint64_t done = 0;
    double seconds = 0;
    while (seconds < study.seconds) seconds += stepper.timed(steps), done += steps;
    rates.push_back(static_cast<double>(done) / seconds);
  }
  return rates;
}

std::vector<double> rates_on_gpu(const Case& c, const Study& study) {
  GpuRequest request;
  request.dt = c.scene.rule.dt;
  request.scene_steps = request.steps = c.scene.steps;
  return gpu_rates(c, started_body(c.scene, true), request, study.repeats, study.seconds);
}

}  // namespace

Speed measure_speed(const Study& study, const Settings& settings) {
  Speed speed;
  try {
    Case c = resolve(study.base, settings);
    const uint64_t per_sample = study.grid.steps_per_sample(c.scene.rule.dt);
    c.scene.rule.dt = study.grid.fitted(c.scene.rule.dt);
    c.scene.steps = per_sample * study.grid.samples;
    const double dt = c.scene.rule.dt;
    const auto particles = static_cast<double>(c.scene.body.size());
    std::vector<double> rates = on_gpu(settings) ? rates_on_gpu(c, study) : rates_here(std::move(c), study);
    if (rates.empty()) return speed;
    std::ranges::sort(rates);
    const size_t n = rates.size();
    const double median = n % 2 ? rates[n / 2] : (rates[n / 2 - 1] + rates[n / 2]) / 2;
    speed.particle_steps = median * particles;
    speed.simulated_seconds = median * dt;
    speed.spread = (rates.back() - rates.front()) / median;
    speed.repeats = study.repeats;
  } catch (const Interrupted&) {
    throw;
  } catch (const std::runtime_error& error) {
    // InputError, RunError, not finite: the errors' row says it. A program that failed says nothing of a
    // point.
    if (on_gpu(settings) && !dynamic_cast<const InputError*>(&error)) throw;
  }
  return speed;
}

}  // namespace cuboct::study
