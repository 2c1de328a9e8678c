// SPDX-License-Identifier: MIT
// Scenes to their plan, archs to the plan of a small scene, technologies, kinds of links, and what yosys and
// nextpnr write.
#include <string>

#include "hw/arch/arch.h"
#include "hw/arch/device_link.h"
#include "hw/cost/technology.h"
#include "hw/engine/scene_engine.h"
#include "hw/plan/setup.h"
#include "model/scene/scene.h"
#include "synth/elaborate.h"
#include "synth/estimate.h"
#include "synth/netlist.h"
#include "synth/report.h"
#include "synth/target.h"
#include "synth/timing.h"
#include "tests/fuzz/targets.h"

namespace cuboct::fuzz {
namespace {

// Of more the plan takes long, and is no other.
constexpr size_t kMostParticles = 1000;

void plan(const Scene& scene, const Arch& arch) {
  if (scene.body.x.size() <= kMostParticles)
    with_places(scene, arch, [&] { return scene_plan_of(scene, arch); });
}

}  // namespace

void take_plan(Bytes input) {
  refusing([&] { plan(parse_scene(text_of(input), in_tree("scenes/fuzzed.toml")), Arch()); });
}

void take_arch(Bytes input) {
  refusing([&] {
    static const Scene scene = read_scene(in_tree("tests/synth/lone.toml"));
    plan(scene, parse_arch(text_of(input), "fuzzed.toml"));
  });
}

void take_technology(Bytes input) {
  const std::string text = text_of(input);
  refusing([&] { parse_technology(text, "fuzzed.toml"); });
  refusing([&] { parse_links(text, "fuzzed.toml"); });
  refusing([&] { parse_board_links(text, "fuzzed.toml"); });
}

void take_liberty(Bytes input) {
  refusing([&] {
    const synth::CostOf cost = synth::costs_of_liberty(file_of(input, "cells.lib"));
    cost("NAND");
  });
}

void take_json(Bytes input) {
  using namespace synth;
  const std::string path = file_of(input, "fuzzed.json");
  failing([&] {
    const Design design = read_design(path);
    bits_below(design, design.top);
    failing([&] { make_harness("cuboct_fifo", design.modules.at(module_of(design, "fifo")).ports); });
    read_netlist(path, design.top, design, design.top, costs_of(Family::ice40));
  });
  failing([&] { count_all(path, "top", costs_of(Family::ecp5)); });
  failing([&] { read_report(path); });
  failing([&] { read_nextpnr_report(path); });
  const std::string text = text_of(input);
  failing([&] { read_utilisation(text); });
  failing([&] { read_icetime(text); });
  failing([&] { read_sta(text); });
  failing([&] { read_depth(text); });
  failing([&] { read_project(path.substr(0, path.rfind('/'))); });
}

}  // namespace cuboct::fuzz
