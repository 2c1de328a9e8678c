// SPDX-License-Identifier: MIT
#include "model/scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <utility>

#include "model/base/error.h"
#include "model/config/file_kind.h"
#include "model/contract/law.h"
#include "model/program/step_limit.h"
#include "model/rules/no_rest.h"
#include "model/rules/rounds_rule.h"
#include "model/scene/auto_margin.h"
#include "model/scene/readings.h"
#include "model/scene/scene_parts.h"
#include "model/solid/dynamical_matrix.h"
#include "model/solid/stiffest_parts.h"
#include "model/solid/vibrations.h"

namespace cuboct {
namespace {

double read_mass(const ConfigTable& table, double pitch, double* density = nullptr) {
  table.not_both("density", "mass");
  if (table.has("mass") || pitch == 0) return table.number("mass", quantity::mass, Range::positive());
  const double value = table.number("density", quantity::density, Range::positive());
  if (density) *density = value;
  return particle_mass(value, pitch);
}

// That of the file, and those of materials that have their own.
void read_masses(const ConfigTable& root, Scene& scene) {
  Rule& rule = scene.rule;
  const auto own = [](const ConfigTable& table) { return table.has("density") || table.has("mass"); };
  const std::vector<ConfigTable> materials = root.tables("material");
  const bool all_own = !materials.empty() && std::all_of(materials.begin(), materials.end(), own);
  if (!all_own || own(root)) rule.mass = read_mass(root, scene.pitch, &scene.density);
  for (const ConfigTable& material : materials)
    rule.masses.push_back(own(material) ? read_mass(material, scene.pitch) : rule.mass);
  if (materials.empty()) return;
  rule.mass = *std::min_element(rule.masses.begin(), rule.masses.end());
  if (rule.heaviest() == rule.mass) rule.masses.clear();
}

void read_damping(const ConfigTable& from, Scene& scene) {
  const auto table = from.table_at("damping");
  if (!table) return;
  table->record_as("damping");
  table->not_both("coefficient", "ratio");
  if (table->has("ratio")) {
    const double ratio = table->number("ratio", quantity::number, Range::not_negative());
    const double stiffness = scene.pitch > 0 && scene.rule.law ? -scene.rule.law->slope(scene.pitch) : 0;
    if (!(stiffness > 0))
      table->at("ratio").fail("'ratio' needs a packing with a stiff bond at its pitch",
                              "give 'coefficient' instead");
    scene.rule.damping.coefficient = ratio * 2 * std::sqrt(stiffness * scene.rule.mass);
  } else {
    scene.rule.damping.coefficient = table->number("coefficient", quantity::damping, Range::not_negative());
  }
  // Limits of the time step square it; a million leaves room for a particle's neighbours.
  const double rate = scene.rule.damping.coefficient / scene.rule.mass;
  if (!std::isfinite(1e6 * rate * rate))
    table->at(table->has("ratio") ? "ratio" : "coefficient")
        .fail("the damping is larger than anything that can be computed with");
  table->done();
}

// The damping as if it were a law of springs: its dynamical matrix is that of the rates C/m.
class DampingAsLaw final : public PairLaw {
 public:
  explicit DampingAsLaw(const Rule& rule) : rule_(rule) {}
  double force(double) const override { return 0; }
  double energy(double) const override { return 0; }
  double slope(double r) const override { return -rule_.damping_over_r2(r) * r * r; }
  double cutoff() const override { return rule_.cutoff(); }
  double core() const override { return rule_.core(); }

 private:
  const Rule& rule_;
};

// The limit of the body's own vibrations, or of its part [low, high]; infinite where nothing is restored. Of
// many particles that of parts.
double vibrations_limit(const Scene& scene, const Vec3& low, const Vec3& high) {
  Body part;
  for (size_t i = 0; i < scene.body.size(); ++i) {
    const Vec3& x = scene.body.x[i];
    if (!x.within(low, high)) continue;
    part.x.push_back(x);
    part.type.push_back(scene.body.type[i]);
  }
  constexpr size_t kMostAtOnce = 10000;  // a second
  if (part.size() > kMostAtOnce) return stiffest_parts_limit(scene.rule, part, scene.periodic);
  return stability_limit(vibrations_of(scene.rule, part, scene.periodic)).dt;
}

struct TimeLimit {
  double dt = std::numeric_limits<double>::infinity();  // s
  std::string of;                                       // what sets it

