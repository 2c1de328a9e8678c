// SPDX-License-Identifier: MIT
#include "model/base/guarded_reader.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <optional>
#include <utility>

#include "model/base/error.h"
#include "model/base/error_parts.h"
#include "model/base/interrupt.h"
#include "model/base/process.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

// Libraries put the rest of the file into their messages.
std::string first_line(const std::string& path) {
  constexpr size_t kMost = 80;
  std::string line;
  std::ifstream in(path);
  std::getline(in, line);
  if (line.size() > kMost) line = line.substr(0, kMost) + " ...";
  return line_text(line);
}

std::string outcome(int status, const ReaderLimits& limits, const std::string& complaint) {
  if (status == 2 && !complaint.empty()) return complaint;
  if (status == -SIGXCPU)
    return fmt::format("reading it takes more than {} s of processor time", limits.seconds);
  if (status == -SIGALRM) return fmt::format("reading it takes more than {} s", 10 * limits.seconds);
  if (status < 0) return fmt::format("it crashes the library that reads it ({})", strsignal(-status));
  return fmt::format("reading it fails with code {}", status);
}

// A pipe whose other end a program opens by name, as `Streams` has it.
class Pipe {
 public:
  Pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0)
      throw InputError(fmt::format("cannot make a pipe: {}", std::strerror(errno)));
    from_.reset(fdopen(ends[0], "rb"));
    to_ = ends[1];
    fcntl(to_, F_SETPIPE_SZ, 1 << 20);  // fewer turns; as it is where the system gives less
  }
  ~Pipe() { close_writer(); }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  std::FILE* from() const { return from_.get(); }
  std::string name() const { return fmt::format("/proc/self/fd/{}", to_); }
  // Ours: while it is open the pipe never ends.
  void close_writer() {
    if (to_ >= 0) close(std::exchange(to_, -1));
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> from_;
  int to_ = -1;
};

}  // namespace

ReaderLimits reader_limits(uint64_t bytes) {
  const uint64_t megabytes = bytes >> 20;
  return {.seconds = 4 + megabytes, .megabytes = 1024 + 200 * megabytes};
}

void read_guarded(const std::string& program, const std::string& file, const std::string& result,
                  const ReaderLimits& limits) {
  const std::string said = result + ".said";
  const int status =
      Process(program, {file, result, std::to_string(limits.seconds), std::to_string(limits.megabytes)},
              false, {"/dev/null", said})
          .wait();
  if (status == 0) return;
  if (interrupted()) throw InputError("interrupted");
  throw InputError(outcome(status, limits, first_line(said)));
}

struct GuardedStream::Impl {
  Impl(const std::string& program, std::vector<std::string> words, const std::string& file,
       const ReaderLimits& limits)
      : file(file), limits(limits) {
    words.insert(words.end(), {file, std::to_string(limits.seconds), std::to_string(limits.megabytes)});
    process.emplace(program, words, false, Streams{out.name(), err.name()});
    out.close_writer(), err.close_writer();
  }

  [[noreturn]] void fail() {
    std::string said(1 << 13, '\0');
    if (!interrupted()) said.resize(std::fread(said.data(), 1, said.size(), err.from()));
    const int status = process->wait();
    if (interrupted()) throw InputError("interrupted");
    if (status == 2 && !said.empty()) throw error_of(said);
    throw InputError(fmt::format("cannot read {}: {}", file, outcome(status, limits, "")));
  }

  const std::string file;
  const ReaderLimits limits;
  Pipe out, err;
  std::optional<Process> process;
};

GuardedStream::GuardedStream(const std::string& program, const std::vector<std::string>& words,
                             const std::string& file, const ReaderLimits& limits)
    : impl_(std::make_unique<Impl>(program, words, file, limits)) {}

GuardedStream::~GuardedStream() = default;

void GuardedStream::read(void* to, size_t bytes) {
  char* next = static_cast<char*>(to);
  std::FILE* const from = impl_->out.from();
  while (bytes > 0) {
    const size_t come = std::fread(next, 1, bytes, from);
    next += come, bytes -= come;
    if (bytes == 0) return;
    if (!std::ferror(from) || errno != EINTR || interrupted()) impl_->fail();
    std::clearerr(from);
  }
}

}  // namespace cuboct
