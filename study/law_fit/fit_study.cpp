// SPDX-License-Identifier: MIT
#include "study/law_fit/fit_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/base/error.h"
#include "model/base/hash.h"
#include "model/base/spelling.h"
#include "model/config/file_kind.h"
#include "study/law_fit/cheap_case.h"
#include "study/sweep/changed_base.h"

namespace cuboct::fit {
namespace {

// A pull that lasts to the reach would draw further neighbours in, as soon as a specimen narrows: Q4 only
// pushes.
constexpr std::array<Bounds, kParameters> kBounds{{{0.5, 2},     // stiffness
                                                   {0.15, 0.8},  // push_top
                                                   {0.1, 0.9},   // push_1
                                                   {0.1, 0.9},   // push_2
                                                   {0.3, 1.5},   // push_2_force
                                                   {0.02, 0.3},  // push_3
                                                   {0.2, 2},     // pull_1
                                                   {0.02, 0.8},  // pull_2
                                                   {0.02, 0.8},  // pull_3
                                                   {0.02, 0.8},  // pull_4
                                                   {-0.8, 2},    // pull_2_force
                                                   {-0.8, 2},    // pull_3_force
                                                   {-0.8, 0}}};  // pull_4_force
// Beyond these no law is drawn, or none that restores.
Range limits_of(size_t parameter) {
  switch (parameter) {
    case stiffness:
      return {.low = 0.01, .high = 100};
    case push_1:
    case push_2:
    case push_3:
    case pull_2:
    case pull_3:
    case pull_4:
      return {.low = 0.001, .high = 0.99};
    case pull_1:
      return {.low = 0.01, .high = 100};
    default:
      return {.low = -100, .high = 100};
  }
}

const Probe& probe_of(const ConfigTable& root, const Scene& scene, FitStudy& study) {
  std::vector<std::string> curves;
  for (const Probe& probe : scene.probes)
    if (probe.kind == Probe::Kind::stress_strain) curves.push_back(probe.name + ".stress");
  if (curves.empty()) root.at("scene").fail("the scene has no probe of the kind 'stress_strain'");
  study.test.curve = root.string_or("curve", curves.front());
  const auto at = std::ranges::find(curves, study.test.curve);
  if (at == curves.end()) {
    const std::string near = did_you_mean(study.test.curve, curves);
    root.at("curve").fail(fmt::format("the scene has no curve '{}' of stress", study.test.curve),
                          near.empty() ? "known: " + list_of(curves) : near);
  }
  const std::string name = at->substr(0, at->rfind('.'));
  study.test.against = name + ".strain";
  return *std::ranges::find(scene.probes, name, &Probe::name);
}

void check_scene(const ConfigTable& root, const Scene& scene, FitStudy& study) {
  const ConfigValue where = root.at("scene");
  if (scene.pitch == 0) where.fail("a fit needs a scene with a [packing]: its law vanishes at the pitch");
  if (scene.grains > 0) where.fail("a fit needs a packing of one crystal: its cheap case has one");
  if (scene.steps == 0) where.fail("the scene has no steps");
  const auto engine = root.find("engine");
  const std::vector<std::string> engines{"lattice", "reference"};
  study.test.engine = engine          ? engines[engine->choice("engine", engines)]
                      : scene.loading ? "reference"
                                      : "lattice";
  if (scene.loading && study.test.engine != "reference")
    engine->fail("the lattice engine knows motion alone, but the scene's loading is static",
                 "leave 'engine' out, or say \"reference\"");
}

void read_bounds(const ConfigTable& root, FitStudy& study) {
  study.bounds = kBounds;
  if (const auto table = root.table_at("bounds")) {
    for (size_t k = 0; k < kParameters; ++k) {
      const auto value = table->find(parameter_names()[k]);
      if (!value) continue;
      const std::vector<double> limits = value->numbers(quantity::number, limits_of(k));
      if (limits.size() != 2 || limits[0] > limits[1])
        value->fail(fmt::format("'{}' takes [lowest, highest]", value->key()));
      study.bounds[k] = {limits[0], limits[1]};
    }
    table->done();
  }
  for (size_t k = 0; k < kParameters; ++k)
    study.start[k] = std::clamp(study.start[k], study.bounds[k].low, study.bounds[k].high);
}

void read_search(const ConfigTable& root, Search& search) {
  const auto table = root.table_at("search");
  if (!table) return;
  const auto whole = [&](const char* key, int64_t low, unsigned otherwise) {
    return static_cast<unsigned>(table->integer_or(key, low, 1'000'000, otherwise));
  };
  search.samples = whole("samples", 5, search.samples);
  search.patience = whole("patience", 1, search.patience);
  search.generations = whole("generations", 0, search.generations);
  search.seed = whole("seed", 0, search.seed);
  search.threshold = table->number_or("threshold", quantity::number, search.threshold, {.low = 0, .high = 1});
  search.goal = table->number_or("goal", quantity::number, search.goal, {.low = 0, .high = 1});
  search.spread =
      table->number_or("spread", quantity::number, search.spread, {.low = 1e-6, .high = 1, .low_open = true});
  table->done();
}

// A stiff law has short steps. The one at the start is as stiff as those that are tried, but for a factor.
void check_work(const ConfigTable& root, const FitStudy& study) {
  constexpr double kMostWork = 1e11;  // particle-steps of one run: hours, and a fit makes hundreds of runs
  Scene scene;
  try {
    scene = parse_scene(scene_with(study.test.base, points_of(draw(study.start, study.scale))),
                        study.test.base.scene_path);
  } catch (const InputError&) {
    return;  // no run takes such a law
  }
  const double work = static_cast<double>(scene.steps) * static_cast<double>(scene.body.size());
  if (scene.loading || work <= kMostWork) return;
  root.at("target").fail(
      fmt::format("a run of the scene with a law for this curve, whose modulus is {:.3g} Pa, takes {:.3g} "
                  "particle-steps: at most {:.3g} are made",
                  study.target.modulus, work, kMostWork),
      "the right unit of the stresses, a shorter 'duration' of the scene, or static loading");
}

uint64_t hash_of(const FitStudy& study) {
  std::string text = fmt::format(
      "{}\n{}\n{} {} {} {} {} {}", study.test.base.scene_text, study.test.base.arch_text, study.test.engine,
      study.test.curve, study.scale.reach, study.search.samples, study.search.seed, study.search.spread);
  for (const Bounds& bounds : study.bounds) text += fmt::format(" {} {}", bounds.low, bounds.high);
  for (const double strain : study.target.strain) text += fmt::format(" {}", strain);
  for (const double stress : study.target.stress) text += fmt::format(" {}", stress);
  Hash hash;
  for (const char c : text) hash.add(c);
  return hash.value();
}

// 0, 1, 0, ... at 0, 1, 2, ..., straight in between.
double mirrored(double x) { return std::abs(std::remainder(x, 2.0)); }

}  // namespace

namespace {

FitStudy fit_of(const ConfigTable& root, const std::string& path) {
  FitStudy study;
  study.path = path;
  study.title = root.string_or("title", "");
  study.test.base = study::read_changed_base(root, path);
  const Scene scene = parse_scene(study.test.base.scene_text, study.test.base.scene_path);
  check_scene(root, scene, study);
  const Probe& probe = probe_of(root, scene, study);
  study.target = read_target(root.at("target").table());
  study.test.last_strain = study.target.strain.back();
  const double reach = root.number_or("reach", quantity::number, 3, {.low = 1.05, .high = 10});
  study.scale = cheap_scale(study.target, scene, probe.axis, reach);
  study.axes = pull_axes(scene, probe.axis);
  study.start = cheap_start(study.target, study.scale);
  read_bounds(root, study);
  read_search(root, study.search);
  if (const auto target = root.table_at("target")) target->done();
  root.done();
  check_work(root, study);
  study.hash = hash_of(study);
  return study;
}

}  // namespace

FitStudy read_fit(const std::string& path) {
  return read_kind(FileKind::curve_fit, path, [&](const ConfigTable& root) { return fit_of(root, path); });
}

Parameters parameters_of(const FitStudy& study, const std::vector<double>& sample) {
  Parameters p{};
  for (size_t k = 0; k < kParameters; ++k) {
    const auto [low, high] = study.bounds[k];
    const double share = mirrored(sample[k]);
    p[k] = k == stiffness ? low * std::pow(high / low, share) : low + share * (high - low);
  }
  return p;
}

std::vector<double> sample_of(const FitStudy& study, const Parameters& parameters) {
  std::vector<double> sample(kParameters, 0.5);
  for (size_t k = 0; k < kParameters; ++k) {
    const auto [low, high] = study.bounds[k];
    if (high > low)
      sample[k] = k == stiffness ? std::log(parameters[k] / low) / std::log(high / low)
                                 : (parameters[k] - low) / (high - low);
  }
  return sample;
}

}  // namespace cuboct::fit
