// SPDX-License-Identifier: MIT
#include "emu/gpu/rates.h"

#include <chrono>

#include "emu/gpu/run.h"
#include "emu/gpu/text_run.h"
#include "hw/engine/engine_kind.h"
#include "model/base/interrupt.h"

namespace cuboct::gpu {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_of(auto&& engine, uint64_t steps) {
  const auto begin = Clock::now();
  engine->advance(steps, nullptr);
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

}  // namespace

std::vector<double> step_rates(const Scene& scene, const Plan& plan, const RateRequest& request) {
  const bool fixed = request.arithmetic == Arithmetic::fixed;
  const GpuChoice choice{request.arithmetic, request.engine, {}};
  const State initial =
      fixed && plan.program == nullptr ? to_fixed(scene.body, plan.rule, plan.lattice, plan.origin) : State();
  const auto rounds = [&](const State& state) {
    return make_rounds_engine(plan, state, request.engine, rounds_compiler(request.interpret));
  };
  const auto seconds_of_a_run = [&] {
    if (scene.rule.rounds != nullptr && !fixed)
      return seconds_of(TextRun::make(scene, plan.rule.cell_edge, choice, nullptr), request.steps);
    if (plan.program != nullptr) return seconds_of(integer_run(scene, plan, nullptr, rounds), request.steps);
    if (fixed) return seconds_of(make_fixed_engine(scene, plan, initial, request.engine), request.steps);
    return seconds_of(make_real_engine(scene, scene.body, request.arithmetic, request.engine), request.steps);
  };
  std::vector<double> rates;
  for (int repeat = -1; repeat < request.repeats; ++repeat) {
    double seconds = 0, steps = 0;
    while (seconds < request.seconds) {
      seconds += seconds_of_a_run();
      if (interrupted()) return rates;
      steps += static_cast<double>(request.steps);
    }
    if (repeat >= 0) rates.push_back(steps / seconds);
  }
  return rates;
}

}  // namespace cuboct::gpu
