// SPDX-License-Identifier: MIT
// Frames of engines in programs of their own: they are there while the run goes on, and stay where it is cut.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "hw/program/frame_files.h"
#include "model/base/process.h"
#include "model/trace/trace.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

class ProgramFrames : public testing::Test {
 protected:
  void TearDown() override {
    unsetenv("LIE");
    unsetenv("WAIT_FOR");
  }
  // The fake engine goes on behind step 2 once the frame of step 2 is in the directory.
  Answer run(const std::string& engine, const char* lie) const {
    setenv("LIE", lie, 1);
    setenv("WAIT_FOR", bench_.path(engine + "/frames_000001.vtp").c_str(), 1);
    return bench_.cuboct({"run", "scenes/lj_block.toml", "--engine", engine, "--steps", "6", "--frame-every",
                          "2", "--quiet", "--out", bench_.path(engine)});
  }
  std::string file(const std::string& name) const { return contents(bench_.path(name)); }

  Bench bench_{true};
};

TEST_F(ProgramFrames, ComeWhileItRuns) {
  for (const char* engine : {"golden", "rtl"}) {
    const Answer answer = run(engine, "wait");
    ASSERT_EQ(answer.code, 0) << answer.err;
  }
  const Trace golden = read_trace(bench_.path("golden/trace.h5")),
              rtl = read_trace(bench_.path("rtl/trace.h5"));
  ASSERT_EQ(rtl.frames.size(), 4u);
  EXPECT_EQ(golden.frames, rtl.frames);
  EXPECT_EQ(golden.state_hash, rtl.state_hash);
  EXPECT_EQ(file("golden/frames.xyz"), file("rtl/frames.xyz"));
  EXPECT_EQ(file("golden/frames_000003.vtp"), file("rtl/frames_000003.vtp"));
}

TEST_F(ProgramFrames, OfOneThatDiesStay) {
  ASSERT_EQ(run("golden", "").code, 0);
  const Answer answer = run("rtl", "cut");
  EXPECT_EQ(answer.code, 1);
  EXPECT_EQ(answer.err, "cuboct-rtl was ended by signal 6 (Aborted)\n");
  EXPECT_EQ(file("golden/frames_000001.vtp"), file("rtl/frames_000001.vtp"));
  EXPECT_FALSE(fs::exists(bench_.path("rtl/frames_000002.vtp")));
  const std::string all = file("golden/frames.xyz"), some = file("rtl/frames.xyz");
  EXPECT_TRUE(all.starts_with(some));
  size_t heads = 0;
  for (size_t at = some.find("Lattice="); at != std::string::npos; at = some.find("Lattice=", at + 1))
    ++heads;
  EXPECT_EQ(heads, 2u);
  EXPECT_TRUE(fs::exists(bench_.path("rtl/trace.part.h5")));
  EXPECT_NE(file("rtl/run.toml").find("state = 'running'"), std::string::npos) << file("rtl/run.toml");
}

// Sixteen wait at most; all come, in order, and no file is left.
TEST_F(ProgramFrames, TakeNoMoreRoomThanTheirReaderLeaves) {
  const std::string prefix = bench_.path("frame"), last = prefix + ".15", beyond = prefix + ".16";
  FrameReceiver ours(prefix);  // before: it removes what an earlier program left
  std::jthread program([&] {
    FrameSender sender(prefix);
    for (uint64_t step = 0; step < 40; ++step) {
      State state{10 * step, std::vector<Particle>(3)};
      for (uint32_t id = 0; id < 3; ++id)
        state.particles[id].id = id, state.particles[id].x[0] = static_cast<int64_t>(step);
      for (uint64_t part = 0; part < step; ++part)
        sender.read({{"grip.force", "N", {}, {}}, {"energy.total", "J", {}, {}}}, 10 * step + part,
                    std::vector<double>(part == 0 ? 2 : 1, 0.1 * static_cast<double>(part)));
      sender.send(state);
    }
  });
  ASSERT_TRUE(comes([&] { return fs::exists(last); }));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // for one that would not wait
  EXPECT_FALSE(fs::exists(beyond));
  uint64_t step = 0, read = 0;
  const auto see = [&](const RunState& frame) {
    EXPECT_EQ(std::get<State>(frame).step, 10 * step);
    EXPECT_EQ(std::get<State>(frame).particles[2].x[0], static_cast<int64_t>(step));
    EXPECT_EQ(read, step);
    read = 0;
    ++step;
  };
  const auto take = [&](const std::vector<Curve>& of, uint64_t at, Values values) {
    EXPECT_EQ(of[0].name + of[0].unit + of[1].name + of[1].unit, "grip.forceNenergy.totalJ");
    EXPECT_EQ(at, 10 * step + read);
    ASSERT_EQ(values.size(), read == 0 ? 2U : 1U);
    EXPECT_EQ(values.back(), 0.1 * static_cast<double>(read));
    ++read;
  };
  EXPECT_TRUE(comes([&] { return ours.receive(see, take), step == 40; }));
  EXPECT_EQ(step, 40u);
  EXPECT_FALSE(fs::exists(prefix + ".39"));
}

#ifdef CUBOCT_SYSTEMC
// A run of minutes.
TEST_F(ProgramFrames, OfAMachineComeWhileItRuns) {
  fs::remove(bench_.path("bin/cuboct-systemc"));
  fs::copy(CUBOCT_SYSTEMC, bench_.path("bin/cuboct-systemc"));
  const std::string out = bench_.path("run");
  {
    Process run(bench_.path("bin/cuboct"),
                {"run", CUBOCT_SOURCE_DIR "/scenes/lj_block.toml", "--engine", "systemc", "--steps", "100000",
                 "--frame-every", "2", "--frames", "vtp", "--quiet", "--out", out});
    ASSERT_TRUE(comes([&] { return fs::exists(out + "/frames_000003.vtp"); }));
    EXPECT_FALSE(fs::exists(out + "/trace.h5"));
  }  // SIGTERM
  const Trace trace = read_trace(out + "/trace.h5");
  ASSERT_GE(trace.frames.size(), 4u);
  EXPECT_EQ(trace.frames[3].step, 6u);
  EXPECT_EQ(trace.frames.back().step, trace.steps());
}
#endif

}  // namespace
}  // namespace cuboct::test
