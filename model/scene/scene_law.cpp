// SPDX-License-Identifier: MIT
// [packing] and [law] of a scene.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "model/base/error_parts.h"
#include "model/base/mat3.h"
#include "model/contract/law.h"
#include "model/scene/scene_parts.h"
#include "model/solid/dynamical_matrix.h"

namespace cuboct {
namespace {

std::optional<Vec3> least_integers(const Vec3& v) {
  int64_t divisor = 0;
  for (double c : v) {
    if (c != std::round(c) || std::abs(c) > 1e6) return std::nullopt;
    divisor = std::gcd(divisor, std::llround(c));
  }
  return v / static_cast<double>(divisor);
}

void read_orientation(const ConfigTable& table, PackingChoice& packing) {
  packing.along = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  const auto axes = table.find("axes");
  if (!axes) return;
  const auto rows = axes->items();
  if (rows.size() != 2) axes->fail("'axes' needs two crystal directions: along x and along y");
  const Vec3 x = rows[0].vector(quantity::number), y = rows[1].vector(quantity::number);
  if (x.norm() == 0 || y.norm() == 0) axes->fail("'axes' must not hold a zero direction");
  if (std::abs(x.dot(y)) > 1e-9 * x.norm() * y.norm())
    axes->fail("the two directions of 'axes' are not perpendicular");
  const Vec3 rows_of[3] = {x.normalized(), y.normalized(), x.normalized().cross(y.normalized())};
  for (int k = 0; k < 3; ++k) packing.fcc.orientation.row(k) = eigen(rows_of[k]);
  packing.along = {least_integers(x), least_integers(y), std::nullopt};
  if (packing.along[0] && packing.along[1])
    packing.along[2] = least_integers(packing.along[0]->cross(*packing.along[1]));
}

GrainChoice read_grains(const ConfigTable& packing, const ConfigTable& table) {
  table.record_as("packing");
  Grains grains;
  grains.size = table.number("size", quantity::length, Range::positive());
  grains.seed = static_cast<uint64_t>(table.at("seed").integer(0, INT64_MAX));
  if (const auto texture = table.find("texture"))
    grains.column_axis = static_cast<int>(texture->choice("texture", {"random", "x", "y", "z"})) - 1;
  grains.closest = table.number_or("closest", quantity::number, grains.closest, Range::between(0.3, 0.95));
  table.done();
  if (const auto axes = packing.find("axes"); axes && grains.column_axis < 0)
    axes->fail("'axes' serves one crystal, and grains that are columns: others turn any way",
               "give 'grains' a texture = \"x\", \"y\" or \"z\"");
  return {grains, table};
}

// The makers of laws know no file: their complaints get the place of the table.
template <typename Make>
auto placed(const ConfigValue& table, Make make) {
  try {
    return make();
  } catch (const InputError& error) {
    const ErrorParts parts = parts_of(error);
    table.fail(parts.message, parts.hint);
  }
}

double positive(const ConfigTable& table, const char* key, const Quantity& quantity) {
  return table.number(key, quantity, Range::positive());
}

double pitch_for(const ConfigTable& law, const std::string& what, const PackingChoice* packing) {
  if (packing == nullptr) law.fail(fmt::format("{} needs the pitch of a [packing]", what));
  return packing->fcc.pitch;
}

std::shared_ptr<const PairLaw> read_lennard_jones(const ConfigTable& law) {
  const double sigma = positive(law, "sigma", quantity::length);
  const double epsilon = positive(law, "epsilon", quantity::energy);
  const double cutoff = positive(law, "cutoff", quantity::length);
  const double core = law.number_or("core", quantity::length, 0.8 * sigma, Range::positive());
  const auto smooth = law.find("smooth");
  const Smoothing smoothing =
      smooth ? static_cast<Smoothing>(smooth->choice("smoothing", {"none", "linear"})) : Smoothing::none;
  return placed(law, [&] { return lennard_jones(epsilon, sigma, cutoff, core, smoothing); });
}

std::shared_ptr<const PairLaw> read_spline(const ConfigTable& law, const PackingChoice* packing) {
  auto r = law.at("r").numbers(quantity::length, Range::not_negative());
  const ConfigValue force = law.at("force");
  auto f = force.numbers(quantity::force);
  const auto how = law.find("interpolation");
  const auto kind = how && how->choice("interpolation", {"monotone_cubic", "b_spline"}) == 1
                        ? Interpolation::b_spline
                        : Interpolation::monotone_cubic;
  const double core = law.has("core") ? positive(law, "core", quantity::length)
                                      : pitch_for(law, "a spline law without 'core'", packing) / 2;
  if (r.size() != f.size()) force.fail(fmt::format("'r' has {} points, 'force' has {}", r.size(), f.size()));
  for (size_t i = 1; i < r.size(); ++i)
    if (!(r[i] > r[i - 1])) law.at("r").fail(fmt::format("'r' must ascend, but point {} does not", i + 1));
  if (!f.empty() && f.back() != 0)
    force.fail(fmt::format("the law does not vanish at the cutoff: the last force is {:.6g} N", f.back()),
               "let the last force be 0");
  return placed(law, [&] { return spline_law(std::move(r), std::move(f), kind, core); });
}

// {111} planes, the weakest, are cut at 2 sqrt(3)/pitch^2 bonds per area (model/solid/cleavage.h).
double range_for(const ConfigValue& energy, const PairLaw& whole, double pitch) {
  const double asked = energy.number(quantity::surface_energy, Range::positive());
  const double most = -2 * std::numbers::sqrt3 * whole.energy(pitch) / (pitch * pitch);
  if (asked > most)
    energy.fail(fmt::format("at this pitch and stiffness the law holds no more than {:.6g} J/m^2", most),
                "the energy grows with pitch times stiffness");
  return std::sqrt(asked / most);
}

std::shared_ptr<const PairLaw> read_preset(const ConfigTable& law, const std::string& name,
                                           const PackingChoice* packing) {
  const double pitch = pitch_for(law, fmt::format("the law '{}'", name), packing);
  law.not_both("stiffness", "youngs_modulus");
  double stiffness = 0;
  if (law.has("youngs_modulus")) {
    const ConfigValue along = law.at("direction");
    Vec3 direction = along.direction();
    if (along.is_string()) {
      for (int a = 0; packing->grains && a < 3; ++a)
        if (direction[a] != 0 && a != packing->grains->grains.column_axis)
          along.fail(fmt::format("each grain has another crystal direction along {}", "xyz"[a]),
                     "give the crystal direction: three numbers");
      direction = packing->fcc.orientation.transpose() * direction;
    }
    stiffness = stiffness_from_modulus(positive(law, "youngs_modulus", quantity::pressure), direction, pitch);
  } else {
    if (!law.has("stiffness"))
      law.fail(fmt::format("missing key 'stiffness' or 'youngs_modulus' in '{}'", law.key()));
    stiffness = positive(law, "stiffness", quantity::stiffness);
  }
  const auto whole = placed(law, [&] { return preset_law(name, pitch, stiffness); });
  const auto energy = law.find("fracture_energy");
  if (!energy) return whole;
  return preset_law(name, pitch, stiffness, range_for(*energy, *whole, pitch));
}

}  // namespace

void relax_pitch(const ConfigValue& value, const PairLaw& law, PackingChoice& packing) {
  if (packing.fcc.pitch > 0) return;
  const double guess = stiffest_rest_distance(law);
  if (!(guess > 0)) value.fail("\"relaxed\" needs a force that pushes, and pulls further out");
  packing.fcc.pitch = placed(value, [&] { return relaxed_pitch(law, guess); });
}

void check_at_pitch(const ConfigValue& table, const PairLaw& law, double pitch, bool must_vanish) {
  if (law.cutoff() <= pitch)
    table.fail(
        fmt::format("the cutoff {:.6g} m of the law is not beyond the pitch {:.6g} m", law.cutoff(), pitch));
  placed(table, [&] {
    check_neighbours(pitch, law.cutoff());
    return true;
  });
  const double f = law.force(pitch);
  if (must_vanish && std::abs(f) > 1e-6 * std::abs(law.slope(pitch)) * pitch)
    table.fail(fmt::format("the law does not vanish at the pitch: {:.6g} N at {:.6g} m", f, pitch),
               "the undeformed packing would not be at rest");
}

std::optional<PackingChoice> read_packing(const ConfigTable& root) {
  const auto table = root.table_at("packing");
  if (!table) return std::nullopt;
  PackingChoice packing;
  const ConfigValue pitch = table->at("pitch");
  if (pitch.is_string() && pitch.string() == "auto")
    pitch.fail("a run has one pitch, which 'auto' does not tell",
               "'cuboct pitch SCENE --error 5%' finds the coarsest one that keeps a figure within an error");
  if (!pitch.is_string() || pitch.string() != "relaxed")
    packing.fcc.pitch = pitch.number(quantity::length, Range::positive());
  packing.fcc.offset = table->vector_or("offset", quantity::length, Vec3::Zero());
  read_orientation(*table, packing);
  if (const auto grains = table->table_at("grains"))
    packing.grains = std::make_shared<const GrainChoice>(read_grains(*table, *grains));
  table->done();
  return packing;
}

double stiffness_from_modulus(double modulus, const Vec3& direction, double pitch) {
  const Vec3 n2 = direction.normalized().cwiseAbs2();
  const double j = n2[0] * n2[1] + n2[1] * n2[2] + n2[2] * n2[0];
  return std::numbers::sqrt2 * pitch * modulus * (0.75 - j);
}

std::shared_ptr<const PairLaw> read_law(const ConfigTable& root, PackingChoice* packing) {
  const auto found = root.table_at("law");
  if (!found) root.at("law");
  return read_law_table(*found, packing);
}

std::shared_ptr<const PairLaw> read_law_table(const ConfigTable& table, PackingChoice* packing) {
  table.record_as("law");
  const std::vector<std::string> kinds = {"elastic", "brittle", "ductile", "viscous", "spline", "lj", "rule"};
  const std::string kind = kinds[table.at("kind").choice("law", kinds)];
  std::shared_ptr<const PairLaw> law;
  if (kind == "lj") {
    law = read_lennard_jones(table);
    // The pair's own minimum is a good guess.
    const double guess = std::pow(2.0, 1.0 / 6) * table.number("sigma", quantity::length);
    if (packing != nullptr && packing->fcc.pitch == 0)
      packing->fcc.pitch = placed(table, [&] { return relaxed_pitch(*law, guess); });
  } else if (kind == "rule") {
    table.at("file");
    law = read_program_rule(table, packing, {}, [&] {
            table.fail("a pair's law is a rule with 'core'", "without 'core' a rule is one of any force");
          }).law;
    if (packing != nullptr) relax_pitch(table, *law, *packing);
  } else {
    if (packing != nullptr && packing->fcc.pitch == 0)
      table.fail(fmt::format("the law '{}' needs a given pitch, not \"relaxed\"", kind));
    law = kind == "spline" ? read_spline(table, packing) : read_preset(table, kind, packing);
  }
  table.done();
  if (packing != nullptr) check_at_pitch(table, *law, packing->fcc.pitch, kind != "lj" && kind != "rule");
  return law;
}

double largest_stiffness(const Rule& rule, double pitch) {
  constexpr int kSamples = 4096;
  double most = 0;
  for (size_t k = 0; k < rule.laws(); ++k) {
    const PairLaw& law = rule.law_at(k);
    const double from = pitch > 0 ? pitch : law.core();
    double steepest = 0;
    for (int i = 0; i <= kSamples; ++i)
      steepest = std::max(steepest, std::abs(law.slope(from + (law.cutoff() - from) * i / kSamples)));
    most = std::max(most, rule.strongest_of(k) * steepest);
  }
  return most;
}

}  // namespace cuboct
