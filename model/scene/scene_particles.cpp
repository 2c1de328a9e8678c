// SPDX-License-Identifier: MIT
// [particles]: those that a file holds. Units, materials and the box are settled here;
// model/body/particle_file.h reads the file.
#include "model/scene/scene_particles.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "model/base/error.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

constexpr double kSameUnit = 1e-6, kSameSize = 1e-6;

// "angstrom", or "3.405 angstrom" where one of the file's is no unit.
double one_of(const ConfigTable& table, const char* key, const Quantity& quantity) {
  const ConfigValue value = table.at(key);
  if (!value.is_string()) return value.number(quantity, Range::positive());
  const std::string text = value.string();
  const bool number =
      !text.empty() && (std::isdigit(static_cast<unsigned char>(text[0])) != 0 || text[0] == '.');
  return number ? value.number(quantity, Range::positive()) : value.unit(quantity);
}

// As the file states them; what it does not state is 0. `reduced`: it says that they are.
struct StatedUnits {
  ParticleUnits units;
  bool reduced = false;
};

StatedUnits stated_units(const ParticleFile& file) {
  StatedUnits stated;
  stated.reduced = file.style == "lj" || file.length_unit == "reduced";
  const std::vector<std::string>& names = particle_unit_names();
  if (const auto name = std::ranges::find(names, file.style); name != names.end())
    stated.units = particle_units(static_cast<size_t>(name - names.begin()));
  const auto value = [](const std::string& unit, const Quantity& quantity) {
    try {
      const ParsedQuantity one = parse_quantity("1 " + unit);
      return !one.list && one.dimension == quantity.dimension ? one.values[0] : 0.0;
    } catch (const UnitError&) {
      return 0.0;
    }
  };
  if (!file.length_unit.empty()) stated.units.length = value(file.length_unit, quantity::length);
  if (!file.velocity_unit.empty()) stated.units.velocity = value(file.velocity_unit, quantity::velocity);
  return stated;
}

ParticleUnits given_units(const ConfigValue& key) {
  if (key.is_string()) {
    if (key.reduced())
      key.fail("the scene's units are reduced: no named ones are theirs",
               "units = { length = 1, velocity = 1 } says what one of the file's is here");
    return particle_units(key.choice("units", particle_unit_names()));
  }
  const ConfigTable table = key.table();
  table.record_as("particles");
  ParticleUnits units{one_of(table, "length", quantity::length), 0, 0};
  if (table.has("velocity")) units.velocity = one_of(table, "velocity", quantity::velocity);
  table.done();
  return units;
}

void check_stated(const ConfigValue& key, const StatedUnits& stated, const ParticleUnits& given) {
  const auto check = [&](double says, double is, const char* of, const char* unit) {
    if (says > 0 && is > 0 && std::abs(is / says - 1) > kSameUnit)
      key.fail(fmt::format("the file states that its unit of {} is {:.7g} {}, and 'units' says {:.7g} {}", of,
                           says, unit, is, unit),
               "leave 'units' out");
  };
  if (key.reduced()) return;
  check(stated.units.length, given.length, "length", "m");
  check(stated.units.velocity, given.velocity, "velocity", "m/s");
}

ParticleUnits units_of(const ConfigTable& table, const ParticleFile& file) {
  const StatedUnits stated = stated_units(file);
  if (const auto key = table.find("units")) {
    const ParticleUnits given = given_units(*key);
    check_stated(*key, stated, given);
    return given;
  }
  const ConfigValue at = table.at("file");
  if (table.reduced() && (stated.reduced || stated.units.length == 0)) return {1, 1, 1};
  if (table.reduced())
    at.fail(
        fmt::format("the file states that its unit of length is {:.7g} m, and the scene's units are reduced",
                    stated.units.length),
        "units = { length = 1, velocity = 1 } says what one of the file's is here");
  if (stated.reduced)
    at.fail("the file states that its units are reduced, and those of the scene are not",
            "units = { length = \"3.405 angstrom\", velocity = \"157 m/s\" } says what one of the file's is");
  if (stated.units.length == 0)
    at.fail("the file states no units",
            "units = \"metal\" is angstrom and angstrom/ps, \"ase\" angstrom and ASE's velocities; or "
            "units = { length = \"nm\", velocity = \"nm/ps\" }");
  return stated.units;
}

