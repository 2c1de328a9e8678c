// SPDX-License-Identifier: MIT
// The command lines of cuboct-systemc and cuboct-rtl: exit codes and texts, as a user meets them.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "model/trace/trace.h"
#include "tests/support/folder.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

struct Ended {
  int code = -1;
  std::string err, out;
};

class Programs : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(dir_ / "bad.toml") << "stepz = 3\n"
                                     << std::ifstream(CUBOCT_SOURCE_DIR "/scenes/lj_block.toml").rdbuf();
  }

  Ended run(const std::string& command) const {
    const int status = std::system(fmt::format("cd '{}' && {} > out 2> err", dir_.string(), command).c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, folder_.read("err"), folder_.read("out")};
  }
  // A tool on the path that `script` describes; the path holds nothing else.
  void tool(const std::string& name, const std::string& script) const {
    fs::create_directories(dir_ / "bin");
    std::ofstream(dir_ / "bin" / name) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(dir_ / "bin" / name, fs::perms::owner_all);
  }
  // cuboct-rtl on a good scene, with that path.
  Ended rtl(const std::string& variables = "") const {
    fs::create_directories(dir_ / "bin");
    return run(fmt::format("env -u CXX {} PATH='{}' '{}' '{}' --steps 1 --out t.h5 --build-dir made",
                           variables, (dir_ / "bin").string(), CUBOCT_RTL,
                           CUBOCT_SOURCE_DIR "/scenes/lj_block.toml"));
  }
  // Files in the build directory, by extension.
  std::vector<std::string> made(const std::string& extension) const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(dir_ / "made"))
      if (entry.path().extension() == extension) names.push_back(entry.path().filename().string());
    return names;
  }

  const test::Folder folder_;
  const fs::path dir_ = folder_.path();
};

constexpr const char* kVerilator = "if [ \"$1\" = --version ]; then echo Verilator 5.006; exit 0; fi; ";
constexpr const char* kCompiler =
    "[ \"$1\" = --version ] && echo c++ 12 && exit 0; echo 'no such flag'; exit 4";

TEST_F(Programs, WrongCommandLinesAndScenesEndWithTwo) {
  for (const std::string program : {CUBOCT_SYSTEMC, CUBOCT_RTL}) {
    const auto ends = [&](const std::string& arguments, const std::string& text) {
      const Ended e = run("'" + program + "' " + arguments);
      EXPECT_EQ(e.code, 2) << program << " " << arguments;
      EXPECT_EQ(e.err, text) << program << " " << arguments;
    };
    const std::string help = "Run with --help for more information.\n";
    const std::string scene = "'" CUBOCT_SOURCE_DIR "/scenes/lj_block.toml'";
    ends("", "a scene is required\n");
    ends(scene, "--out is required\n");
    ends(scene + " --out t.h5 --stepz", "unknown option '--stepz'\n" + help);
    ends(scene + " --out t.h5 --stall-rate 2",
         "--stall-rate: Value 2 not in range 0.000000 to 0.990000\n" + help);
    ends("none.toml --out t.h5", "none.toml: cannot read this file\n");
    ends("bad.toml --out t.h5", "bad.toml:1:1: unknown key 'stepz'\n   1 | stepz = 3\n     | ^\n");
    ends(scene + " --out none/t.h5", "cannot write none/t.h5: No such file or directory\n");
    ends(scene + " --out t.h5 --steps 5000000000",
         "5000000000 steps: the machine counts at most 4294967295\n");
  }
  EXPECT_EQ(run(fmt::format("'{}' --help", CUBOCT_RTL)).code, 0);
}

TEST_F(Programs, RefuseWhatTheirWordsDoNotHoldAtItsKey) {
  std::ofstream(dir_ / "a.toml") << "name = \"a\"\n[link]\nbits = 500\ncheck = \"retry\"\n";
  for (const std::string program : {CUBOCT_SYSTEMC, CUBOCT_RTL}) {
    const Ended e = run("'" + program +
                        "' '" CUBOCT_SOURCE_DIR "/scenes/lj_block.toml' --arch a.toml --steps 1 --out t.h5");
    EXPECT_EQ(e.code, 2);
    EXPECT_EQ(e.err,
              "a.toml:3:8: a checked beat of 521 bits: the cycle-accurate engines hold at most 512\n"
              "   3 | bits = 500\n     |        ^\n  hint: use fewer link.bits\n");
  }
}

TEST_F(Programs, AFileOfFramesTakesWhatACommandLineCannot) {
  const std::string scene = "'" CUBOCT_SOURCE_DIR "/scenes/lj_block.toml'",
                    program = "'" CUBOCT_SYSTEMC "' " + scene;
  std::ofstream every(dir_ / "every");
  for (int step = 100000; step >= 0; --step) every << step << '\n';  // 590 kB; an argument holds 128 kB
  every.close();
  std::ofstream(dir_ / "few") << "1\r\n\n3";
  std::ofstream(dir_ / "bad") << "1\n2 \n";
  const Ended all = run(program + " --out all.h5 --steps 3 --frames-file every");
  EXPECT_EQ(all.code, 0) << all.err;
  EXPECT_EQ(run(program + " --out listed.h5 --steps 3 --frames 0,1,2,3").code, 0);
  EXPECT_EQ(run(program + " --out few.h5 --steps 3 --frames-file few").code, 0);
  const Trace all_frames = read_trace(dir_ / "all.h5"), listed = read_trace(dir_ / "listed.h5"),
              few = read_trace(dir_ / "few.h5");
  ASSERT_EQ(all_frames.frames.size(), 4u);
  EXPECT_TRUE(all_frames.frames == listed.frames);
  ASSERT_EQ(few.frames.size(), 2u);
  EXPECT_TRUE(few.frames[1] == listed.frames[3]);

  const Ended bad = run(program + " --out t.h5 --frames-file bad");
  EXPECT_EQ(bad.code, 2);
  EXPECT_EQ(bad.err, "bad:2:1: expected a step, got '2 '\n  hint: one number per line\n");
  const Ended none = run(program + " --out t.h5 --frames-file none");
  EXPECT_EQ(none.code, 2);
  EXPECT_EQ(none.err, "none: cannot read this file\n");
  const Ended both = run(program + " --out t.h5 --frames-file few --frames 1");
  EXPECT_EQ(both.code, 2);
  EXPECT_EQ(both.err, "--frames excludes --frames-file\nRun with --help for more information.\n");
}

