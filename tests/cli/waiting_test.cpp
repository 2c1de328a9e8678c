// SPDX-License-Identifier: MIT
// Threads and ranks that wait leave their core to others: beside busy programs a run in two takes hardly more
// CPU time than a run in one. CPU time alone is compared, which a busy machine does not change.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <thread>
#include <vector>

#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

// Programs that want all of a core each, while they live.
class Busy {
 public:
  explicit Busy(unsigned programs) {
    for (unsigned k = 0; k < programs; ++k) {
      const pid_t child = fork();
      if (child == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        for (std::atomic<uint64_t> n = 0;;) ++n;
      }
      children_.push_back(child);
    }
  }
  ~Busy() {
    for (const pid_t child : children_) {
      kill(child, SIGKILL);
      waitpid(child, nullptr, 0);
    }
  }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  std::vector<pid_t> children_;
};

// Of a run of the coupon, bound to so many cores (0: all).
double cpu_of(const std::string& option, const std::string& count, int cores = 0,
              const std::string& steps = "300") {
  const Bench bench(false);
  std::filesystem::copy(CUBOCT_LATTICE, bench.path("bin/cuboct-lattice"));
  const Answer answer = bench.cuboct(
      {"run", "scenes/coupon.toml", "--no-watch", "--steps", steps, option, count}, {}, {.cores = cores});
  EXPECT_EQ(answer.code, 0) << answer.err;
  return answer.cpu;
}

bool has_ranks() {
  const Bench bench(false);
  std::filesystem::copy(CUBOCT_LATTICE, bench.path("bin/cuboct-lattice"));
  return bench.cuboct({"run", "scenes/lj_block.toml", "--steps", "1", "--ranks", "2"}).code == 0;
}

TEST(Waiting, ThreadsLeaveTheCoreToBusyPrograms) {
  const Busy busy(2 * std::thread::hardware_concurrency());
  EXPECT_LT(cpu_of("--threads", "2"), 2.5 * cpu_of("--threads", "1") + 0.1);
}

TEST(Waiting, MoreThreadsThanCoresDoNotSpin) {
  EXPECT_LT(cpu_of("--threads", "4", 1), 2.5 * cpu_of("--threads", "1", 1) + 0.1);
}

TEST(Waiting, RanksLeaveTheCoreToBusyPrograms) {
  if (!has_ranks()) GTEST_SKIP() << "no MPI";
  const Busy busy(2 * std::thread::hardware_concurrency());
  // mpirun and the start of its ranks cost something too.
  const double start = cpu_of("--ranks", "2", 0, "1");
  EXPECT_LT(cpu_of("--ranks", "2"), start + 4 * cpu_of("--threads", "1") + 0.5);
}

}  // namespace
}  // namespace cuboct::test
