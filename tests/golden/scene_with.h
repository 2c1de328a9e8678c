// SPDX-License-Identifier: MIT
// A committed scene with some of its values replaced, and its run in golden's bits (the lattice engine holds
// them).
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "emu/lattice/run.h"
#include "hw/plan/setup.h"
#include "model/config/changes.h"

namespace cuboct::test {

inline Scene scene_with(const std::string& path, const std::vector<Change>& changes) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  const auto copy =
      std::filesystem::temp_directory_path() / ("cuboct_scene_with_" + std::to_string(::getpid()) + ".toml");
  std::ofstream(copy) << with_changes(text.str(), path, changes);
  Scene scene = read_scene(copy.string());
  std::filesystem::remove(copy);
  return scene;
}

// The curves of the scene's probes every `probe_every` steps, and the energies where asked.
inline std::vector<Curve> curves_of(const Scene& scene, const Arch& arch, bool energies = false) {
  const Plan plan = plan_of(scene, arch);
  emu::LatticeRun request;
  request.steps = scene.steps;
  request.energies = energies;
  request.hash_every = scene.steps;
  request.engine.threads = 1;
  for (uint64_t step = 0; step <= scene.steps; step += scene.probe_every) request.probes.push_back(step);
  const Trace trace = emu::run_lattice(scene, plan, request).trace;
  if (trace.stop) throw std::runtime_error(trace.stop->text);
  return trace.curves;
}

inline const Curve& curve_named(const std::vector<Curve>& curves, const std::string& name) {
  for (const Curve& curve : curves)
    if (curve.name == name) return curve;
  throw std::runtime_error("no curve " + name);
}

}  // namespace cuboct::test
