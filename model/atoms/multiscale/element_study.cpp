// SPDX-License-Identifier: MIT
#include "model/atoms/multiscale/element_study.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "model/atoms/multiscale/mesh_file.h"
#include "model/atoms/multiscale/tersoff_law.h"
#include "model/base/atom_units.h"
#include "model/base/error.h"
#include "model/base/error_parts.h"
#include "model/base/hash.h"
#include "model/base/mat3.h"
#include "model/config/file_kind.h"

namespace cuboct {
namespace {

constexpr int64_t kMostCubes = 100, kMostSets = 1000;
constexpr double kMostStrain = 0.2, kLeastStrain = 1e-9, kMostTolerance = 0.01;
constexpr int kMostCells = 4, kMostRefine = 16;

uint64_t hash_of(const std::string& text, Hash hash = {}) {
  for (const char c : text) hash.add(c);
  return hash.value();
}

// Of an error's text: without its hint.
std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

int axis_of(const ConfigTable& table, const std::string& key) {
  return static_cast<int>(table.at(key).choice("axis", {"x", "y", "z"}));
}

// Parameters as papers print them: eV and angstrom, plain numbers.
Tersoff inline_parameters(const ConfigTable& table, const std::string& element) {
  TersoffTerm<double> t;
  const auto number = [&](const char* key) { return table.number(key, quantity::number); };
  t.A = number("A"), t.B = number("B"), t.lambda1 = number("lambda1"), t.lambda2 = number("lambda2");
  t.lambda3 = number("lambda3"), t.beta = number("beta"), t.n = number("n"), t.gamma = number("gamma");
  t.c = number("c"), t.d = number("d"), t.cos_theta0 = number("cos_theta0"), t.R = number("R"),
  t.D = number("D");
  t.m = static_cast<int>(table.integer_or("m", 1, 3, 3));
  try {
    return tersoff_of(element, t);
  } catch (const InputError& error) {
    table.fail(first_line(error.what()));
  }
}

Tersoff read_potential(const ConfigTable& table, std::string& name) {
  const std::string element = table.string_or("element", "Si");
  table.not_both("potential", "parameters");
  table.not_both("potential", "file");
  table.not_both("file", "parameters");
  if (const auto file = table.find("file")) {
    name = file->string();
    const std::string path = file->file();
    try {
      return read_tersoff(path, {element});
    } catch (const InputError& error) {
      if (error.place() != nullptr) throw;
      file->fail(first_line(error.what()));  // of the file as a whole
    }
  }
  if (const auto parameters = table.table_at("parameters")) {
    name = "parameters of the study";
    Tersoff out = inline_parameters(*parameters, element);
    parameters->done();
    return out;
  }
  const ConfigValue value = table.at("potential");
  const std::vector<std::string> names = tersoff_set_names();
  name = names[value.choice("potential", names)];
  return tersoff_set(name);
}

SpringInput read_springs(const ConfigTable& table, Crystal crystal, double edge) {
  SpringInput out;
  const auto constant = [&](const char* key) {
    return table.number(key, quantity::pressure, Range::positive());
  };
  out.c11 = constant("C11"), out.c12 = constant("C12"), out.c44 = constant("C44");
  table.done();
  out.fit = cauchy_fit(out.c11, out.c12, out.c44);
  try {
    out.springs = springs_of(crystal, edge, out.fit);
  } catch (const InputError& error) {
    const ErrorParts parts = parts_of(error);
    table.fail(parts.message, parts.hint);
  }
  return out;
}

double eV_per_angstrom(double force) { return force * kAngstrom / kElectronVolt; }

MaterialInput read_material(const ConfigTable& table) {
  MaterialInput out;
  out.guess = table.number("edge", quantity::length, Range::positive()) / kAngstrom;
  if (const auto crystal = table.find("crystal"))
    out.crystal = static_cast<Crystal>(crystal->choice("crystal", {"diamond", "fcc"}));
  for (const char* other : {"potential", "file", "parameters"}) table.not_both("springs", other);
  if (const auto springs = table.table_at("springs")) {
    out.springs = read_springs(*springs, out.crystal, out.guess);
    out.law = spring_law(out.springs->springs), out.name = "springs";
  } else {
    Tersoff tersoff = read_potential(table, out.name);
    out.tersoff = tersoff.terms[0];
    out.law = tersoff_law(std::move(tersoff));
  }
  out.mass = table.number("mass", quantity::mass, Range::positive());
  out.cells = static_cast<int>(table.integer_or("cells", 1, kMostCells, 2));
  out.force = eV_per_angstrom(
      table.number_or("force", quantity::force, 1e-6 * kElectronVolt / kAngstrom, Range::positive()));
  table.done();
  return out;
}

std::array<int, 3> cubes_of(const ConfigTable& table) {
  const ConfigValue value = table.at("cubes");
  const std::vector<ConfigValue> items = value.items();
  if (items.size() != 3) value.fail("'cubes' needs three numbers, one for each axis");
  std::array<int, 3> out;
  for (size_t a = 0; a < 3; ++a) out[a] = static_cast<int>(items[a].integer(1, kMostCubes * 10));
  if (int64_t{out[0]} * out[1] * out[2] > kMostCubes * kMostCubes * kMostCubes)
    value.fail("more than a million cubes");
  return out;
}

ElementMesh read_box(const ConfigTable& table, int grain_cubes, int refine) {
  std::array<int, 3> cubes = cubes_of(table);
  const ConfigValue size = table.at("size");
  const Vec3 extent = size.vector(quantity::length);
  if (!(extent.minCoeff() > 0)) size.fail("'size' must be positive along each axis");
  const std::array<bool, 3> repeats = table.has("repeats") ? table.axes("repeats") : std::array<bool, 3>{};
  for (size_t a = 0; a < 3; ++a)
    if (repeats[a] && cubes[a] % 2 != 0)
      table.at("cubes").fail(fmt::format("along {}, which repeats, the number of cubes must be even, not {}",
                                         "xyz"[a], cubes[a]),
                             "the division into tetrahedra is mirrored in every second cube");
  for (int& count : cubes) count *= refine;
  ElementMesh mesh = box_mesh(cubes, extent, repeats, grain_cubes * refine);
  try {
    check_mesh(mesh, "the box");
  } catch (const InputError& error) {
    size.fail(error.what());
  }
  return mesh;
}

void read_mesh(ElementStudy& study, const ConfigTable& table, int grain_cubes, int refine) {
  table.not_both("file", "cubes");
  if (const auto file = table.find("file")) {
    study.mesh_name = file->file();
    if (grain_cubes > 0)
      file->fail("a mesh from a file has its grains by its volumes: leave out grains.cubes");
    const std::array<bool, 3> repeats = table.has("repeats") ? table.axes("repeats") : std::array<bool, 3>{};
    study.mesh = read_gmsh(study.mesh_name, table.at("unit").unit(quantity::length), repeats);
    study.hash = hash_of(read_config_text(study.mesh_name), Hash().add(static_cast<int64_t>(study.hash)));
  } else {
    study.mesh_name = study.path;
    study.mesh = read_box(table, grain_cubes, refine);
  }
  table.done();
}

// The rotation that lays crystal directions `along` on x and, as far as it can, `up` on z.
Mat3 orientation_of(const ConfigTable& table) {
  const ConfigValue along = table.at("along");
  const Vec3 x = along.direction().normalized();
  const Vec3 up = table.has("up") ? table.at("up").direction().normalized()
                                  : Vec3(std::abs(x[2]) < 0.9 ? Vec3(0, 0, 1) : Vec3(0, 1, 0));
  const Vec3 across = up.cross(x);
  if (across.norm() < 1e-6) along.fail("'along' and 'up' are parallel");
  Mat3 lattice;  // columns: where x, y, z of space lie in the lattice
  lattice << eigen(x), eigen(across.normalized()), eigen(x.cross(across.normalized()));
  return lattice.transpose();
}

int read_grains(ElementStudy& study, const ConfigTable& table) {
  study.seed = static_cast<uint64_t>(table.integer_or("seed", 0, std::numeric_limits<int64_t>::max() / 2, 1));
  study.sets = static_cast<size_t>(table.integer_or("sets", 1, kMostSets, 1));
  const auto cubes = static_cast<int>(table.integer_or("cubes", 0, kMostCubes * 10, 0));
  if (const auto one = table.table_at("orientation")) {
    study.orientation = orientation_of(*one);
    if (study.sets > 1)
      one->fail("sets of grains that are all turned alike are one set: leave out grains.sets");
    one->done();
  }
  table.done();
  return cubes;
}

StretchInput read_stretch(const ConfigTable& table, const ElementMesh& mesh) {
  StretchInput out;
  out.axis = axis_of(table, "axis");
  if (mesh.period[out.axis] == 0)
    table.at("axis").fail(fmt::format("the mesh does not repeat along {}", "xyz"[out.axis]),
                          "name it in mesh.repeats");
  const ConfigValue strains = table.at("strains");
  out.strains = strains.numbers(quantity::number, Range::between(-kMostStrain, kMostStrain));
  if (out.strains.size() < 2) strains.fail("'strains' needs at least two, for modulus and Poisson's ratio");
  for (const double strain : out.strains)
    if (std::abs(strain) < kLeastStrain)
      strains.fail(fmt::format("a strain of {:g} is lost in the rounding of positions: {:g} at least", strain,
                               kLeastStrain));
  table.done();
  return out;
}

WaveInput read_wave(const ConfigTable& table, const ElementMesh& mesh) {
  WaveInput out;
  out.axis = axis_of(table, "along");
  if (mesh.period[out.axis] > 0)
    table.at("along").fail(
        fmt::format("the mesh repeats along {}: a wave needs an end to begin at", "xyz"[out.axis]));
  out.polarisation = table.has("polarisation") ? axis_of(table, "polarisation") : out.axis;
  out.peak = table.number("peak", quantity::pressure, Range::positive());
  if (table.has("pulse")) out.pulse = table.number("pulse", quantity::time, Range::positive());
  if (table.has("duration")) out.duration = table.number("duration", quantity::time, Range::positive());
  if (table.has("reference"))
    out.reference = table.number("reference", quantity::velocity, Range::positive());
  if (const auto snapshots = table.find("snapshots"))
    out.snapshots = snapshots->numbers(quantity::time, Range::not_negative());
  out.step = table.number_or("step", quantity::number, 0.6, {.low = 0, .high = 0.95, .low_open = true});
  table.done();
  return out;
}

std::vector<int> integers_of(const ConfigTable& table, const char* key, int most, int otherwise) {
  const auto value = table.find(key);
  if (!value) return {otherwise};
  std::vector<int> out;
  for (const ConfigValue& item : value->items()) out.push_back(static_cast<int>(item.integer(1, most)));
  if (out.empty()) value->fail(fmt::format("'{}' has no value", key));
  return out;
}

std::vector<double> numbers_of(const ConfigTable& table, const char* key, const Quantity& quantity,
                               const Range& range, double otherwise) {
  const auto value = table.find(key);
  if (!value) return {otherwise};
  std::vector<double> out = value->numbers(quantity, range);
  if (out.empty()) value->fail(fmt::format("'{}' has no value", key));
  return out;
}

CompareInput read_compare(const ConfigTable& table, const ElementStudy& study, bool box, int grain_cubes) {
  CompareInput out;
  out.cells = integers_of(table, "cells", kMostCells, study.material.cells);
  out.force = numbers_of(table, "force", quantity::force, Range::positive(),
                         study.material.force * kElectronVolt / kAngstrom);
  for (double& force : out.force) force = eV_per_angstrom(force);
  out.strain_tolerance = numbers_of(table, "strain_tolerance", quantity::number,
                                    Range::between(0, kMostTolerance), study.strain_tolerance);
  out.refine = integers_of(table, "refine", kMostRefine, 1);
  if (const auto refine = table.find("refine")) {
    if (!box) refine->fail("a mesh from a file has its elements: leave out 'refine'");
    if (grain_cubes == 0 && !study.orientation)
      refine->fail("elements that are grains each make another polycrystal when they are cut",
                   "give grains.cubes = 1, or more");
  }
  table.done();
  if (efforts_of(out).size() < 2) table.fail("one point alone compares with nothing");
  return out;
}

void apply(const ElementEffort& effort, ElementStudy& study) {
  study.material.cells = effort.cells, study.material.force = effort.force;
  study.strain_tolerance = effort.strain_tolerance;
  Hash hash;
  hash.add(static_cast<int64_t>(study.hash)).add(int64_t{effort.cells}).add(int64_t{effort.refine});
  study.hash = hash_of(fmt::format("{} {}", effort.force, effort.strain_tolerance), hash);
}

}  // namespace

std::vector<ElementEffort> efforts_of(const CompareInput& compare) {
  std::vector<ElementEffort> out;
  for (const int refine : compare.refine)
    for (const int cells : compare.cells)
      for (const double force : compare.force)
        for (const double tolerance : compare.strain_tolerance)
          out.push_back({cells, force, tolerance, refine});
  return out;
}

ElementEffort finest(const CompareInput& compare) {
  return {std::ranges::max(compare.cells), std::ranges::min(compare.force),
          std::ranges::min(compare.strain_tolerance), std::ranges::max(compare.refine)};
}

namespace {

// `hash`: of the file's text; the mesh's and the effort's join it.
ElementStudy element_study_of(const ConfigTable& root, const std::string& path, uint64_t hash,
                              const std::optional<ElementEffort>& effort) {
  ElementStudy out;
  out.path = path;
  out.hash = hash;
  out.title = root.string_or("title", "");
  const auto table = [&](const char* key) { return root.at(key).table(); };
  out.material = read_material(table("material"));
  const int grain_cubes = root.has("grains") ? read_grains(out, table("grains")) : 0;
  read_mesh(out, table("mesh"), grain_cubes, effort ? effort->refine : 1);
  if (const auto samples = root.table_at("samples")) {
    out.strain_tolerance =
        samples->number_or("strain_tolerance", quantity::number, 0, Range::between(0, kMostTolerance));
    samples->done();
  }
  if (const auto stretch = root.table_at("stretch")) out.stretch = read_stretch(*stretch, out.mesh);
  if (const auto wave = root.table_at("wave")) out.wave = read_wave(*wave, out.mesh);
  if (const auto compare = root.table_at("compare"))
    out.compare = read_compare(*compare, out, root.at("mesh").table().has("cubes"), grain_cubes);
  root.done();
  out.places = root.places();
  if (effort) apply(*effort, out);
  if (!out.stretch && !out.wave) root.fail("nothing to study: the file has neither [stretch] nor [wave]");
  check_mesh(out.mesh, out.mesh_name);
  return out;
}

}  // namespace

ElementStudy read_element_study(const std::string& path, const std::optional<ElementEffort>& effort) {
  const std::string text = read_config_text(path);
  return read_kind(FileKind::element_study, text, path, [&](const ConfigTable& root) {
    return element_study_of(root, path, hash_of(text), effort);
  });
}

std::shared_ptr<const SampleMaterial> material_of(const ElementStudy& study) {
  const MaterialInput& m = study.material;
  try {
    return std::make_shared<const SampleMaterial>(
        crystal_material(m.crystal, m.law, m.guess, m.cells, m.mass, m.force));
  } catch (const InputError& error) {
    study.places.fail(
        {"material.potential", "material.file", "material.parameters", "material.springs", "material"},
        fmt::format("{}: {}", m.name, first_line(error.what())),
        fmt::format("these parameters hold no stable lattice of {}",
                    m.crystal == Crystal::fcc ? "FCC" : "diamond"));
  }
}

ElementBody body_of(const ElementStudy& study, std::shared_ptr<const SampleMaterial> material, size_t set,
                    int threads, const RelaxerMaker& relaxer) {
  const size_t grains = study.mesh.grains();
  return {study.mesh,
          std::move(material),
          study.orientation ? std::vector<Mat3>(grains, *study.orientation)
                            : random_turns(grains, study.seed + set),
          {study.strain_tolerance, threads, relaxer},
          study.mesh_name};
}

}  // namespace cuboct
