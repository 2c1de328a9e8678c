// SPDX-License-Identifier: MIT
#include "model/config/foreign_words.h"

#include <fmt/format.h>

namespace cuboct {
namespace {

constexpr std::string_view kMatter = "law rule bond material damping constraint run";

constexpr ForeignWord kKeys[] = {
    {"poissons_ratio poisson_ratio poisson nu", "law bond.law material",
     "a pair law has the ratio that its packing makes; [rule] kind = \"lps\" takes any", "forces"},
    {"angle angles dihedral dihedrals improper torsion bending bending_stiffness",
     "law rule bond material constraint run probe", "forces are of pairs: no term has an angle", "forces"},
    {"charge charges dielectric permittivity kspace kspace_style ewald pppm", "",
     "forces end at a cutoff; a rule of text has screened charges", "charges"},
    {"friction friction_coefficient mu", kMatter,
     "damping acts along the line between two particles; a rule of text has friction across it", "friction"},
    {"restitution", kMatter, "[damping] ratio takes energy from contacts", "friction"},
    {"thermostat nvt ensemble langevin andersen nose_hoover berendsen", "",
     "pair laws have no thermostat; the rules scenes/rules/langevin.toml and dpd.toml hold a temperature",
     "motion"},
    {"temperature", "run box packing law material constraint",
     "[[velocity]] temperature begins a run; the rules langevin and dpd hold a temperature", "motion"},
    {"rigid rigid_body", "", "no body is rigid; regions are held, or moved along a line", "motion"},
    {"angular_velocity rotate rotation spin omega torque frequency amplitude", "constraint stage.constraint",
     "a constraint moves along a line at a constant velocity; stages change it", "motion"},
    {"timestep time_step delta_t", "run stage", "the time step is 'dt'", ""},
    {"adaptive adaptive_dt dt_max dt_min max_dt min_dt", "run stage",
     "a run has one 'dt'; each stage may have its own", "motion"},
    {"engine threads precision integrator", "run stage",
     "an option of 'cuboct run' says how it is computed: --engine, --threads, --precision, --integrator", ""},
    {"barostat npt", "",
     "no box follows a pressure; a traction on faces presses a body, 'deform' strains a box", "the-box"},
    {"pressure", "run box packing",
     "no box follows a pressure; a traction on faces presses a body, 'deform' strains a box", "the-box"},
    {"strain_rate final_strain strain velocity erate final", "box",
     "deform = { strain_rate = ... } or deform = { final_strain = ... } changes the lengths", ""},
    {"trate wiggle vel delta scale volume tilt xy xz yz remap", "box",
     "lengths change at a constant engineering strain rate, and positions go with them", "the-box"},
    {"boundary", "", "[box] periodic = \"xy\" names the axes that repeat", "the-box"},
    {"thermal_expansion expansion conductivity thermal_conductivity heat_capacity specific_heat",
     "law bond.law material run", "pair laws know no heat; a rule of text does: scenes/rules/heat.toml",
     "heat"},
    {"lattice structure", "packing", "a packing is face-centred cubic; [particles] reads others from a file",
     "bodies"},
    {"dimension dimensions", "", "a flat scene is one layer of particles", "bodies"},
    {"pair_style pair_coeff bond_style", "", "[law] or [rule] has the forces: docs/user/scene.md", ""},
    {"nlist neighbor neighbors neighbour_list neigh_modify skin", "",
     "the engine chooses how it finds neighbours: nothing is to be set", ""},
    {"fix fixes", "", "[[constraint]] holds and moves regions, [damping] damps: docs/user/coming-from.md",
     ""},
    {"dump dumps", "", "[run] frame_every keeps frames; 'cuboct run --frames lammps' writes a dump", ""},
    {"frames output_every dump_every", "run stage", "'frame_every' is the number of steps between two frames",
     ""},
    {"E youngs", "law bond.law rule", "the key is 'youngs_modulus'", ""},
    {"rho", "", "the key is 'density'", ""},
};

constexpr ForeignWord kKinds[] = {
    {"eam embedded_atom", "law rule",
     "embedded atoms are a rule of text, as in scenes/rules/copper.toml: docs/user/rules.md", ""},
    {"heat", "law rule", "heat is a rule of text, as in scenes/rules/heat.toml: docs/user/rules.md", ""},
    {"plastic", "law rule",
     "springs that yield are a rule of text, as in scenes/rules/plastic.toml: docs/user/rules.md", ""},
    {"langevin dpd", "law rule",
     "a rule of text, as scenes/rules/langevin.toml and dpd.toml: docs/user/rules.md", ""},
    {"morse buckingham yukawa harmonic mie", "law rule",
     "a pair law of formulas is a rule of text: [law] kind = \"rule\", docs/user/rules.md", ""},
    {"coulomb coul ewald", "law rule", "forces end at a cutoff; a rule of text has screened charges",
     "charges"},
    {"hertz hertzian granular dem", "law rule",
     "contact = true in [[bond]] only pushes; a rule of text has friction", "friction"},
    {"meam reaxff sw stillinger_weber airebo snap", "law rule",
     "of many bodies there are Tersoff's bond order and embedded atoms", "forces"},
    {"lps peridynamic tersoff", "law", "[rule] has this kind, in the place of [law]", ""},
    {"rigid", "constraint", "no body is rigid; regions are held, or moved along a line", "motion"},
    {"thermostat langevin", "constraint",
     "pair laws have no thermostat; the rules scenes/rules/langevin.toml and dpd.toml hold a temperature",
     "motion"},
    {"pressure", "constraint", "kind = \"pulled\" has a traction over an area", ""},
    {"metal real cgs electron micro nano si", "units",
     "\"SI\": values carry their units, as \"300 K\"; [particles] units are those of a file", ""},
    {"lj", "units", "\"reduced\": all values are plain numbers", ""},
};

bool has_word(std::string_view list, std::string_view word) {
  while (!list.empty()) {
    const size_t end = list.find(' ');
    if (list.substr(0, end) == word) return true;
    list = end == std::string_view::npos ? std::string_view() : list.substr(end + 1);
  }
  return false;
}

}  // namespace

std::span<const ForeignWord> foreign_keys() { return kKeys; }
std::span<const ForeignWord> foreign_kinds() { return kKinds; }

std::string foreign_hint(std::span<const ForeignWord> list, std::string_view word, std::string_view table) {
  for (const ForeignWord& row : list) {
    if (!has_word(row.words, word)) continue;
    if (!row.tables.empty() && !has_word(row.tables, table)) continue;
    if (row.section.empty()) return std::string(row.instead);
    return fmt::format("{}: docs/user/limits.md#{}", row.instead, row.section);
  }
  return {};
}

}  // namespace cuboct
