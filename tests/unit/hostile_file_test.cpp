// SPDX-License-Identifier: MIT
// Traces and rasters that say of themselves what is not so: refused in one line, before memory is taken.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>

#include "hw/plan/setup.h"
#include "model/base/error.h"
#include "model/base/process.h"
#include "model/scene/scene.h"
#include "model/trace/left_state.h"
#include "model/trace/raster.h"
#include "model/trace/state_check.h"
#include "model/trace/trace.h"
#include "model/trace/trace_file.h"
#include "model/trace/trace_head.h"
#include "tests/support/refused_with.h"
#include "tests/unit/made_trace.h"

namespace cuboct {
namespace {

class HostileFile : public testing::Test {
 protected:
  HostileFile() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

  // What is said to a file that `change` was at.
  std::string of_trace(const std::function<void(hid_t)>& change) {
    write_trace(path_, made_trace());
    edit(change);
    return refused_with([&] { read_trace(path_); });
  }
  // As a run that is to go on takes it.
  std::string of_left_state(const std::function<void(hid_t)>& change) {
    const Scene scene = read_scene(CUBOCT_SOURCE_DIR "/scenes/boards/grips.toml");
    const cuboct::Setup setup = make_setup(scene, {});
    const TraceHead head{scene, &setup.plan.rule, &setup.plan.lattice, setup.plan.origin, ""};
    TraceWriter out(path_, path_ + ".part", true, &head);
    out.add(setup.initial);
    out.finish({});
    edit(change);
    return refused_with([&] { EXPECT_EQ(read_left_state(path_).body.size(), scene.body.size()); });
  }
  template <typename T>
  static void overwrite(hid_t file, const char* name, hid_t type, T value) {
    const hid_t data = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(data);
    const std::vector<T> all(static_cast<size_t>(H5Sget_simple_extent_npoints(space)), value);
    ASSERT_GE(H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()), 0);
    H5Sclose(space), H5Dclose(data);
  }
  std::string of_rasters(const std::function<void(hid_t)>& change) {
    Frame frame;
    frame.x = {{0, 0, 0}, {1, 1, 0}};
    frame.v.assign(2, Vec3::Zero()), frame.strain.assign(2, 0), frame.type.assign(2, 0);
    RasterWriter out(path_, path_ + ".part", {"title", 0, 1, {}, {}}, 10);
    out.add(frame);
    out.finish();
    edit(change);
    return refused_with([&] { read_rasters(path_); });
  }

  static void put_number(hid_t file, const char* name, hid_t type, const void* value) {
    const hid_t attribute = H5Aopen(file, name, H5P_DEFAULT);
    ASSERT_GE(H5Awrite(attribute, type, value), 0);
    H5Aclose(attribute);
  }
  static void put_double(hid_t file, const char* name, double value) {
    put_number(file, name, H5T_NATIVE_DOUBLE, &value);
  }
  // In the place of a dataset one of this shape, of which nothing is stored.
  static void put_empty(hid_t file, const char* name, std::vector<hsize_t> shape, hid_t type) {
    H5Ldelete(file, name, H5P_DEFAULT);
    const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    std::vector<hsize_t> chunk;
    for (const hsize_t extent : shape) chunk.push_back(std::clamp<hsize_t>(extent, 1, 16));
    H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data());
    const hid_t data = H5Dcreate2(file, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    ASSERT_GE(data, 0);
    H5Dclose(data), H5Pclose(properties), H5Sclose(space);
  }
  std::string name() const { return path_; }

  const Scratch scratch_;
  const std::string path_ = scratch_.path("file.h5");