TEST_F(Programs, BenchPrintsOneLineAndNeedsNoTrace) {
  const Ended e = run("'" CUBOCT_SYSTEMC "' '" CUBOCT_SOURCE_DIR "/scenes/lj_block.toml' --steps 3 --bench");
  EXPECT_EQ(e.code, 0) << e.err;
  std::smatch match;
  ASSERT_TRUE(std::regex_match(e.out, match, std::regex("systemc\\.node_cycles ([0-9.e+]+) 1/s\n"))) << e.out;
  EXPECT_GT(std::stod(match[1]), 1e3);
  EXPECT_LT(std::stod(match[1]), 1e10);
}

TEST_F(Programs, WithoutVerilatorOneLineNamesItsPackage) {
  const Ended e = rtl();
  EXPECT_EQ(e.code, 2);
  EXPECT_EQ(e.err,
            "verilator is missing: the emitted hardware is compiled with it (Debian package verilator)\n");
}

TEST_F(Programs, WithoutACompilerOneLineNamesItsPackage) {
  tool("verilator", kVerilator);
  const Ended e = rtl();
  EXPECT_EQ(e.code, 2);
  EXPECT_EQ(e.err, "c++ is missing: the emitted hardware is compiled with it (Debian package g++)\n");
}

// CXX may hold more than one word, as in make: the tool before the compiler gets the rest.
TEST_F(Programs, TheCompilerMayHaveAToolBeforeIt) {
  tool("verilator", std::string(kVerilator) + "echo /usr");
  tool("ccache", "echo \"$*\" >> '" + (dir_ / "asked").string() + "'");
  const Ended e = rtl("CXX='ccache g++'");
  EXPECT_EQ(e.err.find("is missing"), std::string::npos) << e.err;
  std::ifstream asked(dir_ / "asked");
  std::string first, second;
  std::getline(asked, first);
  std::getline(asked, second);
  EXPECT_EQ(first, "g++ --version");
  EXPECT_TRUE(second.starts_with("g++ -std=c++17 ")) << second;
  EXPECT_EQ(rtl("CXX='nowhere g++'").err,
            "nowhere g++ is missing: the emitted hardware is compiled with it (Debian package g++)\n");
}

TEST_F(Programs, AToolThatDoesNotRunIsNamed) {
  tool("verilator", "exit 1");
  const Ended e = rtl();
  EXPECT_EQ(e.code, 2);
  EXPECT_EQ(e.err, "'verilator --version' fails: the tool does not work\n");
}

// The log keeps what the tool said; its name is the library's, so another try writes the same file.
TEST_F(Programs, AFailureNamesTheLog) {
  tool("verilator", std::string(kVerilator) + "echo 'bad day'; exit 3");
  tool("c++", kCompiler);
  for (const std::string tool_name : {"verilator", "the C++ compiler"}) {
    fs::remove_all(dir_ / "made");
    if (tool_name != "verilator") tool("verilator", std::string(kVerilator) + "echo /usr; exit 0");
    for (int tries = 0; tries < 2; ++tries) {
      const Ended e = rtl();
      EXPECT_EQ(e.code, 2);
      const std::vector<std::string> logs = made(".log");
      ASSERT_EQ(logs.size(), 1u);
      EXPECT_TRUE(std::regex_match(logs[0], std::regex("cuboct_node-[0-9a-f]{16}\\.log"))) << logs[0];
      EXPECT_EQ(e.err, fmt::format("{} failed: see {}\n", tool_name, (dir_ / "made" / logs[0]).string()));
      std::ifstream log(dir_ / "made" / logs[0]);
      std::string line, last;
      while (std::getline(log, line)) last = line;
      EXPECT_EQ(last, tool_name == "verilator" ? "bad day" : "no such flag");
      EXPECT_EQ(std::distance(fs::directory_iterator(dir_ / "made"), fs::directory_iterator()), 1)
          << "only the log";
    }
  }
}

// A compiled node serves only the tools that made it: another version has another name.
TEST_F(Programs, TheNameHoldsTheVersionsOfTheTools) {
  std::vector<std::string> names;
  for (const auto& [verilator, compiler] : {std::pair{"5.006", "12"}, {"5.008", "12"}, {"5.006", "13"}}) {
    tool("verilator",
         fmt::format("if [ \"$1\" = --version ]; then echo Verilator {}; exit 0; fi; exit 3", verilator));
    tool("c++", fmt::format("echo c++ {}", compiler));
    fs::remove_all(dir_ / "made");
    EXPECT_EQ(rtl().code, 2);
    for (const std::string& name : made(".log")) names.push_back(name);
  }
  ASSERT_EQ(names.size(), 3u);
  EXPECT_NE(names[0], names[1]);
  EXPECT_NE(names[0], names[2]);
  EXPECT_NE(names[1], names[2]);
}

}  // namespace
}  // namespace cuboct::test
