// SPDX-License-Identifier: MIT
// Pictures of runs: every engine leaves rasters, and they become a PNG of the size asked for.
#include <gtest/gtest.h>

#include <cmath>

#include "model/trace/raster.h"
#include "model/trace/trace.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

// Width and height as the file's header has them: big-endian, after signature, length and "IHDR".
std::pair<uint32_t, uint32_t> size_of_png(const std::string& png) {
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  const auto number = [&](size_t at) {
    uint32_t value = 0;
    for (size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<uint8_t>(png.at(at + k));
    return value;
  };
  return {number(16), number(20)};
}

TEST(Picture, IsDrawnOfFixedAndRealRuns) {
  const Bench bench(false);
  std::vector<Rasters> rasters;
  for (const char* engine : {"golden", "reference"}) {
    const std::string out = bench.path(engine);
    const Answer run = bench.cuboct({"run", "scenes/coupon.toml", "--steps", "400", "--frame-every", "200",
                                     "--engine", engine, "--raster", "100", "--no-states", "--out", out});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_FALSE(fs::exists(out + "/frames.xyz"));
    EXPECT_FALSE(fs::exists(out + "/frames.pvd"));
    EXPECT_TRUE(read_trace(out + "/trace.h5").frames.empty());
    EXPECT_FALSE(read_trace(out + "/trace.h5").curves.empty());
    const Answer drawn = bench.cuboct({"picture", out, "--width", "700"});
    ASSERT_EQ(drawn.code, 0) << drawn.err;
    EXPECT_EQ(drawn.out, out + "/picture.png\n");
    EXPECT_EQ(size_of_png(contents(out + "/picture.png")).first, 700u);
    rasters.push_back(read_rasters(out + "/rasters.h5"));
  }
  // Both show the same strains.
  ASSERT_EQ(rasters[0].frames.size(), 3u);
  ASSERT_EQ(rasters[1].frames.size(), 3u);
  ASSERT_EQ(rasters[0].grid.columns, rasters[1].grid.columns);
  ASSERT_EQ(rasters[0].grid.rows, rasters[1].grid.rows);
  EXPECT_EQ(rasters[0].frames[2].step, 400u);
  EXPECT_GE(rasters[0].grid.columns, 100u);
  EXPECT_LE(rasters[0].grid.columns, 103u);  // 100 pixels at the start; it has been pulled
  double largest = 0, apart = 0;
  for (size_t k = 0; k < rasters[0].grid.pixels(); ++k) {
    largest = std::max(largest, std::abs(double{rasters[0].frames[2].strain[k]}));
    apart =
        std::max(apart, std::abs(double{rasters[0].frames[2].strain[k] - rasters[1].frames[2].strain[k]}));
  }
  EXPECT_GT(largest, 1e-3);
  EXPECT_LT(apart, 0.01 * largest);
}

TEST(Picture, SaysWhatItCannotDraw) {
  const Bench bench(false);
  const std::string out = bench.path("run");
  ASSERT_EQ(
      bench.cuboct({"run", "scenes/coupon.toml", "--steps", "20", "--frame-every", "10", "--out", out}).code,
      0);
  const auto refused = [&](std::vector<std::string> arguments, const std::string& text) {
    arguments.insert(arguments.begin(), "picture");
    const Answer answer = bench.cuboct(arguments);
    EXPECT_EQ(answer.code, 2);
    EXPECT_EQ(answer.out, "");
    EXPECT_EQ(answer.err, text);
  };
  refused({"scenes"},
          "scenes holds no pictures: no file rasters.h5\n  hint: 'cuboct run SCENE --out DIR' makes one\n");
  refused({out, "--steps", "10,15"}, "no frame of step 15\n  hint: kept are 0, 10, 20\n");
  refused({out, "--field", "sped"}, "unknown field 'sped'\n  hint: did you mean 'speed'?\n");
  refused({out, "--field", "colour"},
          "unknown field 'colour'\n  hint: strain, speed, thickness and broken can be drawn\n");
  fs::copy_file(out + "/trace.h5", out + "/rasters.h5", fs::copy_options::overwrite_existing);
  refused({out},
          out + "/rasters.h5 holds no rasters\n  hint: 'cuboct run SCENE --out DIR' makes DIR/rasters.h5\n");
}

}  // namespace
}  // namespace cuboct::test
