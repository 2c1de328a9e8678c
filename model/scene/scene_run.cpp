// SPDX-License-Identifier: MIT
// What of a scene says how it is run: [start], [[stage]] and `until`.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/base/error.h"
#include "model/base/tensor.h"
#include "model/config/name.h"
#include "model/scene/scene_parts.h"
#include "model/scene/static_loading.h"

namespace cuboct {
namespace {

struct CurveOf {
  std::string name;
  Quantity quantity;
};

Quantity quantity_of(const Probe& probe) {
  try {
    return {parse_quantity("1 " + probe.unit).dimension, "a value of the field", "1"};
  } catch (const UnitError&) {
    return quantity::number;
  }
}

// Those that model/analysis/measure.h makes of the probe.
std::vector<CurveOf> curves_of(const Probe& probe, const Scene& scene) {
  std::vector<CurveOf> curves;
  const auto add = [&](const std::string& name, const Quantity& quantity) {
    curves.push_back({probe.name + "." + name, quantity});
  };
  const auto along = [&](const std::string& one, const std::string& each, const Quantity& quantity) {
    if (!probe.axis.isZero(0)) return add(one, quantity);
    for (const char axis : {'x', 'y', 'z'}) add(each + axis, quantity);
  };
  switch (probe.kind) {
    case Probe::Kind::force:
      along("force", "force_", quantity::force);
      break;
    case Probe::Kind::displacement:
      along("along", "", quantity::length);
      break;
    case Probe::Kind::stress_strain:
      add("strain", quantity::number), add("stress", quantity::pressure);
      break;
    case Probe::Kind::crack:
      add("broken", quantity::number), add("length", quantity::length);
      add("speed", quantity::velocity), add("energy", quantity::energy);
      break;
    case Probe::Kind::velocity:
      along("velocity", "velocity_", quantity::velocity);
      break;
    case Probe::Kind::kinetic_energy:
      add("kinetic_energy", quantity::energy);
      break;
    case Probe::Kind::temperature:
      add("temperature", quantity::temperature);
      break;
    case Probe::Kind::field:
      if (probe.numbers == 1) add(probe.field, quantity_of(probe));
      for (int k = 0; probe.numbers > 1 && k < probe.numbers; ++k)
        add(fmt::format("{}_{}", probe.field, "xyz"[k]), quantity_of(probe));
      break;
    case Probe::Kind::stress:
      for (const std::string& name : kTensorNames) add(name, quantity::pressure);
      for (int a = 0; probe.whole && a < 3; ++a)
        if (scene.periodic.extent[a] > 0) add(fmt::format("strain_{}", "xyz"[a]), quantity::number);
      break;
  }
  return curves;
}

// A probe's name stands for its curve where it has one alone.
CurveOf curve_at(const ConfigValue& value, const Scene& scene) {
  std::vector<std::string> names;
  std::vector<CurveOf> all;
  for (const Probe& probe : scene.probes) {
    const std::vector<CurveOf> curves = curves_of(probe, scene);
    if (curves.size() == 1 && value.string() == probe.name) return curves[0];
    for (const CurveOf& curve : curves) names.push_back(curve.name), all.push_back(curve);
  }
  if (all.empty()) value.fail("'until' needs a [[probe]]");
  return all[value.choice("curve", names)];
}

// Each is a directory and a summary.
constexpr int64_t kMostStageParts = 100;

}  // namespace

std::vector<StageName> stage_names(const ConfigTable& root) {
  std::vector<StageName> names;
  for (const ConfigTable& table : root.tables("stage")) {
    const ConfigValue at = table.at("name");
    const std::string stage = read_name(at);
    const bool twice = std::ranges::count(names, stage, &StageName::stage) > 0;
    const auto asked = table.find("parts");
    const auto parts = static_cast<size_t>(asked ? asked->integer(2, kMostStageParts) : 1);
    for (size_t part = 0; part < parts; ++part) {
      const std::string name = parts > 1 ? fmt::format("{}-{}", stage, part + 1) : stage;
      if (twice || std::ranges::count(names, name, &StageName::name) > 0)
        at.fail(fmt::format("stage '{}' is there twice", name));
      names.push_back({name, stage, part, parts});
    }
  }
  return names;
}

namespace {

std::string texts_of(const std::vector<StageName>& names) {
  std::string text;
  for (const StageName& one : names) text += (text.empty() ? "" : ", ") + one.name;
  return text;
}

}  // namespace

Vec3 StagePart::vector_of(const ConfigValue& value, const Quantity& quantity) const {
  if (!value.is_table()) return value.vector(quantity);
  ramps_ = true;
  const ConfigTable ramp = value.table();
  ramp.record_as("stage");
  const Vec3 from = ramp.at("from").vector(quantity), to = ramp.at("to").vector(quantity);
  ramp.done();
  if (parts_ == 1)
    value.fail("a ramp needs 'parts' in its stage: of how many constant values it is made", "parts = 10");
  return from + (static_cast<double>(part_) + 0.5) / static_cast<double>(parts_) * (to - from);
}

void StagePart::check_ramps() const {
  if (parts_ > 1 && !ramps_)
    at("parts").fail("'parts' serves ramps, and the stage has none",
                     "velocity = { from = ..., to = ... } is one");
}

void read_start(const ConfigTable& root, const SceneChoice& choice, Scene& scene) {
  const auto table = root.table_at("start");
  if (!table) return;
  if (!choice.begins)
    table->fail("[start] is for 'cuboct run', 'crosscheck', 'check' and 'emit'",
                "this command begins with the packing");
  scene.start = table->at("from").string();
  if (scene.start.empty()) table->at("from").fail("'from' names no directory");
  table->done();
}

std::optional<StagePart> read_stage(const ConfigTable& root, const SceneChoice& choice, Scene& scene) {
  const std::vector<ConfigTable> tables = root.tables("stage");
  if (tables.empty()) {
    if (!choice.stage.empty())
      throw InputError(fmt::format("{} has no stages, and no stage '{}'", scene.path, choice.stage));
    return std::nullopt;
  }
  const std::vector<StageName> names = stage_names(root);
  if (choice.stage.empty())
    tables[0].fail(choice.begins ? fmt::format("the scene has {} stages: --stage takes one", names.size())
                                 : "a scene of stages is for 'cuboct run', 'crosscheck', 'check' and 'emit'",
                   fmt::format("its stages: {}", texts_of(names)));
  std::optional<StagePart> chosen;
  for (const ConfigTable& table : tables) {
    const std::string stage = table.at("name").string();
    const auto part = std::ranges::find_if(
        names, [&](const StageName& one) { return one.stage == stage && one.name == choice.stage; });
    if (part != names.end())
      chosen.emplace(table, part->part, part->parts);
    else
      table.names();  // for whoever reads that stage
  }
  if (!chosen)
    throw InputError(fmt::format("{} has no stage '{}'", scene.path, choice.stage),
                     fmt::format("its stages: {}", texts_of(names)));
  scene.stage = choice.stage;
  return chosen;
}

void refuse_tearing(const Scene& scene, const StaticLoading& loading) {
  if (scene.pitch == 0) return;
  double fastest = 0;
  for (const ParticleType& type : scene.rule.types)
    if (!type.pd) fastest = std::max(fastest, type.velocity.norm());
  const double travel = fastest * static_cast<double>(loading.every) * scene.rule.dt;
  const double most = (scene.rule.cutoff() - scene.pitch) / 2;
  if (travel <= most) return;
  const double steps = std::ceil(static_cast<double>(scene.steps / loading.every) * travel / most);
  throw InputError(
      fmt::format(
          "a load step moves a constraint by {:.3g} pitches at once, {:.3g} may do without tearing bonds",
          travel / scene.pitch, most / scene.pitch),
      fmt::format("load_steps = {:.0f} or more", steps));
}

std::optional<StaticLoading> read_static(const ConfigTable& table, Scene& scene) {
  const ConfigValue value = table.at("static");
  StaticLoading loading;
  int64_t load_steps = 50, evaluations = 100000;
  if (value.is_table()) {
    const ConfigTable keys = value.table();
    keys.record_as("run");
    load_steps = keys.integer_or("load_steps", 1, 1000000, load_steps);
    evaluations = keys.integer_or("evaluations", 1, INT64_MAX, evaluations);
    loading.tolerance =
        keys.number_or("tolerance", quantity::number, loading.tolerance, Range::between(1e-9, 0.5));
    keys.done();
  } else if (!value.boolean()) {
    return std::nullopt;
  }
  const auto count = static_cast<uint64_t>(load_steps);
  loading.every = std::max<uint64_t>(1, (scene.steps + count - 1) / count);
  loading.evaluations = static_cast<uint64_t>(evaluations);
  scene.steps = loading.whole(scene.steps);
  placed_at(value, [&] { refuse_tearing(scene, loading); });
  return loading;
}

std::optional<Until> read_until(const ConfigTable& table, const Scene& scene) {
  const auto found = table.table_at("until");
  if (!found) return std::nullopt;
  found->record_as("run");
  const CurveOf curve = curve_at(found->at("probe"), scene);
  Until until;
  until.curve = curve.name;
  const char* keys[] = {"above", "below", "beyond"};
  for (int a = 0; a < 3; ++a)
    for (int b = a + 1; b < 3; ++b) found->not_both(keys[a], keys[b]);
  const char* key = keys[0];
  for (int k = 0; k < 3; ++k)
    if (found->has(keys[k])) key = keys[k], until.side = static_cast<Until::Side>(k);
  until.limit = found->number(key, curve.quantity,
                              until.side == Until::Side::beyond ? Range::not_negative() : Range::any());
  if (found->has("after")) {
    const double steps =
        std::ceil(found->number("after", quantity::time, Range::not_negative()) / scene.rule.dt);
    if (steps > 1e15) found->at("after").fail(fmt::format("'after' takes {:.3g} steps", steps));
    until.after = static_cast<uint64_t>(steps);
  }
  found->done();
  return until;
}

std::vector<StageName> stages_of(const std::string& path) { return stage_names(read_config(path)); }

}  // namespace cuboct
