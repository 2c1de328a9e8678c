// SPDX-License-Identifier: MIT
// [rule] kind = "tersoff": a published set by its name, or an element of a file of LAMMPS.
#include <fmt/format.h>

#include <cmath>

#include "model/rules/tersoff_rule.h"
#include "model/scene/scene_parts.h"

namespace cuboct {
namespace {

struct Potential {
  std::string name;
  Tersoff tersoff;  // eV and angstrom
};

Potential read_potential(const ConfigTable& table) {
  table.not_both("potential", "file");
  if (const auto file = table.find("file")) {
    const std::string path = file->file();
    const std::vector<std::string> elements = placed_at(*file, [&] { return tersoff_elements(path); });
    const std::string element = elements[table.at("element").choice("element", elements)];
    return {file->string(), placed_at(*file, [&] { return read_tersoff(path, {element}); })};
  }
  if (const auto element = table.find("element"))
    element->fail("'element' is of a 'file': a set by its name has one element");
  const std::vector<std::string> names = tersoff_set_names();
  const std::string name = names[table.at("potential").choice("potential", names)];
  return {name, tersoff_set(name)};
}

CrystalRest rest_or_none(const Tersoff& tersoff, AtomLattice lattice) {
  try {
    return crystal_rest(tersoff, lattice);
  } catch (const std::runtime_error&) {
    return {};
  }
}

// Of atoms that are listed one by one the stiffer of both lattices, whose long waves are no one's.
CrystalRest rest_of(const Tersoff& tersoff, CrystalChoice* crystal) {
  if (crystal == nullptr) {
    CrystalRest rest;
    for (const AtomLattice lattice : {AtomLattice::graphene, AtomLattice::diamond})
      rest.curvature = std::max(rest.curvature, rest_or_none(tersoff, lattice).curvature);
    return rest;
  }
  const CrystalRest rest = rest_or_none(tersoff, crystal->lattice);
  if (crystal->bond > 0) return rest;
  if (rest.bond == 0)
    crystal->table.at("lattice").fail("under this potential the lattice has no size without pressure",
                                      "give 'bond'");
  crystal->bond = rest.bond * kAngstrom;
  return rest;
}

// An atom would meet two images of another, or itself.
void check_box(const ConfigTable& root, double cutoff, const Scene& scene, const CrystalChoice* crystal) {
  for (int a = 0; a < 3; ++a) {
    const double extent = scene.periodic.extent[a];
    if (extent == 0 || extent >= 2 * cutoff) continue;
    const ConfigTable box = root.at("box").table();
    const char axis = "xyz"[a];
    box.at(box.has("cells") ? "cells" : "size")
        .fail(fmt::format("the box repeats after {:.4g} m along {}, less than two cutoffs of {:.4g} m",
                          extent, axis, cutoff),
              crystal == nullptr
                  ? fmt::format("{:.4g} m or more along {}", 2 * cutoff, axis)
                  : fmt::format("{:.0f} cells or more along {}",
                                std::ceil(2 * cutoff / crystal->edge(static_cast<size_t>(a))), axis));
  }
}

}  // namespace

RuleChoice read_tersoff_rule(const ConfigTable& table, CrystalChoice* crystal) {
  const Potential potential = read_potential(table);
  table.done();
  const CrystalRest rest = rest_of(potential.tersoff, crystal);
  const double cutoff = potential.tersoff.cutoff() * kAngstrom;
  return {cutoff, [=](const ConfigTable& root, const Regions&, const Scene& scene) {
            check_rounds_body(root, scene);
            check_box(root, cutoff, scene, crystal);
            return tersoff_rule(potential.name, potential.tersoff, rest);
          }};
}

}  // namespace cuboct
