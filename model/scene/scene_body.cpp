// SPDX-License-Identifier: MIT
// The particles of a scene: where they are, how they move, what they are made of and what holds them.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "model/base/error.h"
#include "model/base/resources.h"
#include "model/config/name.h"
#include "model/contract/law.h"
#include "model/scene/scene_particles.h"
#include "model/scene/scene_parts.h"
#include "model/scene/symmetry.h"

namespace cuboct {
namespace {

constexpr double kPitchTolerance = 1e-6;  // of the pitch, as in packing.h
constexpr size_t kMaxTypes = 256;
constexpr double kMostParticles = 4e9;  // ids have 32 bits
constexpr double kBytesToRead = 64;     // a particle while it is read: position, velocity, type, two numbers

// Particles on a region's surface count as inside; where there is no packing the law's cutoff sets the scale.
double tolerance_of(const Scene& scene) {
  return kPitchTolerance * (scene.pitch > 0 ? scene.pitch : scene.rule.cutoff());
}

void check_size(const ConfigValue& geometry, const Bounds& bounds, double pitch) {
  for (int a = 0; a < 3; ++a) {
    const double size = bounds.high[a] - bounds.low[a];
    const char axis = "xyz"[a];
    if (std::isinf(size)) geometry.fail(fmt::format("the geometry has no end along {}", axis));
    if (size < pitch * (1 - kPitchTolerance))
      geometry.fail(fmt::format("the geometry is {:.6g} m along {}, less than the pitch {:.6g} m",
                                std::max(size, 0.0), axis, pitch));
  }
}

// Before anything is made: what stops a packing that this machine cannot hold, or that takes hours.
// `by_cells`: the box is so many cells of the crystal, whatever their size.
void check_packing(const ConfigValue& at, const Fcc& fcc, const Shape* shape, const Periodic& box,
                   bool by_cells) {
  constexpr double kMostTests = 4e9;  // half a minute
  const PackingSize size = packing_size(fcc, shape, box);
  if (size.farthest > 1e6) at.fail("the geometry is beyond a million pitches");
  const size_t parts = shape != nullptr ? shape->parts() : 1;
  const double tests = size.tested * static_cast<double>(parts);
  // Where there are `times` too many.
  const auto hint = [&](double times) {
    if (by_cells) return fmt::format("'cells' whose product is smaller by a factor of {:.2g}", 1.1 * times);
    return fmt::format("a pitch of {:.2g} m, or a smaller geometry", fcc.pitch * std::cbrt(times) * 1.06);
  };
  if (tests > kMostTests)
    at.fail(fmt::format("{:.3g} sites of the packing, held against {} parts of the geometry: at most {:.3g} "
                        "tests are made",
                        size.tested, parts, kMostTests),
            hint(std::pow(tests / kMostTests, 1.5)) + (parts > 100 ? ", or fewer points" : ""));
  const double bytes = size.sites * kBytesToRead, free = static_cast<double>(free_memory());
  const double most = std::min(kMostParticles, free / kBytesToRead);
  if (size.sites > most)
    at.fail(fmt::format("about {:.3g} particles, {} to read them: {}", size.sites, in_bytes(bytes),
                        most < kMostParticles ? in_bytes(free) + " are free"
                                              : fmt::format("a scene holds at most {:.3g}", kMostParticles)),
            hint(size.sites / most));
}

// Before grains are drawn: those that this body cannot have.
void check_grains(const GrainChoice& choice, const GrainDomain& domain, double pitch) {
  constexpr double kLeastSize = 3;     // pitches: less has hardly an inner particle
  constexpr double kLeastThick = 3;    // pitches: less is a layer, of which a turned crystal leaves scraps
  constexpr double kMostGrains = 1e6;  // half a minute
  const Grains& grains = choice.grains;
  const ConfigTable& table = choice.table;
  if (grains.size < kLeastSize * pitch * (1 - kPitchTolerance))
    table.at("size").fail(
        fmt::format("grains of {:.3g} pitches: they have at least {:g}", grains.size / pitch, kLeastSize),
        "a larger size, or a finer pitch");
  for (int a = 0; a < 3; ++a) {
    const double thick = domain.extent[a] / pitch;
    if (grains.column_axis < 0 && thick < kLeastThick)
      table.fail(fmt::format("the body has {:.3g} pitches along {}: grains that turn any way need {:g}",
                             thick, "xyz"[a], kLeastThick),
                 fmt::format("texture = \"{}\" makes columns along it", "xyz"[a]));
    if (domain.repeats[a] && domain.extent[a] < 2 * grains.closest * pitch)
      table.fail(fmt::format(
          "the box repeats after {:.3g} pitches along {}, grains need {:.3g}: a site would be near "
          "its own image",
          thick, "xyz"[a], 2 * grains.closest));
  }
  const double count = grain_count(grains, domain);
  if (count < 2)
    table.at("size").fail("the body holds one grain",
                          "a smaller size, or no 'grains': 'axes' turn one crystal");
  if (count > kMostGrains)
    table.at("size").fail(fmt::format("{:.3g} grains: at most {:g} are drawn", count, kMostGrains));
}

SitePeriods periods_of(const PackingChoice& packing) {
  return {[&packing](size_t a, const ConfigValue& cells) {
            if (!packing.along[a]) cells.fail("'cells' needs 'axes' of whole numbers; give 'size' instead");
            return packing.along[a]->norm() * packing.fcc.cell();
          },
          [&packing](size_t a, double extent) {
            return !packing.repeats_by_crystal(a) || is_period(packing.fcc, extent * Vec3::Unit(a));
          }};
}

void pack_geometry(const ConfigTable& root, const Regions& regions, const PackingChoice& packing,
                   Scene& scene) {
  const SitePeriods sites = periods_of(packing);
  const auto [boxed, periodic] = read_box(root, &sites);
  for (size_t a = 0; a < 3; ++a)
    if (periodic[a]) scene.periodic.extent[a] = boxed.extent[a];
  scene.periodic.origin = boxed.origin;
  const auto geometry = root.find("geometry");
  const bool whole_box = boxed.extent.minCoeff() > 0;
  if (!geometry && !whole_box)
    root.at("packing").fail("nothing says what to pack", "add [geometry], or [box] with 'cells'");
  ShapePtr shape;
  if (geometry) {
    shape = read_shape(*geometry, regions);
    Bounds bounds = shape->bounds();
    for (int a = 0; a < 3; ++a) {
      if (boxed.extent[a] == 0) continue;
      bounds.low[a] = std::max(bounds.low[a], boxed.origin[a]);
      bounds.high[a] = std::min(bounds.high[a], boxed.origin[a] + boxed.extent[a]);
    }
    check_size(*geometry, bounds, scene.pitch);
  }
  const ConfigValue box = geometry ? *geometry : root.at("box");
  check_packing(box, packing.fcc, shape.get(), boxed, !geometry && root.at("box").table().has("cells"));
  if (packing.grains) {
    const Grains& grains = packing.grains->grains;
    const GrainDomain domain = grain_domain(shape.get(), boxed, periodic);
    check_grains(*packing.grains, domain, scene.pitch);
    scene.grains = static_cast<size_t>(grain_count(grains, domain));
    scene.body.x = pack_grains(packing.fcc, grains, shape.get(), boxed, periodic);
  } else {
    scene.body.x = pack(packing.fcc, shape.get(), boxed);
  }
  if (scene.body.x.empty()) box.fail("no particle: no site of the packing lies inside");
  scene.body.v.assign(scene.body.x.size(), Vec3::Zero());
}

void read_single_box(const ConfigTable& root, const FileParticles* file, Scene& scene) {
  const auto [boxed, periodic] = read_box(root, nullptr, file && file->file.box ? &*file->file.box : nullptr);
  scene.periodic.origin = boxed.origin;
  for (size_t a = 0; a < 3; ++a)
    if (periodic[a]) scene.periodic.extent[a] = boxed.extent[a];
}

// Which key gives a free particle the largest speed: a speed that no format holds is refused there.
class Fastest {
 public:
  void meet(const ConfigValue& key, double speed) {
    if (speed > speed_) speed_ = speed, key_ = key;
  }
  void mark(Places& places) const {
    if (key_) key_->mark(places, "velocity[fastest]");
  }

