// SPDX-License-Identifier: MIT
// Programs whose standard input, output and error are closed, full, or read no more.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "model/base/text.h"
#include "model/trace/trace.h"
#include "tests/cli/shell.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStreamsScene = "scenes/lj_block.toml";
constexpr const char* kOutputFull = "cannot write to standard output: No space left on device";

class StandardStreams : public testing::Test {
 protected:
  // By bash, in the root of the sources. What is left of standard error comes in `err`.
  Answer sh(const std::string& command) const {
    const std::string line =
        fmt::format("cd {}; cuboct={} dir={}; {{ {}; }} 2>{}", shell_word(CUBOCT_SOURCE_DIR),
                    shell_word(bench_.path("bin/cuboct")), shell_word(bench_.path("dir")), command,
                    shell_word(bench_.path("err")));
    const int status = std::system(("bash -c " + shell_word(line)).c_str());
    return {WEXITSTATUS(status), "", contents(bench_.path("err"))};
  }
  // All programs of the build.
  std::vector<std::string> programs() const {
    std::vector<std::string> found;
    for (const char* name : {"", "-lattice", "-systemc", "-rtl", "-fpga", "-board-sim", "-gpu"})
      if (fs::exists(CUBOCT_PROGRAM + std::string(name))) found.push_back(CUBOCT_PROGRAM + std::string(name));
    return found;
  }

  Bench bench_{true};
};

// Each nonempty choice of the three. Output that is not closed is dropped.
std::vector<std::string> closed_streams() {
  std::vector<std::string> all;
  for (int which = 1; which < 8; ++which)
    all.push_back(fmt::format("{} {}{}", which & 1 ? " <&-" : "", which & 2 ? ">&-" : ">/dev/null",
                              which & 4 ? " 2>&-" : ""));
  return all;
}

TEST_F(StandardStreams, ClosedOnesLeaveTheRunWhole) {
  for (const char* engine : {"lattice", "systemc"}) {
    const auto run = [&](const std::string& streams) {
      EXPECT_EQ(sh(fmt::format("$cuboct run {} --engine {} --steps 3 --quiet --force --out $dir{}",
                               kStreamsScene, engine, streams))
                    .code,
                0);
      return read_trace(bench_.path("dir/trace.h5")).state_hash;
    };
    const std::vector<uint64_t> whole = run(" >/dev/null");
    ASSERT_GT(whole.size(), 1u);
    // A program of its own starts as any other: of its runs one is enough, with all three closed.
    std::vector<std::string> closed = closed_streams();
    if (std::string(engine) == "systemc") closed.erase(closed.begin(), closed.end() - 1);
    for (const std::string& streams : closed) {
      SCOPED_TRACE(engine + streams);
      fs::remove_all(bench_.path("dir"));
      EXPECT_EQ(run(streams), whole);
    }
  }
}

// The engines' programs alone, as others may start them.
TEST_F(StandardStreams, ClosedOnesLeaveAProgramsTraceWhole) {
  const std::string out = bench_.path("t.h5");
  std::vector<std::string> engines{CUBOCT_LATTICE};
#ifdef CUBOCT_SYSTEMC
  engines.push_back(CUBOCT_SYSTEMC);
#endif
  for (const std::string& program : engines)
    for (const std::string& streams : closed_streams()) {
      SCOPED_TRACE(program + streams);
      EXPECT_EQ(sh(fmt::format("{} {} --steps 2 --out {}{}", shell_word(program), kStreamsScene,
                               shell_word(out), streams))
                    .code,
                0);
      EXPECT_EQ(read_trace(out).steps(), 2u);
      fs::remove(out);
    }
}

TEST_F(StandardStreams, OfAllProgramsMayBeClosed) {
  for (const std::string& program : programs())
    for (const std::string& streams : closed_streams())
      EXPECT_EQ(sh(shell_word(program) + " --help" + streams).code, 0) << program << streams;
}

TEST_F(StandardStreams, OfAllProgramsMayBeFull) {
  for (const std::string& program : programs()) {
    const Answer answer = sh(shell_word(program) + " --help >/dev/full");
    EXPECT_EQ(answer.code, 1) << program;
    EXPECT_EQ(answer.err, std::string(kOutputFull) + "\n") << program;
    EXPECT_EQ(sh(shell_word(program) + " --nonsense 2>/dev/full").code, 2) << program;
    EXPECT_EQ(sh(shell_word(program) + " --help | :; exit ${PIPESTATUS[0]}").code, 0) << program;
  }
}

// What a stranger's word holds never steers the terminal.
TEST_F(StandardStreams, OfAllProgramsShowEscapesAsText) {
  for (const std::string& program : programs())
    for (const char* word : {"$'--\\x1b[31m'", "$'\\x1b[31mx' --nonsense"}) {
      const Answer answer = sh(shell_word(program) + " " + word);
      EXPECT_EQ(answer.code, 2) << program;
      EXPECT_NE(answer.err, "") << program;
      EXPECT_EQ(answer.err.find('\x1b'), std::string::npos) << program << answer.err;
    }
}

