// SPDX-License-Identifier: MIT
// JSON files of other tools.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace cuboct::synth {

// Throws std::runtime_error ("FILE: ...") where it cannot be read or is no JSON. Whole, as the library's
// filter while reading takes quadratic time in an object's members, and a netlist has ten thousands of cells.
nlohmann::json read_json(const std::string& file);

}  // namespace cuboct::synth
