// SPDX-License-Identifier: MIT
// JSON files of other tools.
#pragma once

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

namespace cuboct::synth {

// Throws std::runtime_error ("FILE: ...") where it cannot be read or is no JSON. Whole, as the library's
// filter while reading takes quadratic time in an object's members, and a netlist has ten thousands of cells.
nlohmann::json read_json(const std::string& file);

// What `read` makes of a netlist. Throws std::runtime_error, too, where `read` asks for what is not there.
template <typename Read>
auto read_netlist_json(const std::string& file, Read read) {
  const nlohmann::json json = read_json(file);
  try {
    return read(json);
  } catch (const nlohmann::json::exception&) {
    throw std::runtime_error(file + ": is no netlist as yosys writes it");
  }
}

// Modules of a netlist lie in one another at most so deep; deeper is one that holds itself.
inline constexpr int kDeepest = 1000;

}  // namespace cuboct::synth
