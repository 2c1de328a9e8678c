// SPDX-License-Identifier: MIT
#include "study/sweep/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace cuboct::study {
namespace {

// Blue, vermilion and green of M. Okabe and K. Ito's set for all kinds of colour vision, then five that stay
// apart from them and dark enough for white paper.
constexpr std::array<const char*, 8> kColours{"#0072b2", "#d55e00", "#00875f", "#aa4499",
                                              "#332288", "#7a6a00", "#882255", "#555555"};

}  // namespace

const char* series_colour(size_t k) { return kColours[k % kColours.size()]; }

const char* label(Arithmetic arithmetic) {
  return arithmetic == Arithmetic::float64 ? "double" : arithmetic == Arithmetic::float32 ? "float" : "fixed";
}

const char* label(Status status) {
  return status == Status::done ? "done" : status == Status::unstable ? "unstable" : "refused";
}

const char* label(Integrator integrator) {
  return integrator == Integrator::semi_implicit_euler ? "semi-implicit Euler" : "velocity Verlet";
}

std::string describe(const Settings& settings) {
  std::string text = fmt::format("{}, {}", settings.engine, label(settings.arithmetic));
  if (settings.arithmetic != Arithmetic::fixed) text += fmt::format("; {}", label(settings.integrator));
  if (!on_gpu(settings))
    text += fmt::format("; {} thread{}", settings.threads, settings.threads == 1 ? "" : "s");
  for (const auto* changes : {&settings.scene, &settings.arch})
    for (const Change& change : *changes) text += fmt::format("; {} {}", change.key, change.value);
  return text;
}

std::vector<Series> series_of(const Results& results) {
  constexpr std::array kKnown{"lattice, fixed", "reference, double", "reference, float",
                              "gpu, fixed",     "gpu, double",       "gpu, float"};
  std::vector<Series> all;
  const auto add = [&](const std::string& name) {
    const size_t k = all.size();
    all.push_back({name, series_colour(k), static_cast<int>(k % kSymbols), {}});
    return all.end() - 1;
  };
  for (const char* name : kKnown) add(name);
  for (size_t n = 0; n < results.outcomes.size(); ++n) {
    const Outcome& outcome = results.outcomes[n];
    const std::string engine =
        fmt::format("{}, {}", outcome.settings.engine, label(outcome.settings.arithmetic));
    const std::string& machine = outcome.measured_on();
    const std::string name = machine.empty() ? engine : fmt::format("{} ({})", engine, machine);
    auto at = std::ranges::find(all, name, &Series::name);
    // The first machine of a GPU takes the look of its engine.
    const auto own = std::ranges::find(all, engine, &Series::name);
    if (at == all.end() && on_gpu(outcome.settings) && own != all.end()) own->name = name, at = own;
    if (at == all.end()) at = add(name);
    at->points.push_back(n);
  }
  std::erase_if(all, [](const Series& s) { return s.points.empty(); });
  return all;
}

}  // namespace cuboct::study