// gnuplot has nothing to complain of, whatever the locale.
TEST_F(StandardStreams, PicturesComeInSilenceInAnyLocale) {
  ASSERT_EQ(sh(fmt::format("$cuboct run {} --steps 3 --quiet --out $dir >/dev/null", kStreamsScene)).code, 0);
  for (const char* locale : {"C", "POSIX", "nowhere"}) {
    const Answer answer = sh(fmt::format("LC_ALL={} $cuboct picture $dir >/dev/null", locale));
    EXPECT_EQ(answer.code, 0);
    EXPECT_EQ(answer.err, "");
  }
}

// The same rule for all, in lines and in JSON, below a buffer's size and beyond it.
TEST_F(StandardStreams, AFullOutputIsToldByEachCommand) {
  ASSERT_EQ(sh(fmt::format("$cuboct run {} --steps 3 --quiet --out $dir >/dev/null", kStreamsScene)).code, 0);
  const std::string scene = std::string(" ") + kStreamsScene;
  std::vector<std::string> commands{"--version",
                                    "--help",
                                    "run --help",
                                    "bench --list",
                                    "new --list",
                                    "check" + scene,
                                    "run" + scene + " --steps 1 --quiet",
                                    "crosscheck" + scene + " --steps 1 --engines golden,lattice",
                                    "energy" + scene,
                                    "emit" + scene + " --out " + bench_.path("rtl"),
                                    "report $dir",
                                    "picture $dir",
                                    "new " + bench_.path("a.toml") + " --like gas"};
  for (const std::string& command : commands)
    for (const char* json : {"", " --json"}) {
      if (*json != 0 && (command.starts_with("--") || command.starts_with("report"))) continue;
      fs::remove(bench_.path("a.toml"));
      fs::remove_all(bench_.path("rtl"));
      SCOPED_TRACE(command + json);
      const Answer answer = sh("$cuboct " + command + json + " >/dev/full");
      EXPECT_EQ(answer.code, 1);
      if (*json == 0)
        EXPECT_TRUE(answer.err.ends_with(std::string(kOutputFull) + "\n")) << answer.err;
      else
        EXPECT_EQ(nlohmann::json::parse(answer.err)["error"]["message"], kOutputFull);
      if (command.starts_with("report")) continue;  // it takes seconds, and ends as picture does
      EXPECT_EQ(sh("$cuboct " + command + json + " | :; exit ${PIPESTATUS[0]}").code,
                command.starts_with("new /") ? 2 : 0);  // it is there already
    }
}

// The files come first: what they hold does not hang on who reads the summary.
TEST_F(StandardStreams, AFullOutputCostsNothingOfTheRun) {
  EXPECT_EQ(sh(fmt::format("$cuboct run {} --steps 3 --quiet --out $dir >/dev/full", kStreamsScene)).code, 1);
  EXPECT_EQ(read_trace(bench_.path("dir/trace.h5")).steps(), 3u);
  EXPECT_NE(contents(bench_.path("dir/run.toml")).find("state = 'finished'"), std::string::npos);
}

TEST_F(StandardStreams, ATemporaryDirectoryThatIsNotThereIsNamed) {
  const Answer answer = sh(fmt::format("TMPDIR=/nowhere $cuboct run {} --steps 3", kStreamsScene));
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(answer.err,
            "cannot make a directory in /nowhere: No such file or directory\n"
            "  hint: TMPDIR says so: it has to name a directory in which you may write\n");
}

TEST_F(StandardStreams, ARefusalOfTheFileSystemIsOneOfInput) {
  const std::string name(300, 'a');
  for (const auto& [command, told] : {std::pair{"$cuboct picture ", name + " holds no pictures: "},
                                      {"$cuboct report ", name + " holds no run: "},
                                      {"$cuboct synth --target up5k ", ": File name too long\n"}}) {
    const Answer answer = sh(command + name);
    EXPECT_EQ(answer.code, 2);
    EXPECT_NE(answer.err.find(told), std::string::npos) << answer.err;
    EXPECT_EQ(answer.err.find("filesystem error"), std::string::npos) << answer.err;
  }
}

TEST_F(StandardStreams, AFullErrorOutputChangesNoExitCode) {
  EXPECT_EQ(sh("$cuboct run nowhere.toml 2>/dev/full").code, 2);
  EXPECT_EQ(sh("$cuboct run nowhere.toml --json 2>/dev/full").code, 2);
  EXPECT_EQ(sh(fmt::format("$cuboct run {} --steps 3 >/dev/null 2>/dev/full", kStreamsScene)).code, 0);
}

}  // namespace
}  // namespace cuboct::test
