// SPDX-License-Identifier: MIT
#include "model/base/directory_lock.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "model/base/process.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

// What a killed process was writing goes with the next one's lock; what a living one writes stays, and so
// does what only looks like it.
TEST(DirectoryLock, RemovesWhatDeadProcessesLeft) {
  const pid_t dead = fork();
  ASSERT_GE(dead, 0);
  if (dead == 0) _exit(0);
  ASSERT_EQ(waitpid(dead, nullptr, 0), dead);
  const Scratch scratch;
  const std::string directory = scratch.path("run");
  fs::create_directory(directory);
  const std::string living = "plan.txt." + std::to_string(getpid()) + ".tmp";
  const std::set<std::string> stay{living, "notes.tmp", "a.12x.tmp", "b.0.tmp", "run.toml"};
  for (const std::string& name : stay) std::ofstream(fs::path(directory) / name) << "x";
  std::ofstream(fs::path(directory) / ("plan.txt." + std::to_string(dead) + ".tmp")) << "x";
  const DirectoryLock lock(directory, "a test");
  std::set<std::string> left;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory))
    left.insert(entry.path().filename().string());
  left.erase(".lock");
  EXPECT_EQ(left, stay);
}

}  // namespace
}  // namespace cuboct