// Which material each kind is; empty: regions say it.
std::vector<int> materials_of(const ConfigTable& table, const ParticleFile& file,
                              const std::vector<std::string>& materials) {
  std::vector<int> of;
  if (const auto key = table.find("materials")) {
    const ConfigTable map = key->table();
    map.record_as("names");
    const std::vector<std::string> named = map.names();
    for (const std::string& kind : file.kinds) {
      if (std::ranges::find(named, kind) == named.end())
        key->fail(fmt::format("no material for '{}', which the file has", line_text(kind)),
                  fmt::format("'{}' = \"{}\"", line_text(kind), materials[0]));
      of.push_back(static_cast<int>(map.at(kind).choice("material", materials)));
    }
    if (file.kinds.empty()) key->fail("the file tells no species");
    for (const std::string& name : named)
      if (std::ranges::find(file.kinds, name) == file.kinds.end())
        map.at(name).fail(
            fmt::format("the file has no '{}'", line_text(name)),
            fmt::format("it has {}", line_text(fmt::format("{}", fmt::join(file.kinds, ", ")))));
    return of;
  }
  if (materials.size() == 1) return std::vector<int>(file.kinds.size(), 0);
  // Blanks of names are '_' in frames.
  const auto material = [&](const std::string& kind) {
    const auto found = std::ranges::find_if(
        materials, [&](const std::string& name) { return name == kind || xyz_word(name) == kind; });
    return found == materials.end() ? -1 : static_cast<int>(found - materials.begin());
  };
  for (const std::string& kind : file.kinds) of.push_back(material(kind));
  if (file.kinds.size() == 1 && of[0] < 0) return {};
  for (size_t k = 0; k < of.size(); ++k)
    if (of[k] < 0)
      table.at("file").fail(
          fmt::format("the file has '{}', and no material of the scene has that name",
                      line_text(file.kinds[k])),
          fmt::format("materials = {{ '{}' = \"{}\" }}", line_text(file.kinds[k]), materials[0]));
  return of;
}

ParticleFile file_of(const ConfigTable& table, bool box) {
  const ConfigValue path = table.at("file");
  ParticleFileChoice choice;
  choice.box = box;
  if (table.has("frame")) choice.frame = static_cast<uint64_t>(table.at("frame").integer(0, INT64_MAX));
  const auto style = table.find("atom_style");
  if (style) choice.atom_style = particle_atom_styles()[style->choice("atom style", particle_atom_styles())];
  try {
    ParticleFile file = placed_at(path, [&] { return read_particle_file(path.file(), choice); });
    if (style && !file.data) style->fail("'atom_style' is of LAMMPS's data files, and this is extended XYZ");
    return file;
  } catch (const NoSuchFrame& none) {
    table.at("frame").fail(
        none.frames == 1 ? std::string("the file has one frame, 0")
                         : fmt::format("the file has {} frames, from 0 to {}", none.frames, none.frames - 1));
  } catch (const UnknownAtomStyle& unknown) {
    path.fail(
        fmt::format("its section Atoms does not say which atom style it has: {} columns are those of {}",
                    unknown.columns, fmt::join(unknown.styles, ", ")),
        fmt::format("atom_style = \"{}\"", unknown.styles[0]));
  }
}

}  // namespace

std::optional<FileParticles> read_file_particles(const ConfigTable& root, bool packed,
                                                 const std::vector<std::string>& materials) {
  const auto table = root.table_at("particles");
  if (!table) return std::nullopt;
  const bool box = table->boolean_or("box", true) && !packed;
  FileParticles of{*table, file_of(*table, box), {}, {}};
  of.units = units_of(*table, of.file);
  ParticleFile& file = of.file;
  if (!table->boolean_or("velocities", true)) file.v.clear(), file.momenta = false;
  if (!file.v.empty() && !file.momenta && of.units.velocity == 0)
    table->at("file").fail("the file has velocities, and nothing says their unit",
                           "units = { length = ..., velocity = ... }; 'velocities = false' leaves them out");
  of.material = materials_of(*table, file, materials);
  table->done();
  const auto in_units = [&](double value, double unit, size_t at) {
    if (!std::isfinite(value * unit))
      file.text->fail(at, "this is larger than any number that can be computed with");
    return value * unit;
  };
  for (size_t i = 0; i < file.size(); ++i)
    for (double& c : file.x[i]) c = in_units(c, of.units.length, file.at[i]);
  if (!file.momenta)
    for (size_t i = 0; i < file.v.size(); ++i)
      for (double& c : file.v[i]) c = in_units(c, of.units.velocity, file.at[i]);
  if (file.box) {
    file.box->low *= of.units.length, file.box->extent *= of.units.length;
    for (size_t a = 0; a < 3; ++a)
      if (file.box->periodic[a] && !(file.box->extent[a] > 0))
        file.text->fail(file.box->at,
                        fmt::format("the box repeats along {}, and has no length there", "xyz"[a]),
                        "'box = false' leaves it out");
  }
  return of;
}

