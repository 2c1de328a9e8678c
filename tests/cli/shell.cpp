// SPDX-License-Identifier: MIT
#include "tests/cli/shell.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace cuboct::test {

namespace fs = std::filesystem;

std::string contents(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

Bench::Bench(bool fake_engines) {
  std::string name = (fs::temp_directory_path() / "cuboct-test-XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("mkdtemp");
  directory_ = name;
  fs::create_directory(directory_ / "bin");
  fs::copy(CUBOCT_PROGRAM, directory_ / "bin/cuboct");
  if (fake_engines)
    for (const char* engine : {"cuboct-systemc", "cuboct-rtl"})
      fs::copy(FAKE_ENGINE, directory_ / "bin" / engine);
}

Bench::~Bench() {
  std::error_code none;
  fs::remove_all(directory_, none);
}

Answer Bench::cuboct(const std::vector<std::string>& arguments, double interrupt_after) const {
  const std::string program = path("bin/cuboct");
  std::vector<char*> argv{const_cast<char*>("cuboct")};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    const auto redirect = [](int to, const std::string& file, int flags) {
      const int from = open(file.c_str(), flags, 0666);
      dup2(from, to);
    };
    redirect(0, "/dev/null", O_RDONLY);
    redirect(1, path("out"), O_WRONLY | O_CREAT | O_TRUNC);
    redirect(2, path("err"), O_WRONLY | O_CREAT | O_TRUNC);
    if (chdir(CUBOCT_SOURCE_DIR) == 0) execv(program.c_str(), argv.data());
    _exit(127);
  }
  if (interrupt_after > 0) {
    std::this_thread::sleep_for(std::chrono::duration<double>(interrupt_after));
    kill(child, SIGINT);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), contents(path("out")),
          contents(path("err"))};
}

}  // namespace cuboct::test
