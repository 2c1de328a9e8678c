// SPDX-License-Identifier: MIT
// What a study file says: points, and mistakes word for word.
#include "study/sweep/study.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "model/base/error.h"
#include "tests/study/small_study.h"
#include "tests/support/refused_with.h"

namespace cuboct::study {
namespace {

using test::SmallStudy;

std::string error_of(const SmallStudy& files, const std::string& text) {
  try {
    read_study(files.study(text));
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.starts_with(files.path("")) ? what.substr(files.path("").size()) : what;
  }
  return "no error";
}

std::string value_of_key(const std::vector<Change>& changes, const std::string& key) {
  for (const Change& change : changes)
    if (change.key == key) return change.value;
  return "";
}

TEST(Study, GridsAddUpAndDuplicatesFallTogether) {
  const SmallStudy files;
  const Study study = read_study(files.study(R"(
[[sweep]]
dt_safety = [0.1, 0.2]
index_bits = [5, 6, 7]
[[sweep]]
dt_safety = [0.2, 0.4]
index_bits = 7
threads = [1, 2]
[[sweep]]  # an arch is nothing to the reference
arithmetic = "float64"
index_bits = [5, 6]
)"));
  // 6; then (0.2, 7, one thread) again, and 3 more; then one.
  ASSERT_EQ(study.points.size(), 10U);
  EXPECT_EQ(value_of_key(study.points[0].scene, "run.dt_safety"), "0.1");
  EXPECT_EQ(value_of_key(study.points[1].arch, "table.index_bits"), "6");  // the last key fastest
  EXPECT_EQ(value_of_key(study.points[5].scene, "run.dt_safety"), "0.2");
  EXPECT_EQ(study.points[6].threads, 2);
  EXPECT_EQ(study.points[9].arithmetic, Arithmetic::float64);
  EXPECT_EQ(study.points[9].engine, "reference");
  EXPECT_TRUE(study.points[9].arch.empty());
}

TEST(Study, AGpuHasEachArithmeticAndNoThreads) {
  const SmallStudy files;
  const Study study = read_study(files.study(R"(
[[sweep]]
engine = "gpu"
arithmetic = ["float32", "float64", "fixed"]
index_bits = [5, 6]
threads = [1, 2]
[[sweep]]
engine = "gpu"
index_bits = 5
[[sweep]]
engine = ["reference", "gpu"]
)"));
  // Two in real numbers, which know no tables; two fixed ones; the second sweep has nothing new.
  ASSERT_EQ(study.points.size(), 6U);
  EXPECT_EQ(study.points[0].numbers_key(), "gpu float32 euler threads=1");
  EXPECT_EQ(study.points[1].numbers_key(), "gpu float64 euler threads=1");
  EXPECT_EQ(study.points[2].numbers_key(), "gpu fixed euler arch.table.index_bits=5");
  EXPECT_EQ(study.points[3].numbers_key(), "gpu fixed euler arch.table.index_bits=6");
  EXPECT_EQ(study.points[4].numbers_key(), "reference float64 euler threads=1");
  EXPECT_EQ(study.points[5].numbers_key(), "gpu fixed euler");
  Settings verlet = study.points[0];
  verlet.integrator = Integrator::velocity_verlet;
  EXPECT_EQ(refused_with([&] { resolve(study.base, verlet); }),
            "the gpu engine knows the integrator 'euler' only");
}

TEST(Study, PresetsSetSeveralKeysAndWidthsFollowPositions) {
  const SmallStudy files;
  const Study study = read_study(files.study(R"(
[[sweep]]
presets = [ { name = "coarse", position_frac = 14 }, { name = "own", position_frac = 16, velocity_bits = 20 } ]
[search]
guard = [4, 8]
)"));
  ASSERT_EQ(study.points.size(), 2U);
  const auto& coarse = study.points[0].arch;
  EXPECT_EQ(value_of_key(coarse, "widths.velocity_bits"), "");  // automatic: it follows by itself
  EXPECT_EQ(value_of_key(coarse, "widths.difference_frac"), "");
  EXPECT_EQ(value_of_key(coarse, "widths.relative_velocity_frac"), "");
  EXPECT_EQ(value_of_key(study.points[1].arch, "widths.velocity_bits"), "20");
  ASSERT_EQ(study.search.size(), 1U);
  EXPECT_EQ(study.search[0].name, "guard");
  EXPECT_EQ(study.search[0].labels, (std::vector<std::string>{"4", "8"}));
  Settings settings;
  study.search[0].sets[0](settings);
  EXPECT_EQ(value_of_key(settings.arch, "widths.velocity_bits"), "");
  study.search[0].sets[1](settings);
  EXPECT_EQ(value_of_key(settings.arch, "widths.velocity_bits"), "");
}

TEST(Study, ChangesTheSceneForAllPoints) {
  const SmallStudy files;
  const Study study =
      read_study(files.study("[change.run]\nsteps = 320\n[[sweep]]\nset.damping.ratio = [0.1]\n"));
  EXPECT_EQ(resolve(study.base, study.points[0]).scene.steps, 320U);
  EXPECT_GT(resolve(study.base, study.points[0]).scene.rule.damping.coefficient, 0);
  EXPECT_EQ(study.grid.samples, 16U);
}

TEST(Study, TheHashKnowsWhatErrorsDependOn) {
  const SmallStudy files;
  const auto hash = [&](const std::string& text) { return read_study(files.study(text)).hash; };
  const std::string sweep = "[[sweep]]\ndt_safety = 0.1\n";
  EXPECT_EQ(hash(sweep), hash("[[sweep]]\ndt_safety = 0.2\n"));  // points may be added
  EXPECT_EQ(hash(sweep), hash("[speed]\nrepeats = 5\n" + sweep));
  EXPECT_NE(hash(sweep), hash("[truth]\ntolerance = 1e-3\n" + sweep));
  EXPECT_NE(hash(sweep), hash("[change.run]\nsteps = 320\n" + sweep));
  EXPECT_NE(hash(sweep), hash("[change.packing]\noffset = \"[0.2, 0.1, 0.1] mm\"\n" + sweep));
  EXPECT_NE(hash(sweep), hash("[[figure]]\nkind = \"final\"\ncurve = \"energy.kinetic\"\n" + sweep));
}

// Results of a GPU go into the coupon's study: --add takes what has its hash.
TEST(Study, TheCouponOnAGpuIsTheSameStudy) {
  const Study coupon = read_study(CUBOCT_SOURCE_DIR "/scenes/studies/coupon.toml");
  const Study gpu = read_study(CUBOCT_SOURCE_DIR "/scenes/studies/coupon_gpu.toml");
  EXPECT_EQ(gpu.hash, coupon.hash);
  ASSERT_GT(gpu.points.size(), 40U);
  for (const Settings& settings : gpu.points) {
    EXPECT_TRUE(on_gpu(settings)) << settings.key();
    EXPECT_NO_THROW(resolve(gpu.base, settings)) << settings.key();
    // A fixed point has its twin in lattice's: same bits, so the same errors.
    Settings twin = settings;
    twin.engine = "lattice";
    const bool has_twin = std::ranges::find(coupon.points, twin) != coupon.points.end();
    EXPECT_EQ(has_twin, settings.arithmetic == Arithmetic::fixed) << settings.key();
  }
}

TEST(Study, MistakesNameTheirPlace) {
  const SmallStudy files;
  EXPECT_EQ(error_of(files, "[[sweep]]\ndt_saftey = [0.1]\n"),
            "study.toml:4:1: unknown key 'dt_saftey'\n  hint: did you mean 'dt_safety'?");
  EXPECT_EQ(error_of(files, "[[sweep]]\nposition_frac = [20, 40]\n"),
            "study.toml:4:22: 'position_frac' must be between 8 and 30, not 40");
  EXPECT_EQ(error_of(files, "[[sweep]]\narithmetic = \"fixd\"\n"),
            "study.toml:4:14: unknown arithmetic 'fixd'\n  hint: did you mean 'fixed'?");
  EXPECT_EQ(error_of(files, "[[sweep]]\nset.damping.ration = [0.1]\n"),
            "study.toml:4:23: missing key 'coefficient' in 'damping'\n  hint: the value has the key "
            "'ration': did you "
            "mean 'ratio'?");
  EXPECT_EQ(error_of(files, "[[sweep]]\nindex_bits = []\n"), "study.toml:4:14: 'index_bits' lists nothing");
  EXPECT_EQ(error_of(files, ""),
            "study.toml:1:1: a study without points\n  hint: add a [[sweep]] or a [search]");
  EXPECT_EQ(error_of(files, "[[figure]]\nkind = \"mean\"\ncurve = \"energy.kinetc\"\n[[sweep]]\n"),
            "study.toml:5:9: the scene has no curve 'energy.kinetc'\n  hint: did you mean 'energy.kinetic'?");
  EXPECT_EQ(
      error_of(files, "[search]\nengine = [\"lattice\", \"gpu\"]\n"),
      "study.toml:3:1: a search cannot set the engine 'gpu'\n  hint: its fixed points have lattice's errors");
  EXPECT_EQ(error_of(files, "[[sweep]]\nengine = \"gpuu\"\n"),
            "study.toml:4:10: unknown engine 'gpuu'\n  hint: did you mean 'gpu'?");
  EXPECT_EQ(error_of(files, "[truth]\nrungs = 1\n[[sweep]]\n"),
            "study.toml:4:9: 'rungs' must be between 2 and 20, not 1");
  const std::string missing = error_of(files, "arch = \"nowhere.toml\"\n[[sweep]]\n");
  EXPECT_TRUE(missing.starts_with("study.toml:3:8: 'arch' names no file: ")) << missing;
  EXPECT_TRUE(missing.ends_with("nowhere.toml\n  hint: paths count from the study's directory")) << missing;
}

// All runs are looked at at the same times: dt is made shorter until whole steps fit, never longer.
TEST(Study, TimeStepsFitTheGrid) {
  const TimeGrid grid{1.0, 10, 5};
  EXPECT_EQ(grid.steps_per_sample(0.25), 4U);
  EXPECT_EQ(grid.fitted(0.25), 0.25);
  EXPECT_EQ(grid.steps_per_sample(0.3), 4U);
  EXPECT_EQ(grid.fitted(0.3), 0.25);
  EXPECT_EQ(grid.steps_per_sample(0.1), 10U);  // 1/0.1 in doubles is no reason for an eleventh step
  EXPECT_EQ(grid.steps_per_sample(3), 1U);
}

}  // namespace
}  // namespace cuboct::study
