// SPDX-License-Identifier: MIT
// What a user writes, resolved to SI units: particles, rule, what to measure and for how long.
// docs/user/scene.md is the reference of the file format.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "model/base/mat3.h"
#include "model/base/places.h"
#include "model/body/mesh.h"
#include "model/contract/box_deformation.h"
#include "model/contract/rule.h"

namespace cuboct {

inline constexpr double kBoltzmann = 1.380649e-23;  // J/K, exact: the SI defines the kelvin by it

// Of temperatures: in reduced units k_B is 1, and they are energies.
inline const char* temperature_unit(double boltzmann) { return boltzmann == 1 ? "J" : "K"; }

// A named set of particles (by id, ascending): those whose initial position lies in the probe's region.
struct ParticleSet {
  std::string name;
  std::vector<uint32_t> ids;
};

// What a datasheet says of a material in tension; what it does not say is 0.
struct Datasheet {
  double modulus = 0;          // Pa
  double strength = 0;         // Pa
  double yield_strain = 0;     // at the strength
  double strain_at_break = 0;  // elongation of the gauge length
  std::string source;
};

// What to measure every `probe_every` steps. Curves are named "<probe>.<quantity>".
struct Probe {
  enum class Kind : uint8_t {
    force,           // total pair force on a set, N: force_x, force_y, force_z; or force, along an axis
    displacement,    // mean displacement of a set from its initial mean position, m: x, y, z; or along
    stress_strain,   // two sets and an axis: strain = change of the distance between their means along it
                     // over its initial value; stress = pull on `grip` along the axis over `area`, Pa
    crack,           // broken bonds of a set: broken, length (m), speed (m/s), energy (J)
    velocity,        // mean of a set, m/s: velocity_x, velocity_y, velocity_z; or velocity, along an axis
    kinetic_energy,  // of a set, J
    temperature,     // of the motion of a set about its mean velocity
    field,           // mean of a field of the rule over a set: its name, of a vector with _x, _y, _z
    stress,          // of a set, or of all particles, Pa: xx, yy, zz, xy, xz, yz; of all also the box's
                     // strain: strain_x, strain_y, strain_z
  };
  Kind kind = Kind::force;
  std::string name;
  ParticleSet set;           // all but stress_strain; of a temperature those that nothing holds or leads
  ParticleSet lower, upper;  // stress_strain: gauge marks
  ParticleSet grip;          // stress_strain: whose force counts, on the side of `upper`
  Vec3 axis = Vec3::Zero();  // unit length; 0: forces, displacements and velocities give three components
  double area = 0;           // m^2
  // kinetic_energy: over the sum of v^2. temperature: over the sum of (v - mean)^2, m/(g k_B) with g degrees
  // of freedom.
  double scale = 0;
  // The masses of the set's particles over rule.mass, where they differ: factors of v^2 and of the mean.
  std::vector<double> relative;
  std::string unit;  // of temperature: K, in reduced units J; of a field
  // What its curves in integers may be off by, over their size (model/analysis/probe_error.h); 0: not asked.
  double accuracy = 0;
  // field: its name, which of the declaration's `shown` it is, and how many numbers it has.
  std::string field;
  size_t field_at = 0;
  int numbers = 1;
  // stress: of all particles; with the part of their motion; the volume of the set, m^3, or 0: its share of
  // the box's.
  bool whole = false, kinetic = true;
  double volume = 0, share = 1;
  std::optional<Datasheet> datasheet;  // stress_strain: what the material is said to show
  // crack:
  double bond_length = 0;            // m, particles that begin nearer to each other have a bond
  std::optional<double> start;       // m along the axis, from where the length counts; none: the crack's end
  bool from_start = false;           // bonds are those of where the run begins, not of the packing
  std::vector<Vec3> begin;           // m, where the set's particles are then; empty: as packed
  size_t window = 0;                 // readings over which the speed is taken
  std::vector<uint8_t> types;        // of the set's particles
  std::shared_ptr<const Rule> rule;  // of the scene
};

// Where a run ends before its last step: at the first reading of a probe that is beyond a limit.
struct Until {
  enum class Side : uint8_t { above, below, beyond };  // beyond: by its magnitude
  std::string curve;                                   // "tip.along"
  Side side = Side::above;
  double limit = 0;    // in the curve's unit
  uint64_t after = 0;  // readings count behind this step

