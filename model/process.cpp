// SPDX-License-Identifier: MIT
#include "model/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <utility>

#include "model/error.h"
#include "model/interrupt.h"

extern char** environ;

namespace cuboct {

Process::Process(const std::string& program, const std::vector<std::string>& arguments, bool apart,
                 const Streams& streams)
    : pid_(-1), passed_on_(apart ? SIGUSR1 : SIGTERM) {
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const auto send = [&](int stream, const std::string& to) {
    if (!to.empty())
      posix_spawn_file_actions_addopen(&actions, stream, to.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  };
  send(STDOUT_FILENO, streams.out);
  send(STDERR_FILENO, streams.err);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  if (apart) posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const int error = posix_spawnp(&pid_, program.c_str(), &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    pid_ = -1;
    throw InputError(fmt::format("cannot start {}: {}", program, std::strerror(error)));
  }
}

Process::~Process() {
  if (pid_ < 0) return;
  kill(pid_, SIGTERM);
  while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

Process::Process(Process&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)), passed_on_(other.passed_on_) {}

int Process::wait() {
  bool passed_on = false;
  int status = 0;
  // Readable when the program has ended. Where the kernel gives none, we look every 10 ms.
  pollfd ended{static_cast<int>(syscall(SYS_pidfd_open, pid_, 0)), POLLIN, 0};
  const nfds_t count = ended.fd >= 0 ? 1 : 0;
  pid_t found = 0;
  while ((found = waitpid(pid_, &status, WNOHANG)) == 0) {
    // A terminal sends Ctrl-C to the engine as well; a `kill` meets us alone, and of our threads any one.
    if (interrupted() && !std::exchange(passed_on, true)) kill(pid_, passed_on_);
    poll(&ended, count, count ? 100 : 10);
  }
  if (ended.fd >= 0) close(ended.fd);
  if (found < 0) throw std::runtime_error(fmt::format("waitpid: {}", std::strerror(errno)));
  pid_ = -1;
  return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

std::string program_directory() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path().string();
}

bool in_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream directories(path ? path : "");
  for (std::string directory; std::getline(directories, directory, ':');)
    if (access((directory + "/" + program).c_str(), X_OK) == 0) return true;
  return false;
}

Scratch::Scratch() {
  std::string name = (std::filesystem::temp_directory_path() / "cuboct-XXXXXX").string();
  if (!mkdtemp(name.data()))
    throw InputError(fmt::format("cannot make the directory {}: {}", name, std::strerror(errno)));
  directory_ = name;
}

Scratch::~Scratch() {
  std::error_code none;
  std::filesystem::remove_all(directory_, none);
}

}  // namespace cuboct
