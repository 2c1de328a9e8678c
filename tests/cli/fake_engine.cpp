// SPDX-License-Identifier: MIT
// An engine that lies as told, to see that `cuboct crosscheck` finds out: golden's states with the fault that
// the variable LIE names. It stands beside a copy of cuboct as cuboct-systemc and cuboct-rtl; only the latter
// lies.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "hw/setup.h"
#include "model/contract/golden.h"
#include "model/trace/trace.h"

namespace {

using namespace cuboct;

int run(int argc, char** argv) {
  std::string scene, arch, out, frames_file;
  uint64_t steps = 0;
  std::vector<uint64_t> frames;
  CLI::App app;
  app.add_option("scene", scene);
  app.add_option("--arch", arch);
  app.add_option("--steps", steps);
  app.add_option("--out", out);
  app.add_option("--frames", frames)->delimiter(',');
  app.add_option("--frames-file", frames_file);
  app.add_flag("--progress");
  CLI11_PARSE(app, argc, argv);

  std::ifstream list(frames_file);
  for (uint64_t step; list >> step;) frames.push_back(step);
  const std::string name = std::filesystem::path(argv[0]).filename().string();
  const char* told = std::getenv("LIE");
  const std::string lie = told && name == "cuboct-rtl" ? told : "";
  if (lie == "refuse") throw InputError("refused by the fake engine");
  if (lie == "crash") std::abort();
  if (lie == "nothing") return 1;

  const Setup setup = make_setup(read_scene(scene), read_arch(arch));
  Trace trace;
  trace.engine = name.substr(name.find('-') + 1);
  trace.plan_hash = setup.plan.hash + (lie == "plan");
  trace.nodes = setup.plan.lattice.size();
  Golden golden(setup.plan.rule, setup.plan.lattice, setup.plan.arch.capacity, setup.initial);
  for (uint64_t step = 0;; ++step) {
    State state = golden.state();
    if (lie == "state" && step >= 3) state.particles[17].v[1] ^= 1;
    trace.state_hash.push_back(hash_of(setup.plan.lattice, state) + (lie == "hash" && step == 2));
    if (std::find(frames.begin(), frames.end(), step) != frames.end()) trace.frames.push_back(state);
    if (step == steps) break;
    for (uint64_t node = 0; node < trace.nodes; ++node)
      for (uint64_t phase = 0; phase < kPhases; ++phase) {
        const uint64_t start = 100 * step + 10 * phase;
        const bool late = lie == "cycles" && step == 2 && node == 5 && phase == 3;
        trace.cycles.push_back({start, start + 9 + late});
      }
    try {
      golden.step();
    } catch (const RunError& e) {
      trace.stop = StopReason{e.fault, e.step, e.cell, e.particle, e.number, e.what()};
      break;
    }
  }
  if (lie == "stop") trace.stop = StopReason{Fault::sum, steps, 1, 2, 3, "stopped by the fake engine"};
  write_trace(out, trace);
  return trace.stop ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const cuboct::InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
