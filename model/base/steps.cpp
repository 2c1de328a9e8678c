// SPDX-License-Identifier: MIT
#include "model/base/steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "model/base/error.h"
#include "model/base/input_file.h"

namespace cuboct {

std::vector<uint64_t> read_steps(const std::string& path) {
  std::istringstream in(read_input(path));
  std::vector<uint64_t> steps;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) continue;
    const char* const end = line.data() + line.size();
    uint64_t step = 0;
    const auto [stopped, error] = std::from_chars(line.data(), end, step);
    if (error != std::errc{} || stopped != end)
      throw InputError(path, number, 1, fmt::format("expected a step, got '{}'", line),
                       "one number per line");
    steps.push_back(step);
  }
  put_in_order(steps);
  return steps;
}

void put_in_order(std::vector<uint64_t>& steps) {
  std::sort(steps.begin(), steps.end());
  steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
}

std::vector<uint64_t> every_so_often(uint64_t every, uint64_t last) {
  constexpr uint64_t kMost = 10'000'000;  // states; memory goes first
  if (every > 0 && last / every > kMost)
    throw InputError(fmt::format("every {} of {} steps are {} states: at most {} can be kept", every, last,
                                 last / every, kMost));
  std::vector<uint64_t> steps{0};
  for (uint64_t step = every; every > 0 && step < last; step += every) steps.push_back(step);
  if (last > 0) steps.push_back(last);
  return steps;
}

}  // namespace cuboct
