// SPDX-License-Identifier: MIT
// Rules that between them have every kind of law, and those of the committed scenes.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "model/contract/law.h"
#include "model/scene/scene.h"
#include "tests/fcc_block.h"

namespace cuboct::test {

struct NamedRule {
  std::string name;
  Rule rule;
};

// Two materials and a damping of a tenth of the critical.
inline Rule full_rule(std::shared_ptr<const PairLaw> law, double mass, double dt, double stiffness) {
  Rule rule = simple_rule(std::move(law), mass, dt);
  rule.damping.coefficient = 0.2 * std::sqrt(stiffness * mass);
  rule.types.push_back(rule.types[0]);
  rule.types[1].material = 1;
  rule.strength = {{1.0, 0.7}, {0.7, 1.9}};
  return rule;
}

inline std::vector<NamedRule> made_rules() {
  std::vector<NamedRule> rules;
  for (const char* name : {"elastic", "brittle", "ductile", "viscous"})
    rules.push_back({name, full_rule(preset_law(name, 1e-3, 1e3), 1e-6, 3e-6, 1e3)});
  rules.push_back({"contact", rules[1].rule});
  Rule& touch = rules.back().rule;
  touch.contact = {{0, 1}, {1, 0}};
  touch.contact_distance = push_end(*touch.law);
  rules.push_back({"masses", rules[2].rule});
  Rule& heavy = rules.back().rule;
  heavy.masses = {heavy.mass, 2.7 * heavy.mass};
  const double epsilon = 1.65e-21, sigma = 3.4e-10, mass = 6.6e-26;  // argon
  const double stiffness = 57 * epsilon / (sigma * sigma);
  const auto lj = [&](double cutoff, double core, Smoothing smoothing) {
    return full_rule(lennard_jones(epsilon, sigma, cutoff * sigma, core * sigma, smoothing), mass, 1e-14,
                     stiffness);
  };
  rules.push_back({"lj", lj(2.5, 0.6, Smoothing::none)});
  rules.push_back({"lj_deep_core", lj(2.5, 0.1, Smoothing::none)});
  rules.push_back({"lj_smooth", lj(2.2, 0.7, Smoothing::linear)});
  const std::vector<double> r{0.4e-3, 0.7e-3, 1e-3, 1.1e-3, 1.3e-3, 1.7e-3}, f{0.5, 0.3, 0, -0.08, -0.03, 0};
  for (const auto by : {Interpolation::monotone_cubic, Interpolation::b_spline}) {
    const std::string name = by == Interpolation::b_spline ? "b_spline" : "cubic";
    rules.push_back({name, full_rule(spline_law(r, f, by, 0.5e-3), 1e-6, 3e-6, 1e3)});
    // From its first point on, and a last force that jumps.
    std::vector<double> jump = f;
    jump.back() = 0.05;
    rules.push_back({name + "_jump", full_rule(spline_law(r, jump, by, r[0]), 1e-6, 3e-6, 1e3)});
    // Joints near each other: bins of two and more.
    std::vector<double> near_r = r, near_f = f;
    near_r.insert(near_r.begin() + 3, {1.00001e-3, 1.00002e-3, 1.00003e-3});
    near_f.insert(near_f.begin() + 3, {-0.8e-5, -1.7e-5, -2.5e-5});
    rules.push_back({name + "_crowded", full_rule(spline_law(near_r, near_f, by, 0.5e-3), 1e-6, 3e-6, 1e3)});
    std::vector<double> many_r, many_f;
    for (int k = 0; k <= 40; ++k) {
      many_r.push_back((0.5 + 0.03 * k + 0.004 * (k % 3)) * 1e-3);
      many_f.push_back(0.3 * std::cos(0.2 * k) * (1 - k / 40.0));
    }
    rules.push_back({name + "_many", full_rule(spline_law(many_r, many_f, by, 0.6e-3), 1e-6, 3e-6, 1e3)});
  }
  return rules;
}

// Four laws of other kinds and cutoffs, one for each pair of three types but two; two only touch.
inline NamedRule several_laws() {
  const std::vector<double> r{0.4e-3, 0.7e-3, 1e-3, 1.1e-3, 1.2e-3}, f{0.5, 0.3, 0, -0.08, 0};
  NamedRule named{"several", full_rule(spline_law({0.3e-3, 1e-3, 1.2e-3, 1.7e-3}, {0.5, 0, -0.1, 0},
                                                  Interpolation::monotone_cubic, 0.5e-3),
                                       1e-6, 3e-6, 1e3)};
  Rule& rule = named.rule;
  rule.types.push_back(rule.types[0]);
  rule.types[2].material = 2;
  rule.strength = {{1.0, 0.7, 0.4}, {0.7, 1.9, 1.2}, {0.4, 1.2, 1}};
  rule.other_laws = {preset_law("brittle", 1e-3, 1e3), spline_law(r, f, Interpolation::b_spline, 0.45e-3),
                     lennard_jones(1e-5, 0.9e-3, 1.5e-3, 0.6e-3)};
  rule.law_index = {{0, 1, 2}, {1, 3, 0}, {2, 0, 2}};
  rule.contact = {{0, 1, 0}, {1, 0, 0}, {0, 0, 0}};
  rule.contact_distance = push_end(*rule.other_laws[0]);
  return named;
}

// Of all committed scenes (archs have no law) but the large ones of the benchmarks.
inline std::vector<NamedRule> scene_rules() {
  namespace fs = std::filesystem;
  std::vector<fs::path> paths;
  for (const char* folder : {"scenes", "scenes/failures", "scenes/validation"})
    for (const auto& entry : fs::directory_iterator(fs::path(CUBOCT_SOURCE_DIR) / folder))
      if (entry.path().extension() == ".toml") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<NamedRule> rules;
  for (const fs::path& path : paths) {
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    if (text.str().find("\n[law]") != std::string::npos)
      rules.push_back({path.stem().string(), read_scene(path.string()).rule});
  }
  return rules;
}

}  // namespace cuboct::test
