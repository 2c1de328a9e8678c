// SPDX-License-Identifier: MIT
#include "study/learn/stretch_fit.h"

#include <algorithm>

#include "model/base/interrupt.h"
#include "study/sweep/interrupted.h"

namespace cuboct::learn {
namespace {

constexpr int kScan = 10;  // steps from the lowest to the highest stretch
constexpr int kHalvings = 5;

}  // namespace

StretchFit fit_stretch(const CrackData& data, const Kernel& kernel, double slit, double interval,
                       const StretchInput& input, const PredictionInput& prediction) {
  const std::vector<Frame> frames(data.frames.begin(), data.frames.begin() + input.frames[1] + 1);
  const CrackData training{data.grid, data.density, data.velocity, frames};
  const std::vector<size_t> points = inside(data.grid, prediction.collar);
  StretchFit fit;
  const auto at = [&](double stretch) {
    if (interrupted()) throw study::Interrupted();
    const Breaking breaking{stretch, input.width};
    std::vector<CrackState> predicted = predict(training, kernel, breaking, slit, interval, prediction),
                            atoms = seen(training, kernel, breaking, slit);
    // errors_of() leaves out the first.
    for (std::vector<CrackState>* states : {&predicted, &atoms})
      states->erase(states->begin(), states->begin() + input.frames[0] - 1);
    fit.tried.push_back({stretch, errors_of(predicted, atoms, points),
                         stretch_residual(training, kernel, breaking, slit, input.frames, points)});
  };
  const auto best = [&] {
    return std::ranges::min_element(fit.tried, {},
                                    [](const StretchPoint& p) { return p.errors.displacement; })
        ->stretch;
  };
  double step = (input.high - input.low) / kScan;
  for (int k = 0; k <= kScan; ++k) at(input.low + k * step);
  for (int k = 0; k < kHalvings; ++k) {
    step /= 2;
    const double middle = best();
    for (const double side : {-step, step})
      if (middle + side > input.low && middle + side < input.high) at(middle + side);
  }
  fit.stretch = best();
  std::ranges::sort(fit.tried, {}, &StretchPoint::stretch);
  return fit;
}

}  // namespace cuboct::learn
