// SPDX-License-Identifier: MIT
#include "rtl/synth/json_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>

namespace cuboct::synth {

nlohmann::json read_json(const std::string& file, const std::vector<std::string>& without) {
  using Json = nlohmann::json;
  std::ifstream in(file);
  if (!in) throw std::runtime_error(fmt::format("{}: cannot be read", file));
  const auto wanted = [&](int, Json::parse_event_t event, Json& parsed) {
    return event != Json::parse_event_t::key ||
           std::find(without.begin(), without.end(), parsed.get_ref<const std::string&>()) == without.end();
  };
  try {
    return Json::parse(in, wanted);
  } catch (const Json::parse_error& error) {
    throw std::runtime_error(fmt::format("{}: is not JSON, at byte {}", file, error.byte));
  }
}

}  // namespace cuboct::synth
