// SPDX-License-Identifier: MIT
// `cuboct explore` with and without the gpu engine's program beside it.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/cli/shell.h"
#include "tests/study/rows.h"
#include "tests/study/small_study.h"

namespace cuboct::test {
namespace {

constexpr const char* kStudy =
    "[speed]\nrepeats = 1\nseconds = 0.01\n[truth]\nrungs = 2\n[[figure]]\nkind = \"mean\"\n"
    "curve = \"energy.potential\"\n[[sweep]]\nengine = [\"lattice\", \"gpu\"]\ndt_safety = [0.2, 0.4]\n"
    "[[sweep]]\nengine = \"gpu\"\narithmetic = \"float32\"\n";

// What is told of the points that are not there: the line that begins with a number of points, and its hint.
std::string left_out(const std::string& out) {
  const size_t at = out.find(" of the gpu engine left out");
  if (at == std::string::npos) return "";
  const size_t begin = out.rfind('\n', at) + 1, end = out.find('\n', out.find('\n', at) + 1);
  return out.substr(begin, end - begin);
}

std::string points_of(const std::string& directory) {
  return rows(directory + "/results.db",
              "select p.numbers, p.status, p.machine, s.machine from points p left join speeds s on "
              "p.numbers = s.numbers order by p.numbers");
}

constexpr const char* kHint = "\n  hint: --add FILE takes them from another machine's results.db";

class ExploreOnGpu : public testing::Test {
 protected:
  void put(const std::string& script) const {
    std::ofstream(bench_.path("bin/cuboct-gpu")) << "#!/bin/sh\n" << script;
    std::filesystem::permissions(bench_.path("bin/cuboct-gpu"), std::filesystem::perms::owner_all);
  }
  Answer explore(const std::string& out, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"explore", study_, "--out", out});
    return bench_.cuboct(more);
  }
  Bench bench_{false};
  SmallStudy files_;
  std::string study_ = files_.study(kStudy);
};

TEST_F(ExploreOnGpu, WithoutTheProgramItsPointsAreLeftOutAndComeFromAnotherMachine) {
  const std::string here = bench_.path("here"), there = bench_.path("there");
  const Answer alone = explore(here);
  EXPECT_EQ(alone.code, 0) << alone.err;
  EXPECT_EQ(
      left_out(alone.out),
      std::string("3 points of the gpu engine left out: no program cuboct-gpu beside this one") + kHint);
  const std::string lattice = "lattice fixed euler run.dt=\"auto\" run.dt_safety=";
  EXPECT_EQ(points_of(here), lattice + "0.2|done|||\n" + lattice + "0.4|done|||\n");

  std::filesystem::copy(CUBOCT_GPU_HOST, bench_.path("bin/cuboct-gpu"));
  const Answer with = explore(there);
  EXPECT_EQ(with.code, 0) << with.err;
  EXPECT_EQ(left_out(with.out), "");
  const std::string gpu = "gpu fixed euler run.dt=\"auto\" run.dt_safety=";
  const std::string on_gpu = gpu + "0.2|done|host|host|\n" + gpu + "0.4|done|host|host|\n" +
                             "gpu float32 euler threads=1|done|host|host|\n";
  EXPECT_EQ(points_of(there), on_gpu + points_of(here));

  // Lattice's rows are here already: they stay this machine's.
  std::filesystem::remove(bench_.path("bin/cuboct-gpu"));
  rows(there + "/results.db", "update meta set value = 'another machine' where name = 'machine'");
  const Answer added = explore(here, {"--add", there + "/results.db"});
  EXPECT_EQ(added.code, 0) << added.err;
  EXPECT_TRUE(added.out.starts_with("6 rows from ")) << added.out;
  EXPECT_EQ(left_out(added.out), "");
  EXPECT_EQ(points_of(here), points_of(there));
#ifdef CUBOCT_HAS_PAGE
  const std::string page = contents(here + "/page.html");
  EXPECT_NE(page.find("\"name\":\"gpu, float (host)\""), std::string::npos);
  EXPECT_NE(page.find("\"name\":\"lattice, fixed\""), std::string::npos);
#endif
}

// What the program says where there is no driver is tested with it.
TEST_F(ExploreOnGpu, WithoutADeviceItsPointsAreLeftOut) {
  put("echo 'the gpu engine needs a CUDA device: no driver (libcuda.so.1)' >&2\nexit 2\n");
  const Answer answer = explore(bench_.path("here"), {"--no-speed"});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_EQ(left_out(answer.out),
            std::string("3 points of the gpu engine left out: the gpu engine needs a CUDA "
                        "device: no driver (libcuda.so.1)") +
                kHint);
  EXPECT_EQ(rows(bench_.path("here") + "/results.db", "select count(*) from points"), "2|\n");
}

