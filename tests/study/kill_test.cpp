// SPDX-License-Identifier: MIT
// `cuboct explore`, killed in the middle several times and begun again, ends with the results of a run that
// was let be.
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

// Longer than any of these runs takes on a busy machine: what hangs ends there.
constexpr auto kPatience = std::chrono::minutes(10);

// Looks every millisecond. Whether it came about.
template <typename Condition>
bool wait_until(Condition condition) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
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
      setenv("PATH", "/nonexistent", 1);  // without gnuplot there are no charts to wait for
      execl(CUBOCT_PROGRAM, "cuboct", "explore", study.c_str(), "--out", out.c_str(), "--jobs", count.c_str(),
            "--no-speed", nullptr);
      _exit(127);
    }
  }
  ~Explore() {
    if (ended()) return;
    signal(SIGKILL);
    waitpid(child_, &status_, 0);
  }
  Explore(const Explore&) = delete;
  Explore& operator=(const Explore&) = delete;

  // Once it was seen to have ended, its number may be another process's.
  bool ended() { return ended_ = ended_ || waitpid(child_, &status_, WNOHANG) == child_; }
  void signal(int signal) {
    if (!ended()) kill(child_, signal);
  }
  // Its exit code; of a signal that ended it, the negative number.
  int wait() {
    if (!wait_until([&] { return ended(); })) return kStuck;
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : -WTERMSIG(status_);
  }

 private:
  static constexpr int kStuck = -1000;
  pid_t child_;
  int status_ = 0;
  bool ended_ = false;
};

std::string sweep() {
  // 24 points of some 10 ms each.
  return "[change.run]\nsteps = 800\n[truth]\nrungs = 4\ntolerance = 1e-9\n[[figure]]\nkind = \"mean\"\n"
         "curve = \"energy.potential\"\n[[sweep]]\ndt_safety = [0.05, 0.1, 0.2, 0.4]\nindex_bits = [4, 5, 6, "
         "7, 8, 9]\n";
}

int count_of(const std::string& out, const char* table) {
  const std::string text = rows(out + "/results.db", std::string("select count(*) from ") + table);
  return text.empty() ? 0 : std::stoi(text);
}

// Sends the signal when so many rows stand in the table, or never, where explore ends first. What it ended
// with.
int ended_at(Explore& explore, int signal, const std::string& out, const char* table, int rows) {
  EXPECT_TRUE(wait_until([&] { return explore.ended() || count_of(out, table) >= rows; }))
      << "no " << rows << " rows of " << table;
  explore.signal(signal);
  return explore.wait();
}

TEST(Explore, KilledAndBegunAgainEndsTheSame) {
  const SmallStudy files;
  const std::string study = files.study(sweep());
  const std::string whole = files.path("whole");
  ASSERT_EQ(Explore(files, study, whole, 1).wait(), 0) << answer_of(files.path("said"));
  ASSERT_EQ(count_of(whole, "points"), 24);
  const std::string expected = rows(whole + "/results.db", kAll);
  ASSERT_GT(expected.size(), 10'000U);

  // Within the truth's refinement, then every few points. A run that ended before its signal came, as this
  // process had no turn meanwhile, leaves nothing to kill: then all is tried once more.
  int kills = 0;
  for (int attempt = 0; attempt < 5 && kills < 3; ++attempt) {
    const std::string cut = files.path("cut" + std::to_string(attempt));
    for (const auto& [table, rows] : {std::pair("rungs", 2), std::pair("points", 1), std::pair("points", 5),
                                      std::pair("points", 11), std::pair("points", 17)}) {
      Explore explore(files, study, cut, 2);
      const int end = ended_at(explore, SIGKILL, cut, table, rows);
      ASSERT_TRUE(end == 0 || end == -SIGKILL) << end << ": " << answer_of(files.path("said"));
      kills += end != 0 && count_of(cut, "points") < 24;
    }
    ASSERT_EQ(Explore(files, study, cut, 2).wait(), 0) << answer_of(files.path("said"));
    EXPECT_EQ(rows(cut + "/results.db", kAll), expected);
  }
  EXPECT_GE(kills, 3);
}

TEST(Explore, CtrlCEndsItAndSaysHowItGoesOn) {
  const SmallStudy files;
  const std::string study = files.study(sweep());
  int end = 0;
  for (int attempt = 0; attempt < 5 && end == 0; ++attempt) {
    const std::string out = files.path("out" + std::to_string(attempt));
    Explore explore(files, study, out, 2);
    end = ended_at(explore, SIGINT, out, "points", 1);
    if (end == 0) continue;  // it was done before the signal came
    EXPECT_EQ(answer_of(files.path("said")), "interrupted; the same command goes on where it was\n");
    EXPECT_LT(count_of(out, "points"), 24);
  }
  EXPECT_EQ(end, 1);
}

}  // namespace
}  // namespace cuboct::test
