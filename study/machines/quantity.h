// SPDX-License-Identifier: MIT
// The numbers that a machine is judged by: what constraints and objectives of a study name.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "hw/cost/technology.h"
#include "model/base/units.h"

namespace cuboct::study {

// How a number is known. `exact`: counted, of the steps that were counted. `estimated`: by a model, or with
// figures of a technology. `measured`: by runs against the truth, or by synthesis.
enum class Known : uint8_t { none, exact, estimated, measured };
const char* to_string(Known known);

// A number as a band; one that is not one has equal ends. `open`: something that is not in it would make it
// larger, so that its high end claims nothing.
struct MachineValue {
  Band band{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  Known known = Known::none;
  bool open = false;

  bool there() const { return known != Known::none; }
  static MachineValue of(double value, Known known) { return {{value, value}, known, false}; }
  bool operator==(const MachineValue&) const = default;
};

enum class MachineQuantity : uint8_t {
  cycles,  // per step, mean
  rate,    // steps/s
  time,    // s of a step
  energy,  // J of a particle's step
  power,   // W
  area,    // m^2
  nodes,
  lut,
  ff,
  dsp,
  bram,
  error  // of the figures, the largest; the study's own follow, `error.NAME`
};
inline constexpr size_t kMachineQuantities = static_cast<size_t>(MachineQuantity::error) + 1;

struct QuantityName {
  const char* name;   // in constraints, objectives and tables
  const char* unit;   // of its values; empty: a number
  const char* label;  // of an axis
  Dimension dimension;
  bool more_is_better = false;
};
const QuantityName& named(MachineQuantity quantity);

// 12.3, "" or 1e6 with the unit's prefix: "3.2 W", "1.3 mm^2", "2 to 7 nJ".
std::string value_text(MachineQuantity quantity, const MachineValue& value);

// The place of a number among a machine's: the quantities, then each figure's error.
std::vector<std::string> measure_names(const std::vector<std::string>& figures);
// The quantity of that place.
MachineQuantity quantity_at(size_t measure);

}  // namespace cuboct::study
