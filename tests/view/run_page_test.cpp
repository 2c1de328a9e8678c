// SPDX-License-Identifier: MIT
// `cuboct run --view`: the page of a run, which it outlives, and which never ends it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

#include "tests/cli/shell.h"
#include "tests/view/page_client.h"

namespace cuboct::test {
namespace {

namespace fs = std::filesystem;

// A browser that copies what it is asked to open.
void put_browser(const Bench& bench) {
  fs::create_directories(bench.path("browser"));
  std::ofstream(bench.path("browser/xdg-open")) << "#!/bin/sh\n/bin/cp \"$1\" " + bench.path("copy") +
                                                       " && /bin/mv " + bench.path("copy") + " " +
                                                       bench.path("opened") + "\n";
  fs::permissions(bench.path("browser/xdg-open"), fs::perms::owner_all);
}

class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_(name) {
    if (const char* now = std::getenv(name)) before_ = now;
    setenv(name, value.c_str(), 1);
  }
  ~Environment() { setenv(name_, before_.c_str(), 1); }

 private:
  const char* name_;
  std::string before_;
};

const std::vector<std::string> kLong{"run",  "scenes/coupon.toml", "--steps", "10000000", "--frame-every",
                                     "1000", "--anyway",           "--view",  "--out"};

std::vector<std::string> with(std::vector<std::string> words, const std::string& last) {
  words.push_back(last);
  return words;
}

TEST(RunPage, FollowsTheRunWhichLeavesItsReport) {
  const Bench bench(false);
  put_browser(bench);
  const Environment path("PATH", bench.path("browser") + ":" + std::getenv("PATH")), display("DISPLAY", ":7");
  std::string story;
  const Answer ran = bench.cuboct(with(kLong, bench.path("run")), [&](pid_t) {
    story = ask(address_in(contents(bench.path("opened"))), "story");
    return has(story, "\"extent\"") && has(story, "\"live\":true");
  });
  EXPECT_EQ(ran.code, 1) << ran.err;
  EXPECT_TRUE(has(story, "coupon in tension")) << story.substr(0, 1000);
  // The browser's file leads to the address that the command has told.
  const Address told = address_in(ran.err);
  EXPECT_EQ(told.token, address_in(contents(bench.path("opened"))).token);
  EXPECT_TRUE(ask(told, "story").empty());  // Ctrl-C ends both
  EXPECT_TRUE(has(contents(bench.path("run/report.html")), "<h2>Run</h2>"));
  EXPECT_TRUE(has(contents(bench.path("run/run.toml")), "state = 'interrupted'"));
}

// Without a display the address is told; nobody opens it, so the command ends with the run.
TEST(RunPage, EndsWithTheRunThatNobodyLooksAt) {
  const Bench bench(false);
  const Environment x("DISPLAY", ""), wayland("WAYLAND_DISPLAY", "");
  const Answer ran = bench.cuboct({"run", "scenes/lj_block.toml", "--steps", "3", "--quiet", "--view",
                                   "--out", bench.path("run"), "--json"});
  EXPECT_EQ(ran.code, 0);
  EXPECT_TRUE(std::regex_match(ran.err, std::regex("view: http://127\\.0\\.0\\.1:\\d+/[0-9a-f]{32}/\n")))
      << ran.err;
  EXPECT_EQ(ran.out[0], '{');
  EXPECT_TRUE(fs::exists(bench.path("run/report.html")));
  EXPECT_EQ(bench.cuboct({"run", "scenes/lj_block.toml", "--steps", "3", "--view"}).err,
            "--view needs --out DIR: without it nothing of the run is kept\n");
}

// Without gnuplot, and so without a report, which would take the most time of the tests that follow.
struct Bare {
  const Bench bench{false};
  const Environment path{"PATH", bench.path("browser")}, x{"DISPLAY", ""}, wayland{"WAYLAND_DISPLAY", ""};
};

// The page is then that of the directory, until Ctrl-C.
TEST(RunPage, OutlivesTheRunOnceItIsOpened) {
  const Bare at;
  put_browser(at.bench);
  fs::create_symlink("/usr/bin/setsid", at.bench.path("browser/setsid"));
  const Environment display("DISPLAY", ":7");
  std::string story;
  const Answer ran = at.bench.cuboct(
      {"run", "scenes/lj_block.toml", "--steps", "3", "--view", "--quiet", "--out", at.bench.path("run")},
      [&](pid_t) {
        story = ask(address_in(contents(at.bench.path("opened"))), "story");
        return has(story, "\"live\":false");
      });
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(has(story, "\"step\":3,")) << story.substr(0, 1000);
}

// Each stage has a page; the first alone is opened.
TEST(RunPage, OfStagesIsOneOfEach) {
  const Bare at;
  const Bench& bench = at.bench;
  std::ifstream one(std::string(CUBOCT_SOURCE_DIR) + "/scenes/lj_block.toml");
  std::ofstream scene(bench.path("two.toml"));
  scene << one.rdbuf()
        << "\n[[stage]]\nname = \"first\"\nsteps = 3\n[[stage]]\nname = \"second\"\nsteps = 2\n";
  scene.close();
  const Answer ran =
      bench.cuboct({"run", bench.path("two.toml"), "--view", "--quiet", "--out", bench.path("run")});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(std::regex_match(
      ran.err, std::regex("(view: http://[0-9a-f.:/]+\nwarning: --view leaves no report[^\n]+\n){2}")))
      << ran.err;
}

// A page that ends the run stays, and so does the command.
TEST(RunPage, StaysWhereItHasEndedTheRun) {
  const Bare place;
  const Bench& bench = place.bench;
  bool asked = false;
  std::string story;
  const Answer ran = bench.cuboct(with(kLong, bench.path("run")), [&](pid_t) {
    const Address at = address_in(contents(bench.path("err")));
    if (at.port == 0) return false;
    if (!asked) {
      ask(at, "");  // opened
      return asked = has(ask(at, "command/end", "POST"), " 204 "), false;
    }
    story = ask(at, "story");
    return has(story, "\"live\":false");
  });
  EXPECT_EQ(ran.code, 1) << ran.err;
  EXPECT_TRUE(has(story, "\"live\":false"));
  EXPECT_TRUE(has(contents(bench.path("run/run.toml")), "state = 'interrupted'"));
}

// No gnuplot, no program of the page; the run is none the worse.
TEST(RunPage, NeverEndsARun) {
  const Bench bench(false);
  fs::remove(bench.path("bin/cuboct-view"));
  const Environment path("PATH", bench.path("nothing")), display("DISPLAY", "");
  const Answer ran = bench.cuboct(
      {"run", "scenes/lj_block.toml", "--steps", "3", "--quiet", "--view", "--out", bench.path("run")});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(
      ran.err.starts_with("warning: --view shows no page: view: no program cuboct-view beside cuboct"))
      << ran.err;
  EXPECT_TRUE(has(ran.err, "; the run goes on\nwarning: --view leaves no report: ")) << ran.err;
  EXPECT_FALSE(fs::exists(bench.path("run/report.html")));
  EXPECT_TRUE(fs::exists(bench.path("run/trace.h5")));
}

// Options of a page of a run that goes, told of one that is over.
TEST(RunPage, OfARunThatIsOverIsRefused) {
  const Bench bench(false);
  const std::string out = bench.path("run");
  ASSERT_EQ(bench.cuboct({"run", "scenes/lj_block.toml", "--steps", "3", "--quiet", "--out", out}).code, 0);
  const Answer answer = bench.cuboct({"view", out, "--while-run", "--no-open"});
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(answer.err, "--while-run is of a run that goes, and " + out +
                            " holds none\n  hint: without it the page stays until Ctrl-C\n");
}

}  // namespace
}  // namespace cuboct::test
