// SPDX-License-Identifier: MIT
// The nodes that were synthesised lie within the bands that are told before any synthesis.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "hw/plan/setup.h"
#include "synth/node_estimate.h"

namespace cuboct::synth {
namespace {

const std::string kRoot = CUBOCT_SOURCE_DIR;

struct NodeRow {
  std::string scene;
  double lut, ff, dsp, bram;
};

std::vector<NodeRow> synthesised() {
  std::ifstream in(kRoot + "/docs/measured/data/synth-nodes-ecp5-85.tsv");
  std::vector<NodeRow> rows;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("#") || line.starts_with("node of")) continue;
    std::istringstream cells(line);
    NodeRow row;
    double nodes = 0, cycles = 0;
    cells >> row.scene >> nodes >> cycles >> row.lut >> row.ff >> row.dsp >> row.bram;
    rows.push_back(row);
  }
  return rows;
}

TEST(NodeEstimate, SynthesisedNodesLieWithinTheBands) {
  const Target& target = target_of("ecp5-85");
  const auto rows = synthesised();
  ASSERT_EQ(rows.size(), 5U);
  for (const NodeRow& row : rows) {
    const Scene scene = read_scene(kRoot + "/scenes/" + row.scene + ".toml");
    const Plan plan = plan_of(scene, Arch());
    const auto node = estimate_node(plan, target);
    ASSERT_TRUE(node);
    const auto within = [&](const char* what, const Band& band, double value) {
      EXPECT_TRUE(band.low <= value && value <= band.high)
          << row.scene << ' ' << what << ' ' << value << " of " << band.low << " to " << band.high
          << fmt::format(", {:.0f} bits of logic", logic_bits(plan));
    };
    within("LUT", node->lut, row.lut);
    within("FF", node->ff, row.ff);
    within("DSP", node->dsp, row.dsp);
    within("BRAM", node->bram, row.bram);
  }
}

TEST(NodeEstimate, TellsNothingOfWhatItWasNotDrawnAround) {
  Arch narrow;
  narrow.narrow_memories = true, narrow.overlap = false, narrow.filter_lanes = 1;
  const Scene scene = read_scene(kRoot + "/scenes/undamped_block.toml");
  EXPECT_FALSE(estimate_node(plan_of(scene, narrow), target_of("ecp5-85")));
  EXPECT_FALSE(estimate_node(plan_of(scene, Arch()), target_of("up5k")));
}

// The share is that of the scarcest resource, of what a plan should use of it.
TEST(NodeEstimate, TheShareIsThatOfTheScarcestResource) {
  const Target& target = target_of("ecp5-85");
  const NodeEstimate node{{100, 200}, {100, 100}, {1, 1}, {1, 1}};
  const double dsps = planned_share(target, Resource::dsp) * static_cast<double>(target.holds[Resource::dsp]);
  const double luts = planned_share(target, Resource::lut) * static_cast<double>(target.holds[Resource::lut]);
  const Band share = share_of_room(node, 10, target);
  const double least = std::max(
      {10 / dsps, 1000 / luts,
       10 / (planned_share(target, Resource::bram) * static_cast<double>(target.holds[Resource::bram]))});
  EXPECT_DOUBLE_EQ(share.low, least);
  EXPECT_DOUBLE_EQ(share.high, std::max(least, 2000 / luts));
}

}  // namespace
}  // namespace cuboct::synth