  bool holds(double value) const {
    return side == Side::above   ? value >= limit
           : side == Side::below ? value <= limit
                                 : std::abs(value) >= limit;
  }
  const char* side_name() const {
    return side == Side::above ? "above" : side == Side::below ? "below" : "beyond";
  }
};

// Quasi-static loading: constraints move on by a load step, then the body relaxes to a minimum of its energy,
// and so on. No motion lies between.
struct StaticLoading {
  uint64_t every = 1;        // time steps of the scene that make a load step
  double tolerance = 1e-3;   // of the load: the residual of docs/user/scene.md, [run]
  uint64_t evaluations = 0;  // of forces, at most, per load step
  // The least multiple of `every` that is no less.
  uint64_t whole(uint64_t steps) const { return (steps + every - 1) / every * every; }
};

// The run whose last state a scene begins with.
struct Began {
  std::string from, engine;
  uint64_t step = 0;
};

// What [box] or a stage asks of the box: strains count from the box as packed.
struct AskedDeformation {
  Vec3 rate = Vec3::Zero();          // 1/s, engineering
  std::optional<Vec3> final_strain;  // at the end, and of a stage's parts at the end of the last; else `rate`
  uint64_t steps = 0;                // until then
};

struct Scene {
  std::string path;  // as given
  std::string text;  // of the file
  std::string title;
  std::string stage;  // of [[stage]], whose keys replace others; empty: the scene has none
  std::string start;  // a run's directory, as [start] says; empty: the run begins with the packing
  std::optional<Began> began;
  Rule rule;
  Body body;                           // as the run begins
  std::shared_ptr<const Body> packed;  // as the scene packs it, where the run begins elsewhere
  Periodic periodic;                   // as the run begins
  std::optional<AskedDeformation> asked_deform;
  std::optional<BoxDeformation>
      deform;        // where the box changes its lengths, or begins with others than packed
  double pitch = 0;  // m, nearest-neighbour distance of the packing; 0 where particles are listed singly
  Mat3 orientation = Mat3::Identity();  // columns: the packing's cubic axes in scene coordinates; of many
                                        // grains those of one that is not turned
  size_t grains = 0;                    // of the packing; 0: one crystal, or none
  std::vector<MeshFacts> meshes;        // that shapes are made of
  bool thermal = false;                 // some velocities are drawn
  double boltzmann = kBoltzmann;        // J/K; 1 in reduced units
  double density = 0;                   // kg/m^3, at the top of the file; 0 if it is not given
  std::shared_ptr<const Rule> whole;    // with [[symmetry]]: as if particles in planes were whole; else null
  double dt_limit = 0;      // s, largest stable dt: of the perfect packing, and of the vibrations of
                            // particles that are listed (docs/user/scene.md, [run]); 0 if unknown
  std::string dt_limit_of;  // what sets it, e.g. "the perfect packing"
  double dt_safety = 0;     // dt = dt_safety * dt_limit where dt was "auto", else dt / dt_limit
  Vec3 reach_margin =
      Vec3::Constant(-1);  // m, space around the body that particles may reach; negative: one cell edge
  std::array<Vec3, 2> reach{Vec3::Zero(),
                            Vec3::Zero()};  // m, an extra box that particles may reach; empty if equal
  // What the formats of a fixed rule are chosen by: no imposed velocity, gravity or gain may be off by more,
  // and the strain that is expected has so many units of a difference.
  double accuracy = 1e-3;
  double expected_strain = 0;  // 0: what the scene's motion tells (model/analysis/motion.h)
  std::vector<Probe> probes;
  uint64_t steps = 0;
  uint64_t planned_steps = 0;  // cells and formats are those of a run of so many steps, where they are more
  uint64_t probe_every = 0;    // 0: never
  uint64_t energy_every = 0;   // a multiple of probe_every; 0: first and last only
  uint64_t frame_every = 0;    // 0: first and last only
  std::optional<Until> until;
  std::optional<StaticLoading> loading;  // probes and frames are then those of whole load steps
  Places places;                         // of the file's keys

  // What regions, displacements and strains count from.
  const Body& packing() const { return packed ? *packed : body; }
  const Periodic& packing_box() const { return deform ? deform->packed : periodic; }

  // s, that cells and formats must hold.
  double planned_duration() const { return static_cast<double>(std::max(steps, planned_steps)) * rule.dt; }

  bool deforms() const { return deform && deform->moves(); }
  Periodic box_at(uint64_t step) const { return deform ? deform->at(step) : periodic; }
};

// The scene's box begins with this strain of the box as packed, and goes on from there as it is asked to.
// InputError where it becomes too short for the rule before the run ends.
void begin_box(Scene& scene, const Vec3& strain);
// Why the rule cannot run in the box of a step; empty: it can.
std::string box_fault(const Scene& scene, uint64_t step);

// m: particles of the packing that begin nearer than this to each other are nearest neighbours, (1 + sqrt
// 2)/2 pitches lies between the first and the second shell. Without a packing the cutoff.
double first_shell(const Scene& scene);

// Axes along which particles can come to differ in their motion. Of a flat sheet and of a straight chain none
// can along some: pairs then have no force along it.
std::array<bool, 3> live_axes(const Scene& scene);

// A stage as it runs. One with `parts` is so many, "load-1", "load-2": its ramps have one value in each.
struct StageName {
  std::string name;   // "load-2"
  std::string stage;  // "load"
  size_t part = 0, parts = 1;
};

// What of a file is read. Without `begins` a file with [start] or [[stage]] is refused: such scenes are for
// those who put the particles where another run left them (model/run/start.h).
struct SceneChoice {
  bool begins = false;
  std::string stage;  // required where the file has stages
};

// Throws InputError with file:line:column.
Scene read_scene(const std::string& path, const SceneChoice& choice = {});
// The same for text in memory; `path` stands in messages.
Scene parse_scene(const std::string& text, const std::string& path, const SceneChoice& choice = {});
// The file's stages and their parts, in the order in which they run.
std::vector<StageName> stages_of(const std::string& path);

}  // namespace cuboct
