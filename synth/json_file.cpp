// SPDX-License-Identifier: MIT
#include "synth/json_file.h"

#include <fmt/format.h>

#include <fstream>
#include <stdexcept>

namespace cuboct::synth {

nlohmann::json read_json(const std::string& file) {
  using Json = nlohmann::json;
  std::ifstream in(file);
  if (!in) throw std::runtime_error(fmt::format("{}: cannot be read", file));
  try {
    return Json::parse(in);
  } catch (const Json::parse_error& error) {
    throw std::runtime_error(fmt::format("{}: is not JSON, at byte {}", file, error.byte));
  } catch (const Json::out_of_range&) {
    throw std::runtime_error(file + ": holds a number beyond those of doubles");
  }
}

}  // namespace cuboct::synth
