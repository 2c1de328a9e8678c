// SPDX-License-Identifier: MIT
// The [[probe]] tables of a scene.
#include <fmt/format.h>

#include <algorithm>

#include "model/config/name.h"
#include "model/rules/rounds_rule.h"
#include "model/scene/scene_parts.h"
#include "model/solid/dynamical_matrix.h"

namespace cuboct {
namespace {

double mean_along(const ParticleSet& set, const std::vector<Vec3>& x, const Vec3& axis) {
  double sum = 0;
  for (uint32_t id : set.ids) sum += x[id].dot(axis);
  return sum / static_cast<double>(set.ids.size());
}

// T = m sum (v - mean)^2/(g k_B), with g = d (N - 1) degrees of freedom along the d axes that live: the mean
// takes one each.
void read_temperature(const ConfigTable& table, const Scene& scene, Probe& probe) {
  const std::array<bool, 3> live = live_axes(scene);
  std::erase_if(probe.set.ids, [&](uint32_t id) {
    const ParticleType& type = scene.rule.types[scene.body.type[id]];
    for (int a = 0; a < 3; ++a)
      if (live[a] && !is_free(type, a)) return true;
    return false;
  });
  const auto degrees =
      static_cast<double>(std::ranges::count(live, true)) * (static_cast<double>(probe.set.ids.size()) - 1);
  if (!(degrees > 0))
    table.at("region").fail("a temperature needs two particles that no constraint holds or moves");
  probe.scale = scene.rule.mass / (degrees * scene.boltzmann);
  probe.unit = temperature_unit(scene.boltzmann);
}

Datasheet read_datasheet(const ConfigTable& table) {
  table.record_as("probe");
  Datasheet sheet;
  const auto stress = [&](const char* key) {
    return table.number_or(key, quantity::pressure, 0, Range::positive());
  };
  const auto strain = [&](const char* key) {
    return table.number_or(key, quantity::number, 0, Range::positive());
  };
  sheet.modulus = stress("modulus");
  sheet.strength = stress("strength");
  sheet.yield_strain = strain("yield_strain");
  sheet.strain_at_break = strain("strain_at_break");
  sheet.source = table.string_or("source", "");
  table.done();
  return sheet;
}

void read_field(const ConfigTable& table, const Scene& scene, Probe& probe) {
  const ConfigValue field = table.at("field");
  const RoundsRule* rule = scene.rule.rounds.get();
  if (rule == nullptr || rule->declaration().shown.empty())
    table.at("kind").fail("a field probe reads fields of a [rule], and there are none here");
  const std::vector<RuleField>& shown = rule->declaration().shown;
  std::vector<std::string> names;
  for (const RuleField& one : shown) names.push_back(one.name);
  probe.field_at = field.choice("field", names);
  probe.field = names[probe.field_at];
  probe.numbers = shown[probe.field_at].numbers;
  if (probe.numbers != 1 && probe.numbers != 3)
    field.fail(fmt::format("'{}' is no number and no vector: frames have it", probe.field));
  probe.unit = shown[probe.field_at].unit.empty() ? "1" : shown[probe.field_at].unit;
}

// The region is read.
void read_crack(const ConfigTable& table, const Scene& scene, Probe& probe) {
  if (scene.rule.rounds != nullptr)
    table.at("kind").fail("a crack probe counts the bonds of a pair law, and [rule] has none",
                          "a probe of kind \"field\" follows the 'damage' of a rule whose bonds break");
  if (probe.set.ids.size() < 2) table.at("region").fail("a crack needs bonds: two particles or more");
  probe.bond_length = table.number_or("bond_length", quantity::length, first_shell(scene), Range::positive());
  if (const auto start = table.find("start")) probe.start = start->number(quantity::length);
  if (const auto bonds = table.find("bonds"))
    probe.from_start = bonds->choice("bonds", {"packing", "start"}) == 1;
  probe.window = static_cast<size_t>(table.integer_or("window", 1, 1'000'000, 10));
  for (const uint32_t id : probe.set.ids) probe.types.push_back(scene.body.type[id]);
}

// The volume of a set: as given, else its share of a box that repeats along all axes, else what its particles
// have in the packing.
void read_stress(const ConfigTable& table, const Scene& scene, Probe& probe) {
  if (scene.whole != nullptr)
    table.at("kind").fail("a stress probe counts whole particles: planes of [[symmetry]] part some",
                          "a probe of kind \"stress_strain\" has the stress at a grip");
  probe.kinetic = !table.boolean_or("virial", false);
  const double count = static_cast<double>(probe.whole ? scene.body.size() : probe.set.ids.size());
  probe.share = count / static_cast<double>(scene.body.size());
  const bool filled = scene.periodic.extent.minCoeff() > 0;
  const bool atoms = scene.rule.rounds && !scene.rule.rounds->element().empty();
  if (table.has("volume"))
    probe.volume = table.number("volume", kVolume, Range::positive());
  else if (!filled && scene.pitch > 0 && !atoms)
    probe.volume = count * fcc_volume(scene.pitch);
  else if (!filled)
    table.at("kind").fail(
        "the volume of the particles is not known: the box does not repeat along x, y and z",
        scene.boltzmann == 1 ? "volume = 1" : "volume = \"1 nm^3\"");
}

void read_accuracy(const ConfigTable& table, const Scene& scene, Probe& probe) {
  const auto accuracy = table.find("accuracy");
  if (!accuracy) return;
  probe.accuracy = accuracy->number(quantity::number, {.low = 1e-6, .high = 0.1});
  if (probe.kind == Probe::Kind::crack)
    accuracy->fail("a crack goes on by a spacing at a time: no accuracy is asked of it");
  if (probe.kind == Probe::Kind::stress)
    accuracy->fail("stress is that of all particles, by the law in doubles: no accuracy is asked of it");
  if (scene.rule.rounds != nullptr)
    accuracy->fail("a [rule] chooses its formats by itself: accuracy is asked of probes of a [law]");
}

}  // namespace

void read_probes(const ConfigTable& root, const Regions& regions, Scene& scene) {
  const double tolerance = 1e-6 * (scene.pitch > 0 ? scene.pitch : scene.rule.cutoff());
  for (const ConfigTable& table : root.tables("probe")) {
    Probe probe;
    const std::vector<std::string> kinds = {"force",       "displacement", "stress_strain",
                                            "crack",       "velocity",     "kinetic_energy",
                                            "temperature", "field",        "stress"};
    probe.kind = static_cast<Probe::Kind>(table.at("kind").choice("probe", kinds));
    probe.name = read_name(table.at("name"));
    for (const Probe& other : scene.probes)
      if (other.name == probe.name)
        table.at("name").fail(fmt::format("probe '{}' is there twice", probe.name));
    const auto set = [&](const char* key, const std::string& name) {
      return ParticleSet{name, regions.select(table.at(key), scene.body.x, tolerance)};
    };
    const bool tension = probe.kind == Probe::Kind::stress_strain;
    const bool crack = probe.kind == Probe::Kind::crack;
    const bool scalar = probe.kind >= Probe::Kind::kinetic_energy;
    const bool stress = probe.kind == Probe::Kind::stress;
    if (tension || crack || (!scalar && table.has("axis")))
      probe.axis = table.at("axis").direction().normalized();
    if (tension) {
      probe.lower = set("lower", probe.name + ".lower");
      probe.upper = set("upper", probe.name + ".upper");
      probe.grip = set("grip", probe.name + ".grip");
      probe.area = table.number("area", quantity::area, Range::positive());
      if (const auto sheet = table.table_at("datasheet")) probe.datasheet = read_datasheet(*sheet);
      if (!(mean_along(probe.lower, scene.body.x, probe.axis) <
            mean_along(probe.upper, scene.body.x, probe.axis)))
        table.at("upper").fail("'upper' must lie further along 'axis' than 'lower'");
    } else {
      probe.whole = stress && !table.has("region");
      probe.set = probe.whole ? ParticleSet{probe.name, {}} : set("region", probe.name);
      if (stress) read_stress(table, scene, probe);
      probe.scale = scene.rule.mass / 2;
      if (probe.kind == Probe::Kind::temperature) read_temperature(table, scene, probe);
      if (probe.kind == Probe::Kind::field) read_field(table, scene, probe);
      if (crack) read_crack(table, scene, probe);
      if (!scene.rule.masses.empty())
        for (const uint32_t id : probe.set.ids)
          probe.relative.push_back(scene.rule.relative_mass(scene.body.type[id]));
    }
    read_accuracy(table, scene, probe);
    table.done();
    scene.probes.push_back(std::move(probe));
  }
}

}  // namespace cuboct
