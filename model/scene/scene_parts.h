// SPDX-License-Identifier: MIT
// The parts of reading a scene, in the order in which they are read. Each takes the file's root table and
// what the parts before it found, and throws InputError.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/atoms/bond_order/crystal_rest.h"
#include "model/base/error_parts.h"
#include "model/body/grains.h"
#include "model/body/packing.h"
#include "model/body/regions.h"
#include "model/config/config.h"
#include "model/rules/reference_bonds.h"
#include "model/scene/scene.h"

namespace cuboct {

inline constexpr Quantity kVolume{{{0, 3, 0, 0}}, "a volume", "2 mm^3"};

class RoundsRule;        // model/rules/rounds_rule.h
struct ParticleFileBox;  // model/body/particle_file.h

struct GrainChoice {
  Grains grains;
  ConfigTable table;
};

// [packing]. Absent where all particles are listed.
struct PackingChoice {
  Fcc fcc;  // pitch 0: "relaxed", to be found from the law
  std::array<std::optional<Vec3>, 3>
      along;  // crystal directions along x, y, z in least integers, where they are such
  std::shared_ptr<const GrainChoice> grains;  // null: one crystal

  // Whether the crystal has to repeat after the period of an axis.
  bool repeats_by_crystal(size_t axis) const {
    return !grains || grains->grains.column_axis == static_cast<int>(axis);
  }
};
std::optional<PackingChoice> read_packing(const ConfigTable& root);

// [crystal]. Absent in scenes of a packing, or where all particles are listed.
struct CrystalChoice {
  AtomLattice lattice = AtomLattice::diamond;
  double bond = 0;  // m, between nearest neighbours; 0: "relaxed", to be found from the potential
  Vec3 offset = Vec3::Zero();
  bool turned = false;  // graphene: zigzag rows along y
  ConfigTable table;

  double edge(size_t axis) const;  // m, of the cell that repeats
  bool repeats(size_t axis) const { return axis < 2 || lattice == AtomLattice::diamond; }
};
std::optional<CrystalChoice> read_crystal(const ConfigTable& root);
// Positions of [crystal] in [box] and [geometry], and the axes that repeat. Fills scene.body and .periodic.
void place_crystal(const ConfigTable& root, const Regions& regions, const CrystalChoice& crystal,
                   Scene& scene);

// The table of the stage that is chosen, as one of its parts.
class StagePart : public ConfigTable {
 public:
  StagePart(ConfigTable table, size_t part, size_t parts)
      : ConfigTable(std::move(table)), part_(part), parts_(parts) {}

  // Parts before this one, and all.
  size_t part() const { return part_; }
  size_t parts() const { return parts_; }
  // A vector, or the ramp { from, to } in the middle of this part. All parts are equally long: the integral
  // over the stage is that of the straight line.
  Vec3 vector_of(const ConfigValue& value, const Quantity& quantity) const;
  // Once all is read: parts without a ramp are a mistake.
  void check_ramps() const;

