// SPDX-License-Identifier: MIT
#include "model/trace/trace.h"

#include <gtest/gtest.h>
#include <hdf5.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>

#include "model/base/output.h"
#include "model/trace/hdf5_file.h"
#include "model/trace/trace_file.h"
#include "tests/support/file_limit.h"
#include "tests/support/folder.h"
#include "tests/support/refused_with.h"
#include "tests/unit/made_trace.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

class TraceFile : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.path(name); }
  // A trace of which a number says something else.
  void write_with(const char* attribute, uint64_t value) const {
    write_trace(path("t.h5"), made_trace());
    const hid_t file = H5Fopen(path("t.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t at = H5Aopen(file, attribute, H5P_DEFAULT);
    EXPECT_GE(H5Awrite(at, H5T_NATIVE_UINT64, &value), 0);
    H5Aclose(at), H5Fclose(file);
  }

  const test::Folder folder_;
  const fs::path directory_ = folder_.path();
};

void expect_equal(const Trace& a, const Trace& b) {
  EXPECT_EQ(a.engine, b.engine);
  EXPECT_EQ(a.plan_hash, b.plan_hash);
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.state_hash, b.state_hash);
  EXPECT_EQ(a.hash_every, b.hash_every);
  EXPECT_EQ(a.steps(), b.steps());
  EXPECT_EQ(a.asked, b.asked);
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (size_t k = 0; k < a.frames.size(); ++k) {
    EXPECT_EQ(a.frames[k].step, b.frames[k].step);
    EXPECT_EQ(a.frames[k].particles, b.frames[k].particles);
  }
  ASSERT_EQ(a.curves.size(), b.curves.size());
  for (size_t k = 0; k < a.curves.size(); ++k) {
    EXPECT_EQ(a.curves[k].name, b.curves[k].name);
    EXPECT_EQ(a.curves[k].unit, b.curves[k].unit);
    EXPECT_EQ(a.curves[k].step, b.curves[k].step);
    EXPECT_EQ(a.curves[k].value, b.curves[k].value);
  }
  EXPECT_EQ(a.cycles, b.cycles);
  EXPECT_EQ(a.stop, b.stop);
  EXPECT_EQ(a.reached, b.reached);
  EXPECT_EQ(a.seconds, b.seconds);
  EXPECT_EQ(a.counters, b.counters);
  EXPECT_EQ(a.notes, b.notes);
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  EXPECT_EQ(a.bonds, b.bonds);
  for (size_t k = 0; k < a.bodies.size(); ++k) {
    EXPECT_EQ(a.bodies[k].step, b.bodies[k].step);
    EXPECT_EQ(a.bodies[k].x, b.bodies[k].x);
    EXPECT_EQ(a.bodies[k].v, b.bodies[k].v);
    EXPECT_EQ(a.bodies[k].force, b.bodies[k].force);
    EXPECT_EQ(a.bodies[k].u, b.bodies[k].u);
  }
  EXPECT_EQ(a.watched, b.watched);
  ASSERT_EQ(a.findings.size(), b.findings.size());
  for (size_t k = 0; k < a.findings.size(); ++k) {
    EXPECT_EQ(a.findings[k].failure, b.findings[k].failure);
    EXPECT_EQ(a.findings[k].step, b.findings[k].step);
    EXPECT_EQ(a.findings[k].particle, b.findings[k].particle);
    EXPECT_EQ(a.findings[k].place, b.findings[k].place);
    EXPECT_EQ(a.findings[k].number, b.findings[k].number);
    EXPECT_EQ(a.findings[k].limit, b.findings[k].limit);
    EXPECT_EQ(a.findings[k].text, b.findings[k].text);
  }
}

TEST_F(TraceFile, ReturnsEachFieldAsWritten) {
  const Trace trace = made_trace();
  write_trace(path("t.h5"), trace);
  expect_equal(trace, read_trace(path("t.h5")));
}

TEST_F(TraceFile, ReturnsAnEmptyTrace) {
  write_trace(path("t.h5"), Trace{});
  expect_equal(Trace{}, read_trace(path("t.h5")));
}

