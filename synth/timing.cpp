// SPDX-License-Identifier: MIT
#include "synth/timing.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <regex>
#include <sstream>
#include <string_view>
#include <system_error>

#include "model/base/error.h"
#include "synth/json_file.h"

namespace cuboct::synth {
namespace {

constexpr size_t kLongestLine = 200;  // of what is read; longer ones tell names of cells

// With which the text begins; nothing where that is no number, or one too large.
template <typename Number>
std::optional<Number> number_in(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

}  // namespace

Placed read_nextpnr_report(const std::string& file) {
  nlohmann::json json;
  try {
    json = read_json(file);
  } catch (const std::runtime_error& error) {
    throw InputError(error.what());
  }
  const auto refuse = [&](const char* why) {
    throw InputError(fmt::format("{}: {}", file, why), "nextpnr writes it with --report FILE");
  };
  if (!json.is_object() || !json.contains("fmax") || !json.contains("utilization"))
    refuse("is no report of nextpnr: it has no 'fmax' and 'utilization'");
  Placed placed;
  try {
    for (const auto& [clock, f] : json.at("fmax").items()) {
      const double achieved = f.at("achieved");
      placed.fmax = placed.fmax == 0 ? achieved : std::min(placed.fmax, achieved);
    }
    for (const auto& [kind, use] : json.at("utilization").items())
      placed.use[kind] = {use.at("used"), use.at("available")};
    // The path from register to register that takes longest.
    double longest = 0;
    for (const auto& path : json.value("critical_paths", nlohmann::json::array())) {
      if (path.at("from") != path.at("to") || !path.at("from").get<std::string>().starts_with("posedge"))
        continue;
      double total = 0;
      std::vector<std::string> parts;
      for (const auto& part : path.at("path")) {
        total += part.at("delay").get<double>();
        parts.push_back(fmt::format("{:.2f} ns {} {}", part.at("delay").get<double>(),
                                    part.at("type").get<std::string>(),
                                    part.at("to").at("cell").get<std::string>()));
      }
      if (total > longest) {
        longest = total;
        placed.critical = parts;
      }
    }
  } catch (const nlohmann::json::exception&) {
    refuse("is no report of nextpnr: an entry is of another kind");
  }
  if (placed.fmax <= 0) refuse("has no clock");
  return placed;
}

std::map<std::string, Use> read_utilisation(const std::string& log) {
  static const std::regex line_form(R"(^Info:\s+([A-Z0-9_]+):\s*(\d+)/\s*(\d+)\s+\d+%$)");
  std::map<std::string, Use> use;
  std::istringstream lines(log);
  std::smatch m;
  for (std::string line; std::getline(lines, line);)
    if (line.size() <= kLongestLine && line.starts_with("Info:") && std::regex_match(line, m, line_form)) {
      const auto used = number_in<uint64_t>(m[2].str()), available = number_in<uint64_t>(m[3].str());
      if (used && available) use[m[1]] = {*used, *available};
    }
  return use;
}

std::optional<double> read_icetime(const std::string& log) {
  static const std::regex form(R"(Total path delay: [0-9.]+ ns \(([0-9.]+) MHz\))");
  std::istringstream lines(log);
  std::smatch m;
  for (std::string line; std::getline(lines, line);)
    if (line.size() <= kLongestLine && std::regex_search(line, m, form)) return number_in<double>(m[1].str());
  return std::nullopt;
}

std::optional<Analysed> read_sta(const std::string& log) {
  static const std::regex slack_form(R"(^\s*(-?[0-9.]+)\s+slack \()"),
      power_form(R"(^Total\s+\S+\s+\S+\s+\S+\s+([0-9.eE+-]+)\s)");
  std::optional<double> slack, power;
  std::istringstream lines(log);
  std::smatch m;
  for (std::string line; std::getline(lines, line);) {
    if (line.size() > kLongestLine) continue;
    if (!slack && std::regex_search(line, m, slack_form)) slack = number_in<double>(m[1].str());
    if (std::regex_search(line, m, power_form)) power = number_in<double>(m[1].str());
  }
  if (!slack || !power) return std::nullopt;
  return Analysed{*slack, *power};
}

std::optional<uint64_t> read_depth(const std::string& log) {
  // std::regex would recurse over the whole log. `ltp` tells of each module.
  const std::string title = "Longest topological path", key = "(length=";
  std::optional<uint64_t> depth;
  for (size_t at = log.find(title); at != std::string::npos; at = log.find(title, at + title.size())) {
    const size_t length = log.find(key, at);
    if (length == std::string::npos) break;
    if (const auto cells = number_in<uint64_t>(std::string_view(log).substr(length + key.size(), 20)))
      depth = std::max(depth.value_or(0), *cells);
  }
  return depth;
}

}  // namespace cuboct::synth
