// SPDX-License-Identifier: MIT
#include "study/machines/quantity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "model/base/quantity_text.h"

namespace cuboct::study {
namespace {

constexpr Dimension kNoUnit{}, kTime{{0, 0, 1}}, kEnergy{{1, 2, -2}}, kPower{{1, 2, -3}}, kArea{{0, 2, 0}};

// By MachineQuantity.
constexpr std::array<QuantityName, kMachineQuantities> kNames{{
    {"cycles", "", "cycles per step", kNoUnit},
    {"steps/s", "", "steps per second", kNoUnit, true},
    {"time", "s", "seconds of a step", kTime},
    {"energy", "J", "joules per particle-step", kEnergy},
    {"power", "W", "watts", kPower},
    {"area", "m^2", "area, mm²", kArea},
    {"nodes", "", "nodes", kNoUnit},
    {"LUT", "", "LUTs", kNoUnit},
    {"FF", "", "flip-flops", kNoUnit},
    {"DSP", "", "multipliers of the device", kNoUnit},
    {"BRAM", "", "blocks of memory", kNoUnit},
    {"error", "", "largest relative error of a figure", kNoUnit},
}};

std::string number_of(double x) {
  return std::abs(x) >= 1e6 || (x != 0 && std::abs(x) < 1e-3) ? fmt::format("{:.3g}", x)
                                                              : fmt::format("{:.4g}", x);
}

}  // namespace

const char* to_string(Known known) {
  static constexpr const char* kWords[] = {"not known", "exact", "estimated", "measured"};
  return kWords[static_cast<size_t>(known)];
}

const QuantityName& named(MachineQuantity quantity) { return kNames[static_cast<size_t>(quantity)]; }

std::string value_text(MachineQuantity quantity, const MachineValue& value) {
  if (!value.there()) return "not known";
  const QuantityName& name = named(quantity);
  double scale = 1;
  std::string unit = name.unit;
  if (quantity == MachineQuantity::area) {
    scale = 1e-6, unit = "mm^2";
  } else if (!unit.empty()) {
    const Multiple multiple = multiple_of(value.band.high, unit);
    scale = multiple.unit, unit = multiple.name;
  }
  std::string text = number_of(value.band.low / scale);
  if (value.band.high != value.band.low) text += " to " + number_of(value.band.high / scale);
  if (value.open) text = "at least " + number_of(value.band.low / scale);
  return unit.empty() ? text : text + " " + unit;
}

std::vector<std::string> measure_names(const std::vector<std::string>& figures) {
  std::vector<std::string> names;
  for (const QuantityName& name : kNames) names.emplace_back(name.name);
  for (const std::string& figure : figures) names.push_back("error." + figure);
  return names;
}

MachineQuantity quantity_at(size_t measure) {
  return static_cast<MachineQuantity>(std::min(measure, kMachineQuantities - 1));
}

}  // namespace cuboct::study
