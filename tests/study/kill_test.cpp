// SPDX-License-Identifier: MIT
// `cuboct explore`, killed in the middle several times and begun again, ends with the results of a run that was let be.
#include <gtest/gtest.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <sstream>
#include <thread>

#include "tests/study/rows.h"
#include "tests/study/small_study.h"

namespace cuboct::test {
namespace {

// Errors, statuses and truths; speeds are what differs from run to run.
constexpr const char* kAll =
    "select * from points order by numbers; select * from figures order by numbers, figure;"
    "select physics, hex(truth) from truths order by physics; select * from rungs order by physics, rung;";

std::string answer_of(const std::string& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

class Explore {
 public:
  Explore(const SmallStudy& files, const std::string& study, const std::string& out, int jobs) {
    const std::string count = std::to_string(jobs), said = files.path("said");
    child_ = fork();
    if (child_ == 0) {
      const int to = open(said.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
      dup2(to, 1);
      dup2(to, 2);
      execl(CUBOCT_PROGRAM, "cuboct", "explore", study.c_str(), "--out", out.c_str(), "--jobs", count.c_str(),
            "--no-speed", nullptr);
      _exit(127);
    }
  }
  void signal(int signal) const { kill(child_, signal); }
  bool running() const { return waitpid(child_, nullptr, WNOHANG) == 0; }
  int wait() const {
    int status = 0;
    waitpid(child_, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  pid_t child_;
};

std::string sweep() {
  // 24 points of some 10 ms each.
  return "[change.run]\nsteps = 800\n[truth]\nrungs = 4\ntolerance = 1e-9\n[[figure]]\nkind = \"mean\"\n"
         "curve = \"energy.potential\"\n[[sweep]]\ndt_safety = [0.05, 0.1, 0.2, 0.4]\nindex_bits = [4, 5, 6, 7, 8, 9]\n";
}

int count_of(const std::string& out, const char* table) {
  const std::string text = rows(out + "/results.db", std::string("select count(*) from ") + table);
  return text.empty() ? 0 : std::stoi(text);
}

TEST(Explore, KilledAndBegunAgainEndsTheSame) {
  const SmallStudy files;
  const std::string study = files.study(sweep());
  const std::string whole = files.path("whole"), cut = files.path("cut");
  ASSERT_EQ(Explore(files, study, whole, 1).wait(), 0) << answer_of(files.path("said"));
  ASSERT_EQ(count_of(whole, "points"), 24);

  // Within the truth's refinement, then every few points. What counts is what stands on the disk, not the time.
  int kills = 0;
  for (const auto& [table, rows] : {std::pair("rungs", 2), std::pair("points", 1), std::pair("points", 5),
                                    std::pair("points", 11), std::pair("points", 17)}) {
    const Explore explore(files, study, cut, 2);
    while (explore.running() && count_of(cut, table) < rows)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    explore.signal(SIGKILL);
    kills += explore.wait() != 0;
    ASSERT_LT(count_of(cut, "points"), 24);
  }
  EXPECT_EQ(kills, 5);
  ASSERT_EQ(Explore(files, study, cut, 2).wait(), 0) << answer_of(files.path("said"));
  EXPECT_EQ(rows(cut + "/results.db", kAll), rows(whole + "/results.db", kAll));
  EXPECT_GT(rows(cut + "/results.db", kAll).size(), 10'000U);
}

TEST(Explore, CtrlCEndsItAndSaysHowItGoesOn) {
  const SmallStudy files;
  const std::string study = files.study(sweep()), out = files.path("out");
  const Explore explore(files, study, out, 2);
  while (count_of(out, "points") < 1) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  explore.signal(SIGINT);
  EXPECT_EQ(explore.wait(), 1);
  EXPECT_EQ(answer_of(files.path("said")), "interrupted; the same command goes on where it was\n");
  EXPECT_LT(count_of(out, "points"), 24);
}

}  // namespace
}  // namespace cuboct::test
