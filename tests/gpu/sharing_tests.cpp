// SPDX-License-Identifier: MIT
// Who may stay on a device that several runs share: blocks of a launch that wait for one another are there
// all or not at all.
#include "emu/gpu/device/sharing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <thread>

namespace cuboct::gpu {
namespace {

TEST(Sharing, BlocksOfOneSizeFillADeviceToTheLast) {
  EXPECT_TRUE(fit_together({}, 3));
  EXPECT_TRUE(fit_together({{12, 4}}, 3));
  EXPECT_FALSE(fit_together({{13, 4}}, 3));
  EXPECT_TRUE(fit_together({{5, 4}, {7, 4}}, 3));
  EXPECT_FALSE(fit_together({{6, 4}, {7, 4}}, 3));
}

// Three multiprocessors. Blocks of an eighth may leave each 3/8, a half then finds no place: 15 of them do,
// and with 12 one multiprocessor has a half free for sure, as 12/8 are no more than 3 * (1 - 1/2).
TEST(Sharing, OfSeveralSizesTheLargestFindsAPlaceWhereverOthersAre) {
  EXPECT_TRUE(fit_together({{12, 8}, {1, 2}}, 3));
  EXPECT_FALSE(fit_together({{13, 8}, {1, 2}}, 3));
  EXPECT_FALSE(fit_together({{1, 8}, {5, 2}}, 3));
}

// Whether blocks, placed one after the other on any multiprocessor with room, can leave one without a place.
bool may_fail(const std::vector<Resident>& residents, int multiprocessors, std::mt19937& random) {
  constexpr int kParts = 24;  // a multiple of all sizes
  std::vector<int> blocks, taken(static_cast<size_t>(multiprocessors), 0);
  for (const Resident& one : residents) blocks.insert(blocks.end(), one.blocks, kParts / one.each);
  std::ranges::shuffle(blocks, random);
  for (const int size : blocks) {
    std::vector<int*> with_room;
    for (int& one : taken)
      if (one + size <= kParts) with_room.push_back(&one);
    if (with_room.empty()) return true;
    *with_room[random() % with_room.size()] += size;
  }
  return false;
}

TEST(Sharing, WhatFitsFindsPlacesInAnyOrder) {
  std::mt19937 random(1);
  const int sizes[] = {1, 2, 3, 4, 8};
  int fitting = 0, failing = 0;
  for (int trial = 0; trial < 20'000; ++trial) {
    const int multiprocessors = 2 + static_cast<int>(random() % 3);
    std::vector<Resident> residents(1 + random() % 3);
    for (Resident& one : residents)
      one = {1 + static_cast<unsigned>(random() % 10), sizes[random() % std::size(sizes)]};
    const bool fits = fit_together(residents, multiprocessors),
               fails = may_fail(residents, multiprocessors, random);
    EXPECT_FALSE(fits && fails);
    fitting += fits, failing += fails;
  }
  EXPECT_GT(fitting, 1000);
  EXPECT_GT(failing, 1000);
}

TEST(Sharing, ThreadsWaitUntilThereIsRoom) {
  constexpr int kThreads = 6, kTurns = 300, kEach = 4, kMultiprocessors = 5;
  Sharing::all().begin();
  std::atomic<int> there = 0, most = 0, too_many = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t)
    threads.emplace_back([&, t] {
      std::mt19937 random(static_cast<unsigned>(t));
      for (int k = 0; k < kTurns; ++k) {
        const auto blocks = 1 + static_cast<int>(random() % 12);
        const Sharing::Stay stay(0, {static_cast<unsigned>(blocks), kEach}, kMultiprocessors);
        const int now = there += blocks;
        too_many += now > kEach * kMultiprocessors;
        for (int seen = most; now > seen && !most.compare_exchange_weak(seen, now);) continue;
        std::this_thread::yield();
        there -= blocks;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(too_many, 0);
  EXPECT_EQ(there, 0);
  EXPECT_GT(most, 12);  // several stayed at once
}

TEST(Sharing, ARunsShareIsThatOfThoseThatGoOn) {
  Sharing::all().begin();
  EXPECT_EQ(Sharing::all().share_of(100), 100u);
  const Sharing::Run first;
  EXPECT_EQ(Sharing::all().share_of(100), 100u);
  {
    const Sharing::Run second, third;
    EXPECT_EQ(Sharing::all().share_of(100), 33u);
  }
  EXPECT_EQ(Sharing::all().share_of(100), 100u);
}

}  // namespace
}  // namespace cuboct::gpu