// A device that fails is no property of a point: nothing is recorded of it, and the next call begins there.
TEST_F(ExploreOnGpu, AProgramThatFailsEndsTheStudyAndLeavesNoRow) {
  put("case \"$*\" in --list) echo '0 a GPU';; *) echo 'cuboct-gpu: an illegal memory access' >&2; exit 1;; "
      "esac\n");
  const Answer answer = explore(bench_.path("here"), {"--no-speed"});
  EXPECT_EQ(answer.code, 1);
  EXPECT_EQ(answer.err, "cuboct-gpu: an illegal memory access\n");
  EXPECT_EQ(rows(bench_.path("here") + "/results.db", "select count(*) from points"), "2|\n");
}

// What a point leaves does not depend on those beside it: one is refused, one fails within its run.
TEST_F(ExploreOnGpu, PointsAtOnceHaveTheErrorsOfOneAfterTheOther) {
  std::filesystem::copy(CUBOCT_GPU_HOST, bench_.path("bin/cuboct-gpu"));
  const std::string study = files_.study(
      "[truth]\nrungs = 2\n[[figure]]\nkind = \"mean\"\ncurve = \"energy.potential\"\n"
      "[[sweep]]\nengine = \"gpu\"\narithmetic = [\"fixed\", \"float32\"]\n"
      "dt_safety = 0.4\n[[sweep]]\nengine = \"gpu\"\nsum_bits = 14\n"
      "[[sweep]]\nengine = \"gpu\"\ncell_edge = \"0.6 mm\"\n",
      "many.toml");
  const std::string one = bench_.path("one"), many = bench_.path("many");
  const auto run = [&](const std::string& out, const std::string& jobs) {
    return bench_.cuboct({"explore", study, "--out", out, "--no-speed", "--jobs", jobs});
  };
  Answer answer = run(one, "1");
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_NE(answer.out.find("points on the GPU: 1 at once\n"), std::string::npos) << answer.out;
  answer = run(many, "3");
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_NE(answer.out.find("points on the GPU: 3 at once\n"), std::string::npos) << answer.out;
  const char* all = "select * from points order by numbers; select * from figures order by numbers, figure;";
  EXPECT_EQ(rows(many + "/results.db", all), rows(one + "/results.db", all));
  EXPECT_EQ(rows(many + "/results.db", "select status, count(*) from points group by status order by status"),
            "done|2|\nrefused|1|\nunstable|1|\n");
}

// Those that were done stay, and the same command goes on with the rest.
TEST_F(ExploreOnGpu, AnInterruptLeavesThePointsThatAreDone) {
  std::filesystem::copy(CUBOCT_GPU_HOST, bench_.path("bin/cuboct-gpu"));
  constexpr int kPoints = 5;
  std::string steps;
  for (int k = 1; k <= kPoints; ++k) steps += (k > 1 ? ", " : "") + std::to_string(0.06 + 0.02 * k);
  const std::string study = files_.study(
      "[truth]\nrungs = 2\n[[sweep]]\nengine = \"gpu\"\ndt_safety = [" + steps + "]\n", "many.toml");
  const std::string out = bench_.path("cut"), whole = bench_.path("whole");
  const auto run = [&](const std::string& to, const Condition& interrupts = {}) {
    return bench_.cuboct({"explore", study, "--out", to, "--no-speed", "--jobs", "2"}, interrupts);
  };
  const auto done = [](const std::string& of) {
    const std::string count = rows(of + "/results.db", "select count(*) from points");
    return count.empty() ? 0 : std::stoi(count);
  };
  const Answer cut = run(out, [&](pid_t) { return done(out) > 0; });
  EXPECT_EQ(cut.code, 1);
  EXPECT_EQ(cut.err, "interrupted; the same command goes on where it was\n");
  EXPECT_GT(done(out), 0);
  EXPECT_LT(done(out), kPoints);
  EXPECT_EQ(rows(out + "/results.db", "select count(*) from points where status != 'done'"), "0|\n");
  EXPECT_EQ(run(out).code, 0);
  EXPECT_EQ(run(whole).code, 0);
  const char* all = "select * from points order by numbers;";
  EXPECT_EQ(rows(out + "/results.db", all), rows(whole + "/results.db", all));
  EXPECT_EQ(done(out), kPoints);
}

// An interrupt that meets cuboct alone is passed on, from whichever thread waits: the program need not end by
// itself.
TEST_F(ExploreOnGpu, AnInterruptEndsTheProgram) {
  const std::string begun = bench_.path("begun");
  put("case \"$*\" in --list) echo '0 a GPU';; *) echo $$ > " + begun + ".tmp; mv " + begun + ".tmp " +
      begun + "; exec sleep infinity;; esac\n");
  const Answer answer =
      bench_.cuboct({"explore", study_, "--out", bench_.path("here"), "--no-speed"}, there(begun));
  EXPECT_EQ(answer.code, 1);
  EXPECT_EQ(answer.err, "interrupted; the same command goes on where it was\n");
  EXPECT_FALSE(std::filesystem::exists("/proc/" + std::to_string(std::stoi(contents(begun)))));
}

}  // namespace
}  // namespace cuboct::test
