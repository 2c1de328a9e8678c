// SPDX-License-Identifier: MIT
#include "synth/target.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <regex>
#include <sstream>

#include "model/base/enum_names.h"
#include "model/base/error.h"
#include "model/base/excerpt.h"
#include "model/base/input_file.h"
#include "model/base/spelling.h"

namespace cuboct::synth {
namespace {

constexpr Counts lut(uint64_t n) { return {{n}}; }
constexpr Counts ff(uint64_t n) { return {{0, n}}; }
constexpr Counts dsp(uint64_t n) { return {{0, 0, n}}; }
constexpr Counts bram(uint64_t n) { return {{0, 0, 0, n}}; }

using Costs = std::map<std::string, Counts>;

// A carry shares its logic cell with a LUT; nextpnr counts the few that do not.
const Costs kIce40 = {{"SB_LUT4", lut(1)},
                      {"SB_CARRY", {}},
                      {"SB_MAC16", dsp(1)},
                      {"SB_RAM40_4K", bram(1)},
                      {"SB_RAM40_4KNR", bram(1)},
                      {"SB_RAM40_4KNW", bram(1)},
                      {"SB_RAM40_4KNRNW", bram(1)},
                      {"SB_IO", {}},
                      {"SB_GB", {}},
                      {"SB_GB_IO", {}},
                      {"SB_HFOSC", {}},
                      {"SB_PLL40_PAD", {}},
                      {"SB_PLL40_CORE", {}},
                      {"SB_RGBA_DRV", {}}};

// nextpnr's count of TRELLIS_COMB: a CCU2C takes two, a 16 x 4 memory four.
const Costs kEcp5 = {{"LUT4", lut(1)},
                     {"CCU2C", lut(2)},
                     {"TRELLIS_DPR16X4", lut(4)},
                     {"PFUMX", {}},
                     {"L6MUX21", {}},
                     {"TRELLIS_FF", ff(1)},
                     {"MULT18X18D", dsp(1)},
                     {"ALU54B", {}},
                     {"DP16KD", bram(1)},
                     {"PDPW16KD", bram(1)},
                     {"TRELLIS_IO", {}},
                     {"EHXPLLL", {}},
                     {"DCCA", {}},
                     {"GSR", {}},
                     {"SGSR", {}},
                     {"BB", {}},
                     {"IB", {}},
                     {"OB", {}}};

const Costs kXc7 = {{"LUT1", lut(1)},    {"LUT2", lut(1)},      {"LUT3", lut(1)},      {"LUT4", lut(1)},
                    {"LUT5", lut(1)},    {"LUT6", lut(1)},      {"INV", lut(1)},       {"MUXF7", {}},
                    {"MUXF8", {}},       {"CARRY4", {}},        {"SRL16E", lut(1)},    {"SRLC16E", lut(1)},
                    {"SRLC32E", lut(1)}, {"RAM32X1D", lut(2)},  {"RAM64X1D", lut(2)},  {"RAM128X1D", lut(4)},
                    {"RAM32M", lut(4)},  {"RAM64M", lut(4)},    {"RAM32X1S", lut(1)},  {"RAM64X1S", lut(1)},
                    {"FDRE", ff(1)},     {"FDSE", ff(1)},       {"FDCE", ff(1)},       {"FDPE", ff(1)},
                    {"DSP48E1", dsp(1)}, {"RAMB18E1", bram(1)}, {"RAMB36E1", bram(2)}, {"IBUF", {}},
                    {"OBUF", {}},        {"BUFG", {}},          {"IBUFG", {}}};

}  // namespace

const char* to_string(Resource resource) {
  constexpr const char* kNames[] = {"LUT", "FF", "DSP", "BRAM", "gates", "um^2", "logic cells"};
  return name_in(kNames, resource);
}

const std::vector<Resource>& resources_of(Family family) {
  static const std::vector<Resource> fpga = {Resource::lut, Resource::ff, Resource::dsp, Resource::bram};
  static const std::vector<Resource> silicon = {Resource::gates, Resource::ff, Resource::area};
  return family == Family::asic ? silicon : fpga;
}

Counts& Counts::operator+=(const Counts& other) {
  for (size_t r = 0; r < of.size(); ++r) of[r] += other.of[r];
  return *this;
}

const std::vector<Target>& targets() {
  // From the data sheets; a logic cell of iCE40 is one LUT with one FF.
  static const std::vector<Target> all = {
      {"up5k", Family::ice40, "iCE40UP5K", "sg48", {{5280, 5280, 8, 30}}, 48},
      {"hx8k", Family::ice40, "iCE40HX8K", "ct256", {{7680, 7680, 0, 32}}, 100},
      {"ecp5-25", Family::ecp5, "LFE5U-25F", "CABGA381", {{24288, 24288, 28, 56}}, 150},
      {"ecp5-85", Family::ecp5, "LFE5U-85F", "CABGA381", {{83640, 83640, 156, 208}}, 150},
      {"xc7", Family::xc7, "XC7A100T", "", {{63400, 126800, 240, 270}}, 0},
      {"asic", Family::asic, "osu018", "", {}, 0},
  };
  return all;
}

const Target& target_of(const std::string& name) {
  std::vector<std::string> names;
  for (const Target& t : targets()) {
    if (t.name == name) return t;
    names.push_back(t.name);
  }
  const std::string near = did_you_mean(name, names);
  throw InputError("unknown target '" + name + "'",
                   (near.empty() ? "" : near + " ") + "there are " +
                       list_of(names).replace(list_of(names).rfind(" or "), 4, " and "));
}

double planned_share(const Target& target, Resource resource) {
  return target.family == Family::ecp5 && resource == Resource::dsp ? 0.75 : 1.0;
}

CostOf costs_of(Family family) {
  const Costs& costs = family == Family::ice40 ? kIce40 : family == Family::ecp5 ? kEcp5 : kXc7;
  return [family, &costs](const std::string& type) -> std::optional<Counts> {
    if (family == Family::ice40 && type.starts_with("SB_DFF")) return ff(1);
    const auto found = costs.find(type);
    if (found == costs.end()) return std::nullopt;
    return found->second;
  };
}

namespace {

struct LibertyPlace {
  const std::string &file, &line;
  int number;
  size_t at;
};

// Of a cell, in the library's own unit.
uint64_t area_of(const std::string& text, const LibertyPlace& place) {
  constexpr double kMost = 1e12;
  double area = -1;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, area);
  if (error != std::errc() || stop != end || !(area >= 0 && area <= kMost)) {
    const int column = characters(std::string_view(place.line).substr(0, place.at)) + 1;
    throw InputError(place.file, place.number, column, fmt::format("'{}' is no area of a cell", text), {},
                     excerpt(place.line, place.number, column));
  }
  return static_cast<uint64_t>(std::llround(area));
}

}  // namespace

