// SPDX-License-Identifier: MIT
#include "emu/gpu/bench/bench.h"

#include <algorithm>
#include <cmath>

#include "model/base/interrupt.h"

namespace cuboct::gpu {
namespace {

Arithmetic arithmetic_of(const std::string& word) {
  return word == "fixed" ? Arithmetic::fixed : word == "float" ? Arithmetic::float32 : Arithmetic::float64;
}

double timed(Engine& engine, uint64_t steps, MeterClock& clock) {
  const double begin = clock.now();
  engine.advance(steps);
  return clock.now() - begin;
}

// Steps that take `seconds`: as many as took at least a quarter of it, scaled.
uint64_t steps_for(Engine& engine, double seconds, MeterClock& clock) {
  timed(engine, 1, clock);  // the first list, memory that is touched
  uint64_t steps = 1;
  while (!interrupted()) {
    const double took = timed(engine, steps, clock);
    const auto scaled = [&](double to) {
      return static_cast<uint64_t>(std::ceil(static_cast<double>(steps) * to / std::max(took, 1e-9)));
    };
    if (took >= 0.25 * seconds) return std::max<uint64_t>(1, scaled(1.1 * seconds));
    steps = std::clamp(scaled(0.4 * seconds), 2 * steps, 10 * steps);
  }
  return steps;
}

}  // namespace

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

double RowResult::median_seconds() const { return median(seconds); }

double RowResult::rate() const {
  return static_cast<double>(particles) * static_cast<double>(steps) / median_seconds();
}

double RowResult::mean_rate() const {
  double sum = 0;
  for (const double s : seconds) sum += s;
  return static_cast<double>(particles) * static_cast<double>(steps) * static_cast<double>(seconds.size()) /
         sum;
}

double RowResult::spread() const {
  if (seconds.size() < 2) return 0;
  double sum = 0, squares = 0;
  for (const double s : seconds) sum += 1 / s;
  const auto n = static_cast<double>(seconds.size());
  const double mean = sum / n;
  for (const double s : seconds) squares += (1 / s - mean) * (1 / s - mean);
  return std::sqrt(squares / (n - 1)) / mean;
}

BenchBody::BenchBody(const BenchScene& scene)
    : of_(scene), scene_(parse_scene(scene.text(), "the benchmark's scene")) {}

const Setup& BenchBody::setup() {
  if (!setup_)
    setup_ = make_setup(scene_, of_.arch().empty() ? Arch{} : parse_arch(of_.arch(), "its machine"));
  return *setup_;
}

std::optional<RowResult> measure_row(const BenchRow& row, BenchBody& body, const BenchOptions& options,
                                     const BenchMachine& machine, PowerMeter& power) {
  const Arithmetic arithmetic = arithmetic_of(row.arithmetic);
  const Scene& scene = body.scene();
  const std::unique_ptr<Engine> engine =
      arithmetic == Arithmetic::fixed
          ? machine.fixed(scene, body.setup().plan, body.setup().initial, options.engine)
          : machine.real(scene, scene.body, arithmetic, options.engine);
  RowResult result;
  result.particles = scene.body.size();
  EnergyMeter meter(power, options.times);
  if (options.energy) meter.idle();
  engine->advance(options.settle.value_or(row.scene.settle_steps()));
  result.steps = steps_for(*engine, options.seconds, power.clock());
  while (!interrupted()) {
    result.seconds.clear();
    result.before = engine->counters();
    while (static_cast<int>(result.seconds.size()) < options.repeats && !interrupted()) {
      result.seconds.push_back(timed(*engine, result.steps, power.clock()));
      meter.did(result.steps);
    }
    if (interrupted()) return std::nullopt;
    result.after = engine->counters();
    const double shortest = *std::min_element(result.seconds.begin(), result.seconds.end());
    if (shortest >= options.seconds) break;
    // Faster than at first: clocks went up, or lists last longer.
    result.steps = static_cast<uint64_t>(
        std::ceil(1.1 * static_cast<double>(result.steps) * options.seconds / shortest));
  }
  if (options.energy) {
    while (power.works() && !meter.enough() && !interrupted()) {
      engine->advance(result.steps);
      meter.did(result.steps);
    }
    result.energy = meter.finish(&result.no_energy);
  } else {
    result.no_energy = "not asked for";
  }
  if (interrupted()) return std::nullopt;
  return result;
}

}  // namespace cuboct::gpu
