// SPDX-License-Identifier: MIT
#include "study/sweep/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <tuple>

#include "study/sweep/numbers.h"

namespace cuboct::study {
namespace {

constexpr char kScene[] = "scene.", kArch[] = "arch.";

// All that errors depend on, by key: changes as "scene.run.dt", the rest under "engine" and so on.
using Values = std::map<std::string, std::string>;
Values values_of(const Settings& settings) {
  Values values{{"engine", settings.engine},
                {"arithmetic", std::to_string(static_cast<int>(settings.arithmetic))},
                {"integrator", std::to_string(static_cast<int>(settings.integrator))}};
  for (const Change& change : settings.scene) values[kScene + change.key] = change.value;
  for (const Change& change : settings.arch) values[kArch + change.key] = change.value;
  return values;
}

std::string value_in(const Values& values, const std::string& key) {
  const auto found = values.find(key);
  return found == values.end() ? "" : found->second;
}

// Where the study does not set it: that of the arch, which is 1 by default.
int degree_of(const Settings& settings) {
  return value_in(values_of(settings), "arch.table.degree") == "2" ? 2 : 1;
}

bool is_time_step(const std::string& key) { return key == "scene.run.dt" || key == "scene.run.dt_safety"; }

// TOML text of a number, or of a quantity with its unit.
struct Number {
  double value = NAN;
  std::string unit;
};
std::optional<Number> number_of(std::string text) {
  if (text.size() > 1 && (text.front() == '"' || text.front() == '\''))
    text = text.substr(1, text.size() - 2);
  std::erase(text, '_');
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || !std::isfinite(value)) return std::nullopt;
  std::string unit = end;
  unit.erase(0, unit.find_first_not_of(' '));
  return Number{value, unit};
}

std::string unquoted(const std::string& text) {
  return text.size() > 1 && text.front() == '"' && text.back() == '"' ? text.substr(1, text.size() - 2)
                                                                      : text;
}

// Bits and small counts stay linear.
bool wants_logarithm(const Parameter& p) {
  double low = INFINITY, high = -INFINITY;
  bool counts = true;
  for (const double x : p.x)
    if (std::isfinite(x)) {
      low = std::min(low, x), high = std::max(high, x);
      counts = counts && x == std::floor(x) && x < 100;
    }
  return p.names.empty() && !counts && low > 0 && high >= 4 * low;
}

// The keys that change with x, one value for each: a preset sets several at once. (A function one way alone
// would take a sum of two settings for the cause of both.)
std::set<std::string> followers(const std::vector<Values>& all, const std::set<std::string>& keys,
                                const std::vector<double>& x) {
  std::set<std::string> follows;
  for (const std::string& key : keys) {
    std::map<double, std::string> value_at;
    std::map<std::string, double> x_at;
    bool one_to_one = true;
    for (size_t n = 0; n < all.size(); ++n) {
      if (!std::isfinite(x[n])) continue;
      const std::string value = value_in(all[n], key);
      one_to_one = one_to_one && value_at.try_emplace(x[n], value).first->second == value &&
                   x_at.try_emplace(value, x[n]).first->second == x[n];
    }
    if (one_to_one) follows.insert(key);
  }
  return follows;
}

// Sweeps of outcomes that are equal in everything but what `follows` x.
std::vector<Sweep> sweeps_of(const Results& results, const std::vector<Values>& all,
                             const std::vector<double>& x, const std::set<std::string>& follows) {
  std::map<std::string, size_t> index;  // of the sweep with these other values
  std::vector<std::map<double, size_t>> found;
  for (size_t n = 0; n < all.size(); ++n) {
    if (!std::isfinite(x[n]) || results.outcomes[n].status != Status::done) continue;
    std::string others;
    for (const auto& [key, value] : all[n])
      if (!follows.contains(key)) others += fmt::format("{}={}\n", key, value);
    const auto [at, added] = index.try_emplace(others, found.size());
    if (added) found.emplace_back();
    found[at->second].try_emplace(x[n], n);
  }
  std::vector<Sweep> sweeps;
  for (const auto& points : found) {
    if (points.size() < 2) continue;
    sweeps.emplace_back();
    for (const auto& [at, n] : points) sweeps.back().points.push_back(n);
  }
  return sweeps;
}

// Numbers where at least two values are numbers of one unit, else names in the order in which they occur.
Parameter parameter_of(const std::string& key, const std::vector<Values>& all) {
  Parameter p{key, key.substr(key.find('.') + 1), false, {}, std::vector<double>(all.size(), NAN), {}};
  std::set<double> numbers;
  std::set<std::string> units;
  for (const Values& values : all)
    if (const auto number = number_of(value_in(values, key))) {
      numbers.insert(number->value);
      units.insert(number->unit);
    }
  const bool numeric = numbers.size() > 1 && units.size() == 1;
  if (numeric && !units.begin()->empty()) p.label += ", " + *units.begin();
  for (size_t n = 0; n < all.size(); ++n) {
    const std::string value = value_in(all[n], key);
    if (value.empty()) continue;
    if (numeric) {
      const auto number = number_of(value);
      if (number) p.x[n] = number->value;
      continue;
    }
    const auto at = std::find(p.names.begin(), p.names.end(), unquoted(value));
    p.x[n] = static_cast<double>(at - p.names.begin());
    if (at == p.names.end()) p.names.push_back(unquoted(value));
  }
  return p;
}

}  // namespace

