// SPDX-License-Identifier: MIT
#include "study/sweep/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "model/analysis/measure.h"
#include "model/base/error.h"
#include "model/base/hash.h"
#include "model/base/spelling.h"
#include "model/config/file_kind.h"
#include "model/rules/rounds_rule.h"
#include "study/sweep/axes.h"
#include "study/sweep/changed_base.h"
#include "study/sweep/study_frame.h"

namespace cuboct::study {
namespace {

void read_figures(const ConfigTable& root, const Scene& scene, Study& study) {
  std::vector<Curve> known = ProbeMeter(scene.probes, scene.periodic, scene.body.x).curves();
  for (const char* part : {"total", "kinetic", "potential", "gravity"})
    known.push_back({std::string("energy.") + part, "J", {}, {}});
  std::vector<std::string> curves;
  for (const Curve& curve : known) curves.push_back(curve.name);
  std::set<std::string> names;
  for (const ConfigTable& table : root.tables("figure")) {
    study.figures.push_back(read_figure(table));
    for (const char* key : {"curve", "against"}) {
      const auto value = table.find(key);
      if (!value || std::ranges::find(curves, value->string()) != curves.end()) continue;
      const std::string near = did_you_mean(value->string(), curves);
      value->fail(fmt::format("the scene has no curve '{}'", value->string()),
                  near.empty() ? "known: " + list_of(curves) : near);
    }
    study.figure_units.push_back(study.figures.back().unit(known));
    if (!names.insert(study.figures.back().name).second)
      table.fail(fmt::format("two figures are called '{}'", study.figures.back().name), "give one a 'name'");
  }
}

// The times at which runs are looked at. Half of the default step is the shortest time between two.
void read_grid(const ConfigTable& root, const Scene& scene, Study& study) {
  if (const RoundsRule* rounds = scene.rule.rounds.get(); rounds && rounds->declaration().noise)
    root.at("scene").fail("the scene's rule draws noise in each step: another time step is another run");
  const double duration = static_cast<double>(scene.steps) * scene.rule.dt;
  if (scene.steps == 0) root.at("scene").fail("the scene has no steps");
  const uint64_t from_scene = scene.probe_every > 0 ? scene.steps / scene.probe_every : 100;
  study.grid.samples = static_cast<uint64_t>(root.integer_or(
      "samples", 1, 1'000'000, static_cast<int64_t>(std::clamp<uint64_t>(from_scene, 1, scene.steps))));
  study.grid.sample = duration / static_cast<double>(study.grid.samples);
}

void read_truth_settings(const ConfigTable& root, Study& study) {
  const auto table = root.table_at("truth");
  if (!table) return;
  study.truth_tolerance =
      table->number_or("tolerance", quantity::number, study.truth_tolerance, {.low = 1e-12, .high = 1});
  study.truth_rungs = static_cast<int>(table->integer_or("rungs", 2, 20, study.truth_rungs));
  study.lengthen_cutoff = table->boolean_or("lengthen_cutoff", study.lengthen_cutoff);
  study.horizon = table->number_or("horizon", quantity::time, 0, Range::positive());
  table->done();
}

void read_speed_settings(const ConfigTable& root, Study& study) {
  const auto table = root.table_at("speed");
  if (!table) return;
  study.repeats = static_cast<int>(table->integer_or("repeats", 1, 1000, study.repeats));
  study.seconds = table->number_or("seconds", quantity::number, study.seconds, {.low = 1e-3, .high = 1e4});
  table->done();
}

// All combinations of the axes' notches, the last axis fastest.
void add_grid(const std::vector<Axis>& axes, std::set<std::string>& known, std::vector<Settings>& points) {
  std::vector<size_t> at(axes.size(), 0);
  for (;;) {
    Settings settings;
    for (size_t k = 0; k < axes.size(); ++k) axes[k].sets[at[k]](settings);
    settings = canonical(std::move(settings));
    if (known.insert(settings.key()).second) points.push_back(std::move(settings));
    size_t k = axes.size();
    while (k > 0 && ++at[k - 1] == axes[k - 1].sets.size()) at[--k] = 0;
    if (k == 0) return;
  }
}

void read_points(const ConfigTable& root, Study& study) {
  std::set<std::string> known;
  for (const ConfigTable& table : root.tables("sweep")) {
    const std::vector<Axis> axes = read_axes(table, study.base);
    double count = 1;
    for (const Axis& axis : axes) count *= static_cast<double>(axis.sets.size());
    if (count > 100'000)
      table.fail(fmt::format("this grid has {:.3g} points: at most 100000 are taken", count));
    add_grid(axes, known, study.points);
  }
}

// What is sought is the least hardware (cost.h), and a GPU has its own.
void read_search(const ConfigTable& table, const Scene& scene, Study& study) {
  if (scene.rule.rounds != nullptr)
    table.fail("a search is for the least hardware, and no machine runs a rule of rounds yet");
  study.search = read_axes(table, study.base);
  for (const Axis& axis : study.search)
    for (const auto& set : axis.sets) {
      Settings settings;
      set(settings);
      if (on_gpu(settings))
        table.fail("a search cannot set the engine 'gpu'", "its fixed points have lattice's errors");
    }
}

uint64_t hash_of(const Study& study) {
  Hash hash;
  const auto text = [&](const std::string& t) {
    hash.add(static_cast<int64_t>(t.size()));
    for (const char c : t) hash.add(c);
  };
  text(study.base.scene_text);
  text(study.base.arch_text);
  for (const Figure& f : study.figures)
    text(fmt::format("{} {} {} {} {} {} {}", static_cast<int>(f.kind), f.name, f.curve, f.against, f.from,
                     f.to, f.fraction));
  text(fmt::format("{} {} {} {} {} {}", study.grid.sample, study.grid.samples, study.horizon,
                   study.truth_tolerance, study.truth_rungs, study.lengthen_cutoff));
  return hash.value();
}

}  // namespace

Settings canonical(Settings settings) {
  if (settings.arithmetic != Arithmetic::fixed) settings.arch.clear();
  if (on_gpu(settings)) settings.threads = 1;
  return settings;
}

double size_of_run(const Study& study, const Settings& settings) {
  try {
    const Case c = resolve(study.base, settings);
    const uint64_t steps = study.grid.steps_per_sample(c.scene.rule.dt) * study.grid.samples;
    return static_cast<double>(steps) * static_cast<double>(c.scene.body.size()) *
           (settings.arithmetic == Arithmetic::fixed ? 1 : 10);
  } catch (const InputError&) {
    return 0;
  }
}

Study read_study_frame(const ConfigTable& root, const std::string& path) {
  Study study;
  study.path = path;
  study.title = root.string_or("title", "");
  study.base = read_changed_base(root, path);
  Settings plain;
  plain.engine = default_engine(Arithmetic::float64);
  plain.arithmetic = Arithmetic::float64;
  const Scene scene = resolve(study.base, plain).scene;
  read_grid(root, scene, study);
  read_truth_settings(root, study);
  read_figures(root, scene, study);
  study.hash = hash_of(study);
  return study;
}

namespace {

Study study_of(const ConfigTable& root, const std::string& path) {
  Study study = read_study_frame(root, path);
  read_speed_settings(root, study);
  read_points(root, study);
  if (const auto search = root.table_at("search")) read_search(*search, resolve(study.base, {}).scene, study);
  if (study.points.empty() && study.search.empty())
    root.fail("a study without points", "add a [[sweep]] or a [search]");
  root.done();
  return study;
}

}  // namespace

Study read_study(const std::string& path) {
  return read_kind(FileKind::study, path, [&](const ConfigTable& root) { return study_of(root, path); });
}

}  // namespace cuboct::study