 private:
  double speed_ = 0;
  std::optional<ConfigValue> key_;
};

// Adds the materials named by the [[particle]] entries, the last of all particles; -1: by region.
void read_particles(const ConfigTable& root, const std::vector<std::string>& materials, Scene& scene,
                    Fastest& fastest, std::vector<int>& named) {
  const auto tables = root.tables("particle");
  scene.body.x.reserve(scene.body.x.size() + tables.size());  // behind millions: no growth by halves
  scene.body.v.reserve(scene.body.v.size() + tables.size());
  for (const ConfigTable& table : tables) {
    const ConfigValue position = table.at("position");
    const Vec3 x = position.vector(quantity::length);
    for (int a = 0; a < 3; ++a) {
      const double in = x[a] - scene.periodic.origin[a];
      if (scene.periodic.extent[a] > 0 && !(in >= 0 && in < scene.periodic.extent[a]))
        position.fail(fmt::format("'position' is outside the periodic box along {}", "xyz"[a]));
    }
    scene.body.x.push_back(x);
    scene.body.v.push_back(table.vector_or("velocity", quantity::velocity, Vec3::Zero()));
    if (table.has("velocity")) fastest.meet(table.at("velocity"), scene.body.v.back().norm());
    const auto material = table.find("material");
    named.push_back(material ? static_cast<int>(material->choice("material", materials)) : -1);
    table.done();
  }
}

// Sites of a packing are a pitch apart: only the listed particles, the last of `x`, can stand where another
// does. `refuse` has the message about two of them.
template <typename Refuse>
void check_distinct(const std::vector<Vec3>& x, size_t listed, Refuse refuse) {
  const auto key = [&](size_t i) { return std::array{x[i][0], x[i][1], x[i][2], static_cast<double>(i)}; };
  std::vector<size_t> order(listed);
  std::iota(order.begin(), order.end(), x.size() - listed);
  std::ranges::sort(order, {}, key);
  const size_t packed = listed > 0 ? x.size() - listed : 0;
  const auto place = [&](size_t i) { return std::array{x[i][0], x[i][1], x[i][2]}; };
  std::vector<size_t> covered;
  for (size_t i = 0; i < packed; ++i)
    if (std::ranges::binary_search(order, place(i), {}, place)) covered.push_back(i);
  order.insert(order.end(), covered.begin(), covered.end());
  std::ranges::sort(order, {}, key);
  for (size_t i = 1; i < order.size(); ++i)
    if (x[order[i]] == x[order[i - 1]])
      refuse(order[i - 1], order[i],
             fmt::format("particles {} and {} stand at the same point", order[i - 1], order[i]));
}

struct Material {
  std::string name;
  double strength = 1;
};

std::vector<Material> read_materials(const ConfigTable& root) {
  std::vector<Material> materials;
  for (const ConfigTable& table : root.tables("material")) {
    if (materials.size() == kMaxTypes) table.fail(fmt::format("more than {} materials", kMaxTypes));
    Material material{read_name(table.at("name")),
                      table.number_or("strength", quantity::number, 1, Range::positive())};
    for (const Material& other : materials)
      if (other.name == material.name)
        table.at("name").fail(fmt::format("material '{}' is there twice", other.name));
    // A plane of symmetry adds ':' and its axes.
    if (material.name.find(':') != std::string::npos)
      table.at("name").fail(fmt::format("'name' of a material must not hold ':': '{}'", material.name));
    materials.push_back(material);
  }
  if (materials.empty()) materials.push_back({"matter", 1});
  return materials;
}

// The law of a bond, and its number among those of the rule: equal ones are one.
size_t read_bond_law(const ConfigTable& table, const PackingChoice* packing, Rule& rule) {
  std::optional<PackingChoice> own;
  if (packing != nullptr) own = *packing;
  const auto law = read_law_table(table, own ? &*own : nullptr);
  for (size_t k = 0; k < rule.laws(); ++k)
    if (same_law(rule.law_at(k), *law)) return k;
  if (rule.laws() == kMostLaws)
    table.fail(fmt::format("more than {} laws", kMostLaws),
               "each takes a table in every force pipe; bonds of equal laws share one");
  rule.other_laws.push_back(law);
  return rule.laws() - 1;
}

// All contacts of a scene end at one distance.
void read_contact(const ConfigTable& bond, size_t i, size_t j, size_t law, Rule& rule) {
  const double end = push_end(rule.law_at(law));
  if (rule.contact.empty()) {
    rule.contact.assign(rule.strength.size(), std::vector<char>(rule.strength.size(), 0));
    rule.contact_distance = end;
  }
  if (std::abs(end - rule.contact_distance) > 1e-9 * end)
    bond.at("contact").fail(
        fmt::format("the push of this pair's law ends at {:.6g} m, that of another contact at "
                    "{:.6g} m",
                    end, rule.contact_distance),
        "all contacts of a scene end at one distance");
  rule.contact[i][j] = rule.contact[j][i] = 1;
}

// Where bonds have replaced the scene's law everywhere, the first of theirs takes its place.
void drop_unused_law(Rule& rule) {
  if (rule.strongest_of(0) > 0) return;
  rule.law = rule.other_laws.front();
  rule.other_laws.erase(rule.other_laws.begin());
  for (auto& row : rule.law_index)
    for (uint8_t& law : row) --law;
  if (rule.other_laws.empty()) rule.law_index.clear();
}

// Pairs of unlike materials take the geometric mean unless a [[bond]] gives a strength, or a law: that has
// its own.
void read_bonds(const ConfigTable& root, const std::vector<Material>& materials,
                const std::vector<std::string>& names, const PackingChoice* packing, Rule& rule) {
  const size_t n = materials.size();
  rule.strength.assign(n, std::vector<double>(n));
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < n; ++j)
      rule.strength[i][j] =
          i == j ? materials[i].strength : std::sqrt(materials[i].strength * materials[j].strength);
  for (const ConfigTable& table : root.tables("bond")) {
    const ConfigValue between = table.at("between");
    const auto pair = between.items();
    if (pair.size() != 2) between.fail("'between' needs two materials");
    const size_t i = pair[0].choice("material", names), j = pair[1].choice("material", names);
    const bool contact = table.boolean_or("contact", false);
    const auto own = table.table_at("law");
    size_t law = 0;
    if (own) {
      law = read_bond_law(*own, packing, rule);
      if (rule.law_index.empty() && law > 0) rule.law_index.assign(n, std::vector<uint8_t>(n, 0));
      if (!rule.law_index.empty()) rule.law_index[i][j] = rule.law_index[j][i] = static_cast<uint8_t>(law);
      rule.strength[i][j] = rule.strength[j][i] = 1;
    }
    if ((!contact && !own) || table.has("strength"))
      rule.strength[i][j] = rule.strength[j][i] =
          table.number("strength", quantity::number, Range::positive());
    if (contact) read_contact(table, i, j, law, rule);
    table.done();
  }
  drop_unused_law(rule);
}

std::vector<int> assign_materials(const ConfigTable& root, const Regions& regions,
                                  const std::vector<int>& named, const Scene& scene) {
  std::vector<int> material(scene.body.size(), 0);
  int index = 0;
  for (const ConfigTable& table : root.tables("material")) {
    if (const auto region = table.find("region"))
      for (uint32_t id : regions.select(*region, scene.body.x, tolerance_of(scene))) material[id] = index;
    else if (index > 0)
      table.at("region");  // only the first material may fill what no region claims
    table.done();
    ++index;
  }
  const size_t packed = material.size() - named.size();
  for (size_t i = 0; i < named.size(); ++i)
    if (named[i] >= 0) material[packed + i] = named[i];
  return material;
}

// What a stage says of the scene's constraints, by their names, and the constraints of its own.
struct StageConstraints {
  std::map<std::string, ConfigTable> changes;
  std::vector<ConfigTable> own;
};

StageConstraints stage_constraints(const ConfigTable& root, const StagePart* stage) {
  StageConstraints found;
  if (!stage) return found;
  std::vector<std::string> names;
  for (const ConfigTable& table : root.tables("constraint")) names.push_back(table.at("name").string());
  for (const ConfigTable& table : stage->tables("constraint")) {
    table.record_as("constraint");
    if (table.has("kind")) {
      found.own.push_back(table);
      continue;
    }
    const ConfigValue name = table.at("name");
    if (names.empty())
      name.fail("the scene has no [[constraint]]", "one of the stage's own has 'kind' and 'region'");
    name.choice("constraint", names);
    const std::array keys = {"velocity", "force", "traction", "free"};
    for (size_t k = 0; k < keys.size(); ++k)
      for (size_t other = 0; other < k; ++other) table.not_both(keys[other], keys[k]);
    if (std::ranges::none_of(keys, [&](const char* key) { return table.has(key); }))
      table.fail("a stage gives a constraint 'velocity', 'force', 'traction' or 'free'");
    if (!found.changes.try_emplace(name.string(), table).second)
      name.fail(fmt::format("constraint '{}' is there twice", name.string()));
  }
  return found;
}

const std::vector<std::string> kConstraintKinds = {"held", "moved", "held_by_force", "moved_by_force",
                                                   "pulled"};

// N, on the particles of a `pulled` constraint together. `change`: what `stage` says of it, or null.
Vec3 read_pull(const ConfigTable& table, const ConfigTable* change, const StagePart* stage) {
  table.not_both("force", "traction");
  const bool traction = table.has("traction");
  const char *key = traction ? "traction" : "force", *other = traction ? "force" : "traction";
  const Quantity& of = traction ? quantity::pressure : quantity::force;
  const double area = traction ? table.number("area", quantity::area, Range::positive()) : 1;
  Vec3 value = table.at(key).vector(of);
  if (change) {
    for (const char* wrong : {"velocity", other})
      if (change->has(wrong))
        change->at(wrong).fail(
            fmt::format("'{}' has a '{}', which a stage may change", change->at("name").string(), key));
    if (change->has(key)) value = stage->vector_of(change->at(key), of);
  }
  return area * value;
}

// `change`: what `stage` says of it, or null.
ParticleType read_constraint(const ConfigTable& table, const ConfigTable* change, const StagePart* stage,
                             const Rule& rule, double pitch) {
  ParticleType type;
  const std::vector<std::string>& kinds = kConstraintKinds;
  const size_t kind = table.at("kind").choice("constraint", kinds);
  if (kind == 4) {
    if (const auto axes = table.find("axes"))
      axes->fail("'axes' serves 'held' and 'moved' only, not 'pulled'",
                 "let the force have no part along an axis");
    return type;
  }
  for (const char* key : {"force", "traction"})
    if (change && change->has(key))
      change->at(key).fail(
          fmt::format("'{}' is '{}' and has no {}", change->at("name").string(), kinds[kind], key),
          "make it 'pulled', with a force of 0 where there is none");
  const bool moved = kind % 2 == 1;
  if (moved) type.velocity = table.at("velocity").vector(quantity::velocity);
  if (change && change->has("velocity")) {
    if (!moved)
      change->at("velocity")
          .fail(fmt::format("'{}' is '{}' and has no velocity", change->at("name").string(), kinds[kind]),
                "make it 'moved', with a velocity of 0 where it stands");
    type.velocity = stage->vector_of(change->at("velocity"), quantity::velocity);
  }
  if (kind < 2) {
    type.imposed = table.has("axes") ? table.axes("axes") : std::array{true, true, true};
    for (size_t a = 0; a < 3; ++a)
      if (!type.imposed[a] && type.velocity[a] != 0)
        (change && change->has("velocity") ? *change : table)
            .at("velocity")
            .fail(fmt::format("'velocity' has a part along {}, which 'axes' leaves free", "xyz"[a]));
  } else {
    if (const auto axes = table.find("axes"))
      axes->fail(fmt::format("'axes' serves 'held' and 'moved' only, not '{}'", kinds[kind]));
    type.pd = true;
    // Rounds have no bond of which it could be told here.
    type.kp = rule.law ? table.number_or("kp", quantity::stiffness, 10 * largest_stiffness(rule, pitch),
                                         Range::positive())
                       : table.number("kp", quantity::stiffness, Range::positive());
    type.kd = table.number_or("kd", quantity::damping, rule.damping.coefficient, Range::not_negative());
  }
  return type;
}

bool moves_freely(const ParticleType& type) {
  return is_free(type, 0) && is_free(type, 1) && is_free(type, 2);
}

double material_mass(const Rule& rule, int material) {
  return rule.masses.empty() ? rule.mass : rule.masses[static_cast<size_t>(material)];
}

// Of each constraint's force the part of one whole particle of its own: those that no later constraint took,
// or a stage let go. `regions`: for errors, where none is left. `in`: planes of symmetry in which a particle
// stands, by material; empty without any.
void share_pulls(const std::vector<int>& constraint, const std::vector<int>& material,
                 const std::vector<uint8_t>& in, const std::vector<ConfigValue>& regions,
                 std::vector<Vec3>& pull) {
  std::vector<double> count(pull.size(), 0);
  for (size_t i = 0; i < constraint.size(); ++i)
    if (constraint[i] >= 0)
      count[static_cast<size_t>(constraint[i])] +=
          part_beside(in.empty() ? 0 : in[static_cast<size_t>(material[i])]);
  for (size_t k = 0; k < pull.size(); ++k) {
    if (pull[k].isZero(0)) continue;
    if (count[k] == 0)
      regions[k].fail("later constraints take all particles of this region: its force pulls none");
    pull[k] /= count[k];
  }
}

// Standard deviation of each component, m/s: sqrt(kT/m), m of the lightest material.
std::optional<double> thermal_speed(const ConfigTable& table, const Scene& scene, double mass) {
  const char* keys[] = {"thermal_speed", "thermal_energy", "temperature"};
  table.not_both(keys[0], keys[1]);
  table.not_both(keys[0], keys[2]);
  table.not_both(keys[1], keys[2]);
  const auto not_negative = [&](int key, const Quantity& quantity) {
    return table.number(keys[key], quantity, Range::not_negative());
  };
  if (table.has(keys[0])) return not_negative(0, quantity::velocity);
  if (table.has(keys[1])) return std::sqrt(not_negative(1, quantity::energy) / mass);
  if (!table.has(keys[2])) return std::nullopt;
  return std::sqrt(scene.boltzmann * not_negative(2, quantity::temperature) / mass);
}

// Of a temperature each particle has the speed that its mass gives: half of a particle that of the whole.
ThermalShare thermal_share(const ConfigTable& table, const Rule& rule, const Rule& whole, int material) {
  if (rule.masses.empty()) return {};
  const auto m = static_cast<size_t>(material);
  return {rule.masses[m] / rule.mass,
          table.has("thermal_speed") ? 1 : std::sqrt(whole.mass / whole.masses[m])};
}

// `material`: by particle. `free`: what no constraint holds or leads; others are not the fastest. `whole`:
// the rule as if particles in planes of symmetry were whole.
void read_velocities(const ConfigTable& root, const Regions& regions, const std::vector<int>& material,
                     const std::vector<char>& free, const Rule& whole, Scene& scene, Fastest& fastest) {
  Body& body = scene.body;
  for (const ConfigTable& table : root.tables("velocity")) {
    std::vector<uint32_t> ids;
    if (const auto region = table.find("region")) {
      ids = regions.select(*region, body.x, tolerance_of(scene));
    } else {
      ids.resize(body.size());
      std::iota(ids.begin(), ids.end(), 0U);
    }
    const Vec3 uniform = table.vector_or("uniform", quantity::velocity, Vec3::Zero());
    const Vec3 spin = table.vector_or("spin", quantity::angular_velocity, Vec3::Zero());
    Vec3 centre = Vec3::Zero();
    for (uint32_t id : ids) centre += body.x[id];
    centre /= static_cast<double>(ids.size());
    const std::optional<double> thermal = thermal_speed(table, scene, whole.mass);
    constexpr double kTail = 4;  // standard deviations: the fastest of some ten thousand
    for (uint32_t id : ids) {
      const Vec3 given = uniform + spin.cross(body.x[id] - centre);
      body.v[id] += given;
      if (free[id]) fastest.meet(table, given.norm() + kTail * thermal.value_or(0));
    }
    if (thermal) {
      scene.thermal |= *thermal > 0;
      add_thermal(body.v, ids, *thermal, static_cast<uint64_t>(table.at("seed").integer(0, INT64_MAX)),
                  [&](uint32_t id) { return thermal_share(table, scene.rule, whole, material[id]); });
    }
    table.done();
  }
}

}  // namespace

