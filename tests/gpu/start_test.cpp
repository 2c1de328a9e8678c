// SPDX-License-Identifier: MIT
// cuboct-gpu as other programs use it: from a start of theirs, for its devices, for rates.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "model/real/reference.h"
#include "model/scene/scene.h"
#include "model/trace/trace.h"
#include "tests/cli/shell.h"

namespace cuboct {
namespace {

using test::Answer;
using test::contents;

const std::string kScene = CUBOCT_SOURCE_DIR "/scenes/lj_block.toml";

class Start : public testing::Test {
 protected:
  Answer program(const std::string& arguments) const {
    const std::string out = bench_.path("gpu.out"), err = bench_.path("gpu.err");
    const int status = std::system((CUBOCT_GPU_HOST " " + arguments + " >" + out + " 2>" + err).c_str());
    return {WEXITSTATUS(status), contents(out), contents(err)};
  }
  Trace trace(const std::string& name, const std::string& arguments) const {
    const Answer answer = program(arguments + " --out " + bench_.path(name));
    EXPECT_EQ(answer.code, 0) << answer.err;
    return read_trace(bench_.path(name));
  }
  test::Bench bench_{false};
};

// Forty steps are ten and thirty, where the thirty begin with the ten's last state: in doubles as close as
// doubles of other units allow, from which a start at the scene's own positions is far.
TEST_F(Start, ARunGoesOnFromAnothersLastState) {
  const std::string scene = kScene + " --precision double --frames ";
  const Trace whole = trace("whole.h5", scene + "0,40 --steps 40");
  trace("begun.h5", scene + "10 --steps 10");
  const Trace rest = trace("rest.h5", scene + "30 --steps 30 --start " + bench_.path("begun.h5"));
  const std::vector<Vec3>&end = whole.bodies.back().x, &begin = whole.bodies.front().x,
        &other = rest.bodies.back().x;
  ASSERT_EQ(other.size(), end.size());
  double apart = 0, moved = 0;
  for (size_t i = 0; i < end.size(); ++i) {
    apart = std::max(apart, (other[i] - end[i]).norm());
    moved = std::max(moved, (end[i] - begin[i]).norm());
  }
  EXPECT_GT(moved, 0);
  EXPECT_LT(apart, 1e-9 * moved);
}

// Of no step: the state that was given, and its forces by the reference.
TEST_F(Start, ForcesAtGivenPositions) {
  const Scene scene = read_scene(kScene);
  Trace given;
  given.engine = "test";
  given.bodies.push_back({0, scene.body.x, scene.body.v, {}, {}});
  for (Vec3& x : given.bodies[0].x) x *= 1.01;
  write_trace(bench_.path("given.h5"), given);
  const Trace answer =
      trace("forces.h5",
            kScene + " --precision double --steps 0 --frames 0 --forces --start " + bench_.path("given.h5"));
  Body body = scene.body;
  body.x = given.bodies[0].x;
  const auto forces = Reference(scene.rule, body, scene.periodic, RealOptions{}).forces();
  double largest = 0;
  for (const Vec3& force : forces) largest = std::max(largest, force.norm());
  ASSERT_EQ(answer.bodies.size(), 1U);
  ASSERT_EQ(answer.bodies[0].force.size(), forces.size());
  for (size_t i = 0; i < forces.size(); ++i)
    EXPECT_LT((answer.bodies[0].force[i] - forces[i]).norm(), 1e-9 * largest) << i;
}

TEST_F(Start, MistakesAreTold) {
  Trace trace;
  trace.engine = "test";
  const std::string file = bench_.path("start.h5");
  const auto refusal = [&] {
    write_trace(file, trace);
    const Answer answer = program(kScene + " --out " + bench_.path("out.h5") + " --start " + file);
    EXPECT_EQ(answer.code, 2);
    return answer.err;
  };
  EXPECT_EQ(refusal(), "--start " + file + ": this trace holds no state in real numbers\n");
  trace.bodies.push_back({0, {Vec3::Zero()}, {Vec3::Zero()}, {}, {}});
  const std::string particles = std::to_string(read_scene(kScene).body.size());
  EXPECT_EQ(refusal(), "--start " + file + ": a state of 1 particles, the scene has " + particles + "\n");
  EXPECT_EQ(program("--out " + file).err, "a scene is required\n");
  EXPECT_EQ(program(kScene + " --repeats 2 --out " + file).err, "--repeats goes with --bench\n");
}

TEST_F(Start, DevicesAreListed) {
  const Answer answer = program("--list");
  EXPECT_EQ(answer.code, 0);
  EXPECT_TRUE(answer.out.starts_with("0 host\n1 host\n")) << answer.out;
}

TEST_F(Start, RatesAreOfAsManyRepeatsAsAskedFor) {
  const Answer answer = program(kScene + " --steps 20 --precision float --bench --repeats 3 --seconds 0.02");
  EXPECT_EQ(answer.code, 0) << answer.err;
  std::istringstream lines(answer.out);
  int rates = 0;
  for (std::string name, unit; lines >> name;) {
    double value = 0;
    lines >> value >> unit;
    if (name != "gpu.steps_per_second") continue;
    ++rates;
    EXPECT_GT(value, 0);
    EXPECT_EQ(unit, "1/s");
  }
  EXPECT_EQ(rates, 3);
}

}  // namespace
}  // namespace cuboct
