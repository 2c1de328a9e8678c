// SPDX-License-Identifier: MIT
#include "cli/study/elastic_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "model/base/json.h"
#include "model/base/quantity_text.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

constexpr const char* kPairs[] = {"xx", "yy", "zz", "yz", "xz", "xy"};

struct Direction {
  std::string name;
  Vec3 n;
};

// Of the scene's axes and, where there is a packing, of its crystal; then the extremes.
std::vector<Direction> directions_of(const ElasticFindings& found) {
  std::vector<Direction> out{{"x", Vec3::UnitX()}, {"y", Vec3::UnitY()}, {"z", Vec3::UnitZ()}};
  if (found.crystal)
    for (const auto& [name, n] :
         {std::pair{"[100]", Vec3(1, 0, 0)}, {"[110]", Vec3(1, 1, 0)}, {"[111]", Vec3(1, 1, 1)}})
      out.push_back({name, *found.crystal * n.normalized()});
  const auto [softest, stiffest] = extreme_directions(found.sums.c);
  out.push_back({"softest", softest});
  out.push_back({"stiffest", stiffest});
  return out;
}

Matrix6 in_crystal(const ElasticFindings& found) {
  return found.crystal ? in_axes(found.sums.c, *found.crystal) : found.sums.c;
}

// What is rounding is 0, not -0.
double shown(double ratio) { return std::abs(ratio) < 1e-9 ? 0.0 : ratio; }

std::string matrix_text(const Matrix6& c, const std::string& title) {
  const auto [scale, unit] = pressure_unit(c.cwiseAbs().maxCoeff());
  std::string out = fmt::format("\n{}, {}\n    ", title, unit);
  for (const char* pair : kPairs) out += fmt::format("{:>11}", pair);
  for (int a = 0; a < 6; ++a) {
    out += fmt::format("\n  {}", kPairs[a]);
    // What is rounding beside the largest is 0.
    for (int b = 0; b < 6; ++b)
      out += fmt::format("{:>11.5g}",
                         std::abs(c(a, b)) < 1e-9 * c.cwiseAbs().maxCoeff() ? 0.0 : c(a, b) / scale);
  }
  return out + "\n";
}

std::string vector_text(const Vec3& n) {
  return fmt::format("({:.4f}, {:.4f}, {:.4f})", n.x() + 0.0, n.y() + 0.0, n.z() + 0.0);
}

std::string direction_table(const ElasticFindings& found) {
  std::string out =
      fmt::format("\n{:<10} {:<26} {:>11} {:>9} {:>9} {:>12} {:>12} {:>12}\n", "pull along", "direction", "E",
                  "nu, least", "most", "slow shear", "fast shear", "pressure");
  for (const auto& [name, n] : directions_of(found)) {
    const auto [low, high] = poissons_ratio(found.sums.c, n);
    const Vec3 speed = wave_speeds(found.sums.c, found.density, n);
    out += fmt::format("{:<10} {:<26} {:>11} {:>9.4f} {:>9.4f} {:>12} {:>12} {:>12}\n", name, vector_text(n),
                       quantity_text(youngs_modulus(found.sums.c, n), "Pa"), shown(low), shown(high),
                       quantity_text(speed[0], "m/s"), quantity_text(speed[1], "m/s"),
                       quantity_text(speed[2], "m/s"));
  }
  return out;
}

std::string slab_table(const ElasticFindings& found) {
  if (found.slabs.empty()) return "";
  const double bulk = youngs_modulus(found.sums.c, Vec3::UnitX());
  std::string out = fmt::format("\n{:>6} {:>12} {:>12} {:>12} {:>10}\n", "layers", "thickness", "E along x",
                                "by strain", "over bulk");
  for (const SlabModulus& slab : found.slabs)
    out +=
        fmt::format("{:>6} {:>12} {:>12} {:>12} {:>10.4f}\n", slab.layers, quantity_text(slab.thickness, "m"),
                    found.by_sums ? quantity_text(slab.by_sums, "Pa") : "-",
                    quantity_text(slab.by_strain, "Pa"), slab.by_sums / bulk);
  return out;
}

std::string cleavage_table(const ElasticFindings& found) {
  if (found.cleavage.empty()) return "";
  double least = found.cleavage[0].energy;
  for (const Cleavage& one : found.cleavage) least = std::min(least, one.energy);
  std::string out =
      fmt::format("\n{:<10} {:<26} {:>16} {:>10}\n", "cleavage", "normal", "energy, 2 gamma", "over least");
  for (const Cleavage& one : found.cleavage)
    out += fmt::format("{:<10} {:<26} {:>16} {:>10.4f}\n", one.plane, vector_text(one.normal),
                       quantity_text(one.energy, "J/m^2"), one.energy / least);
  return out;
}

std::string json_matrix(const Matrix6& c) {
  std::string out = "[";
  for (int a = 0; a < 6; ++a) {
    out += a > 0 ? ", [" : "[";
    for (int b = 0; b < 6; ++b) out += (b > 0 ? ", " : "") + json(c(a, b));
    out += "]";
  }
  return out + "]";
}

std::string json_vector(const Vec3& v) {
  return fmt::format("[{}, {}, {}]", json(v[0]), json(v[1]), json(v[2]));
}

}  // namespace

std::pair<double, std::string> pressure_unit(double largest) {
  for (const auto& [scale, name] : {std::pair{1e9, "GPa"}, {1e6, "MPa"}, {1e3, "kPa"}})
    if (largest >= scale) return {scale, name};
  return {1, "Pa"};
}