std::pair<Periodic, std::array<bool, 3>> read_box(const ConfigTable& root, const SitePeriods* sites,
                                                  const ParticleFileBox* file) {
  Periodic box;
  std::array<bool, 3> periodic{};
  if (file != nullptr) box.origin = file->low, box.extent = file->extent, periodic = file->periodic;
  const auto table = root.table_at("box");
  if (!table) return {box, periodic};
  table->has("deform");  // read_deform reads it
  if (table->has("periodic")) periodic = table->axes("periodic");
  box.origin = table->vector_or("origin", quantity::length, box.origin);
  table->not_both("cells", "size");
  if (sites != nullptr && table->has("cells")) {
    const ConfigValue cells = table->at("cells");
    const Vec3 n = cells.vector(quantity::number);
    for (size_t a = 0; a < 3; ++a) {
      if (!(n[a] >= 1 && n[a] == std::round(n[a])))
        cells.fail("'cells' must hold three whole numbers of at least 1");
      box.extent[a] = n[a] * sites->edge(a, cells);
    }
  } else if (file == nullptr || table->has("size") || table->has("cells")) {
    const ConfigValue size = table->at("size");
    box.extent = size.vector(quantity::length);
    if (!(box.extent.minCoeff() > 0)) size.fail("'size' must be greater than 0 along each axis");
    for (size_t a = 0; a < 3; ++a)
      if (sites != nullptr && periodic[a] && !sites->repeats(a, box.extent[a]))
        size.fail(fmt::format("the packing does not repeat after {:.9g} m along {}", box.extent[a], "xyz"[a]),
                  "give 'cells' instead");
    if (file != nullptr) check_box_size(size, *file, box.extent, periodic);
  }
  for (size_t a = 0; a < 3; ++a)
    if (periodic[a] && !(box.extent[a] > 0))
      table->at("periodic")
          .fail(fmt::format("the particles' file has no length of the box along {}", "xyz"[a]));
  table->done();
  return {box, periodic};
}

