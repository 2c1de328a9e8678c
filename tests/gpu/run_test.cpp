// SPDX-License-Identifier: MIT
// The run loop around an engine that a test makes up: it drifts, and loses a particle when it is told to.
#include "emu/gpu/run.h"
#include "emu/gpu/rounds/real_rounds_engine.h"
#include "emu/gpu/rounds/rounds_engine.h"

#include <gtest/gtest.h>

#include "hw/plan/setup.h"

namespace cuboct::gpu {
namespace {

constexpr uint64_t kLost = 7;  // the step that cannot be done

class Drifting : public Engine {
 public:
  explicit Drifting(const Body& body) : body_(body) {}
  void advance(uint64_t steps, std::vector<uint64_t>*) override {
    for (uint64_t k = 0; k < steps; ++k) {
      if (step_ == kLost) throw LostPosition("step 8: particle 3 is gone", step_, 3);
      for (Vec3& x : body_.x) x[0] += 1;
      ++step_;
    }
  }
  uint64_t step_count() const override { return step_; }
  Reading read(bool) override {
    Reading reading;
    reading.step = step_;
    return reading;
  }
  void probe(const std::vector<uint32_t>&) override {}
  State state() override { return {}; }
  uint64_t hash() override { return 0; }
  Body body() override { return body_; }
  const Counters& counters() const override { return counters_; }

 private:
  Body body_;
  uint64_t step_ = 0;
  Counters counters_;
};

TEST(GpuRun, OfALostPositionKeepsTheStatesBefore) {
  const Scene scene = read_scene(CUBOCT_SOURCE_DIR "/scenes/lj_block.toml");
  const Plan plan = plan_of(scene, read_arch(""));
  GpuRun request;
  request.arithmetic = Arithmetic::float32;
  request.steps = 20;
  request.frames = {0, 5, 10};
  request.energies = true;
  request.probes = {0, 20};
  uint64_t done = 0;
  request.hooks.did = [&](uint64_t steps) { done += steps; };
  const Recorded result = run_gpu(scene, plan, request);
  const Trace& trace = result.trace;
  ASSERT_TRUE(trace.stop);
  EXPECT_EQ(trace.stop->text, "step 8: particle 3 is gone");
  EXPECT_EQ(trace.stop->step, kLost);
  EXPECT_EQ(trace.stop->particle, 3u);
  EXPECT_EQ(trace.steps(), kLost);
  EXPECT_EQ(done, kLost);
  ASSERT_EQ(trace.bodies.size(), 3u);
  EXPECT_EQ(trace.bodies[1].step, 5u);
  EXPECT_EQ(trace.bodies[2].step, kLost);
  EXPECT_EQ(trace.bodies[2].x[0][0], scene.body.x[0][0] + 7);
  EXPECT_EQ(trace.curves.front().step, (std::vector<uint64_t>{0, kLost}));
}

}  // namespace

const char* to_string(Arithmetic) { return "made up"; }
std::vector<Device> find_devices(std::string*) { return {}; }
void share_devices(bool) {}
std::unique_ptr<Engine> make_fixed_engine(const Scene&, const Plan&, const State&, const Options&) {
  return nullptr;
}
std::unique_ptr<Engine> make_real_engine(const Scene&, const Body& body, Arithmetic, const Options&) {
  return std::make_unique<Drifting>(body);
}
std::unique_ptr<Engine> resume_real_engine(const Scene&, const Body&, Arithmetic, const Options&,
                                           const Memory&) {
  return nullptr;
}
std::unique_ptr<IntegerEngine> make_rounds_engine(const Plan&, const State&, const Options&,
                                                  const CompileRounds&) {
  return nullptr;
}

std::unique_ptr<RealRounds> make_real_rounds(const Rule&, const Body&, const Periodic&, bool, const Options&,
                                             const CompileRounds&, const Memory&) {
  return nullptr;
}

}  // namespace cuboct::gpu