  void meet(double other, const std::string& what) {
    if (other > 0 && other < dt) dt = other, of = what;
  }
  double known() const { return std::isinf(dt) ? 0 : dt; }  // 0: it is not
};

// Of a dt that the scene gives, and of "auto", which must last for what listed particles may become.
struct TimeLimits {
  TimeLimit given, automatic;
};

// Vibrations of a part are some of those of the body with its images at planes of symmetry.
TimeLimits time_limits(const Scene& scene, size_t listed) {
  const Rule& rule = scene.whole ? *scene.whole : scene.rule;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  TimeLimits limits;
  const double cutoff = rule.cutoff();
  if (const RoundsRule* rounds = rule.rounds.get()) {
    limits.given.meet(rounds->stable_time_step(rule.mass, scene.pitch),
                      scene.pitch > 0 ? "the perfect packing" : "the perfect crystal");
    limits.automatic = limits.given;
    return limits;
  }
  if (scene.pitch > 0) limits.given.meet(stable_time_step(rule, scene.pitch), "the perfect packing");
  bool small = false;  // a box that every engine will refuse
  for (const double extent : scene.periodic.extent) small = small || (extent > 0 && extent < 2 * cutoff);
  if (listed > 0 && !small) {
    // They, and what of a packing is near: elsewhere it is perfect, or has lost bonds.
    Vec3 low = Vec3::Constant(-kNone), high = Vec3::Constant(kNone);
    if (scene.pitch > 0) {
      std::swap(low, high);
      for (size_t i = scene.body.size() - listed; i < scene.body.size(); ++i)
        low = low.cwiseMin(scene.body.x[i]), high = high.cwiseMax(scene.body.x[i]);
      low -= Vec3::Constant(3 * cutoff), high += Vec3::Constant(3 * cutoff);
      for (int axis = 0; axis < 3; ++axis)
        if (scene.periodic.extent[axis] > 0) low[axis] = -kNone, high[axis] = kNone;
    }
    limits.given.meet(vibrations_limit(scene, low, high), "the particles that are listed");
    if (scene.pitch == 0 && stiffest_rest_distance(rule.law_at(0)) > 0.1 * cutoff)
      limits.automatic.meet(stable_time_step(rule, stiffest_rest_distance),
                            "a packing at the law's rest distance");
  }
  limits.automatic.meet(limits.given.dt, limits.given.of);
  return limits;
}

// The table that says how long the run is: the stage's keys replace those of [run].
const ConfigTable& timed(const ConfigTable& run, const StagePart* stage) {
  if (stage && (stage->has("steps") || stage->has("duration"))) return *stage;
  return run;
}

void read_length(const ConfigTable& table, Scene& scene) {
  if (table.has("duration")) {
    const double steps =
        std::ceil(table.number("duration", quantity::time, Range::positive()) / scene.rule.dt * (1 - 1e-12));
    if (steps > 1e15) table.at("duration").fail(fmt::format("'duration' takes {:.3g} steps", steps));
    scene.steps = static_cast<uint64_t>(steps);
  } else {
    scene.steps = static_cast<uint64_t>(table.at("steps").integer(0, INT64_MAX));
  }
}

// Of a stage with a length of its own that of [run] says nothing.
std::optional<ConfigValue> planned_of(const ConfigTable& run, const StagePart* stage) {
  auto planned = run.find("planned_steps");
  if (&timed(run, stage) != &run) planned.reset();
  if (stage)
    if (auto own = stage->find("planned_steps")) planned = std::move(own);
  return planned;
}

// s, as the keys say it, of time steps of `dt`.
double length_of_run(const ConfigTable& run, const StagePart* stage, double dt) {
  const ConfigTable& table = timed(run, stage);
  if (const auto planned = planned_of(run, stage))
    return static_cast<double>(planned->integer(0, INT64_MAX)) * dt;
  if (table.has("duration")) return table.number("duration", quantity::time, Range::positive());
  return static_cast<double>(table.at("steps").integer(0, INT64_MAX)) * dt;
}

// A run that is cut short keeps the bits of the whole one.
void read_planned_steps(const ConfigTable& run, const StagePart* stage, Scene& scene) {
  const auto planned = planned_of(run, stage);
  if (!planned) return;
  scene.planned_steps = static_cast<uint64_t>(planned->integer(0, INT64_MAX));
  if (scene.planned_steps < scene.steps)
    planned->fail(fmt::format("'planned_steps' is less than the run's {} steps", scene.steps),
                  "cells and formats must hold all of the run");
  if (stage && stage->parts() > 1) planned->fail("'planned_steps' does not go with 'parts'");
}

// What the box's strain of the end asks of the time step: of the body as packed, stretched with the box. A
// box that is pressed is stiffer. `time`: s, the longest that the run may take.
void meet_strained_box(const Scene& scene, double time, TimeLimits& limits) {
  const Vec3 strain = asked_strain(scene, time);
  if (strain.isZero(0) || !(strain.minCoeff() > -1)) return;
  Scene end = scene;
  end.periodic = BoxDeformation{scene.periodic, strain}.at(0);
  BoxStretch(scene.periodic, end.periodic).carry(end.body.x);
  for (const double extent : end.periodic.extent)
    if (extent > 0 && extent < 2 * scene.rule.cutoff()) return;  // refused once it is known when
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const RoundsRule* rounds = scene.rule.rounds.get();
  double dt = 0;
  if (rounds == nullptr)
    dt = vibrations_limit(end, Vec3::Constant(-kNone), Vec3::Constant(kNone));
  else if (rounds->text() != nullptr)
    dt = step_limit(*rounds->text(), scene.rule, end.body, end.periodic).dt;
  if (!(dt > 0) || std::isinf(dt)) return;
  const std::string what = "the body in the box of the end";
  if (rounds == nullptr) limits.given.meet(dt, what);
  limits.automatic.meet(dt, what);
}

// What the file gives; without, what its probes and `steps` ask for.
Readings readings_with(const Scene& scene, uint64_t steps, std::optional<uint64_t> probes,
                       std::optional<uint64_t> energies) {
  const uint64_t least = scene.loading ? scene.loading->every : 1;
  Readings every;
  every.probes = probes.value_or(scene.probes.empty() ? energies.value_or(0) : std::max(least, steps / 500));
  if (scene.loading) every.probes = scene.loading->whole(every.probes);
  // A load step takes hundreds of evaluations: beside it no reading counts.
  if (every.probes == 0)
    every.energies = 0;
  else if (energies)
    every.energies = whole_multiple(*energies, every.probes);
  else if (scene.loading || scene.probes.empty())
    every.energies = every.probes;
  else
    every.energies = usual_energy_every(steps, every.probes);
  return every;
}

// A stage's keys replace those of [run]. `listed`: as read_body has it.
void read_time(const ConfigTable& root, const StagePart* stage, size_t listed, Scene& scene) {
  const auto found = root.table_at("run");
  if (!found) root.at("run");
  const ConfigTable& run = *found;
  TimeLimits limits = time_limits(scene, listed);
  const auto usual = run.find("dt"), own = stage ? stage->find("dt") : std::nullopt;
  const auto dt = own ? own : usual;
  const bool automatic = !dt || (dt->is_string() && dt->string() == "auto");
  if (scene.asked_deform) {
    if (const RoundsRule* rounds = scene.rule.rounds.get();
        automatic && limits.automatic.known() == 0 && rounds != nullptr && rounds->text() != nullptr) {
      const StepLimit found = step_limit(*rounds->text(), scene.rule, scene.body, scene.periodic);
      limits.automatic.meet(found.dt, found.of);
    }
    const double longest =
        automatic ? limits.automatic.known() : dt->number(quantity::time, Range::positive());
    meet_strained_box(scene, length_of_run(run, stage, longest), limits);
  }
  TimeLimit limit = automatic ? limits.automatic : limits.given;
  std::string unknown;
  if (const RoundsRule* rounds = scene.rule.rounds.get();
      automatic && limit.known() == 0 && rounds != nullptr && rounds->text() != nullptr) {
    const StepLimit found = step_limit(*rounds->text(), scene.rule, scene.body, scene.periodic);
    limit.meet(found.dt, found.of);
    unknown = ": " + found.unknown;
  }
  scene.dt_limit = limit.known();
  scene.dt_limit_of = limit.of;
  const auto safety = run.find("dt_safety");
  if (automatic) {
    scene.dt_safety =
        safety ? safety->number(quantity::number, {.low = 0, .high = 1, .low_open = true}) : 0.2;
    if (scene.dt_limit == 0)
      (dt ? *dt : run).fail("no stability limit is known for this scene" + unknown, "give 'dt'");
    scene.rule.dt = scene.dt_safety * scene.dt_limit;
  } else {
    if (safety && !own) safety->fail("'dt_safety' serves dt = \"auto\" only");
    scene.rule.dt = dt->number(quantity::time, Range::positive());
    if (scene.dt_limit > 0) {
      scene.dt_safety = scene.rule.dt / scene.dt_limit;
      if (scene.dt_safety > 1)
        dt->fail(fmt::format("'dt' is beyond the stability limit {:.4g} s", scene.dt_limit),
                 fmt::format("\"auto\" would take {:.4g} s", 0.2 * limits.automatic.dt));
    }
  }

  for (const ConfigTable* table : {&run, static_cast<const ConfigTable*>(stage)})
    if (table) table->not_both("steps", "duration");
  read_length(timed(run, stage), scene);
  read_planned_steps(run, stage, scene);
  const uint64_t whole = scene.steps, parts = stage ? stage->parts() : 1;
  scene.steps = (whole + parts - 1) / parts;
  const auto given = [&](const char* key) {
    std::optional<uint64_t> value;
    for (const ConfigTable* table : {&run, static_cast<const ConfigTable*>(stage)}) {
      if (!table) continue;
      if (const auto found = table->find(key)) value = static_cast<uint64_t>(found->integer(0, INT64_MAX));
    }
    return value;
  };
  const bool usual_static = run.has("static");  // asked for, whether a stage has its own or not
  if (stage && stage->has("static"))
    scene.loading = read_static(*stage, scene);
  else if (usual_static)
    scene.loading = read_static(run, scene);
  const auto energies = given("energy_every");
  const Readings readings = readings_with(scene, whole, given("probe_every"), energies);
  scene.probe_every = readings.probes;
  scene.energy_every = readings.energies;
  scene.frame_every = given("frame_every").value_or(0);
  if (scene.loading) scene.frame_every = scene.loading->whole(scene.frame_every);
  if (energies.value_or(0) > 0 && scene.probe_every == 0)
    run.fail("'energy_every' needs readings: 'probe_every' is 0");
  if (const auto accuracy = run.find("accuracy"))
    scene.accuracy = accuracy->number(quantity::number, {.low = 1e-6, .high = 0.1});
  if (const auto strain = run.find("expected_strain"))
    scene.expected_strain = strain->number(quantity::number, {.low = 0, .high = 1, .low_open = true});
  scene.until = read_until(run, scene);
  if (stage)
    if (const auto until = read_until(*stage, scene)) scene.until = until;
  if (scene.until && stage) scene.until->after -= std::min(scene.until->after, stage->part() * scene.steps);
  if (scene.until && scene.probe_every == 0) run.fail("'until' needs readings: 'probe_every' is 0");
  run.done();
}

// What a rule must say of itself where the motion between two load steps is left out.
void check_static_rule(const ConfigTable& root, const Rule& rule) {
  const RoundsRule* rounds = rule.rounds.get();
  if (rounds == nullptr) return;
  if (const auto why = why_no_rest(*rounds))
    root.at("rule").fail("static loading leaves out time, and " + why->what, why->hint);
}

void read_reach(const ConfigTable& root, Scene& scene) {
  if (const auto reach = root.find("reach"); reach && reach->is_string())
    reach->fail("'reach' must be a table",
                "for the cells that the motion asks for write margin = \"auto\" in [reach]");
  const auto table = root.table_at("reach");
  if (!table) return;
  const auto margin = table->find("margin");
  if (margin && margin->is_string() && margin->string() == "auto") {
    scene.reach_margin = Vec3::Constant(kAutoMargin);
  } else if (margin) {
    if (margin->is_string() && std::isalpha(static_cast<unsigned char>(margin->string().c_str()[0])))
      margin->fail(fmt::format("unknown margin '{}'", margin->string()), "\"auto\", one length or three");
    const auto values = margin->is_number() ? std::vector{margin->number(quantity::length)}
                                            : margin->numbers(quantity::length);
    if (values.size() != 1 && values.size() != 3) margin->fail("'margin' needs one length or three");
    for (size_t a = 0; a < 3; ++a) scene.reach_margin[a] = values[values.size() == 1 ? 0 : a];
    if (scene.reach_margin.minCoeff() < 0) margin->fail("'margin' must not be negative");
  }
  if (table->has("min") || table->has("max")) {
    scene.reach = {table->at("min").vector(quantity::length), table->at("max").vector(quantity::length)};
    for (int a = 0; a < 3; ++a)
      if (!(scene.reach[0][a] < scene.reach[1][a]))
        table->at("max").fail(fmt::format("'max' must be above 'min' along {}", "xyz"[a]));
  }
  table->done();
}

}  // namespace

bool gives(const Scene& scene, const std::string& key) {
  return scene.places.placed(InputError("").about({"run." + key})).place() != nullptr;
}

Readings readings_of(const Scene& scene, uint64_t steps) {
  // So a run that is cut may be resumed to end later, or sooner.
  constexpr uint64_t kMostReadings = 1'000'000;
  const Readings own{scene.probe_every, scene.energy_every};
  if (own.probes == 0 || steps / own.probes <= kMostReadings) return own;
  const auto given = [&](const char* key, uint64_t every) {
    return gives(scene, key) ? std::optional(every) : std::nullopt;
  };
  return readings_with(scene, steps, given("probe_every", scene.probe_every),
                       given("energy_every", scene.energy_every));
}

double stable_time_step(const Rule& rule, double pitch, double tolerance) {
  return stable_time_step(
      rule, [pitch](const PairLaw&) { return pitch; }, tolerance);
}

double stable_time_step(const Rule& rule, const std::function<double(const PairLaw&)>& pitch,
                        double tolerance) {
  double kp = 0, kd = 0;           // over the mass
  double fastest = 0, damped = 0;  // frequencies squared, 1/s^2 and 1/s
  for (size_t k = 0; k < rule.types.size(); ++k) {
    const double mass = rule.mass_of(static_cast<int>(k));
    kp = std::max(kp, rule.types[k].kp / mass);
    kd = std::max(kd, rule.types[k].kd / mass);
  }
  for (size_t k = 0; k < rule.laws(); ++k) {
    const double rate = rule.largest_rate(k);
    if (rate == 0) continue;  // no pair of types has it
    const double of = pitch(rule.law_at(k)), w = largest_frequency(rule.law_at(k), rule.mass, of, tolerance);
    fastest = std::max(fastest, rate * w * w);
    if (!(w > 0) || rule.damping.coefficient == 0) continue;
    const double root = largest_frequency(DampingAsLaw(rule), rule.mass, of, tolerance);
    damped = std::max(damped, rate * root * root);
  }
  if (!(fastest > 0)) return 0;
  const double w2 = fastest + kp;
  const double g = kd + damped;
  // (sqrt(g^2 + 4 w^2) - g)/w^2 without its cancellation.
  return 4 / (std::sqrt(g * g + 4 * w2) + g);
}

namespace {

Scene scene_of(const ConfigTable& root, const std::string& path, const SceneChoice& choice) {
  Scene scene;
  scene.path = path;
  scene.places = root.places();
  scene.title = root.string_or("title", "");
  if (root.reduced()) scene.boltzmann = 1;
  read_start(root, choice, scene);
  const std::optional<StagePart> chosen = read_stage(root, choice, scene);
  if (chosen) scene.places.prefer_stage(chosen->at("name").string());
  const StagePart* stage = chosen ? &*chosen : nullptr;
  auto packing = read_packing(root);
  PackingChoice* packed = packing ? &*packing : nullptr;
  auto crystal = read_crystal(root);
  CrystalChoice* grown = crystal ? &*crystal : nullptr;
  const std::optional<RuleChoice> rule = read_rule(root, packed, grown);
  const bool rounds = rule && !rule->law;
  if (rounds)
    scene.rule.rounds_reach = rule->reach;
  else
    scene.rule.law = rule ? rule->law : read_law(root, packed);
  if (packing) {
    scene.pitch = packing->fcc.pitch;
    scene.orientation = packing->fcc.orientation;
  }
  read_masses(root, scene);
  read_damping(root, scene);
  if (stage) read_damping(*stage, scene);
  const Regions regions(root);
  const size_t listed = read_body(root, stage, regions, packed, grown, scene);
  if (stage) stage->check_ramps();
  if (rounds) scene.rule.rounds = rule->make(root, regions, scene);
  read_deform(root, stage, choice, scene);
  read_probes(root, regions, scene);
  scene.meshes = regions.mesh_facts();
  read_time(root, stage, listed, scene);
  if (scene.loading) check_static_rule(root, scene.rule);
  if (scene.asked_deform) {
    scene.asked_deform->steps =
        std::max(scene.steps, scene.planned_steps) * (stage ? stage->parts() - stage->part() : 1);
    // A stage behind another, or a run from another's end, begins in the box that was left.
    const bool begins = scene.start.empty() && (!stage || stage_names(root).front().name == scene.stage);
    if (!begins)
      set_box(scene, Vec3::Zero());
    else if (box_fault(scene, 0).empty())  // else every engine refuses the box
      begin_box(scene, Vec3::Zero());
  }
  read_reach(root, scene);
  for (Probe& probe : scene.probes)
    if (probe.kind == Probe::Kind::crack) probe.rule = std::make_shared<const Rule>(scene.rule);
  root.done();
  return scene;
}

}  // namespace

double first_shell(const Scene& scene) { return scene.pitch > 0 ? 1.207 * scene.pitch : scene.rule.cutoff(); }

std::array<bool, 3> live_axes(const Scene& scene) {
  const Body& body = scene.body;
  const double same = 1e-9 * scene.rule.cutoff();
  const ParticleType& first = scene.rule.types[body.type[0]];
  std::array<bool, 3> live{};
  for (size_t i = 0; i < body.size() && live != std::array{true, true, true}; ++i) {
    const ParticleType& type = scene.rule.types[body.type[i]];
    for (int a = 0; a < 3; ++a)
      live[a] = live[a] || std::abs(body.x[i][a] - body.x[0][a]) > same || body.v[i][a] != body.v[0][a] ||
                type.gravity[a] != first.gravity[a] || type.velocity[a] != first.velocity[a];
  }
  return live;
}

Scene read_scene(const std::string& path, const SceneChoice& choice) {
  return parse_scene(read_config_text(path), path, choice);
}

Scene parse_scene(const std::string& text, const std::string& path, const SceneChoice& choice) {
  Scene scene = read_kind(FileKind::scene, text, path,
                          [&](const ConfigTable& root) { return scene_of(root, path, choice); });
  scene.text = text;
  return scene;
}

}  // namespace cuboct
