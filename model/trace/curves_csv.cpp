// SPDX-License-Identifier: MIT
#include "model/trace/curves_csv.h"

#include <fmt/format.h>

#include <iterator>
#include <set>

namespace cuboct {
namespace {

std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

}  // namespace

std::string curves_csv(const std::vector<Curve>& curves, std::optional<double> dt, bool units) {
  std::set<uint64_t> steps;
  for (const Curve& curve : curves) steps.insert(curve.step.begin(), curve.step.end());
  fmt::memory_buffer out;
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "step{}", !dt ? "" : units ? ",time (s)" : ",time");
  for (const Curve& curve : curves)
    fmt::format_to(to, ",{}",
                   cell(!units || curve.unit == "1" || curve.unit.empty()
                            ? curve.name
                            : fmt::format("{} ({})", curve.name, curve.unit)));
  std::vector<size_t> next(curves.size());
  for (const uint64_t step : steps) {
    fmt::format_to(to, "\n{}", step);
    if (dt) fmt::format_to(to, ",{}", static_cast<double>(step) * *dt);
    for (size_t k = 0; k < curves.size(); ++k) {
      const Curve& curve = curves[k];
      const bool has = next[k] < curve.step.size() && curve.step[next[k]] == step;
      if (has)
        fmt::format_to(to, ",{}", curve.value[next[k]++]);
      else
        out.push_back(',');
    }
  }
  out.push_back('\n');
  return fmt::to_string(out);
}

}  // namespace cuboct
