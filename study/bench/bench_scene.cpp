// SPDX-License-Identifier: MIT
#include "study/bench/bench_scene.h"

#include <fmt/format.h>

#include <optional>
#include <stdexcept>

#include "model/base/resources.h"

namespace cuboct {
namespace {

// The embedded scene's text must hold what is put in place of it.
void replace(std::string& text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the block scene does not hold: " + from);
  text.replace(at, from.size(), to);
}

}  // namespace

std::string BenchScene::text() const {
  if (impact) return kBenchImpact;
  std::string text = kBenchBlock;
  replace(text, "cells = [20, 20, 20]", fmt::format("cells = [{0}, {0}, {0}]", cells));
  if (damped) replace(text, "[run]", "[damping]\nratio = 0.1\n\n[run]");
  return text;
}

std::string BenchScene::arch() const { return impact ? kBenchImpactArch : ""; }

std::shared_ptr<const BenchCase> make_case(const BenchScene& scene) {
  static std::optional<BenchScene> latest;
  static std::shared_ptr<const BenchCase> made;
  if (latest != scene) {
    made.reset();  // before the next one takes its memory
    BenchCase next{parse_scene(scene.text(), "block.toml"), {}};
    next.plan = plan_of(next.scene, scene.impact ? parse_arch(scene.arch(), "arch.toml") : Arch());
    made = std::make_shared<const BenchCase>(std::move(next));
    latest = scene;
  }
  return made;
}

bool fits_in_memory(uint64_t particles) { return particles < free_memory() / 300; }

}  // namespace cuboct
