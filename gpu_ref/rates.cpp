// SPDX-License-Identifier: MIT
#include "gpu_ref/rates.h"

#include <chrono>

#include "model/base/interrupt.h"

namespace cuboct::gpu {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

std::vector<double> step_rates(const Scene& scene, const Plan& plan, const RateRequest& request) {
  const bool fixed = request.arithmetic == Arithmetic::fixed;
  const State initial = fixed ? to_fixed(scene.body, plan.rule, plan.lattice, plan.origin) : State();
  const auto seconds_of_a_run = [&] {
    const auto engine = fixed ? make_fixed_engine(scene, plan, initial, request.engine)
                              : make_real_engine(scene, scene.body, request.arithmetic, request.engine);
    const auto begin = Clock::now();
    engine->advance(request.steps);
    return std::chrono::duration<double>(Clock::now() - begin).count();
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
