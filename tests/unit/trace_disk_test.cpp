// SPDX-License-Identifier: MIT
// A disk that fails while a trace is written to it: HDF5 may meet that where it closes a part of the file.
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>

#include "model/base/error.h"
#include "tests/support/folder.h"
#include "tests/unit/made_trace.h"

namespace {
int left = -1;  // writes until one fails; below 0: none does
}

// In the place of the system's, for HDF5 within this program.
extern "C" ssize_t pwrite(int file, const void* from, size_t size, off_t to) {
  if (left >= 0 && left-- == 0) {
    errno = EIO;
    return -1;
  }
  return syscall(SYS_pwrite64, file, from, size, to);
}

namespace cuboct {
namespace {

TEST(TraceDisk, EachWriteThatFailsIsTold) {
  const test::Folder folder;
  std::string path;
  int failed = 0;
  for (bool whole = false; !whole && failed < 1000;) {
    path = folder.path(std::to_string(failed));  // HDF5 keeps what it could not close
    left = failed;
    try {
      write_trace(path, made_trace());
      whole = left >= 0;
      EXPECT_TRUE(whole) << "write " << failed << " failed in silence";
    } catch (const InputError& error) {
      EXPECT_EQ(error.what(), "cannot write " + path + ": Input/output error") << failed;
      EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << failed;
    }
    left = -1;
    if (!whole) ++failed;
  }
  EXPECT_GT(failed, 20);
  EXPECT_EQ(read_trace(path).frames.size(), made_trace().frames.size());
}

}  // namespace
}  // namespace cuboct