TEST_F(TraceFile, KeepsManyChunks) {
  Trace trace = made_trace();
  for (uint64_t i = 0; i < 100'000; ++i) trace.state_hash.push_back(i * 0x9e3779b97f4a7c15u);
  write_trace(path("t.h5"), trace);
  expect_equal(trace, read_trace(path("t.h5")));
}

// Frames are written and read in pieces: more rows than a piece, pieces across frames, and a frame of
// nothing.
TEST_F(TraceFile, KeepsLargeFrames) {
  Trace trace = made_trace();
  trace.frames.clear();
  uint32_t id = 0;
  for (const uint32_t rows : {40'000u, 0u, 70'001u}) {
    State& frame = trace.frames.emplace_back();
    frame.step = trace.frames.size();
    for (uint32_t k = 0; k < rows; ++k, ++id) {
      const int64_t n = id;
      const auto type = static_cast<uint8_t>(id % 5);
      frame.particles.push_back({id, type, id / 7, {n, n + 1, n + 2}, {-n, 3 * n, 5}, {n * n, 7, -7}});
    }
  }
  write_trace(path("t.h5"), trace);
  expect_equal(trace, read_trace(path("t.h5")));
  write_trace(path("whole.h5"), trace, false);
  expect_equal(trace, read_trace(path("whole.h5")));
  EXPECT_GT(std::filesystem::file_size(path("whole.h5")), 3 * std::filesystem::file_size(path("t.h5")));
}

TEST(Trace, CountsItsSteps) {
  Trace trace;
  EXPECT_EQ(trace.steps(), 0u);
  trace.steps_done = 7;  // an engine without hashes
  EXPECT_EQ(trace.steps(), 7u);
  trace.state_hash = {1, 2, 3};
  EXPECT_EQ(trace.steps(), 2u);
  trace.hash_every = 5;  // of steps 0, 5 and 7
  EXPECT_EQ(trace.steps(), 7u);
  EXPECT_EQ(trace.hashed_step(0), 0u);
  EXPECT_EQ(trace.hashed_step(1), 5u);
  EXPECT_EQ(trace.hashed_step(2), 7u);
  EXPECT_TRUE(trace.hashes(5, 7));
  EXPECT_FALSE(trace.hashes(6, 7));
  EXPECT_TRUE(trace.hashes(7, 7));
}

TEST_F(TraceFile, KeepsHashesWithStepsLeftOut) {
  Trace trace;
  trace.hash_every = 5;
  for (const uint64_t steps : {0, 4, 5, 7, 10}) {
    trace.steps_done = steps;
    trace.state_hash.resize(1 + (steps + 4) / 5, 9);
    write_trace(path("t.h5"), trace);
    expect_equal(trace, read_trace(path("t.h5")));
  }
  trace.state_hash.push_back(9);
  EXPECT_THROW(write_trace(path("t.h5"), trace), std::logic_error);
  // Only a run that stopped may lack the hash of its last step.
  trace.steps_done = 7;
  trace.state_hash = {9, 9};
  EXPECT_THROW(write_trace(path("t.h5"), trace), std::logic_error);
  trace.stop = StopReason{};
  write_trace(path("t.h5"), trace);
  expect_equal(trace, read_trace(path("t.h5")));
}

// A file of an older format says so.
TEST_F(TraceFile, RefusesAnotherVersion) {
  write_with("version", 1);
  EXPECT_EQ(refused_with([&] { read_trace(path("t.h5")); }),
            path("t.h5") + " is a trace of version 1; this program reads version 2");
}

TEST_F(TraceFile, SaysHowTheRunEnded) {
  Trace trace = made_trace();
  trace.stop.reset();
  EXPECT_STREQ(trace.ended(), "");
  trace.asked = 2;
  EXPECT_STREQ(trace.ended(), "finished");
  trace.asked = 3;
  EXPECT_STREQ(trace.ended(), "finished");  // as `until` has it
  trace.reached.reset();
  EXPECT_STREQ(trace.ended(), "interrupted");
  trace.stop = StopReason{};
  EXPECT_STREQ(trace.ended(), "stopped");
  write_trace(path("t.h5"), trace);
  expect_equal(trace, read_trace(path("t.h5")));
}

TEST_F(TraceFile, RefusesAStepCountThatItsHashesContradict) {
  write_with("steps", 3);
  EXPECT_EQ(refused_with([&] { read_trace(path("t.h5")); }),
            path("t.h5") + " is not a cuboct trace: steps and state hashes disagree in length");
}

TEST_F(TraceFile, SameTraceSameBytes) {
  write_trace(path("a.h5"), made_trace());
  sleep(1);  // a time of the clock inside the file would show
  write_trace(path("b.h5"), made_trace());
  EXPECT_EQ(read_text(path("a.h5")), read_text(path("b.h5")));
}

// Frame by frame, or at once: the same bytes. A reader gets one after another.
TEST_F(TraceFile, ComesFrameByFrame) {
  const Trace trace = made_trace();
  ASSERT_GE(trace.frames.size(), 2u);
  {
    TraceWriter out(path("t.h5"), path("part.h5"));
    for (const State& frame : trace.frames) {
      out.add(frame);
      EXPECT_GT(H5Fis_hdf5(path("part.h5").c_str()), 0);
    }
    for (const RealFrame& frame : trace.bodies) out.add(frame);
    EXPECT_FALSE(fs::exists(path("t.h5")));
    out.finish(trace);
  }
  write_trace(path("whole.h5"), trace);
  EXPECT_EQ(read_text(path("t.h5")), read_text(path("whole.h5")));
  EXPECT_FALSE(fs::exists(path("part.h5")));
  size_t frames = 0, bodies = 0;
  const TraceReader in(path("t.h5"));
  EXPECT_TRUE(in.rest().frames.empty() && in.rest().bodies.empty());
  in.frames([&](const State& frame) { EXPECT_EQ(frame.particles, trace.frames.at(frames++).particles); });
  in.bodies([&](const RealFrame& frame) { EXPECT_EQ(frame.x, trace.bodies.at(bodies++).x); });
  EXPECT_EQ(frames, trace.frames.size());
  EXPECT_EQ(bodies, trace.bodies.size());
}

State large_frame(uint64_t step) {
  State frame;
  frame.step = step;
  std::mt19937_64 random(step);  // what does not pack
  for (uint32_t id = 0; id < 20'000; ++id) {
    const auto n = static_cast<int64_t>(random() >> 8);
    frame.particles.push_back({id, 0, id, {n, n, n}, {n, -n, n}, {}});
  }
  return frame;
}

// A full disk costs the frames that do not fit, and no more.
TEST_F(TraceFile, HoldsWhatFits) {
  Trace trace = made_trace();
  TraceWriter out(path("t.h5"), path("part.h5"));
  trace.frames.clear();
  trace.bodies.clear();
  trace.bonds.reset();
  {
    const FileLimit limit(6 << 20);
    for (uint64_t step = 0; step < 20; ++step) try {
        out.add(large_frame(step));
        trace.frames.push_back(large_frame(step));
      } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()), "cannot write " + path("t.h5") + ": File too large");
      }
  }
  EXPECT_GE(trace.frames.size(), 4u);
  EXPECT_LT(trace.frames.size(), 20u);
  out.add(large_frame(30));  // there is room again
  trace.frames.push_back(large_frame(30));
  out.finish(trace);
  expect_equal(trace, read_trace(path("t.h5")));
  EXPECT_LT(fs::file_size(path("t.h5")), 6u << 20);
}