std::string text_of(const ElasticFindings& found) {
  const Matrix6& c = found.sums.c;
  const auto line = [](const char* name, const std::string& text) {
    return fmt::format("{:<22}{}\n", name, text);
  };
  std::string out = line("scene", line_text(found.scene));
  out += line("cell", fmt::format("{}: {} particle{}", line_text(found.cell), found.particles,
                                  found.particles == 1 ? "" : "s"));
  out += line("density", fmt::format("{:.6g} kg/m^3", found.density));
  const Mat3& stress = found.sums.stress;
  if (const double most = stress.cwiseAbs().maxCoeff(); most > 1e-9 * c.cwiseAbs().maxCoeff())
    out += line("stress of the cell",
                fmt::format("up to {}: the constants are those under it", quantity_text(most, "Pa")));
  out += line("force evaluations",
              fmt::format("{} to the minimum, {} of strained cells", found.relaxing, found.evaluations));
  if (!found.left_out.empty())
    out += line("left out",
                fmt::format("the scene's start of {}: it asks where it is", fmt::join(found.left_out, ", ")));
  if (found.by_sums) out += matrix_text(c, "constants by lattice sums");
  out += matrix_text(found.strained, fmt::format("constants by simulation, strains of {:g}", found.strain));
  if (found.by_sums)
    out += fmt::format("largest difference over the largest constant: {:.2g}\n", found.difference());
  else
    out += fmt::format("asymmetry over the largest constant: {:.2g}\n", found.asymmetry());
  if (!found.stable())
    return out +
           fmt::format("\nunstable: a strain has the stiffness {}\n", quantity_text(softest_strain(c), "Pa"));
  const Isotropic mean = hill_mean(c);
  const Matrix6 crystal = in_crystal(found);
  out += "\n";
  if (found.crystal)
    out += line("C11, C12, C44",
                fmt::format("{}, {}, {}", quantity_text(crystal(0, 0), "Pa"),
                            quantity_text(crystal(0, 1), "Pa"), quantity_text(crystal(3, 3), "Pa")));
  out += line("Zener ratio", fmt::format("{:.4f}", zener_ratio(crystal)));
  out += line("universal anisotropy", fmt::format("{:.4f}", universal_anisotropy(c)));
  out += line("bulk modulus", quantity_text(mean.bulk, "Pa"));
  out += line("of many grains (Hill)",
              fmt::format("E {}, shear {}, Poisson's ratio {:.4f}", quantity_text(mean.youngs(), "Pa"),
                          quantity_text(mean.shear, "Pa"), mean.poisson()));
  return out + direction_table(found) + slab_table(found) + cleavage_table(found);
}

std::string json_of(const ElasticFindings& found) {
  std::string out = fmt::format(
      "{{\"scene\": {}, \"cell\": {}, \"particles\": {}, \"density\": {}, \"evaluations\": {},\n"
      " \"constants\": {},\n \"strained\": {},\n \"born\": {},\n \"difference\": {}, \"asymmetry\": {}, "
      "\"stress\": [{}, {}, {}],\n"
      " \"stable\": {}",
      json(found.scene), json(found.cell), found.particles, json(found.density),
      found.relaxing + found.evaluations, json_matrix(found.sums.c), json_matrix(found.strained),
      found.by_sums ? json_matrix(found.sums.born) : "null",
      found.by_sums ? json(found.difference()) : "null", json(found.asymmetry()),
      json_vector(found.sums.stress.row(0)), json_vector(found.sums.stress.row(1)),
      json_vector(found.sums.stress.row(2)), found.stable());
  if (!found.stable()) return out + "}\n";
  const Isotropic mean = hill_mean(found.sums.c);
  out += fmt::format(
      ",\n \"zener\": {}, \"universal_anisotropy\": {}, \"bulk\": {}, \"shear\": {},\n \"directions\": [",
      json(zener_ratio(in_crystal(found))), json(universal_anisotropy(found.sums.c)), json(mean.bulk),
      json(mean.shear));
  const char* separator = "";
  for (const auto& [name, n] : directions_of(found)) {
    const auto [low, high] = poissons_ratio(found.sums.c, n);
    out += fmt::format(
        "{}\n  {{\"name\": {}, \"direction\": {}, \"youngs\": {}, \"poisson\": [{}, {}], \"waves\": {}}}",
        separator, json(name), json_vector(n), json(youngs_modulus(found.sums.c, n)), json(low), json(high),
        json_vector(wave_speeds(found.sums.c, found.density, n)));
    separator = ",";
  }
  out += "],\n \"slabs\": [";
  separator = "";
  for (const SlabModulus& slab : found.slabs) {
    out +=
        fmt::format("{}\n  {{\"layers\": {}, \"thickness\": {}, \"youngs\": {}, \"strained\": {}}}",
                    separator, slab.layers, json(slab.thickness), json(slab.by_sums), json(slab.by_strain));
    separator = ",";
  }
  out += "],\n \"cleavage\": [";
  separator = "";
  for (const Cleavage& one : found.cleavage) {
    out += fmt::format("{}\n  {{\"plane\": {}, \"normal\": {}, \"energy\": {}}}", separator, json(one.plane),
                       json_vector(one.normal), json(one.energy));
    separator = ",";
  }
  return out + "]}\n";
}

}  // namespace cuboct