double Order::at(double x) const { return power != 0 ? std::pow(x, power) : std::exp2(-halvings * x); }

std::vector<Parameter> swept_parameters(const Results& results) {
  std::vector<Values> all;
  std::vector<std::string> scene_keys, arch_keys;
  std::set<std::string> keys;
  for (const Outcome& outcome : results.outcomes) {
    all.push_back(values_of(outcome.settings));
    for (const auto& [changes, prefix, order] : {std::tuple(&outcome.settings.scene, kScene, &scene_keys),
                                                 std::tuple(&outcome.settings.arch, kArch, &arch_keys)})
      for (const Change& change : *changes)
        if (keys.insert(prefix + change.key).second) order->push_back(prefix + change.key);
  }
  std::vector<Parameter> found;
  const auto keep = [&](Parameter p, const std::set<std::string>& follows) {
    p.logarithmic = wants_logarithm(p);
    p.sweeps = sweeps_of(results, all, p.x, follows);
    if (!p.sweeps.empty()) found.push_back(std::move(p));
  };
  Parameter dt{"dt", "time step, s", false, {}, {}, {}};
  for (const Outcome& outcome : results.outcomes) dt.x.push_back(outcome.dt > 0 ? outcome.dt : NAN);
  // A pitch has its own time steps, yet does not follow from them.
  keep(std::move(dt), {"scene.run.dt", "scene.run.dt_safety"});
  for (const auto* order : {&scene_keys, &arch_keys})
    for (const std::string& key : *order)
      if (!is_time_step(key)) {
        Parameter parameter = parameter_of(key, all);
        std::set<std::string> follows = followers(all, keys, parameter.x);
        follows.insert(key);
        keep(std::move(parameter), follows);
      }
  return found;
}

std::vector<Order> expected_orders(const Results& results, const Parameter& parameter, const Measure& error) {
  using Kind = Measure::Kind;
  const bool motion = error.kind == Kind::trajectory || error.kind == Kind::figure;
  if ((!motion && error.kind != Kind::force) || !parameter.names.empty()) return {};
  if (parameter.id == "dt")
    return motion ? std::vector<Order>{{"dt, where something damps", 1, 0, 0}, {"dt²", 2, 0, 0}}
                  : std::vector<Order>{};
  if (parameter.id == "scene.packing.pitch")
    return error.kind == Kind::figure
               ? std::vector<Order>{{"pitch, of free surfaces", 1, 0, 0}, {"pitch², of the bulk", 2, 0, 0}}
               : std::vector<Order>{};
  if (parameter.id == "arch.table.index_bits") {
    std::set<int> degrees;
    for (size_t n = 0; n < results.outcomes.size(); ++n)
      if (std::isfinite(parameter.x[n])) degrees.insert(degree_of(results.outcomes[n].settings));
    std::vector<Order> orders;
    for (const int degree : degrees)
      orders.push_back(
          {fmt::format("bins{}, degree {}", superscript(-degree - 1), degree), 0, degree + 1.0, degree});
    return orders;
  }
  // The guard's bits are of velocities, which no force depends on.
  if (parameter.id == "arch.widths.guard")
    return motion ? std::vector<Order>{{"2^-bits", 0, 1, 0}} : std::vector<Order>{};
  if (parameter.id == "arch.widths.position_frac" || parameter.id == "arch.widths.difference_frac" ||
      parameter.id == "arch.widths.strength_bits" || parameter.id == "arch.table.fraction_bits")
    return {{"2^-bits", 0, 1, 0}};
  return {};
}

std::optional<Line> order_line(const Results& results, const Parameter& parameter, const Measure& error,
                               const Order& order) {
  // From coarse to fine the order falls.
  const bool falls_with_x = order.power <= 0;
  double coarse = NAN, fine = NAN, least = NAN;
  for (const Sweep& sweep : parameter.sweeps)
    for (const size_t n : sweep.points) {
      const double x = parameter.x[n], e = error.value(results.outcomes[n]);
      if (!(e > 0) || !std::isfinite(e)) continue;
      if (order.degree > 0 && order.degree != degree_of(results.outcomes[n].settings)) continue;
      const bool coarser = falls_with_x ? x < coarse : x > coarse;
      const bool finer = falls_with_x ? x > fine : x < fine;
      if (std::isnan(fine) || finer) fine = x;
      if (std::isnan(coarse) || coarser) coarse = x, least = e;
      if (x == coarse) least = std::min(least, e);
    }
  if (std::isnan(coarse) || coarse == fine) return std::nullopt;
  return Line{{coarse, least}, {fine, least * order.at(fine) / order.at(coarse)}};
}

}  // namespace cuboct::study