void check_box_size(const ConfigValue& size, const ParticleFileBox& box, const Vec3& extent,
                    const std::array<bool, 3>& periodic) {
  for (int a = 0; a < 3; ++a)
    if (periodic[static_cast<size_t>(a)] && std::abs(extent[a] / box.extent[a] - 1) > kSameSize)
      size.fail(fmt::format("the box is {:.9g} m along {}, and that of the particles' file {:.9g} m",
                            extent[a], "xyz"[a], box.extent[a]),
                "without 'size' it is the file's; [particles] 'box = false' leaves the file's out");
}

void place_file_particles(const FileParticles& of, Scene& scene) {
  const ParticleFile& file = of.file;
  Body& body = scene.body;
  body.x.reserve(body.x.size() + file.size()), body.v.reserve(body.v.size() + file.size());
  for (size_t i = 0; i < file.size(); ++i) {
    Vec3 x = file.x[i];
    for (int a = 0; a < 3; ++a) {
      const double low = scene.periodic.origin[a], extent = scene.periodic.extent[a];
      if (!(extent > 0) || (x[a] - low >= 0 && x[a] - low < extent)) continue;
      if (!file.box)
        file.text->fail(file.at_axis(i, a),
                        fmt::format("the particle is outside the scene's periodic box along {}", "xyz"[a]),
                        fmt::format("[box] is from {:.9g} m to {:.9g} m there, and the particle at {:.9g} m",
                                    low, low + extent, x[a]));
      x[a] -= extent * std::floor((x[a] - low) / extent);
      if (!(x[a] - low >= 0 && x[a] - low < extent)) x[a] = low;  // a last bit below the box
    }
    body.x.push_back(x);
    body.v.push_back(file.v.empty() || file.momenta ? Vec3::Zero() : file.v[i]);
  }
}

void check_file_masses(const FileParticles& of, const std::vector<int>& material, size_t first,
                       const Scene& scene, const std::vector<std::string>& names) {
  constexpr double kOff = 0.01;  // tables of atomic masses differ by less
  const ParticleFile& file = of.file;
  const bool reduced = of.table.reduced();
  // Column `masses` is ASE's word: u. It is no unit of a reduced scene, unless the file says that it is.
  const double ase = !reduced ? particle_units(0).mass : stated_units(file).reduced ? 1 : 0;
  const double unit = file.data ? of.units.mass : ase;
  if (unit == 0 || (file.mass.empty() && file.kind_mass.empty())) return;
  for (size_t i = 0; i < file.size(); ++i) {
    const double there = unit * (file.mass.empty() ? file.kind_mass[file.kind[i]] : file.mass[i]);
    const int m = material[first + i];
    const double here =
        scene.rule.masses.empty() ? scene.rule.mass : scene.rule.masses[static_cast<size_t>(m)];
    if (there > 0 && std::abs(there / here - 1) > kOff)
      file.text->fail(
          file.at[i],
          fmt::format("this particle has the mass {:.6g}{} in the file, and {:.6g}{} as '{}' of the scene",
                      there, reduced ? "" : " kg", here, reduced ? "" : " kg",
                      line_text(names[static_cast<size_t>(m)])),
          "the scene's 'mass' counts: let both agree to 1 %");
  }
}

void take_momenta(const FileParticles& of, const std::vector<int>& material, size_t first, Scene& scene) {
  const ParticleFile& file = of.file;
  if (!file.momenta) return;
  const bool reduced = of.table.reduced();
  const double momentum = reduced ? 1 : ase_momentum(), mass_unit = reduced ? 1 : particle_units(0).mass;
  for (size_t i = 0; i < file.size(); ++i) {
    const auto m = static_cast<size_t>(material[first + i]);
    const double own = scene.rule.masses.empty() ? scene.rule.mass : scene.rule.masses[m];
    const double mass = file.mass.empty() ? own : file.mass[i] * mass_unit;
    scene.body.v[first + i] = file.v[i] * (momentum / mass);
    if (!scene.body.v[first + i].allFinite())
      file.text->fail(file.at[i],
                      "the velocity of this particle is larger than any number that can be computed with");
  }
}

}  // namespace cuboct
