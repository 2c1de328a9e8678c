// SPDX-License-Identifier: MIT
#include "model/body/particle_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "model/base/error.h"
#include "model/base/units.h"

namespace cuboct {
namespace {

struct UnitStyle {
  const char *name, *length, *velocity, *mass;
};
// https://docs.lammps.org/units.html; ASE's velocities are in angstrom sqrt(eV/u)/angstrom.
constexpr UnitStyle kUnitStyles[] = {{"metal", "angstrom", "angstrom/ps", "u"},
                                     {"real", "angstrom", "angstrom/fs", "u"},
                                     {"si", "m", "m/s", "kg"},
                                     {"cgs", "cm", "cm/s", "g"},
                                     {"micro", "um", "um/us", "pg"},
                                     {"nano", "nm", "nm/ns", "ag"},
                                     {"ase", "angstrom", nullptr, "u"}};

double si_value(const char* unit) {
  // An attogram is the one unit without a prefix of its own.
  if (unit == std::string_view("ag")) return 1e-21;
  return parse_quantity(std::string("1 ") + unit).values[0];
}

template <typename T>
void put_in_order(const std::vector<uint32_t>& order, std::vector<T>& values) {
  if (values.empty()) return;
  std::vector<T> sorted;
  sorted.reserve(values.size());
  for (const uint32_t i : order) sorted.push_back(values[i]);
  values = std::move(sorted);
}

bool looks_like_xyz(ParticleText& text) {
  if (text.path().ends_with(".xyz") || text.path().ends_with(".extxyz")) return true;
  const size_t begin = text.at();
  std::string_view line = text.line();
  text.seek(begin);
  return is_whole(take_word(line)) && is_blank_line(line);
}

}  // namespace

const std::vector<std::string>& particle_unit_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const UnitStyle& style : kUnitStyles) all.emplace_back(style.name);
    return all;
  }();
  return names;
}

ParticleUnits particle_units(size_t name) {
  const UnitStyle& style = kUnitStyles[name];
  const double mass = si_value(style.mass);
  return {si_value(style.length),
          style.velocity != nullptr ? si_value(style.velocity) : std::sqrt(si_value("eV") / mass), mass};
}

double ase_momentum() { return std::sqrt(si_value("u") * si_value("eV")); }

void ParticleKinds::add(std::string_view word) {
  constexpr size_t kMost = 1000;
  std::vector<std::string>& kinds = file_.kinds;
  if (kinds.empty() || kinds[last_] != word) {
    const auto found = std::ranges::find(kinds, word);
    if (found == kinds.end()) {
      if (kinds.size() == kMost) file_.text->fail(word, fmt::format("more than {} species", kMost));
      kinds.emplace_back(word);
      last_ = static_cast<uint16_t>(kinds.size() - 1);
    } else {
      last_ = static_cast<uint16_t>(found - kinds.begin());
    }
  }
  file_.kind.push_back(last_);
}

void order_particles(std::vector<uint64_t>& ids, ParticleFile& file) {
  const bool ordered = std::ranges::adjacent_find(ids, std::ranges::greater_equal{}) == ids.end();
  if (ordered) return;
  std::vector<uint32_t> order(ids.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](uint32_t i) { return ids[i]; });
  for (size_t k = 1; k < order.size(); ++k)
    if (ids[order[k]] == ids[order[k - 1]])
      file.text->fail(file.at[order[k]],
                      fmt::format("the id {} is there twice: in line {} too", ids[order[k]],
                                  file.text->line_at(file.at[order[k - 1]])));
  put_in_order(order, ids);
  put_in_order(order, file.x);
  put_in_order(order, file.v);
  put_in_order(order, file.mass);
  put_in_order(order, file.kind);
  put_in_order(order, file.at);
}

size_t ParticleFile::at_axis(size_t i, int axis) const {
  std::string_view rest = text->text().substr(at[i]), word = rest;
  for (int k = 0; k <= axis; ++k) word = take_word(rest);
  return text->byte_of(word);
}

ParticleFile read_particle_file(const std::string& path, const ParticleFileChoice& choice) {
  ParticleFile file;
  file.text = std::make_unique<ParticleText>(path);
  ParticleText& text = *file.text;
  if (text.text().find_first_not_of(" \t\r\n", text.at()) == std::string_view::npos)
    text.fail(text.at(), "the file is empty");
  file.data = !looks_like_xyz(text);
  if (file.data)
    read_lammps_data(choice, file);
  else
    read_xyz(choice, file);
  return file;
}

}  // namespace cuboct