 private:
  size_t part_, parts_;
  mutable bool ramps_ = false;
};

// The stiffness in N/m of the nearest-neighbour bond that gives an FCC packing the Young's modulus `modulus`
// (Pa) for a pull along the crystal direction n. With bonds between nearest neighbours alone, at rest, of
// stiffness k, the elastic constants are C_abcd = k pitch^2/(2V) sum over the 12 bonds of e_a e_b e_c e_d, V
// = pitch^3/sqrt(2), so C11 = 2c, C12 = C44 = c with c = k/(sqrt(2) pitch). For a cubic crystal 1/E = S11 - 2
// (S11 - S12 - S44/2) J, J = nx^2 ny^2 + ny^2 nz^2 + nz^2 nx^2 (J. F. Nye, Physical Properties of Crystals,
// 1957, ch. VIII), and here S11 = 3/(4c), S12 = -1/(4c), S44 = 1/c: 1/E = (3/4 - J)/c.
double stiffness_from_modulus(double modulus, const Vec3& direction, double pitch);

// [law]. Sets packing->fcc.pitch where it was "relaxed".
std::shared_ptr<const PairLaw> read_law(const ConfigTable& root, PackingChoice* packing);
// A [law] table, or the `law` of a bond.
std::shared_ptr<const PairLaw> read_law_table(const ConfigTable& table, PackingChoice* packing);
// Sets the pitch where it was "relaxed": that without pressure, found from the law's rest distance.
void relax_pitch(const ConfigValue& value, const PairLaw& law, PackingChoice& packing);
// That a packing of this pitch may have the law. `must_vanish`: it is to be at rest.
void check_at_pitch(const ConfigValue& value, const PairLaw& law, double pitch, bool must_vanish);
// [rule], in the place of [law]: a rule of several rounds, which is made when the body is read, or a pair
// law.
struct RuleChoice {
  double reach = 0;  // m
  // InputError where the scene has what the rule cannot do.
  std::function<std::shared_ptr<const RoundsRule>(const ConfigTable& root, const Regions&, const Scene&)>
      make;
  std::shared_ptr<const PairLaw> law{};  // not null: the rule is a pair law, and makes nothing else
};
// Sets crystal->bond where it was "relaxed", and packing->fcc.pitch for a pair law.
std::optional<RuleChoice> read_rule(const ConfigTable& root, PackingChoice* packing, CrystalChoice* crystal);
// Its kinds.
RuleChoice read_lps_rule(const ConfigTable& table, const PackingChoice* packing);
RuleChoice read_tersoff_rule(const ConfigTable& table, CrystalChoice* crystal);
// Its list `slit`, which bonds of the body as packed do not pass.
std::vector<Slit> read_slits(const ConfigTable& rule);
// A rule as text: the path of its file, or a table that has its parts. `no_law` fails where it may be none
// but a pair law, and is not one. `regions`: their names, which starts may use.
RuleChoice read_program_rule(const ConfigValue& rule, const PackingChoice* packing,
                             const std::vector<std::string>& regions, const std::function<void()>& no_law);
// What no rule of rounds can do.
void check_rounds_body(const ConfigTable& root, const Scene& scene);

// What `make` makes; an error of it that knows no file gets the place of `value`.
template <typename Make>
auto placed_at(const ConfigValue& value, Make make) {
  try {
    return make();
  } catch (const InputError& error) {
    if (error.place() != nullptr) throw;
    const ErrorParts parts = parts_of(error);
    value.fail(parts.message, parts.hint);
  }
}

// The largest of strength |df/dr| over the pairs of materials, from the pitch (0: the law's core) to the
// cutoff, N/m, from 4096 samples.
double largest_stiffness(const Rule& rule, double pitch);

// After what the sites of a packing or a crystal repeat.
struct SitePeriods {
  // m, of a cell along an axis; fails at `cells` where there is none.
  std::function<double(size_t axis, const ConfigValue& cells)> edge;
  std::function<bool(size_t axis, double extent)> repeats;
};
// The box of [periodic] or `cells`; the second marks the axes that repeat. `sites`: null where all particles
// are listed.
// `file`: that of a file of particles, from which `size`, `origin` and `periodic` come where they are not
// given.
std::pair<Periodic, std::array<bool, 3>> read_box(const ConfigTable& root, const SitePeriods* sites,
                                                  const ParticleFileBox* file = nullptr);

// `deform` of [box], or of the stage in its place: axes that repeat alone. Before scene.steps are known.
void read_deform(const ConfigTable& root, const StagePart* stage, const SceneChoice& choice, Scene& scene);
// The box's strain, counted from the box as packed, after `time` (s): 0 where it keeps its lengths.
Vec3 asked_strain(const Scene& scene, double time);
// As begin_box (model/scene/scene.h), of a box that may begin elsewhere: where it ends is not yet known.
void set_box(Scene& scene, const Vec3& strain);

// Everything that gives particles: positions and velocities ([packing], [crystal], [geometry], [particles],
// [[particle]], [[velocity]]), their materials and constraints. Fills scene.body, scene.rule.types and
// .strength, and with planes of symmetry scene.whole. scene.rule needs law, damping and mass. `stage`: whose
// keys replace those of the root. How many particles are listed, the last of all: those of [particles] and
// [[particle]].
size_t read_body(const ConfigTable& root, const StagePart* stage, const Regions& regions,
                 const PackingChoice* packing, const CrystalChoice* crystal, Scene& scene);

// The largest stable time step of the perfect packing in s, 0 if unknown. With all frequencies up to w and
// all damping rates up to g (rates of the matrices K/m and C/m) the update v += -dt (K/m x + C/m v), x += dt
// v has the mode equation z^2 - (2 - g dt - w^2 dt^2) z + 1 - g dt = 0, stable while 2 g dt + w^2 dt^2 < 4;
// both at their largest bound dt by (sqrt(g^2 + 4 w^2) - g)/w^2, which is 2/w where nothing damps.
// Of several laws the stiffest decides: no composite of them vibrates faster. `tolerance`: that of
// largest_frequency.
double stable_time_step(const Rule& rule, double pitch, double tolerance = 1e-14);
// The same where each law has a packing of its own pitch, as where no packing is given.
double stable_time_step(const Rule& rule, const std::function<double(const PairLaw&)>& pitch,
                        double tolerance = 1e-14);

void read_probes(const ConfigTable& root, const Regions& regions, Scene& scene);

// stages_of() a file that is read.
std::vector<StageName> stage_names(const ConfigTable& root);
// [start].
void read_start(const ConfigTable& root, const SceneChoice& choice, Scene& scene);
// The stage that is chosen; none where the file has none.
std::optional<StagePart> read_stage(const ConfigTable& root, const SceneChoice& choice, Scene& scene);
// `static` of [run] or of a stage, over scene.steps, which become whole load steps; none for `static =
// false`.
std::optional<StaticLoading> read_static(const ConfigTable& table, Scene& scene);
// `until` of [run] or of a stage. scene.probes are read.
std::optional<Until> read_until(const ConfigTable& table, const Scene& scene);

}  // namespace cuboct