CostOf costs_of_liberty(const std::string& file) {
  // cell (NAME) { ... area : A; ... ff (...) or latch (...) ... }: the one level of the format that is needed
  // here.
  static const std::regex cell_form(R"re(^\s*cell\s*\(\s*"?([A-Za-z0-9_]+)"?\s*\))re"),
      area_form(R"re(^\s*area\s*:\s*([0-9.eE+-]+))re"), register_form(R"re(^\s*(ff|latch)(_bank)?\s*\()re");
  constexpr uint64_t kMostBytes = uint64_t{1} << 30;  // of a large library
  std::istringstream in(read_input(file, kMostBytes));
  Costs costs;
  Counts* cell = nullptr;
  std::smatch m;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.size() > 300) continue;  // tables; the forms are short
    if (std::regex_search(line, m, cell_form)) {
      cell = &(costs[m[1]] = {});
      (*cell)[Resource::gates] = 1;
    } else if (cell && std::regex_search(line, m, area_form)) {
      (*cell)[Resource::area] = area_of(m[1], {file, line, number, static_cast<size_t>(m.position(1))});
    } else if (cell && std::regex_search(line, m, register_form)) {
      (*cell)[Resource::gates] = 0;
      (*cell)[Resource::ff] = 1;
    }
  }
  if (costs.empty()) throw InputError(file + ": describes no cell", "a liberty file is needed");
  return [costs](const std::string& type) -> std::optional<Counts> {
    const auto found = costs.find(type);
    if (found == costs.end()) return std::nullopt;
    return found->second;
  };
}

const Target* nearest_that_holds(const Counts& used, const Target& except) {
  const Target* best = nullptr;
  for (const Target& t : targets()) {
    if (t.family == Family::asic || t.name == except.name) continue;
    const auto& resources = resources_of(t.family);
    const bool room = std::all_of(resources.begin(), resources.end(), [&](Resource r) {
      return static_cast<double>(used[r]) <= planned_share(t, r) * static_cast<double>(t.holds[r]);
    });
    if (room && (!best || t.holds[Resource::lut] < best->holds[Resource::lut])) best = &t;
  }
  return best;
}

}  // namespace cuboct::synth
