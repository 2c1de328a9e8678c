// SPDX-License-Identifier: MIT
#include "study/series.h"

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
  text += fmt::format("; {} thread{}", settings.threads, settings.threads == 1 ? "" : "s");
  for (const auto* changes : {&settings.scene, &settings.arch})
    for (const Change& change : *changes) text += fmt::format("; {} {}", change.key, change.value);
  return text;
}

std::vector<Series> series_of(const Results& results) {
  std::vector<Series> all{{"lattice, fixed", kColours[0], 0, {}},
                          {"reference, double", kColours[1], 1, {}},
                          {"reference, float", kColours[2], 2, {}}};
  for (size_t n = 0; n < results.outcomes.size(); ++n) {
    const Settings& settings = results.outcomes[n].settings;
    const std::string name = fmt::format("{}, {}", settings.engine, label(settings.arithmetic));
    auto at = std::find_if(all.begin(), all.end(), [&](const Series& s) { return s.name == name; });
    if (at == all.end()) {
      const size_t k = all.size();
      all.push_back({name, kColours[k % kColours.size()], static_cast<int>(k % kSymbols), {}});
      at = all.end() - 1;
    }
    at->points.push_back(n);
  }
  std::erase_if(all, [](const Series& s) { return s.points.empty(); });
  return all;
}

}  // namespace cuboct::study
