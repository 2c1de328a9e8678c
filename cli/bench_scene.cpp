// SPDX-License-Identifier: MIT
#include "cli/bench_scene.h"

#include <fmt/format.h>

#include <fstream>
#include <optional>
#include <stdexcept>

#include "hw/engines.h"
#include "model/base/output.h"
#include "model/base/process.h"

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

std::shared_ptr<const Loaded> load_bench(const BenchScene& scene) {
  static std::optional<BenchScene> latest;
  static std::shared_ptr<const Loaded> loaded;
  if (latest != scene) {
    loaded.reset();  // before the next one takes its memory
    const Scratch scratch;
    const std::string path = scratch.path("block.toml");
    write_text(path, scene.text());
    Input input;
    input.scene = path;
    if (const std::string arch = scene.arch(); !arch.empty()) {
      input.arch = scratch.path("arch.toml");
      write_text(input.arch, arch);
    }
    loaded = std::make_shared<const Loaded>(load_plan(input));
    latest = scene;
  }
  return loaded;
}

bool fits_in_memory(uint64_t particles) {
  std::ifstream in("/proc/meminfo");
  std::string name, unit;
  for (uint64_t kilobytes = 0; in >> name >> kilobytes; std::getline(in, unit))
    if (name == "MemAvailable:") return particles * 300 < kilobytes * 1024;
  return true;
}

}  // namespace cuboct
