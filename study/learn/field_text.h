// SPDX-License-Identifier: MIT
// Fields of a sheet in kept lines: x and y of each point in turn.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "model/base/json.h"
#include "model/base/vec.h"

namespace cuboct::learn {

inline std::string text_of_field(const std::vector<Vec3>& field) {
  std::vector<double> flat;
  for (const Vec3& one : field) flat.insert(flat.end(), {one[0], one[1]});
  return json(flat);
}

inline std::vector<Vec3> field_of(const nlohmann::json& numbers) {
  std::vector<Vec3> out;
  for (size_t k = 0; k + 1 < numbers.size(); k += 2)
    out.emplace_back(numbers.at(k).get<double>(), numbers.at(k + 1).get<double>(), 0);
  return out;
}

}  // namespace cuboct::learn
