// SPDX-License-Identifier: MIT
#include "emu/gpu/bench/bench_rows.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "model/base/error.h"
#include "model/base/spelling.h"

namespace cuboct::gpu {
namespace {

// The embedded scene's text must hold what is put in place of it.
void replace(std::string& text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the benchmark's scene does not hold: " + from);
  text.replace(at, from.size(), to);
}

using Kind = BenchScene::Kind;

const char* word(Kind kind, bool damped) {
  if (kind == Kind::block) return damped ? "damped" : "block";
  return kind == Kind::melt ? "melt" : "solid";
}

const char* words(Kind kind, bool damped) {
  if (kind == Kind::block) return damped ? "bonded FCC block, damped" : "bonded FCC block";
  return kind == Kind::melt ? "Lennard-Jones melt" : "Lennard-Jones crystal";
}

}  // namespace

std::string BenchScene::text() const {
  std::string text = kind == Kind::block ? kBenchBlock : kind == Kind::melt ? kBenchMelt : kBenchSolid;
  replace(text, "20 x 20 x 20 cells", fmt::format("{0} x {0} x {0} cells", cells));
  replace(text, "cells = [20, 20, 20]", fmt::format("cells = [{0}, {0}, {0}]", cells));
  if (damped) replace(text, "[run]", "[damping]\nratio = 0.1\n\n[run]");
  return text;
}

std::string BenchScene::arch() const { return kind == Kind::block ? "" : kBenchLjArch; }

std::vector<BenchRow> bench_rows() {
  std::vector<BenchRow> rows;
  const auto add = [&](const char* size, int cells, Kind kind, bool damped, const char* arithmetic) {
    const BenchScene scene{kind, cells, damped};
    rows.push_back({scene, arithmetic, fmt::format("{}_{}.{}", word(kind, damped), size, arithmetic),
                    fmt::format("{}, {} particles, {}", words(kind, damped), scene.particles(), arithmetic)});
  };
  const std::pair<const char*, int> sizes[] = {{"256k", 40}, {"2m", 80}, {"16m", 160}};
  for (const auto& [size, cells] : sizes) {
    for (const char* arithmetic : {"float", "double", "fixed"})
      add(size, cells, Kind::block, false, arithmetic);
    for (const char* arithmetic : {"float", "fixed"}) add(size, cells, Kind::block, true, arithmetic);
    if (cells > 80) continue;
    for (const Kind kind : {Kind::melt, Kind::solid})
      for (const char* arithmetic : {"float", "double", "fixed"}) add(size, cells, kind, false, arithmetic);
  }
  return rows;
}

std::vector<BenchRow> choose_rows(const std::vector<BenchRow>& rows, const std::string& name) {
  std::vector<BenchRow> chosen;
  std::vector<std::string> names;
  for (const BenchRow& row : rows) {
    names.push_back(row.name);
    if (name.empty() || row.name == name || row.name.starts_with(name + ".") ||
        row.name.starts_with(name + "_"))
      chosen.push_back(row);
  }
  if (!chosen.empty()) return chosen;
  const std::string near = did_you_mean(name, names);
  throw InputError(fmt::format("no benchmark '{}'", name), near.empty() ? "--list names them" : near);
}

}  // namespace cuboct::gpu
