// SPDX-License-Identifier: MIT
// What an emitted project says of its speed, beside the run that it is of.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "model/base/output.h"
#include "model/trace/cycles.h"
#include "model/trace/trace.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

// Particles of a liquid, whose steps take unequal numbers of cycles; the trace of `cuboct run --cycles` has
// them node by node.
TEST(Emit, CountsTheCyclesOfTheFirstStepsOfARun) {
  const Bench bench(false);
  const std::string scene = CUBOCT_SOURCE_DIR "/scenes/lj_block.toml";
  const Answer ran = bench.cuboct(
      {"run", scene, "--engine", "lattice", "--steps", "200", "--cycles", "--out", bench.path("run")});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto exact = cycles_per_step(read_trace(bench.path("run/trace.h5")));
  ASSERT_TRUE(exact);
  const Answer emitted = bench.cuboct({"emit", scene, "--out", bench.path("block"), "--json"});
  ASSERT_EQ(emitted.code, 0) << emitted.err;
  const auto cycles =
      nlohmann::json::parse(read_text(bench.path("block/project.json"))).at("cycles_per_step");
  EXPECT_EQ(cycles.at("counted").at("steps"), 200);
  EXPECT_DOUBLE_EQ(cycles.at("counted").at("mean"), exact->mean);
  EXPECT_EQ(cycles.at("counted").at("most"), exact->max);
  EXPECT_GT(exact->max, exact->mean);  // so that the two are told apart
  EXPECT_NE(cycles.at("expected"), exact->max);
  EXPECT_DOUBLE_EQ(nlohmann::json::parse(emitted.out).at("mean_cycles_per_step").at("value"), exact->mean);
}

}  // namespace
}  // namespace cuboct::test
