// SPDX-License-Identifier: MIT
#include "model/base/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "model/base/error.h"
#include "model/base/interrupt.h"

extern char** environ;

namespace cuboct {

namespace {

constexpr std::string_view kStarter = "CUBOCT_STARTED_BY=";

struct Child {
  const char* program;
  char** arguments;
  char** environment;
  bool apart;
  const char *out, *err, *in;
  pid_t parent;
};

// In the child: it shares our memory until it is the other program, so it calls nothing but the system.
[[noreturn]] void become(const Child& child, volatile int& error) {
  const auto send = [](int stream, const char* to) {
    if (*to == 0) return true;
    const int file = open(to, stream == STDIN_FILENO ? O_RDONLY : O_WRONLY | O_CREAT | O_TRUNC, 0666);
    const bool sent = file >= 0 && dup2(file, stream) >= 0;
    if (file >= 0 && file != stream) close(file);
    return sent;
  };
  // No program outlives the one that started it, however that ends.
  if (prctl(PR_SET_PDEATHSIG, child.apart ? SIGTERM : SIGKILL) == 0 && getppid() == child.parent &&
      (!child.apart || setpgid(0, 0) == 0) && send(STDOUT_FILENO, child.out) &&
      send(STDERR_FILENO, child.err) && send(STDIN_FILENO, child.in))
    execvpe(child.program, child.arguments, child.environment);
  error = errno;
  _exit(127);
}

// As posix_spawn, which cannot ask for a signal at our death. 0, or an errno.
int start(const Child& child, pid_t& pid) {
  // Until the child has become the other program, no handler of ours may run in it.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  volatile int error = 0;
  pid = vfork();
  if (pid == 0) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) {
      struct sigaction action {};
      if (sigaction(signal, nullptr, &action) == 0 && action.sa_handler != SIG_IGN) {
        action = {};
        action.sa_handler = SIG_DFL;
        sigaction(signal, &action, nullptr);
      }
    }
    // Ignored in ours (model/base/standard_streams.h), which other programs do not expect.
    struct sigaction usual {};
    usual.sa_handler = SIG_DFL;
    sigaction(SIGPIPE, &usual, nullptr);
    sigprocmask(SIG_SETMASK, &before, nullptr);
    become(child, error);
  }
  const int failed = pid < 0 ? errno : error;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (pid > 0 && failed != 0) waitpid(pid, nullptr, 0);
  return failed;
}

int exit_code(int status) { return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status); }

}  // namespace

Process::Process(const std::string& program, const std::vector<std::string>& arguments, bool apart,
                 const Streams& streams, const std::vector<std::string>& variables)
    : pid_(-1), passed_on_(apart ? SIGUSR1 : SIGTERM) {
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  std::vector<std::string> given = variables;
  given.push_back(fmt::format("{}{}", kStarter, getpid()));
  const auto is_given = [&](std::string_view variable) {
    const std::string_view name = variable.substr(0, variable.find('=') + 1);
    return name == kStarter ||
           std::ranges::any_of(variables, [&](const std::string& one) { return one.starts_with(name); });
  };
  for (char** variable = environ; *variable; ++variable)
    if (!is_given(*variable)) given.emplace_back(*variable);
  std::vector<char*> environment;
  for (std::string& variable : given) environment.push_back(variable.data());
  environment.push_back(nullptr);
  const Child child{program.c_str(),     argv.data(),         environment.data(), apart,
                    streams.out.c_str(), streams.err.c_str(), streams.in.c_str(), getpid()};
  const int error = start(child, pid_);
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

int Process::wait(const std::function<bool()>& begun, const std::function<bool()>& meanwhile) {
  constexpr std::chrono::seconds kGrace(2);
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> passed_on;
  bool early = false;
  int status = 0;
  // Readable when the program has ended. Where the kernel gives none, we look every 10 ms.
  struct Ended : pollfd {
    explicit Ended(pid_t pid) : pollfd{static_cast<int>(syscall(SYS_pidfd_open, pid, 0)), POLLIN, 0} {}
    ~Ended() {
      if (fd >= 0) close(fd);
    }
  } ended(pid_);
  const nfds_t count = ended.fd >= 0 ? 1 : 0;
  pid_t found = 0;
  while ((found = waitpid(pid_, &status, WNOHANG)) == 0) {
    // A terminal sends Ctrl-C to the engine as well; a `kill` meets us alone, and of our threads any one.
    if (interrupted() && !passed_on) {
      passed_on = Clock::now();
      early = begun && !begun();
      kill(pid_, early ? SIGTERM : passed_on_);
    } else if (early && Clock::now() - *passed_on > kGrace) {
      kill(pid_, SIGKILL);
    }
    const bool busy = meanwhile && meanwhile();
    poll(&ended, count, busy ? 0 : meanwhile ? 5 : count ? 100 : 10);
  }
  if (found < 0) throw std::runtime_error(fmt::format("waitpid: {}", std::strerror(errno)));
  pid_ = -1;
  return exit_code(status);
}

void Process::interrupt() const { kill(pid_, SIGINT); }

bool Process::ended() const {
  siginfo_t found{};
  return waitid(P_PID, static_cast<id_t>(pid_), &found, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         found.si_pid == pid_;
}

int Process::finish() {
  int status = 0;
  while (waitpid(pid_, &status, 0) < 0)
    if (errno != EINTR) throw std::runtime_error(fmt::format("waitpid: {}", std::strerror(errno)));
  pid_ = -1;
  return exit_code(status);
}

void end_with_starter() {
  if (!std::getenv(std::string(kStarter.substr(0, kStarter.size() - 1)).c_str())) return;
  // One that is init's child now has lost its starter before this call.
  if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() == 1) _exit(1);
}

namespace {
std::string other_directory;  // empty: that of the program
}

void set_program_directory(const std::string& directory) { other_directory = directory; }

std::string program_directory() {
  if (!other_directory.empty()) return other_directory;
  return std::filesystem::read_symlink("/proc/self/exe").parent_path().string();
}

std::string beside(const std::string& program) {
  const std::string path = program_directory() + "/" + program;
  return access(path.c_str(), X_OK) == 0 ? path : "";
}

bool in_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream directories(path ? path : "/bin:/usr/bin");  // as execvp
  for (std::string directory; std::getline(directories, directory, ':');)
    if (access(directory.append("/").append(program).c_str(), X_OK) == 0) return true;
  return false;
}

Scratch::Scratch() {
  const char* asked = std::getenv("TMPDIR");
  const bool own = asked == nullptr || *asked == 0;
  const std::filesystem::path parent(own ? "/tmp" : asked);
  std::string name = (parent / "cuboct-XXXXXX").string();
  if (!mkdtemp(name.data()))
    throw InputError(fmt::format("cannot make a directory in {}: {}", parent.string(), std::strerror(errno)),
                     own ? "TMPDIR names another place for files that go with the program"
                         : "TMPDIR says so: it has to name a directory in which you may write");
  directory_ = name;
}

Scratch::~Scratch() {
  std::error_code none;
  std::filesystem::remove_all(directory_, none);
}

}  // namespace cuboct
