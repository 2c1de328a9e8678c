// SPDX-License-Identifier: MIT
#include "emu/gpu/rates.h"

#include <chrono>

#include "emu/gpu/run.h"
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
  const GpuChoice choice{request.arithmetic, request.engine, {}, request.interpret};
  const EngineKind kind = gpu_kind(scene, plan, choice);
  std::vector<double> rates;
  for (int repeat = -1; repeat < request.repeats; ++repeat) {
    double seconds = 0, steps = 0;
    while (seconds < request.seconds) {
      seconds += seconds_of(kind.make(nullptr, false), request.steps);
      if (interrupted()) return rates;
      steps += static_cast<double>(request.steps);
    }
    if (repeat >= 0) rates.push_back(steps / seconds);
  }
  return rates;
}

}  // namespace cuboct::gpu
