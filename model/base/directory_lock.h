// SPDX-License-Identifier: MIT
// One process at a time writes into a directory.
#pragma once
#include <string>

namespace cuboct {

// While this lives, no other process that asks for the lock writes into the directory. The lock is a file
// `.lock` in it, which names the process; the system lets go of it with the process, however that ends.
class DirectoryLock {
 public:
  // Makes the directory where there is none. Throws InputError where it cannot be made or written to, and
  // ("DIR is in use by process 12, 'cuboct run'") where another process has it. `work`: what we are. Removes
  // the temporary files (output.h) of processes that are no more.
  DirectoryLock(const std::string& directory, const std::string& work);
  ~DirectoryLock();  // a directory that was made for nothing goes too
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  std::string directory_, path_;
  bool made_;
  int file_ = -1;
};

// Whether a process holds the lock of a directory now.
bool is_locked(const std::string& directory);

}  // namespace cuboct