 private:
  void edit(const std::function<void(hid_t)>& change) {
    const hid_t file = H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    change(file);
    H5Fclose(file);
  }
};

TEST_F(HostileFile, IsAcceptedAsItIs) {
  EXPECT_EQ(of_trace([](hid_t) {}), "accepted");
  EXPECT_EQ(of_rasters([](hid_t) {}), "accepted");
  EXPECT_EQ(of_left_state([](hid_t) {}), "accepted");
}

// What a state that a run begins with says of cells, types and numbers.
TEST_F(HostileFile, AStateToBeginWithMustFitItself) {
  const std::string disagree = path_ + " is not a cuboct trace: ";
  EXPECT_EQ(of_left_state([](hid_t f) { overwrite<uint8_t>(f, "frames/type", H5T_NATIVE_UINT8, 200); }),
            disagree + "types and particles disagree in length");
  EXPECT_EQ(of_left_state([](hid_t f) { overwrite<uint32_t>(f, "frames/node", H5T_NATIVE_UINT32, 1 << 30); }),
            disagree + "cells and particles disagree in length");
  EXPECT_EQ(of_left_state([](hid_t f) { overwrite<uint32_t>(f, "frames/id", H5T_NATIVE_UINT32, 0); }),
            disagree + "ids and particles disagree in length");
  for (const int64_t x : {int64_t{-1}, int64_t{1} << 50, INT64_MIN})
    EXPECT_EQ(of_left_state([x](hid_t f) { overwrite<int64_t>(f, "frames/x", H5T_NATIVE_INT64, x); }),
              disagree + "values and widths disagree in length");
  for (const double edge : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")})
    EXPECT_EQ(of_left_state([edge](hid_t f) { put_double(f, "cell_edge", edge); }),
              disagree + "no number above 0 'cell_edge'");
  for (const char* name : {"guard", "position_frac"})
    for (const int32_t wide : {60, INT32_MAX})
      EXPECT_EQ(of_left_state([&](hid_t f) { put_number(f, name, H5T_NATIVE_INT32, &wide); }),
                disagree + "no width 'guard'");
  EXPECT_EQ(
      of_left_state([](hid_t f) { H5Adelete(f, "packing"); }),
      path_ +
          " does not say whose particles it holds\n  hint: 'cuboct run --out DIR' leaves a trace that does");
}

TEST_F(HostileFile, ShapesAreHeldAgainstTheBytes) {
  const auto damaged = [&](const std::string& what, const std::string& shape) {
    return path_ + " is damaged: '" + what + "' says that it has " + shape +
           " values, and the file does not hold them";
  };
  // 8 TB; a number of values that wraps around to 0; particles that are in no other field.
  EXPECT_EQ(of_trace([](hid_t f) { put_empty(f, "state_hash", {hsize_t{1} << 40}, H5T_STD_U64LE); }),
            damaged("state_hash", "1099511627776"));
  EXPECT_EQ(of_trace([](hid_t f) {
              put_empty(f, "cycles", {hsize_t{1} << 62, 2, 8, 2}, H5T_STD_U64LE);
            }),
            damaged("cycles", "4611686018427387904 x 2 x 8 x 2"));
  EXPECT_EQ(of_trace([](hid_t f) { put_empty(f, "frames/id", {hsize_t{1} << 33}, H5T_STD_U32LE); }),
            damaged("id", "8589934592"));
  // A picture of 16 GB.
  EXPECT_EQ(of_rasters([](hid_t f) {
              const uint32_t wide = 1 << 16;
              for (const char* field : {"thickness", "strain", "speed", "broken"})
                put_empty(f, field, {1, wide, wide}, H5T_IEEE_F32LE);
              for (const char* extent : {"columns", "rows"}) put_number(f, extent, H5T_NATIVE_UINT32, &wide);
            }),
            damaged("thickness", "1 x 65536 x 65536"));
}

TEST_F(HostileFile, AListOfTextsIsNoText) {
  // Read as one it would run over its memory.
  const auto lists = [](hid_t file, const char* name) {
    H5Adelete(file, name);
    const hsize_t many = 1000;
    const hid_t space = H5Screate_simple(1, &many, nullptr), type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, 60);
    const hid_t attribute = H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    ASSERT_GE(attribute, 0);
    H5Awrite(attribute, type, std::string(60000, 'x').data());
    H5Aclose(attribute), H5Tclose(type), H5Sclose(space);
  };
  EXPECT_EQ(of_rasters([&](hid_t f) { lists(f, "title"); }),
            path_ + " is not a cuboct rasters file: no text attribute 'title'");
  EXPECT_EQ(of_trace([&](hid_t f) { lists(f, "engine"); }),
            path_ + " is not a cuboct trace: no text attribute 'engine'");
}

TEST_F(HostileFile, ATableOfNamesIsNoList) {
  EXPECT_EQ(of_trace([](hid_t f) {
              H5Ldelete(f, "notes/name", H5P_DEFAULT);
              const hsize_t shape[] = {3, 1000};
              const hid_t space = H5Screate_simple(2, shape, nullptr), type = H5Tcopy(H5T_C_S1);
              H5Tset_size(type, 9);
              const hid_t data =
                  H5Dcreate2(f, "notes/name", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
              H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, std::string(27000, 'x').data());
              H5Dclose(data), H5Tclose(type), H5Sclose(space);
            }),
            path_ + " is not a cuboct trace: no list of names 'name'");
}

TEST_F(HostileFile, NothingIsReadFromOtherFiles) {
  write_trace(scratch_.path("other.h5"), made_trace());
  EXPECT_EQ(of_trace([&](hid_t f) {
              H5Ldelete(f, "state_hash", H5P_DEFAULT);
              H5Lcreate_external(scratch_.path("other.h5").c_str(), "state_hash", f, "state_hash",
                                 H5P_DEFAULT, H5P_DEFAULT);
            }),
            path_ + " is not a cuboct trace: no dataset 'state_hash'");
  EXPECT_EQ(of_trace([&](hid_t f) {
              H5Ldelete(f, "frames", H5P_DEFAULT);
              H5Lcreate_external(scratch_.path("other.h5").c_str(), "frames", f, "frames", H5P_DEFAULT,
                                 H5P_DEFAULT);
            }),
            path_ + " is not a cuboct trace: no group 'frames'");
  std::ofstream(scratch_.path("secret")) << std::string(24, 's');
  EXPECT_EQ(
      of_trace([&](hid_t f) {
        H5Ldelete(f, "state_hash", H5P_DEFAULT);
        const hsize_t count = 3;
        const hid_t space = H5Screate_simple(1, &count, nullptr), properties = H5Pcreate(H5P_DATASET_CREATE);
        H5Pset_external(properties, scratch_.path("secret").c_str(), 0, 24);
        H5Dclose(H5Dcreate2(f, "state_hash", H5T_STD_U64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT));
        H5Pclose(properties), H5Sclose(space);
      }),
      path_ +
          ": 'state_hash' takes its values from another file\n  hint: a trace of cuboct holds all of its "
          "values");
}

TEST_F(HostileFile, RastersAreAPicture) {
  EXPECT_EQ(of_rasters([](hid_t f) { put_double(f, "pixel", 0); }),
            path_ + ": 'pixel' must be a length above 0, not 0");
  EXPECT_EQ(of_rasters([](hid_t f) { put_double(f, "particle", NAN); }),
            path_ + ": 'particle' must be a length above 0, not nan");
  EXPECT_EQ(of_rasters([](hid_t f) { put_double(f, "left", -INFINITY); }),
            path_ + ": 'left' must be finite, not -inf");
  EXPECT_TRUE(of_rasters([](hid_t f) {
                put_empty(f, "thickness", {0, 2, 3}, H5T_IEEE_F32LE);
              }).starts_with(path_ + ": there is no picture in 0 frames of "));
}

TEST(StateCheck, NumbersAreWithinTheScene) {
  Trace trace;
  trace.frames = {made_state(0)};
  trace.frames[0].particles[2].id = 2;
  trace.frames[0].particles[2].v[2] = 1;
  const StateBounds bounds{.particles = 3, .types = 2, .cells = 2, .position_bits = 8, .velocity_bits = 20};
  const auto error = [&](const std::function<void(Trace&)>& change) -> std::string {
    Trace changed = trace;
    change(changed);
    return refused_with([&] { check_frames(changed, bounds, "t.h5"); });
  };
  const std::string at = "t.h5 is no trace of this scene: frame of step 0, particle 1: ";
  EXPECT_EQ(error([](Trace&) {}), "accepted");
  EXPECT_EQ(error([](Trace& t) { t.frames[0].particles[1].cell = 2; }), at + "cell 2 is not below 2");
  EXPECT_EQ(error([](Trace& t) { t.frames[0].particles[1].type = 2; }), at + "type 2 is not below 2");
  EXPECT_EQ(error([](Trace& t) { t.frames[0].particles[1].id = 3; }), at + "id 3 is not below 3");
  EXPECT_EQ(error([](Trace& t) { t.frames[0].particles[1].id = 2; }), at + "id 2 stands in row 1");
  EXPECT_EQ(error([](Trace& t) { t.frames[0].particles[1].x[1] = 256; }),
            at + "position 256 is outside its cell");
  EXPECT_EQ(error([](Trace& t) { t.frames[0].particles[1].x[1] = -1; }),
            at + "position -1 is outside its cell");
  EXPECT_EQ(error([](Trace& t) { t.frames[0].particles[1].v[1] = 1 << 19; }),
            at + "velocity 524288 is out of 20 bits");
  EXPECT_EQ(error([](Trace& t) { t.frames[0].particles.pop_back(); }),
            "t.h5 is no trace of this scene: the frame of step 0 has 2 particles, the scene 3");
  EXPECT_EQ(error([](Trace& t) {
              t.bodies.push_back({7, {{0, 0, 0}}, {{0, 0, 0}}, {}, {}});
            }),
            "t.h5 is no trace of this scene: the frame of step 7 has 1 particles, the scene 3");
}

}  // namespace
}  // namespace cuboct
