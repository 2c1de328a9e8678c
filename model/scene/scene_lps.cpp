// SPDX-License-Identifier: MIT
// [rule] kind = "lps": the linear peridynamic solid.
#include <fmt/format.h>

#include <cmath>

#include "model/rules/lps.h"
#include "model/scene/scene_parts.h"

namespace cuboct {
namespace {

// Pa, the material's Lame constants; of a sheet those of its plane: by e_zz = 0, or by zero stress along z,
// where lambda is 2 lambda mu/(lambda + 2 mu).
void read_moduli(const ConfigTable& table, LpsMaterial& m) {
  const double nu = table.number("poissons_ratio", quantity::number,
                                 {.low = -1, .high = 0.5, .low_open = true, .high_open = true});
  table.not_both("youngs_modulus", "bulk_modulus");
  const double young =
      table.has("bulk_modulus")
          ? 3 * (1 - 2 * nu) * table.number("bulk_modulus", quantity::pressure, Range::positive())
          : table.number("youngs_modulus", quantity::pressure, Range::positive());
  m.mu = young / (2 * (1 + nu));
  m.lambda = young * nu / ((1 + nu) * (1 - 2 * nu));
  if (const auto plane = table.find("plane")) {
    m.dimensions = 2;
    if (plane->choice("plane", {"strain", "stress"}) == 1) m.lambda *= 2 * m.mu / (m.lambda + 2 * m.mu);
  }
}

double read_horizon(const ConfigTable& table, const PackingChoice* packing) {
  constexpr double kSecondShell = 1.5;  // pitches: 18 neighbours
  if (packing == nullptr) return table.number("horizon", quantity::length, Range::positive());
  table.not_both("horizon", "horizon_pitches");
  constexpr double kMostPitches = 10;  // 5,900 neighbours
  const double pitch = packing->fcc.pitch;
  if (table.has("horizon"))
    return table.number("horizon", quantity::length,
                        {.low = 0, .high = kMostPitches * pitch, .low_open = true});
  return pitch *
         table.number_or("horizon_pitches", quantity::number, kSecondShell, Range::between(1, kMostPitches));
}

double read_volume(const ConfigTable& table, const PackingChoice* packing, const LpsMaterial& m) {
  if (packing != nullptr && m.dimensions == 3 && !table.has("volume"))
    return std::pow(packing->fcc.pitch, 3) / std::sqrt(2.0);
  return table.number("volume", kVolume, Range::positive());
}

// The bonds of a particle inside the packing; of a sheet those in its plane.
std::vector<Vec3> full_bonds(const PackingChoice* packing, const LpsMaterial& m) {
  std::vector<Vec3> bonds;
  if (packing == nullptr || packing->grains) return bonds;
  for (const Vec3& r : fcc_bonds(packing->fcc.pitch, m.horizon)) {
    const Vec3 here = packing->fcc.orientation * r;
    if (m.dimensions == 3 || std::abs(here[2]) < 1e-6 * packing->fcc.pitch) bonds.push_back(here);
  }
  return bonds;
}

void read_breaking(const ConfigTable& table, const std::vector<Vec3>& full, LpsMaterial& m) {
  table.not_both("critical_stretch", "fracture_energy");
  if (table.has("critical_stretch"))
    m.critical_stretch = table.number("critical_stretch", quantity::number, Range::positive());
  if (table.has("fracture_energy"))
    m.critical_stretch = critical_stretch(
        m, full, table.number("fracture_energy", quantity::surface_energy, Range::positive()));
  if (const auto width = table.find("damage_width")) {
    if (!m.breaks()) width->fail("'damage_width' is of bonds that break", "give 'fracture_energy'");
    m.damage_width = width->number(quantity::number, Range::not_negative());
  }
}

void read_sums(const ConfigTable& table, LpsMaterial& m) {
  if (const auto quadrature = table.find("quadrature"))
    m.quadrature =
        static_cast<LpsQuadrature>(quadrature->choice("quadrature", {"points", "partial", "fitted"}));
  m.spacing = m.dimensions == 3 ? std::cbrt(m.volume) : 0;
  const auto spacing = table.find("spacing");
  if (spacing && m.quadrature == LpsQuadrature::points)
    spacing->fail("'spacing' is of quadrature = \"partial\" or \"fitted\"");
  if (spacing || (m.quadrature != LpsQuadrature::points && m.dimensions == 2))
    m.spacing = table.number("spacing", quantity::length, Range::positive());
  if (const auto order = table.find("order")) {
    if (m.quadrature != LpsQuadrature::fitted) order->fail("'order' is of quadrature = \"fitted\"");
    m.order = static_cast<int>(order->integer(2, 7));
  }
  if (const auto strain = table.find("strain")) m.finite = strain->choice("strain", {"finite", "small"}) == 0;
  m.corrected = table.boolean_or("surface_correction", false);
}

std::vector<char> read_unbreakable(const ConfigTable& table, const Regions& regions, const Scene& scene,
                                   bool breaks) {
  const auto names = table.find("unbreakable");
  if (!names) return {};
  if (!breaks) names->fail("'unbreakable' is of bonds that break", "give 'fracture_energy'");
  std::vector<char> kept(scene.body.size(), 0);
  for (const ConfigValue& name : names->items())
    for (const uint32_t id : regions.select(name, scene.packing().x, 1e-6 * scene.rule.cutoff()))
      kept[id] = 1;
  return kept;
}

void check_flat(const ConfigTable& table, const LpsMaterial& m, const Scene& scene) {
  const Vec3& first = scene.body.x.front();
  for (const Vec3& x : scene.body.x)
    if (m.dimensions == 2 && std::abs(x[2] - first[2]) > 1e-6 * m.horizon)
      table.at("plane").fail(
          fmt::format("the body is not flat: its particles lie at z = {:.6g} and {:.6g} m", first[2], x[2]));
}

}  // namespace

RuleChoice read_lps_rule(const ConfigTable& table, const PackingChoice* packing) {
  LpsMaterial m;
  read_moduli(table, m);
  m.horizon = read_horizon(table, packing);
  m.influence = table.number_or("influence_power", quantity::number, packing != nullptr ? 4 : 0,
                                Range::between(0, 4.9));
  m.volume = read_volume(table, packing, m);
  read_sums(table, m);
  const std::vector<Vec3> full = full_bonds(packing, m);
  if (packing != nullptr && !packing->grains && full.empty())
    table.fail(fmt::format("no neighbour is within the horizon of {:.6g} m", m.horizon));
  if (m.corrected && full.empty() && m.quadrature != LpsQuadrature::fitted)
    table.at("surface_correction")
        .fail("what a particle at a surface lacks is known of one crystal alone",
              "quadrature = \"fitted\" serves any points");
  read_breaking(table, full, m);
  const std::vector<Slit> slits = read_slits(table);
  return {m.horizon * (1 + 1e-6),
          [=](const ConfigTable& root, const Regions& regions,
              const Scene& scene) -> std::shared_ptr<const RoundsRule> {
            check_rounds_body(root, scene);
            check_flat(table, m, scene);
            std::vector<char> kept = read_unbreakable(table, regions, scene, m.breaks());
            table.done();
            return placed_at(table,
                             [&] { return std::make_shared<LpsRule>(m, full, slits, std::move(kept)); });
          }};
}

}  // namespace cuboct
