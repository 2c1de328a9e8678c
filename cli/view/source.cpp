// SPDX-License-Identifier: MIT
#include "cli/view/source.h"

#include "model/base/json.h"
#include "model/trace/curve_readings.h"

namespace cuboct {

std::string Story::json() const {
  return json_object(
      {{"head", head},
       {"frames", json_array(frames)},
       {"curves", json_array(curves, curve_json)},
       {"warnings", cuboct::json(warnings)},
       {"lines", cuboct::json(lines)},
       {"facts", json_array(facts,
                            [](const auto& fact) {
                              return cuboct::json(std::vector<std::string>{fact.first, fact.second});
                            })},
       {"left_out", cuboct::json(left_out)},
       {"machine", machine},
       {"with", with},
       {"live", cuboct::json(live)},
       {"may_end", cuboct::json(may_end)},
       {"steered", steered}});
}

Bytes row_of(const std::string& block, size_t bytes, size_t row) {
  if (row >= block.size() / bytes) return nullptr;
  return std::make_shared<const std::string>(block.substr(row * bytes, bytes));
}

}  // namespace cuboct
