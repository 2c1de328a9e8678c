// SPDX-License-Identifier: MIT
#include "model/mesh/stated_unit.h"

#include <algorithm>
#include <utility>

namespace cuboct {

double metres_of(const std::string& unit) {
  constexpr std::pair<const char*, double> kUnits[] = {
      {"micron", 1e-6}, {"millimeter", 1e-3}, {"centimeter", 1e-2}, {"inch", 0.0254},
      {"foot", 0.3048}, {"feet", 0.3048},     {"meter", 1},
  };
  const auto* const found = std::ranges::find(kUnits, unit, [](const auto& u) { return u.first; });
  return found == std::end(kUnits) ? 0 : found->second;
}

std::string attribute(const std::string& xml, const std::string& name, const std::string& key,
                      const std::string& otherwise) {
  constexpr const char* kBlank = " \t\r\n";
  for (size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const size_t end = std::min(xml.find('>', at), xml.size());
    const std::string element =
        xml.substr(at + 1, std::min(xml.find_first_of(" \t\r\n/>", at), end) - at - 1);
    if (element.substr(element.find(':') + 1) != name) continue;
    for (size_t k = xml.find_first_of(kBlank, at); k < end; k = xml.find_first_of(kBlank, k + 1)) {
      if (xml.compare(k + 1, key.size(), key) != 0) continue;
      const size_t sign = xml.find_first_not_of(kBlank, k + 1 + key.size());
      if (sign >= end || xml[sign] != '=') continue;
      const size_t open = xml.find_first_not_of(kBlank, sign + 1);
      if (open >= end || (xml[open] != '"' && xml[open] != '\'')) break;
      return xml.substr(open + 1, std::min(xml.find(xml[open], open + 1), end) - open - 1);
    }
    break;
  }
  return otherwise;
}

}  // namespace cuboct
