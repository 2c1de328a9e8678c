// SPDX-License-Identifier: MIT
// JSON files of other tools, without the parts that nobody reads.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace cuboct::synth {

// Throws std::runtime_error ("FILE: ...") where it cannot be read or is no JSON. Members named in `without`
// are left out while reading: a netlist's connections are ten times the rest.
nlohmann::json read_json(const std::string& file, const std::vector<std::string>& without = {});

}  // namespace cuboct::synth
