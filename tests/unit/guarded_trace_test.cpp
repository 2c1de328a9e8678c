// SPDX-License-Identifier: MIT
// A stranger's traces, read in a program of its own: what comes back is what the file holds, and what that
// program says or how it ends is one line.
#include "model/trace/guarded_trace.h"

#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/stat.h>

#include <cstdint>
#include <fstream>
#include <string>

#include "hw/plan/setup.h"
#include "model/base/error.h"
#include "model/base/module.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/scene/scene.h"
#include "model/trace/trace_file.h"
#include "model/trace/trace_head.h"
#include "tests/support/refused_with.h"
#include "tests/unit/made_trace.h"

namespace cuboct {
namespace {

class GuardedTrace : public testing::Test {
 protected:
  ~GuardedTrace() override { look_for_parts_in({}); }

  std::string path(const std::string& name) const { return scratch_.path(name); }
  static std::string refusal(const std::string& file) {
    return refused_with([&] { guarded_trace(file); });
  }
  // In the place of the program a shell's script.
  std::string refusal_by(const std::string& script) const {
    const std::string program = path(kTraceReader);
    std::ofstream(program) << "#!/bin/sh\n" << script << '\n';
    chmod(program.c_str(), 0700);
    look_for_parts_in({scratch_.path("")});
    return refusal("t.h5");
  }
  // Same trace, same bytes.
  void expect_whole(const Trace& trace) const {
    write_trace(path("a.h5"), trace);
    write_trace(path("b.h5"), guarded_trace(path("a.h5")));
    EXPECT_EQ(read_text(path("a.h5")), read_text(path("b.h5")));
  }

