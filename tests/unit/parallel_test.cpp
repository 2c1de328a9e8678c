// SPDX-License-Identifier: MIT
#include "model/base/parallel.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

namespace cuboct {
namespace {

// Loops of all sizes, one right behind the other: parts of an old loop must not be done in a new one.
TEST(Parallel, DoesEachPartOnceInAMemberOfItsOwn) {
  std::mt19937_64 random(1);
  size_t shared = 0;
  for (int round = 0; round < 20'000; ++round) {
    const int threads = 1 + static_cast<int>(random() % 5);
    const size_t parts = random() % 12;
    std::vector<int> done(parts, 0);
    std::vector<std::atomic<int>> inside(static_cast<size_t>(threads));
    std::atomic<size_t> by_others = 0;
    for_each_part(parts, threads, [&](size_t part, int member) {
      ASSERT_LT(member, threads);
      ASSERT_EQ(inside[static_cast<size_t>(member)]++, 0);
      ++done[part];
      by_others += member > 0 ? 1 : 0;
      --inside[static_cast<size_t>(member)];
    });
    ASSERT_EQ(done, std::vector<int>(parts, 1)) << "round " << round;
    shared += by_others;
  }
  EXPECT_GT(shared, 0u);
}

// Members 1, 2, ... have the slow parts: all others help them, and two reach for the same part again and
// again.
TEST(Parallel, DoesNoPartTwiceWhereManyReachForIt) {
  size_t helped = 0;
  for (int round = 0; round < 3'000; ++round) {
    const int threads = 2 + round % 3;
    std::vector<std::atomic<int>> done(100);
    std::atomic<size_t> by_others = 0;
    for_each_part(done.size(), threads, [&](size_t part, int member) {
      const int owner = static_cast<int>(part % static_cast<size_t>(threads));
      for (volatile int k = 0; k < (owner > 0 ? 100 : 0);) k = k + 1;
      by_others += member != owner ? 1 : 0;
      ++done[part];
    });
    for (size_t part = 0; part < done.size(); ++part)
      ASSERT_EQ(done[part], 1) << "round " << round << ", part " << part;
    helped += by_others;
  }
  EXPECT_GT(helped, 1000u);
}

TEST(Parallel, CoversRanges) {
  for (const int threads : {1, 2, 7}) {
    std::vector<int> done(1000, 0);
    for_each_range(
        done.size(), 10,
        [&](size_t begin, size_t end) {
          for (size_t k = begin; k < end; ++k) ++done[k];
        },
        threads);
    EXPECT_EQ(done, std::vector<int>(done.size(), 1));
  }
}

TEST(Parallel, ThrowsWhatAPartThrew) {
  std::atomic<int> done = 0;
  const auto work = [&](size_t part, int) {
    ++done;
    if (part == 3) throw std::runtime_error("part 3");
  };
  for (int round = 1; round <= 100; ++round) {
    EXPECT_THROW(for_each_part(8, 3, work), std::runtime_error);
    EXPECT_EQ(done, 8 * round);
  }
}

TEST(Parallel, WorksWithinItselfAndBesideItself) {
  std::atomic<int> done = 0;
  const auto both = [&] {
    for_each_part(4, 2, [&](size_t, int) { for_each_part(4, 2, [&](size_t, int) { ++done; }); });
  };
  std::vector<std::thread> callers;
  for (int k = 0; k < 3; ++k)
    callers.emplace_back([&] {
      for (int round = 0; round < 200; ++round) both();
    });
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(done, 3 * 200 * 16);
}

double cpu_seconds() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

// A helper without work sleeps: it is not seen in the CPU time of what the caller does by itself.
TEST(Parallel, WaitsAsleep) {
  for_each_part(2, 2, [](size_t, int) {});
  const double before = cpu_seconds();
  for (int k = 0; k < 5; ++k) {
    for_each_part(2, 2, [](size_t, int) {});
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  // And so does the caller where one part is long: the other one waits.
  for_each_part(2, 2, [](size_t part, int) {
    if (part == 1) std::this_thread::sleep_for(std::chrono::milliseconds(500));
  });
  EXPECT_LT(cpu_seconds() - before, 0.1);
}

}  // namespace
}  // namespace cuboct