size_t read_body(const ConfigTable& root, const StagePart* stage, const Regions& regions,
                 const PackingChoice* packing, const CrystalChoice* crystal, Scene& scene) {
  const std::vector<Material> materials = read_materials(root);
  std::vector<std::string> names;
  for (const Material& material : materials) names.push_back(material.name);
  read_bonds(root, materials, names, packing, scene.rule);

  const auto filed = read_file_particles(root, packing != nullptr || crystal != nullptr, names);
  if (packing != nullptr)
    pack_geometry(root, regions, *packing, scene);
  else if (crystal != nullptr)
    place_crystal(root, regions, *crystal, scene);
  else
    read_single_box(root, filed ? &*filed : nullptr, scene);
  Body& body = scene.body;
  const size_t packed = body.size();
  std::vector<int> named;  // of those that are listed
  if (filed) {
    place_file_particles(*filed, scene);
    for (size_t i = 0; i < filed->file.size(); ++i) named.push_back(filed->material_of(i));
  }
  Fastest fastest;
  read_particles(root, names, scene, fastest, named);
  if (body.size() == 0)
    root.fail("no particle", "add [packing] with [geometry], [particles] or [[particle]]");
  check_distinct(body.x, named.size(), [&](size_t i, size_t j, const std::string& message) {
    const ParticleFile* file = filed ? &filed->file : nullptr;
    for (const size_t of : {j, i})
      if (file != nullptr && of >= packed && of - packed < file->size())
        file->text->fail(
            file->at[of - packed], message,
            i >= packed && i - packed < file->size() && of == j
                ? fmt::format("the other one is that of line {}", file->text->line_at(file->at[i - packed]))
                : "");
    root.fail(message);
  });
  std::vector<int> material = assign_materials(root, regions, named, scene);
  if (filed) {
    check_file_masses(*filed, material, packed, scene, names);
    take_momenta(*filed, material, packed, scene);
  }
  const std::vector<SymmetryPlane> planes = read_symmetry(root, packing, scene);
  Divided divided;
  if (!planes.empty()) divided = divide(planes, body.x, tolerance_of(scene), material, names, scene.rule);
  Vec3 gravity = root.vector_or("gravity", quantity::acceleration, Vec3::Zero());
  if (stage)
    if (const auto own = stage->find("gravity")) gravity = stage->vector_of(*own, quantity::acceleration);
  check_gravity(planes, gravity);
  const StageConstraints of_stage = stage_constraints(root, stage);
  std::vector<ConfigTable> tables = root.tables("constraint");
  tables.insert(tables.end(), of_stage.own.begin(), of_stage.own.end());
  std::vector<int> constraint(body.size(), -1);
  std::vector<ParticleType> constraints;
  std::vector<Vec3> pull;  // N, on each particle of a constraint
  std::vector<ConfigValue> pulled_regions;
  for (const ConfigTable& table : tables) {
    if (constraints.size() == kMaxTypes) table.fail(fmt::format("more than {} constraints", kMaxTypes));
    const auto found = of_stage.changes.find(table.at("name").string());
    const ConfigTable* change = found == of_stage.changes.end() ? nullptr : &found->second;
    ParticleType type = read_constraint(table, change, stage, scene.rule, scene.pitch);
    type.name = read_name(table.at("name"));
    for (const ParticleType& other : constraints)
      if (other.name == type.name)
        table.at("name").fail(fmt::format("constraint '{}' is there twice", type.name));
    const bool free = change && change->boolean_or("free", false);
    const bool pulled = table.at("kind").string() == kConstraintKinds.back();
    const Vec3 force = pulled ? read_pull(table, change, stage) : Vec3::Zero();
    pull.push_back(free ? Vec3::Zero() : force);
    pulled_regions.push_back(table.at("region"));
    for (uint32_t id : regions.select(pulled_regions.back(), body.x, tolerance_of(scene)))
      constraint[id] = free ? -1 : static_cast<int>(constraints.size());
    table.done();
    constraints.push_back(std::move(type));
  }
  share_pulls(constraint, material, divided.planes, pulled_regions, pull);
  std::vector<char> free(body.size());
  for (size_t i = 0; i < body.size(); ++i)
    free[i] = constraint[i] < 0 || moves_freely(constraints[static_cast<size_t>(constraint[i])]);
  if (filed) {
    double speed = 0;
    for (size_t i = packed; i < packed + filed->file.size(); ++i)
      if (free[i] != 0) speed = std::max(speed, body.v[i].norm());
    if (speed > 0) fastest.meet(filed->table.at("file"), speed);
  }
  read_velocities(root, regions, material, free, planes.empty() ? scene.rule : divided.whole, scene, fastest);
  fastest.mark(scene.places);

  std::map<std::pair<int, int>, size_t> occurring;
  for (size_t i = 0; i < body.size(); ++i) occurring.try_emplace({material[i], constraint[i]}, 0);
  if (occurring.size() > kMaxTypes)
    root.fail(fmt::format("{} pairs of material and constraint occur, at most {} may", occurring.size(),
                          kMaxTypes));
  for (auto& [pair, index] : occurring) {
    ParticleType type = pair.second < 0 ? ParticleType{} : constraints[static_cast<size_t>(pair.second)];
    const std::string& name = names[static_cast<size_t>(pair.first)];
    type.name = pair.second < 0 ? name : name + "/" + type.name;
    type.material = pair.first;
    const uint8_t in = planes.empty() ? 0 : divided.planes[static_cast<size_t>(pair.first)];
    if (pair.second >= 0)
      type.pull =
          pull[static_cast<size_t>(pair.second)] * part_beside(in) / material_mass(scene.rule, pair.first);
    type.gravity = gravity + type.pull;
    keep_in_planes(planes, in, type);
    index = scene.rule.types.size();
    scene.rule.types.push_back(std::move(type));
  }
  bool pd = false;
  body.type.resize(body.size());
  for (size_t i = 0; i < body.size(); ++i) {
    const size_t index = occurring.at({material[i], constraint[i]});
    body.type[i] = static_cast<uint8_t>(index);
    const ParticleType& type = scene.rule.types[index];
    pd = pd || type.pd;
    for (size_t a = 0; a < 3; ++a)
      if (type.imposed[a]) body.v[i][a] = type.velocity[a];
  }
  if (pd) body.u.assign(body.size(), Vec3::Zero());
  if (planes.empty()) return named.size();
  divided.whole.types = scene.rule.types;
  scene.whole = std::make_shared<const Rule>(std::move(divided.whole));
  return named.size();
}

}  // namespace cuboct