  const Scratch scratch_;
};

TEST_F(GuardedTrace, ComesWhole) {
  expect_whole({});
  expect_whole(made_trace());
  Trace real = made_trace();
  real.frames.clear();
  const std::vector<Vec3> rows{{1, 2, 3}, {-4, 5e300, 6}};
  real.bodies = {{0, rows, rows, rows, rows}, {7, rows, rows, rows, rows}};
  real.bonds = {1, uint64_t{1} << 63};
  real.reached = Reached{"grip.force_x", "above", 2, 3.5, 3};
  real.watched = 2;
  real.findings = {{Failure::creep, 1, 3, {1, 2, 3}, 4, 5, "text"}, {Failure::heating, 2, {}, {}, 6, 7, ""}};
  expect_whole(real);
}

TEST_F(GuardedTrace, AStateComesWhole) {
  const Scene scene = read_scene(CUBOCT_SOURCE_DIR "/scenes/boards/grips.toml");
  const cuboct::Setup setup = make_setup(scene, {});
  const TraceHead head{scene, &setup.plan.rule, &setup.plan.lattice, setup.plan.origin, ""};
  {
    TraceWriter out(path("t.h5"), path("part"), true, &head);
    out.add(setup.initial);
    out.finish({});
  }
  const LeftState a = read_left_state(path("t.h5")), b = guarded_left_state(path("t.h5"));
  EXPECT_EQ(a.engine, b.engine);
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(a.packing, b.packing);
  EXPECT_EQ(a.types, b.types);
  EXPECT_EQ(a.body.x, b.body.x);
  EXPECT_EQ(a.body.v, b.body.v);
  EXPECT_EQ(a.body.u, b.body.u);
  EXPECT_EQ(a.body.type, b.body.type);
  ASSERT_TRUE(b.body.exact);
  EXPECT_EQ(a.body.exact->x, b.body.exact->x);
  EXPECT_EQ(a.body.exact->v, b.body.exact->v);
  EXPECT_EQ(a.body.exact->u, b.body.exact->u);
  EXPECT_EQ(a.body.exact->cell, b.body.exact->cell);
  EXPECT_TRUE(b.body.exact->fits(setup.plan.rule, setup.plan.origin));
  EXPECT_FALSE(b.body.bonds);
}

TEST_F(GuardedTrace, RastersComeWhole) {
  Frame frame;
  frame.x = {{0, 0, 0}, {1, 1, 0}};
  frame.v.assign(2, Vec3(3, 0, 0)), frame.strain.assign(2, 0.25), frame.type.assign(2, 0);
  {
    RasterWriter out(path("r.h5"), path("part"), {"title", 2, 1, {}, {}}, 10);
    out.add(frame);
    frame.step = 5, frame.time = 0.5;
    out.add(frame);
    out.finish();
  }
  const Rasters a = read_rasters(path("r.h5")), b = guarded_rasters(path("r.h5"));
  EXPECT_EQ(b.title, "title");
  EXPECT_EQ(a.strain_axis, b.strain_axis);
  EXPECT_EQ(a.particle, b.particle);
  EXPECT_EQ(a.grid.columns, b.grid.columns);
  EXPECT_EQ(a.grid.pixel, b.grid.pixel);
  ASSERT_EQ(b.frames.size(), 2U);
  EXPECT_EQ(b.frames[1].step, 5U);
  EXPECT_EQ(a.frames[1].thickness, b.frames[1].thickness);
  EXPECT_EQ(a.frames[1].strain, b.frames[1].strain);
  EXPECT_EQ(a.frames[1].speed, b.frames[1].speed);
  EXPECT_EQ(a.frames[1].broken, b.frames[1].broken);
}

TEST_F(GuardedTrace, ErrorsAreThoseOfTheReader) {
  EXPECT_EQ(refusal(path("none.h5")), "cannot read " + path("none.h5") + ": No such file or directory");
  std::ofstream(path("text.h5")) << "no HDF5";
  EXPECT_EQ(refusal(path("text.h5")), path("text.h5") + " is not an HDF5 file");
  write_trace(path("t.h5"), made_trace());
  EXPECT_EQ(refused_with([&] { guarded_left_state(path("t.h5")); }),
            path("t.h5") +
                " does not say whose particles it holds\n  hint: 'cuboct run --out DIR' leaves a trace that "
                "does");
  EXPECT_EQ(refused_with([&] { guarded_rasters(path("t.h5")); }),
            path("t.h5") + " holds no rasters\n  hint: 'cuboct run SCENE --out DIR' makes DIR/rasters.h5");
}

// Of a layout's version 3, a list in chunks of one axis. As version 2, which has other fields, its chunks
// have no rows, and HDF5 1.10 divides by them.
TEST_F(GuardedTrace, AFileThatCrashesHdf5IsRefusedInALine) {
  write_trace(path("t.h5"), made_trace());
  std::string bytes = read_text(path("t.h5"));
  const std::string layout("\x08\0\x18\0\0\0\0\0\x03\x02\x02", 11);
  size_t found = 0;
  for (size_t at = bytes.find(layout); at != std::string::npos; at = bytes.find(layout, at + 1), ++found)
    bytes[at + 8] = 2;
  EXPECT_GT(found, 5U);
  std::ofstream(path("t.h5"), std::ios::binary) << bytes;
  const std::string told = refusal(path("t.h5"));
  EXPECT_NE(told, "accepted");
  EXPECT_NE(told.find(path("t.h5")), std::string::npos) << told;
  EXPECT_EQ(told.find('\n'), std::string::npos) << told;
}

TEST_F(GuardedTrace, OtherFiltersAreRefused) {
  write_trace(path("t.h5"), made_trace());
  {
    const hid_t file = H5Fopen(path("t.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    H5Ldelete(file, "state_hash", H5P_DEFAULT);
    const hsize_t count = 3;
    const hid_t space = H5Screate_simple(1, &count, nullptr), properties = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(properties, 1, &count);
    H5Pset_fletcher32(properties);
    H5Dclose(H5Dcreate2(file, "state_hash", H5T_STD_U64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT));
    H5Pclose(properties), H5Sclose(space), H5Fclose(file);
  }
  EXPECT_EQ(refusal(path("t.h5")),
            path("t.h5") +
                ": 'state_hash' is packed by filter 3 of HDF5\n  hint: a trace of cuboct is shuffled (2) and "
                "deflated (1): h5repack can make it so");
}

TEST_F(GuardedTrace, HowItsProgramEndsIsTold) {
  const std::string cannot = "cannot read t.h5: ";
  EXPECT_EQ(refusal_by("kill -FPE $$"),
            cannot + "it crashes the library that reads it (Floating point exception)");
  EXPECT_EQ(refusal_by("kill -XCPU $$"), cannot + "reading it takes more than 4 s of processor time");
  EXPECT_EQ(refusal_by("kill -ALRM $$"), cannot + "reading it takes more than 40 s");
  EXPECT_EQ(refusal_by("exit 3"), cannot + "reading it fails with code 3");
  EXPECT_EQ(refusal_by("exit 0"), cannot + "reading it fails with code 0");
  EXPECT_EQ(refusal_by("printf 'what\\n  hint: cure' >&2; exit 2"), "what\n  hint: cure");
  EXPECT_EQ(refusal_by("printf 'a\\033[2J\\nb' >&2; exit 2"), "a\\x1b[2J\\nb");
  // 2^63 - 1 bytes of the engine's name, and a program that goes on.
  EXPECT_EQ(refusal_by("printf '\\377\\377\\377\\377\\377\\377\\377\\177'; exec sleep 1000"),
            cannot + "it takes more memory than is free");
  EXPECT_EQ(refusal_by("printf '%s' \"$*\" >&2; exit 2"), "trace t.h5 4 1024");
}

}  // namespace
}  // namespace cuboct
