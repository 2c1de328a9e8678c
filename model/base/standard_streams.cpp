// SPDX-License-Identifier: MIT
#include "model/base/standard_streams.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

namespace cuboct {
namespace {

// The first error of standard output, 0 before.
volatile int output_error = 0;

// 0, or an errno.
int write_all(int descriptor, const char* text, size_t size) {
  while (size > 0) {
    const ssize_t now = write(descriptor, text, size);
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) return now < 0 ? errno : ENOSPC;
    text += now;
    size -= static_cast<size_t>(now);
  }
  return 0;
}

// Both take all that they are given. Output ends with its first error: later text would follow a gap.
ssize_t write_output(void*, const char* text, size_t size) {
  if (output_error == 0) output_error = write_all(STDOUT_FILENO, text, size);
  return static_cast<ssize_t>(size);
}

ssize_t write_errors(void*, const char* text, size_t size) {
  static_cast<void>(write_all(STDERR_FILENO, text, size));
  return static_cast<ssize_t>(size);
}

// glibc lets programs assign to stdout and stderr.
void replace(std::FILE*& stream, cookie_write_function_t* write, int mode) {
  std::FILE* const other = fopencookie(nullptr, "w", {nullptr, write, nullptr, nullptr});
  if (other == nullptr) return;  // out of memory: the stream stays as it was
  std::setvbuf(other, nullptr, mode, BUFSIZ);
  stream = other;
}

}  // namespace

// What a program did not catch itself, as before it had read its words.
int exit_code_of(const std::function<int()>& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    std::fputs("out of memory\n", stderr);  // without taking any
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
  }
  return 1;
}

void fill_standard_descriptors() {
  // Opening takes the lowest number that is free.
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(descriptor, F_GETFD) < 0 && open("/dev/null", O_RDWR) < 0) _exit(1);
}

int with_standard_streams(const std::function<int()>& work,
                          const std::function<void(const std::string&)>& tell) {
  fill_standard_descriptors();
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  replace(stdout, write_output, isatty(STDOUT_FILENO) != 0 ? _IOLBF : _IOFBF);
  replace(stderr, write_errors, _IONBF);
  const int code = exit_code_of(work);
  std::fflush(stdout);
  if (output_error == 0 || output_error == EPIPE) return code;
  const std::string text = fmt::format("cannot write to standard output: {}", std::strerror(output_error));
  if (tell)
    tell(text);
  else
    fmt::print(stderr, "{}\n", text);
  return code != 0 ? code : 1;
}

bool output_is_lost() { return output_error != 0; }

}  // namespace cuboct