// What the program has flushed is there when it dies; what finish() was not reached for goes with the writer.
TEST_F(TraceFile, LeavesItsFramesWhereTheProgramDies) {
  EXPECT_EXIT(
      {
        TraceWriter out(path("t.h5"), path("part.h5"));
        for (uint64_t step = 0; step < 3; ++step) out.add(large_frame(step));
        kill(getpid(), SIGKILL);
      },
      testing::KilledBySignal(SIGKILL), "");
  {
    const hdf5::Reader in(path("part.h5"));  // HDF5 makes no file anew that is open
    const auto frames = in.group(in.root(), "frames");
    EXPECT_EQ(in.array<int64_t>(frames, "first"), (std::vector<int64_t>{0, 20'000, 40'000, 60'000}));
    EXPECT_GT(in.length(frames, "x"), 50'000u);
    EXPECT_GE(in.length(frames, "id"), 60'000u);
  }
  { TraceWriter out(path("t.h5"), path("part.h5")); }
  EXPECT_FALSE(fs::exists(path("part.h5")));
}

// HDF5 cannot close a file that it failed to write. The program's end must not try.
TEST_F(TraceFile, AFailureOfHdf5EndsTheProgramCleanly) {
  EXPECT_EXIT(
      {
        const FileLimit limit(1 << 20);
        try {
          hdf5::Writer out(path("part.h5"), path("t.h5"), false);
          out.array(out.root(), "values", {1 << 20}, std::vector<double>(1 << 20, 1.5), "", "");
          out.close();
        } catch (const InputError& error) {
          std::fprintf(stderr, "%s", error.what());
          std::exit(2);
        }
      },
      testing::ExitedWithCode(2), "cannot write .*t.h5: File too large");
}

TEST_F(TraceFile, LeavesNoTemporaryFile) {
  write_trace(path("t.h5"), made_trace());
  EXPECT_EQ(std::distance(fs::directory_iterator(directory_), fs::directory_iterator()), 1);
}

TEST_F(TraceFile, ReplacesAnOlderFileWhole) {
  std::ofstream(path("t.h5")) << "old";
  write_trace(path("t.h5"), made_trace());
  expect_equal(made_trace(), read_trace(path("t.h5")));
}

TEST_F(TraceFile, OpensInH5py) {
  write_trace(path("t.h5"), made_trace());
  const std::string command =
      "/usr/bin/python3 " CUBOCT_SOURCE_DIR "/tests/unit/read_trace.py " + path("t.h5");
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST_F(TraceFile, NamesPathAndReasonWhereItCannotWrite) {
  const std::string nowhere = path("none/t.h5");
  const std::string expected = "cannot write " + nowhere + ": No such file or directory";
  EXPECT_EQ(refused_with([&] { check_writable(nowhere); }), expected);
  EXPECT_EQ(refused_with([&] { write_trace(nowhere, made_trace()); }), expected);
  EXPECT_EQ(refused_with([&] { check_writable(path("")); }), "cannot write " + path("") + ": Is a directory");
  check_writable(path("t.h5"));
  EXPECT_FALSE(fs::exists(path("t.h5")));
  EXPECT_TRUE(fs::is_empty(directory_));
}

TEST_F(TraceFile, NamesADirectoryThatCannotBeMade) {
  std::ofstream(path("file")) << "x";
  EXPECT_EQ(refused_with([&] { make_directory(path("file")); }),
            "cannot make the directory " + path("file") + ": Not a directory");
  EXPECT_EQ(refused_with([&] { make_directory(path("file/below")); }),
            "cannot make the directory " + path("file/below") + ": Not a directory");
}

TEST_F(TraceFile, KeepsTheOldFileWhereWritingFails) {
  std::ofstream(path("t.txt")) << "old";
  EXPECT_EQ(refused_with([&] {
              write_whole(path("t.txt"), [](const std::string& temporary) {
                std::ofstream(temporary) << "half";
                throw InputError("broken");
              });
            }),
            "broken");
  EXPECT_EQ(read_text(path("t.txt")), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(directory_), fs::directory_iterator()), 1);
}

TEST_F(TraceFile, SaysWhatIsWrongWithAFileThatIsNoTrace) {
  EXPECT_EQ(refused_with([&] { read_trace(path("none.h5")); }),
            "cannot read " + path("none.h5") + ": No such file or directory");
  std::ofstream(path("text.h5")) << "not HDF5";
  EXPECT_EQ(refused_with([&] { read_trace(path("text.h5")); }), path("text.h5") + " is not an HDF5 file");
  write_trace(path("cut.h5"), made_trace());
  fs::resize_file(path("cut.h5"), fs::file_size(path("cut.h5")) / 2);
  EXPECT_EQ(refused_with([&] { read_trace(path("cut.h5")); }),
            path("cut.h5") +
                " is damaged: it begins as an HDF5 file, and HDF5 cannot open it\n  hint: it was cut "
                "short or written over; the command that made it makes it again");
}

TEST_F(TraceFile, RefusesACurveNameThatHdf5WouldSplit) {
  Trace trace = made_trace();
  trace.curves[0].name = "a/b";
  EXPECT_EQ(refused_with([&] { write_trace(path("t.h5"), trace); }),
            "a curve cannot be called 'a/b' in a trace: a name needs characters, none of them '/'");
  EXPECT_TRUE(fs::is_empty(directory_));
}

}  // namespace
}  // namespace cuboct
